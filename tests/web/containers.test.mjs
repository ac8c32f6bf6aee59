// SPDX-License-Identifier: Apache-2.0
// The viewer in different containers: padding and borders, scaled and rotated ancestors, zoom, other pixel ratios, other
// documents, pages scrolled by touch, right-to-left pages, and contrast themes.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, waitForEvent } from './harness.mjs';
import { load } from './load_source.mjs';
import { serve } from './server.mjs';

const kWidth = 240, kHeight = 320; // of the viewer, CSS pixels
const kDegPerHeight = 240;         // of a drag
const kSource = 'src="/character/character.gltf" upload-path="i420" sequence="walk"';
const kPage = (body, lang = 'lang="en"') => ({ headers: {}, html: `<!doctype html><html ${lang}><meta charset="utf-8"><title>viewer</title><link rel="icon" href="data:,">
<meta name="viewport" content="width=device-width"><style>body { margin: 0 } fourdvt-viewer { width: ${kWidth}px; height: ${kHeight}px }</style>
<script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script>${body}` });
const kStrip = (attributes) => kPage(`<div id="strip" style="display: flex; overflow-x: auto; width: 360px"><fourdvt-viewer ${kSource} controls="none" style="flex: none" ${attributes}></fourdvt-viewer>
<p style="flex: none; width: 900px">picture</p></div><p style="height: 2000px">text</p>`);
const kPages = {
  '/plain.html': kPage(`<div id="outer" style="width: max-content; transform-origin: 0 0"><fourdvt-viewer ${kSource} camera-orbit="0deg 5deg auto" controls="none"></fourdvt-viewer></div>`),
  '/bar.html': kPage(`<fourdvt-viewer ${kSource} style="width: 480px" controls camera-controls></fourdvt-viewer>`, 'lang="ar" dir="rtl"'),
  '/strip.html': kStrip(''),
  '/isolated.html': { ...kPage(''), headers: { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' } },
  '/moving.html': kPage(`<div id="home"><fourdvt-viewer ${kSource.replace('/character/', 'character/')} autoplay loop camera-controls camera-orbit="40deg 10deg auto"></fourdvt-viewer></div><iframe id="frame" srcdoc="<!doctype html><base href='/elsewhere/'><body>" style="width: 300px; height: 360px"></iframe>`),
};

let server, shared, browser, plain, devtools; // shared: another origin that allows CORS
before(async () => {
  server = await serve(environment('SITE'), 0, { pages: kPages });
  shared = await serve(environment('SITE'), 0, { headers: { 'Access-Control-Allow-Origin': '*' } });
  browser = await launch();
  plain = await openPage(browser, { viewport: null, deviceScaleFactor: undefined });
  devtools = await plain.context().newCDPSession(plain);
  await setRatio(1);
  await plain.addInitScript(() => {
    const native = matchMedia, queries = (globalThis.queries = []);
    globalThis.matchMedia = (text) => {
      const query = native(text);
      if (text.includes('resolution')) queries.push(query);
      return query;
    };
  });
  await plain.goto(`${server.url}plain.html`);
  await waitForEvent(plain, 'canplay');
  // Extras come with the player's second part.
  await until(plain, () => document.querySelector('fourdvt-viewer').vertexFromPoint(120, 160) !== null);
});
after(async () => {
  await browser?.close();
  await server?.close();
  await shared?.close();
});

async function open(name, options = {}) {
  const page = await openPage(browser, { viewport: { width: 700, height: 600 }, ...options });
  await page.goto(server.url + name);
  await waitForEvent(page, 'canplay');
  return page;
}
const setRatio = (deviceScaleFactor) => devtools.send('Emulation.setDeviceMetricsOverride', { width: 700, height: 600, deviceScaleFactor, mobile: false });
const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });
const viewer = (page, read, argument) => page.evaluate(`(${read})(document.querySelector('fourdvt-viewer'), ${JSON.stringify(argument)})`);
const rendered = (page) => page.evaluate(async () => { for (let i = 0; i < 3; ++i) await new Promise((next) => requestAnimationFrame(next)); });
const near = (seen, wanted, by, what) => seen.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) <= by, `${what}: ${seen}, not ${wanted}`));
// Sets the styles of the viewer and of its container.
async function dress(page, style, outer = '') {
  await page.evaluate(([style, outer]) => {
    document.querySelector('fourdvt-viewer').style.cssText = style;
    document.querySelector('#outer').style.cssText = `width: max-content; transform-origin: 0 0; ${outer}`;
  }, [style, outer]);
  await rendered(page);
}

