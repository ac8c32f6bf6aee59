// SPDX-License-Identifier: Apache-2.0
// A page with many viewers of the sample in a grid, as in a portfolio: makes and scrolls it, and counts its resources.
import { openPage } from './harness.mjs';
import { serve } from './server.mjs';

const kHtml = `<!doctype html><meta charset="utf-8"><meta name="viewport" content="width=device-width"><link rel="icon" href="data:,"><style>
body { margin: 0; } main { display: grid; grid-template-columns: repeat(3, 1fr); gap: 8px; }
fourdvt-viewer { width: 100%; height: 150px; }</style><main></main>`;

const kPressMs = 150_000;

/** The site with a blank page for the grid. */
export const servePortfolio = (site) => serve(site, 0, { pages: { '/blank.html': { html: kHtml, headers: {} } } });

/**
 * A page on which contexts, modules (and those with their second part), decoders and errors are counted: globalThis.counts. The next
 * call of the player traps if globalThis.trapNext is set: 'any' one, or one made by an 'output' callback of a decoder.
 */
export async function openPortfolio(browser, url, viewport = { width: 480, height: 220 }, device = {}) {
  const page = await openPage(browser, { viewport, ...device }, 'i420');
  await page.addInitScript(() => {
    const counts = (globalThis.counts = { contexts: 0, modules: 0, completed: 0, decoders: 0, maxDecoders: 0, errors: [] });
    const known = new WeakSet();
    for (const { prototype } of [HTMLCanvasElement, OffscreenCanvas]) {
      const { getContext } = prototype;
      prototype.getContext = function (kind, ...rest) {
        const context = getContext.call(this, kind, ...rest);
        if (kind === 'webgl2' && context && !known.has(context)) {
          known.add(context);
          globalThis.contextOfPage = context;
          ++counts.contexts;
        }
        return context;
      };
    }
    let inOutput = false;
    const instantiate = WebAssembly.instantiate;
    WebAssembly.instantiate = async (module, imports) => {
      const instance = await instantiate(module, imports);
      if (imports?.first) ++counts.completed;
      if (!imports?.placeholder) return instance;
      ++counts.modules;
      const exports = Object.entries(instance.exports).map(([name, value]) => [name, typeof value !== 'function' ? value : (...values) => {
        if (globalThis.trapNext !== 'any' && !(globalThis.trapNext === 'output' && inOutput)) return value(...values);
        globalThis.trapNext = null;
        throw new WebAssembly.RuntimeError('unreachable');
      }]);
      return { exports: Object.fromEntries(exports) };
    };
    globalThis.VideoDecoder = class extends VideoDecoder {
      constructor({ output, ...rest }) {
        super({
          output(frame) {
            inOutput = true;
            try {
              output(frame);
            } finally {
              inOutput = false;
            }
          },
          ...rest,
        });
        this.live = true;
        counts.maxDecoders = Math.max(counts.maxDecoders, ++counts.decoders);
      }
      close() {
        super.close();
        if (this.live) --counts.decoders;
        this.live = false;
      }
    };
    addEventListener('error', (e) => { if (e.detail) counts.errors.push(e.detail); }, true);
  });
  await page.goto(`${url}blank.html`);
  return page;
}

/** Adds viewers; sources: addresses of their characters, in turn. */
export const fill = (page, count, sources = ['/character/character.gltf'], attributes = { autoplay: '', loop: '', sequence: 'walk' }) => page.evaluate(
  async ({ count, sources, attributes }) => {
    await import('/fourdvt-viewer/fourdvt-viewer.js');
    globalThis.viewers = Array.from({ length: count }, (_, i) => {
      const viewer = document.createElement('fourdvt-viewer');
      viewer.src = sources[i % sources.length];
      for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
      viewer.addEventListener('loadeddata', () => { viewer.firstMs ??= performance.now(); });
      document.querySelector('main').append(viewer);
      return viewer;
    });
  }, { count, sources, attributes });

