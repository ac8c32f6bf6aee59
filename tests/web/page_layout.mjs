// SPDX-License-Identifier: Apache-2.0
// Returns problems of a page's layout, as sentences. Runs in the page: uses nothing from outside of the function. window:
// size in CSS pixels; a parameter, since a phone's innerWidth grows with content that is too wide.
export async function layoutProblems({ state, window: { width: innerWidth, height: innerHeight }, below = false, world = false }) {
  const kMinContrast = 4.5, kMinLarge = 3, kSlackPx = 2, kFigureAlpha = 200;
  const problems = [], viewers = [...document.querySelectorAll('fourdvt-viewer')];
  const nameOf = (element) => `${element.localName}${element.id ? `#${element.id}` : ''} "${(element.ariaLabel || element.textContent).trim().replace(/\s+/g, ' ').slice(0, 40)}"`;
  const px = (value) => Math.round(value);
  const overlap = (a, b) => Math.min(a.right - b.left, b.right - a.left, a.bottom - b.top, b.bottom - a.top);
  const isSeen = (element) => {
    const box = element.getBoundingClientRect();
    if (box.width < 2 || box.height < 2 || element.closest('.unseen, .skip')) return false;
    return element.checkVisibility({ opacityProperty: true, visibilityProperty: true });
  };

  // --- the window ---

  if (document.documentElement.scrollWidth > innerWidth + 1) problems.push(`the page scrolls sideways: ${document.documentElement.scrollWidth} px in a window of ${innerWidth}`);
  for (const viewer of viewers) {
    const box = viewer.getBoundingClientRect(), size = `${px(box.width)}×${px(box.height)}`, window = `a window of ${innerWidth}×${innerHeight}`;
    if (box.width > innerWidth + 1 || box.height > innerHeight + 1) problems.push(`the viewer is ${size} in ${window}`);
    else if (box.left < -1 || box.right > innerWidth + 1) problems.push(`the viewer reaches from ${px(box.left)} to ${px(box.right)} px across ${window}`);
    else if (!below && (box.top < -1 || box.bottom > innerHeight + 1)) problems.push(`the viewer reaches from ${px(box.top)} to ${px(box.bottom)} px down ${window}`);
    if (box.height > 3 * box.width || box.width > 3 * box.height) problems.push(`the viewer's ratio is ${size}`);
    if (box.width < 120 || box.height < 0.2 * innerHeight) problems.push(`the viewer is small: ${size}`);
  }

  const boxes = viewers.map((viewer) => viewer.getBoundingClientRect()), margins = [Math.min(...boxes.map(({ left }) => left)), innerWidth - Math.max(...boxes.map(({ right }) => right))];
  if (below && Math.abs(margins[0] - margins[1]) > 0.1 * innerWidth) problems.push(`the viewers leave ${px(margins[0])} px at the left and ${px(margins[1])} px at the right`);

  // --- the figure ---

  // The box of opaque pixels in a picture that is drawn into `box`.
  const opaqueBox = (picture, width, height, box) => {
    const [w, h] = [Math.max(1, px(width / 4)), Math.max(1, px(height / 4))], copy = new OffscreenCanvas(w, h).getContext('2d', { willReadFrequently: true });
    copy.drawImage(picture, 0, 0, w, h);
    const { data } = copy.getImageData(0, 0, w, h);
    let [left, top, right, bottom] = [w, h, -1, -1];
    for (let i = 0; i < w * h; ++i) {
      if (data[4 * i + 3] < kFigureAlpha) continue;
      const x = i % w, y = (i - x) / w;
      [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x), Math.max(bottom, y)];
    }
    if (right < 0) return null;
    const across = box.width / w, down = box.height / h;
    return { left: box.left + left * across, right: box.left + (right + 1) * across, top: box.top + top * down, bottom: box.top + (bottom + 1) * down };
  };
  const nextPictures = async (count) => { for (let i = 0; i < count; ++i) await new Promise((next) => requestAnimationFrame(next)); };
  const figureOf = async (viewer) => {
    const box = viewer.getBoundingClientRect();
    if (state === 'poster') {
      const image = viewer.shadowRoot?.querySelector('.picture');
      if (!image || image.hidden || !image.naturalWidth) return null;
      const scale = Math.min(box.width / image.naturalWidth, box.height / image.naturalHeight), [width, height] = [image.naturalWidth * scale, image.naturalHeight * scale];
      return opaqueBox(image, width, height, { left: box.left + (box.width - width) / 2, top: box.top + (box.height - height) / 2, width, height });
    }
    const canvas = viewer.shadowRoot?.querySelector('canvas');
    if (!canvas) return null;
    const { scene } = viewer; // it covers all pixels
    if (scene.length) {
      viewer.scene = [];
      await nextPictures(4);
    }
    const found = opaqueBox(canvas, canvas.width, canvas.height, box);
    if (scene.length) {
      viewer.scene = scene;
      await nextPictures(4);
    }
    return found;
  };
  const figures = [];
  for (const viewer of viewers) {
    if (viewer.getBoundingClientRect().top > innerHeight) continue;
    const figure = await figureOf(viewer);
    if (!figure && world && state === 'poster') continue; // its place is drawn with the figure
    if (!figure) problems.push(`the viewer ${viewer.id} shows no figure`);
    else if (figure.right - figure.left < 16 || figure.bottom - figure.top < 64) problems.push(`the figure is ${px(figure.right - figure.left)}×${px(figure.bottom - figure.top)}`);
    else figures.push({ viewer, figure });
  }
  const texts = [...document.querySelectorAll('h1, h2, h3, p, a, button, input, select, label, legend, output, figcaption, kbd, dt, dd, li, td, th')].filter((element) => isSeen(element) && !element.closest('fourdvt-viewer'));
  const parts = viewers.flatMap((viewer) => [...viewer.shadowRoot?.querySelectorAll('[part]') ?? []]).filter((part) => part.matches('.controls, .play, .error, .note, .prompt, .joystick') && isSeen(part));
  for (const { figure, viewer } of figures) {
    for (const element of [...texts, ...parts]) {
      if (element.matches('.controls.small')) continue; // the corner button
      const box = element.getBoundingClientRect();
      if (overlap(box, figure) > kSlackPx) problems.push(`${nameOf(element)} lies over the figure of ${viewer.id || 'the viewer'} by ${px(overlap(box, figure))} px`);
    }
  }
  for (const part of parts) {
    for (const element of texts) if (overlap(part.getBoundingClientRect(), element.getBoundingClientRect()) > kSlackPx) problems.push(`${nameOf(element)} lies over the viewer's ${part.className || part.getAttribute('part')}`);
    const button = part.matches('.controls.small') && part.querySelector('button'), box = button && button.getBoundingClientRect(), outer = part.getRootNode().host.getBoundingClientRect();
    if (box && (box.width < 44 || box.height < 44)) problems.push(`the corner button is ${px(box.width)}×${px(box.height)} px`);
    if (box && Math.min(box.left - outer.left, outer.right - box.right, outer.bottom - box.bottom, innerWidth - box.right) < 8) problems.push('the corner button touches the edge');
  }

  // --- text that is cut off ---

  const textBox = (element) => {
    const range = document.createRange();
    range.selectNodeContents(element);
    return range.getBoundingClientRect();
  };
  const scrolls = (element) => { for (let at = element; at; at = at.parentElement) if (/auto|scroll/.test(getComputedStyle(at).overflowX)) return true; return false; };
  for (const element of texts.filter((e) => e.matches('h1, h2, h3, p, a, button, label, legend, output, figcaption, dd, dt') && e.textContent.trim())) {
    const box = textBox(element);
    if (!box.width || scrolls(element)) continue;
    const style = getComputedStyle(element), clips = (s) => s.overflow !== 'visible';
    if (box.left < -1 || box.right > innerWidth + 1 || box.top + scrollY < 0) problems.push(`${nameOf(element)} is cut off by the window: ${px(box.left)} to ${px(box.right)} px across, from ${px(box.top + scrollY)} px down`);
    if (clips(style) && (element.scrollWidth > element.clientWidth + 1 || element.scrollHeight > element.clientHeight + 1)) problems.push(`${nameOf(element)} is cut off`);
    for (let at = element.parentElement; at && at !== document.body; at = at.parentElement) {
      const outer = at.getBoundingClientRect();
      if (clips(getComputedStyle(at)) && (box.left < outer.left - 1 || box.right > outer.right + 1 || box.top < outer.top - 1 || box.bottom > outer.bottom + 1)) problems.push(`${nameOf(element)} is cut off by ${at.localName}.${at.className}`);
    }
    if (element.matches('h1, h2') && box.height > 0 && element.getBoundingClientRect().height + 1 < box.height * 0.9) problems.push(`${nameOf(element)} is higher than its line`);
  }

  // --- contrast ---

  const paint = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true }), colors = new Map();
  const colorOf = (text) => {
    if (colors.has(text)) return colors.get(text);
    paint.clearRect(0, 0, 1, 1);
    paint.fillStyle = text;
    paint.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = paint.getImageData(0, 0, 1, 1).data, color = [r, g, b, a / 255];
    colors.set(text, color);
    return color;
  };
  const over = ([r, g, b, a], under) => [r, g, b].map((value, i) => value * a + under[i] * (1 - a));
  const luminance = (color) => color.map((value) => value / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)).reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const contrast = (a, b) => { const [x, y] = [luminance(a), luminance(b)].sort((p, q) => q - p); return (x + 0.05) / (y + 0.05); };
  const stops = (style) => [...style.backgroundImage.matchAll(/(?:rgba?|color|oklab|oklch)\([^()]*\)/g)].map(([text]) => colorOf(text)).filter(([, , , a]) => a > 0.5);
  // Colours that may be behind an element's text: each stop of a gradient; over a world dark and light ones, too.
  const grounds = new Map(), ofWorld = world ? [[90, 110, 80], [230, 220, 205]] : [];
  const behind = (element) => {
    if (!element) return [colorOf('canvas').slice(0, 3), ...ofWorld];
    if (!grounds.has(element)) {
      const style = getComputedStyle(element), color = colorOf(style.backgroundColor), gradient = stops(style);
      const under = color[3] > 0.99 ? [color.slice(0, 3)] : behind(element.parentElement).map((ground) => over(color, ground));
      grounds.set(element, gradient.length ? [...gradient.map((stop) => stop.slice(0, 3)), ...ofWorld] : under);
    }
    return grounds.get(element);
  };
  for (const element of texts) {
    const own = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim());
    if (!own || element.matches(':disabled, :disabled *')) continue;
    const style = getComputedStyle(element), sizePx = parseFloat(style.fontSize), large = sizePx >= 24 || (sizePx >= 18.66 && Number(style.fontWeight) >= 700);
    const ratio = Math.min(...behind(element).map((ground) => contrast(over(colorOf(style.color), ground), ground)));
    if (ratio < (large ? kMinLarge : kMinContrast) - 0.005) problems.push(`${nameOf(element)} has a contrast of ${ratio.toFixed(2)}`);
  }
  return [...new Set(problems)];
}