test('numbers: pixels of a canvas, and points in a box that is moved, scaled, turned and sheared', async () => {
  const { canvasSize, pointInBox } = await load('page/picture-box');
  assert.deepEqual(canvasSize({ width: 240, height: 320 }, 1.5), { width: 360, height: 480 });
  assert.deepEqual(canvasSize({ width: 100.4, height: 50.2 }, 3), { width: 201, height: 100 }, 'at most two pixels for each of CSS');
  const at = (...numbers) => {
    const [x, y, ...corners] = numbers, pair = (i) => ({ x: corners[i], y: corners[i + 1] });
    const point = pointInBox([pair(0), pair(2), pair(4)], { x, y });
    return [point.x, point.y].map((value) => Number(value.toFixed(6)));
  };
  assert.deepEqual(at(60, 80, 0, 0, 240, 0, 0, 320), [0.25, 0.25]);
  assert.deepEqual(at(70, 100, 10, 20, 130, 20, 10, 180), [0.5, 0.5], 'moved and halved');
  assert.deepEqual(at(-80, 60, 0, 0, 0, 240, -320, 0), [0.25, 0.25], 'turned by 90 degrees');
  assert.deepEqual(at(150, 50, 0, 0, 100, 0, 100, 100), [1, 0.5], 'sheared');
  assert.deepEqual(at(-24, 352, 0, 0, 240, 0, 0, 320), [-0.1, 1.1], 'beside it');
});

test('padding, borders and box-sizing: the picture and the poster lie in the content box, in proportion', async () => {
  const styles = ['', 'padding: 0 60px', 'padding: 60px 0', 'box-sizing: border-box; padding: 24px 60px', 'border: 30px solid', 'padding: 1em 2em 3em 4em; border: 5px solid; box-sizing: border-box',
    'padding: 5%', 'padding: 10px 20px 30px 40px; direction: rtl', 'padding: 10px 20px 30px 40px; writing-mode: vertical-rl', 'padding: 10px; display: flex; justify-content: end; align-items: end', 'width: 300px; height: auto; padding: 20px; box-sizing: border-box'];
  for (const style of styles) {
    await dress(plain, style);
    const { wanted, canvas, poster, drawn } = await viewer(plain, (v) => {
      const box = ({ left, top, width, height }) => [left, top, width, height], css = getComputedStyle(v), outer = v.getBoundingClientRect();
      const px = (...names) => names.reduce((sum, name) => sum + parseFloat(css.getPropertyValue(name)), 0);
      const left = px('border-left-width', 'padding-left'), top = px('border-top-width', 'padding-top');
      const { width, height } = v.shadowRoot.querySelector('canvas');
      return {
        wanted: [outer.left + left, outer.top + top, outer.width - left - px('border-right-width', 'padding-right'), outer.height - top - px('border-bottom-width', 'padding-bottom')],
        canvas: box(v.shadowRoot.querySelector('canvas').getBoundingClientRect()), poster: box(v.shadowRoot.querySelector('.poster').getBoundingClientRect()), drawn: [width, height],
      };
    });
    near(canvas, wanted, 0.51, `canvas with ${style}`);
    near(poster, wanted, 0.51, `poster with ${style}`);
    near(drawn, wanted.slice(2), 0.51, `pixels with ${style}`);
  }
  await dress(plain, '');
});

const kOuter = ['', 'transform: scale(.5)', 'transform: scale(1.18)', 'transform: translate(40px, 30px) scale(.6, .9)', 'transform: translate(330px, 0) rotate(90deg)', 'transform: translate(200px, 0) rotate(30deg) scale(.8)', 'zoom: .5', 'zoom: 1.5'];