/** Scrolls to a position and waits until every viewer on screen has a picture: ms of that. */
export const scrollTo = (page, y, patienceMs = 60_000) => page.evaluate(async ({ y, patienceMs }) => {
  const start = performance.now();
  globalThis.scrollTo(0, y);
  await new Promise((next) => requestAnimationFrame(() => requestAnimationFrame(next)));
  const onScreen = () => globalThis.viewers.filter((viewer) => {
    const { top, bottom } = viewer.getBoundingClientRect();
    return bottom > 0 && top < innerHeight;
  });
  while (!onScreen().every((viewer) => viewer.stats?.framesShown > 0)) {
    if (performance.now() - start > patienceMs) throw new Error(`${onScreen().filter((v) => !(v.stats?.framesShown > 0)).length} of ${onScreen().length} viewers on screen have no picture: ${JSON.stringify(globalThis.counts)}`);
    await new Promise((next) => setTimeout(next, 30));
  }
  return performance.now() - start;
}, { y, patienceMs });

/** The pictures that the viewers show, as texts to compare. */
export const pictures = (page) => page.evaluate(() => globalThis.viewers.map((viewer) => {
  const canvas = viewer.shadowRoot.querySelector('canvas'), { width, height } = canvas, copy = new OffscreenCanvas(width, height).getContext('2d');
  copy.drawImage(canvas, 0, 0);
  return String.fromCharCode(...copy.getImageData(0, 0, width, height).data.filter((_, i) => i % 97 === 0));
}));

/**
 * A phone that shows all viewers at once, the class at its highest rung in each, which is more than fits into the page's memory. Watched
 * until no viewer has been freed or loaded for a while: { page, loaded, pictures: viewers that have one, bytes: the most in that while,
 * most: { loaded, bytes } at any time }.
 */
export async function pressPhone(browser, url, count, quietMs = 4000) {
  const rows = Math.ceil(count / 3);
  const page = await openPortfolio(browser, url, { width: 390, height: 160 * rows }, { hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
  await fill(page, count, undefined, { autoplay: '', loop: '', quality: 'highest', sequence: 'locomotion' });
  const seen = await page.evaluate(async ({ quietMs, patienceMs }) => {
    const most = { loaded: 0, bytes: 0 }, end = performance.now() + patienceMs;
    let before = '', since = performance.now(), now = {};
    while (performance.now() - since < quietMs) {
      if (performance.now() > end) throw new Error(`changes for ever: ${JSON.stringify({ ...now, most })}`);
      await new Promise((next) => setTimeout(next, 50));
      const held = globalThis.viewers.filter(({ stats }) => stats);
      const { textureBytes = 0, targetBytes = 0, heapBytes = 0 } = held[0]?.stats ?? {}, bytes = textureBytes + targetBytes + heapBytes;
      now = { loaded: held.length, pictures: held.filter(({ stats }) => stats.framesShown > 0).length, bytes: Math.max(bytes, now.bytes ?? 0) };
      most.loaded = Math.max(most.loaded, now.loaded);
      most.bytes = Math.max(most.bytes, bytes);
      const key = `${now.loaded} ${now.pictures}`;
      if (key !== before || now.pictures < now.loaded || now.pictures === 0) [before, since, now.bytes] = [key, performance.now(), bytes];
    }
    return { ...now, most };
  }, { quietMs, patienceMs: kPressMs });
  return { page, ...seen };
}

/** What the page holds now: viewers with a character, bytes. */
export const holdings = (page) => page.evaluate(() => {
  const loaded = globalThis.viewers.filter(({ stats }) => stats);
  const { textureBytes = 0, targetBytes = 0, heapBytes = 0 } = loaded[0]?.stats ?? {};
  return { loaded: loaded.length, textureBytes, targetBytes, heapBytes, ...globalThis.counts };
});