test('scaled, turned and zoomed ancestors: a hotspot lies on its vertex, and the vertex under it is that one', async () => {
  const kFew = 6;
  await viewer(plain, (v, few) => {
    for (let y = 60, n = 0; y < 300 && n < few; y += 20) {
      const vertex = v.vertexFromPoint(120, y);
      if (vertex !== null) v.insertAdjacentHTML('beforeend', `<i slot="hotspot-${++n}" data-vertex="${vertex}" style="width: 4px; height: 4px"></i>`);
    }
  }, kFew);
  for (const style of ['', 'padding: 20px 40px; border: 5px solid', 'zoom: .7']) {
    for (const outer of kOuter) {
      await dress(plain, style, outer);
      // The vertex nearest to a hotspot may be a neighbour in the same place.
      const same = await viewer(plain, (v) => [...v.children].filter((spot) => {
        const { left, top, width, height } = spot.getBoundingClientRect();
        return v.vertexFromPoint(left + width / 2, top + height / 2) === Number(spot.dataset.vertex);
      }).length);
      assert.ok(same >= kFew - 2, `${same} of ${kFew} with ${outer}; ${style}`);
    }
  }
  await dress(plain, 'padding: 100px');
  assert.equal(await viewer(plain, (v) => v.vertexFromPoint(50, 250)), null, 'in the padding');
  await viewer(plain, (v) => v.replaceChildren());
  await dress(plain, '');
});

test('a drag turns by the share of the picture that the pointer crosses, along its own axes', async () => {
  await viewer(plain, (v) => v.setAttribute('camera-controls', ''));
  for (const [outer, [dx, dy], share] of [['', [60, 0], 60 / kHeight], ['transform: scale(.5)', [60, 0], 120 / kHeight], ['zoom: 1.5', [60, 0], 40 / kHeight], ['transform: translate(330px, 0) rotate(90deg)', [0, 60], 60 / kHeight]]) {
    await dress(plain, '', outer);
    const azimuths = [];
    for (const drag of [false, true]) {
      if (drag) {
        const { x, y } = await viewer(plain, (v) => { const { left, top, width, height } = v.getBoundingClientRect(); return { x: left + width / 2, y: top + height / 2 }; });
        await plain.mouse.move(x, y);
        await plain.mouse.down();
        await plain.mouse.move(x + dx, y + dy, { steps: 3 });
        await plain.mouse.up();
      }
      azimuths.push(await viewer(plain, (v) => { v.jumpCameraToGoal(); return v.getCameraOrbit().azimuth; }));
    }
    near([azimuths[0] - azimuths[1]], [share * kDegPerHeight], 0.6, `degrees with ${outer}`);
  }
  await viewer(plain, (v) => { v.removeAttribute('camera-controls'); v.setAttribute('camera-orbit', '0deg 5deg auto'); });
  await dress(plain, '');
});

test('a click on a viewer without controls leaves the Space key to the page; where its play button was pressed it pauses', async () => {
  await viewer(plain, (v) => v.removeAttribute('camera-controls'));
  await dress(plain, '');
  await plain.evaluate(() => { document.body.style.height = '3000px'; });
  await plain.mouse.click(120, 120);
  assert.equal(await plain.evaluate(() => document.activeElement === document.body), true);
  await plain.keyboard.press('Space');
  await until(plain, () => scrollY > 0);
  assert.equal(await viewer(plain, (v) => v.paused), true);
  await plain.evaluate(() => scrollTo(0, 0));
  await viewer(plain, (v) => { v.removeAttribute('controls'); v.shadowRoot.querySelector('.play').focus(); });
  await plain.keyboard.press('Enter');
  await until(plain, () => !document.querySelector('fourdvt-viewer').paused);
  await plain.keyboard.press('Space');
  await until(plain, () => document.querySelector('fourdvt-viewer').paused);
  await viewer(plain, (v) => { v.setAttribute('controls', 'none'); v.shadowRoot.activeElement.blur(); });
  await plain.mouse.click(120, 120);
  assert.equal(await plain.evaluate(() => document.activeElement === document.body), true, 'again a picture');
  await plain.evaluate(() => { document.body.style.height = ''; });
});

test('the canvas follows a pixel ratio that changes while the size stays: at the browser\'s event, or at the next picture', async () => {
  for (const [ratio, plays] of [[2, false], [1.25, true], [3, false], [1, true]]) {
    await setRatio(ratio);
    // Emulated screens change without the event.
    if (plays) await viewer(plain, (v) => v.play());
    else await plain.evaluate(() => globalThis.queries.at(-1).dispatchEvent(new Event('change')));
    await until(plain, ([width, height]) => {
      const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
      return canvas.width === width && canvas.height === height;
    }, [kWidth, kHeight].map((px) => px * Math.min(ratio, 2)));
    await viewer(plain, (v) => v.pause());
  }
});

test('nothing of that has been reported', () => assert.deepEqual(plain.troubles, []));

test('moved into a frame, into a window and, when that is closed, back: it keeps its style, its place and its view, and goes on by the clock of the document that it is in', async () => {
  const page = await open('moving.html');
  await page.evaluate(() => { globalThis.home = { document, popup: open('', '', 'width=400,height=500') }; });
  const moves = { frame: () => document.querySelector('#frame').contentDocument, window: () => globalThis.home.popup.document, home: () => document };
  await page.evaluate(() => {
    globalThis.v = document.querySelector('fourdvt-viewer');
    // The script's own window draws nothing and is hidden, as one behind a picture-in-picture window is.
    globalThis.asleep = false;
    const request = requestAnimationFrame;
    globalThis.requestAnimationFrame = (turn) => (globalThis.asleep ? 0 : request(turn));
    Object.defineProperty(document, 'hidden', { get: () => globalThis.asleep });
  });
  for (const [name, move] of Object.entries(moves)) {
    await page.evaluate(([name, move]) => {
      const there = (0, eval)(`(${move})`)();
      globalThis.asleep = name !== 'home';
      document.dispatchEvent(new Event('visibilitychange'));
      globalThis.v.style.cssText = 'width: 240px; height: 320px';
      if (name === 'home') globalThis.home.popup.close();
      there.body.prepend(globalThis.v);
      globalThis.shownBefore = null;
    }, [name, String(move)]);
    await until(page, () => {
      const { stats, paused, shadowRoot } = globalThis.v, shown = stats?.framesShown ?? 0;
      globalThis.shownBefore ??= shown || null;
      return !paused && globalThis.shownBefore !== null && shown > globalThis.shownBefore && shadowRoot.querySelector('.controls');
    }, null);
    const seen = await page.evaluate(() => {
      const { v } = globalThis, root = v.shadowRoot, { width, height } = root.querySelector('canvas').getBoundingClientRect();
      return { document: [v.ownerDocument === document, v.ownerDocument === globalThis.home.popup.document], size: [v.offsetWidth, v.offsetHeight], canvas: [width, height],
        bar: v.ownerDocument.defaultView.getComputedStyle(root.querySelector('.controls')).position, azimuth: Math.round(v.getCameraOrbit().azimuth) };
    });
    assert.deepEqual(seen, { document: [name === 'home', name === 'window'], size: [kWidth, kHeight], canvas: [kWidth, kHeight], bar: 'absolute', azimuth: 40 }, name);
  }
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('touch: swipes and pinches over a viewer without camera-controls scroll and zoom the page; what a viewer does with them it keeps', async () => {
  const page = await open('strip.html', { viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true });
  const fingers = await page.context().newCDPSession(page);
  const touch = (type, ...touchPoints) => fingers.send('Input.dispatchTouchEvent', { type, touchPoints });
  const slide = async (from, to, steps = 12) => {
    await touch('touchStart', ...from);
    for (let i = 1; i <= steps; ++i) await touch('touchMove', ...from.map(({ id, x, y }, n) => ({ id, x: x + ((to[n].x - x) * i) / steps, y: y + ((to[n].y - y) * i) / steps })));
    await touch('touchEnd');
  };
  await slide([{ id: 1, x: 200, y: 200 }], [{ x: 40, y: 200 }]);
  await until(page, () => document.querySelector('#strip').scrollLeft > 40);
  await page.evaluate(() => { document.querySelector('#strip').scrollLeft = 0; });
  await slide([{ id: 1, x: 110, y: 160 }, { id: 2, x: 130, y: 160 }], [{ x: 20, y: 160 }, { x: 220, y: 160 }]);
  await until(page, () => visualViewport.scale > 1.1);
  const action = (name, value = '') => viewer(page, (v, [name, value]) => {
    v.setAttribute(name, value);
    return getComputedStyle(v.shadowRoot.querySelector('.stage')).touchAction;
  }, [name, value]);
  assert.equal(await action('camera-controls'), 'pan-y');
  assert.equal(await action('disable-zoom'), 'pan-y pinch-zoom');
  assert.equal(await action('touch-action', 'none'), 'none');
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('right to left: time in the bar still runs to the right, for pointer and keys; controls of the page keep its direction', async () => {
  const page = await open('bar.html'), time = page.locator('[part=time]');
  await time.waitFor({ state: 'visible', timeout: kPatienceMs });
  const { x, y, width, height } = await time.boundingBox();
  const share = () => viewer(page, (v) => v.currentTime / v.duration);
  await page.mouse.click(x + 0.15 * width, y + height / 2);
  await until(page, () => { const v = document.querySelector('fourdvt-viewer'); return !v.seeking && v.currentTime > 0; });
  assert.ok(await share() < 0.4, `at ${await share()}`);
  for (const later of [true, false]) {
    const before = await share();
    await page.keyboard.press(later ? 'ArrowRight' : 'ArrowLeft');
    await until(page, ([before, later]) => {
      const v = document.querySelector('fourdvt-viewer'), now = v.currentTime / v.duration;
      return !v.seeking && (later ? now > before : now < before);
    }, [before, later]);
  }
  const left = async (part) => (await page.locator(`[part=${part}]`).boundingBox()).x;
  assert.ok(await left('play-toggle') < x && x < await left('fullscreen'));
  await viewer(page, (v) => v.insertAdjacentHTML('beforeend', '<div slot="controls" id="mine">mine</div>'));
  await until(page, () => getComputedStyle(document.querySelector('#mine')).direction === 'rtl');
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('contrast themes: progress, buttons and focus are drawn in colours that the theme keeps', async () => {
  const page = await openPage(browser, { viewport: { width: 700, height: 600 }, forcedColors: 'active' });
  let go;
  const held = new Promise((done) => { go = done; });
  await page.route('**/character.gltf', async (route) => { await held; await route.continue(); });
  await page.goto(`${server.url}bar.html`);
  await until(page, () => document.querySelector('fourdvt-viewer').shadowRoot?.querySelector('.bar').checkVisibility());
  const style = (selector, name, pseudo) => viewer(page, (v, [selector, name, pseudo]) => getComputedStyle(v.shadowRoot.querySelector(selector), pseudo)[name], [selector, name, pseudo]);
  const opaque = async (selector) => (await style(selector, 'backgroundColor')).match(/\d+/g).slice(0, 3).join();
  assert.notEqual(await opaque('.fill'), await opaque('.bar'), 'the part that is there differs from the rest');
  go();
  await waitForEvent(page, 'canplay');
  await page.keyboard.press('Tab');
  assert.deepEqual([await style('.stage', 'outlineStyle', '::after'), await style('.stage', 'outlineWidth', '::after')], ['solid', '3px']);
  assert.equal(await style('.play', 'borderTopStyle'), 'solid');
  await page.close();
});

test('posters of other origins: an isolated page has those that allow CORS, with or without crossorigin; others have those that do not, too', async () => {
  const page = await openPage(browser, { viewport: { width: 700, height: 600 } });
  const shown = (crossOrigin, poster) => page.evaluate(async ([crossOrigin, poster]) => {
    const v = document.createElement('fourdvt-viewer');
    if (crossOrigin !== null) v.setAttribute('crossorigin', crossOrigin);
    Object.assign(v, { poster, preload: 'none', src: '/character/character.gltf' });
    document.body.replaceChildren(v);
    const picture = v.shadowRoot.querySelector('.picture');
    while (!picture.hidden && !picture.naturalWidth) await new Promise((next) => setTimeout(next, 20));
    return !picture.hidden;
  }, [crossOrigin, poster]);
  await page.goto(`${server.url}isolated.html`);
  await page.evaluate(() => customElements.whenDefined('fourdvt-viewer').then(() => undefined));
  for (const crossOrigin of ['anonymous', '', null]) assert.equal(await shown(crossOrigin, `${shared.url}character/poster.webp`), true, `crossorigin ${crossOrigin}`);
  assert.equal(await shown(null, `${shared.url}character/none.webp`), false);
  await page.goto(server.url.replace('127.0.0.1', 'localhost') + 'plain.html');
  await page.evaluate(() => customElements.whenDefined('fourdvt-viewer').then(() => undefined));
  assert.equal(await shown('anonymous', `${server.url}character/poster.webp`), true, 'its server does not allow CORS');
  await page.close();
});
