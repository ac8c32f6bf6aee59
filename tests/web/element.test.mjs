// SPDX-License-Identifier: Apache-2.0
// The element by itself, in headless Chromium under a strict content-security policy: what it reports for a broken
// manifest, that the page lives on, that removal frees everything, and its controls and accessibility. No baked
// character is needed; the manifests are made here.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, beforeEach, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { launch } from './harness.mjs';
import { encodePng } from './png.mjs';
import { serve } from './server.mjs';

const EXTENSION = 'FOURDVT_layered_video_texture';
const POLICY = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'";
const PATIENCE_MS = 60_000;
const dist = process.env.FOURDVT_SITE
  ? join(process.env.FOURDVT_SITE, 'fourdvt-viewer')
  : fileURLToPath(new URL('../../web/dist', import.meta.url));

function goodManifest() {
  const camera = {
    name: 'cam00', width: 720, height: 960, fx: 900, fy: 900, cx: 360, cy: 480,
    camFromWorld: [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0.9, 3, 1],
  };
  const rendition = {
    uri: 'walk.mp4', byteLength: 1000, codec: 'avc1.640028', width: 1536, height: 1056,
    layers: [[0, 0, 1024, 1024]], barcode: { rect: [0, 1024, 512, 32], cellSize: 16 },
  };
  const sequence = {
    name: 'walk', frameCount: 28, fps: 25, loop: true, rootVelocity: [0, 0, 1],
    stream: { uri: 'walk.bin', byteLength: 4096, headerLength: 512, headerHash: '0123456789abcdef' }, renditions: [rendition],
  };
  const extension = {
    version: 1, name: 'nobody', layerCount: 1, vertexCount: 100, faceCount: 180, mesh: { uri: 'mesh.bin', byteOffset: 0, byteLength: 2000, hash: '0123456789abcdef' },
    poster: { uri: 'poster.webp' }, bounds: { min: [-0.5, 0, -0.3], max: [0.5, 1.8, 0.3] }, groundY: 0,
    cameras: [camera], sequences: [sequence],
  };
  return { asset: { version: '2.0' }, extensionsUsed: [EXTENSION], extensions: { [EXTENSION]: extension } };
}

const changed = (change) => {
  const gltf = goodManifest();
  change(gltf.extensions[EXTENSION], gltf);
  return JSON.stringify(gltf);
};
const MANIFESTS = {
  'cut.gltf': JSON.stringify(goodManifest()).slice(0, 300),
  'html.gltf': '<!doctype html><p>not found</p>',
  'null.gltf': 'null',
  'bare.gltf': '{"asset":{"version":"2.0"}}',
  'fields.gltf': changed((e) => { delete e.sequences[0].stream.headerLength; }),
  'range.gltf': changed((e) => { e.layerCount = 1e9; }),
  'room.gltf': changed((e) => {
    e.room = { min: [-3, 0, -3], max: [3, 3, 3], uri: 'room.jpg', byteLength: 100, hash: '0123456789abcdef', width: 64, height: 64,
      faces: Array(6).fill([0, 0, 65, 64]) };
  }),
  'newer.gltf': changed((e) => { e.version = 99; }),
  'nofiles.gltf': changed(() => undefined),
};

let folder, server, browser, page;
const troubles = [], reported = [];
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-element-'));
  cpSync(dist, join(folder, 'fourdvt-viewer'), { recursive: true });
  for (const [name, text] of Object.entries(MANIFESTS)) writeFileSync(join(folder, name), text);
  writeFileSync(join(folder, 'page.css'), 'fourdvt-viewer { width: 320px; height: 400px; }');
  writeFileSync(join(folder, 'index.html'), `<!doctype html><html lang="en"><meta charset="utf-8"><title>element</title>
    <link rel="icon" href="data:,"><link rel="stylesheet" href="page.css">
    <script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script><body></body></html>`);
  server = await serve(folder, 0, { headers: { 'Content-Security-Policy': POLICY } });
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 400, height: 500 } });
  page.setDefaultTimeout(PATIENCE_MS);
  page.on('pageerror', (error) => troubles.push(error.message));
  page.on('console', (line) => {
    if (line.type() !== 'error' || line.text().startsWith('Failed to load resource')) return;
    (line.text().startsWith('fourdvt-viewer: ') ? reported : troubles).push(line.text());
  });
  await page.addInitScript(countLiveObjects);
  await page.goto(server.url);
  await page.evaluate(() => customElements.whenDefined('fourdvt-viewer').then(() => undefined));
});
after(async () => {
  await browser?.close();
  await server?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});
beforeEach(() => page.evaluate(() => document.body.replaceChildren()));

// Runs in the page before its scripts: counts what the element must give back.
function countLiveObjects() {
  const live = (globalThis.live = { decoders: 0, observers: 0, frames: 0 });
  const NativeDecoder = globalThis.VideoDecoder;
  globalThis.VideoDecoder = class extends NativeDecoder {
    constructor(init) { super(init); ++live.decoders; }
    close() { super.close(); --live.decoders; }
  };
  for (const name of ['ResizeObserver', 'IntersectionObserver']) {
    const Native = globalThis[name];
    globalThis[name] = class extends Native {
      constructor(...rest) { super(...rest); ++live.observers; }
      disconnect() { super.disconnect(); --live.observers; }
    };
  }
  const request = globalThis.requestAnimationFrame;
  globalThis.requestAnimationFrame = (callback) => {
    ++live.frames;
    return request.call(globalThis, callback);
  };
}

// Adds an element and resolves to its first error event.
const errorOf = (attributes) => page.evaluate(async (attributes) => {
  const viewer = document.createElement('fourdvt-viewer');
  for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
  const names = [];
  for (const name of ['loadstart', 'loadedmetadata', 'canplay']) viewer.addEventListener(name, () => names.push(name));
  const error = new Promise((done) => viewer.addEventListener('error', (e) => done(e.detail), { once: true }));
  document.body.append(viewer);
  const detail = await error;
  const root = viewer.shadowRoot;
  return {
    ...detail, events: names, property: viewer.error?.id, alert: root.querySelector('[role=alert]:not([hidden])')?.textContent,
    bar: root.querySelector('[role=progressbar]').checkVisibility(),
  };
}, attributes);

const CASES = [
  ['no manifest (404)', 'missing.gltf', 'fetch-failed'],
  ['manifest cut off', 'cut.gltf', 'manifest-invalid'],
  ['an HTML page instead of a manifest', 'html.gltf', 'manifest-invalid'],
  ['JSON null', 'null.gltf', 'manifest-invalid'],
  ['glTF without our extension', 'bare.gltf', 'manifest-invalid'],
  ['a field is missing', 'fields.gltf', 'manifest-invalid'],
  ['a field is out of range', 'range.gltf', 'manifest-invalid'],
  ['a room with a face outside of its picture', 'room.gltf', 'manifest-invalid'],
  ['a newer format version', 'newer.gltf', 'unsupported'],
  ['a good manifest whose files are missing', 'nofiles.gltf', 'fetch-failed'],
];
for (const [name, src, id] of CASES) {
  test(`error event: ${name}`, async () => {
    const seen = await errorOf({ src });
    assert.equal(seen.id, id, seen.message);
    assert.equal(seen.property, id);
    assert.ok(seen.message.length > 10 && !seen.message.includes('\n'), seen.message);
    assert.equal(seen.events[0], 'loadstart');
    assert.ok(!seen.events.includes('canplay'));
    const text = `${id}: ${seen.message}`;
    assert.equal(seen.alert, `${text}Try again`, 'the panel has the text on the developer\'s own machine');
    assert.deepEqual(reported.splice(0), [`fourdvt-viewer: ${text}`], 'one line on the console');
    assert.equal(seen.bar, false, 'no progress bar stays behind');
  });
}

test('error event: neither VideoDecoder nor MediaSource', async () => {
  const id = await page.evaluate(async () => {
    const native = { VideoDecoder, MediaSource };
    for (const name in native) delete globalThis[name];
    const viewer = document.createElement('fourdvt-viewer');
    viewer.src = 'nofiles.gltf';
    const error = new Promise((done) => viewer.addEventListener('error', (e) => done(e.detail.id)));
    document.body.append(viewer);
    const id = await error;
    Object.assign(globalThis, native);
    return id;
  });
  assert.equal(id, 'decoder-unsupported');
});

test('error event: no WebGL2', async () => {
  const id = await page.evaluate(async () => {
    await new Promise((next) => setTimeout(next, 3000)); // the page keeps a context for a moment after its last viewer
    const prototypes = [HTMLCanvasElement, OffscreenCanvas].map(({ prototype }) => prototype), natives = prototypes.map(({ getContext }) => getContext);
    for (const prototype of prototypes) prototype.getContext = () => null;
    const viewer = document.createElement('fourdvt-viewer');
    viewer.src = 'nofiles.gltf';
    const error = new Promise((done) => viewer.addEventListener('error', (e) => done(e.detail.id)));
    document.body.append(viewer);
    const id = await error;
    prototypes.forEach((prototype, i) => { prototype.getContext = natives[i]; });
    return id;
  });
  assert.equal(id, 'gpu-failure');
});

test('removal gives everything back, however far loading came', async () => {
  const before = await page.evaluate(() => ({ ...globalThis.live }));
  for (const wait of [0, 30, 300]) {
    const left = await page.evaluate(async (ms) => {
      const viewer = document.createElement('fourdvt-viewer');
      viewer.src = 'nofiles.gltf';
      viewer.autoplay = true;
      viewer.toggleAttribute('auto-rotate', true);
      document.body.append(viewer);
      await new Promise((next) => setTimeout(next, ms));
      viewer.remove();
      await Promise.resolve(); // it might be a move
      return viewer.shadowRoot.querySelectorAll('canvas').length;
    }, wait);
    assert.equal(left, 0);
  }
  await page.waitForTimeout(200);
  const idle = await page.evaluate(() => ({ ...globalThis.live }));
  const requests = server.requests.length;
  await page.waitForTimeout(600);
  const later = await page.evaluate(() => ({ ...globalThis.live }));
  assert.equal(later.observers, before.observers);
  assert.equal(later.decoders, before.decoders);
  assert.equal(later.frames, idle.frames, 'no frame loop is left');
  assert.equal(server.requests.length, requests, 'nothing more is fetched');
});

test('twenty elements one after the other do not exhaust contexts', async () => {
  const ids = await page.evaluate(async () => {
    const ids = [];
    for (let i = 0; i < 20; ++i) {
      const viewer = document.createElement('fourdvt-viewer');
      viewer.src = 'nofiles.gltf';
      const error = new Promise((done) => viewer.addEventListener('error', (e) => done(e.detail.id)));
      document.body.append(viewer);
      ids.push(await error);
      viewer.remove();
    }
    return ids;
  });
  assert.deepEqual([...new Set(ids)], ['fetch-failed']);
});

// globalThis.viewer, without a character.
function addSteeredViewer(orbit) {
  return page.evaluate((orbit) => {
    const viewer = document.createElement('fourdvt-viewer');
    viewer.setAttribute('camera-controls', '');
    viewer.setAttribute('camera-orbit', orbit);
    document.body.append(viewer);
    globalThis.viewer = viewer;
  }, orbit);
}

test('keys, drag and attributes turn the camera; vertical touch stays with the page', async () => {
  await addSteeredViewer('30deg 10deg 4m');
  const orbit = () => page.evaluate(() => {
    globalThis.viewer.jumpCameraToGoal();
    return globalThis.viewer.getCameraOrbit();
  });
  assert.deepEqual(await orbit(), { azimuth: 30, elevation: 10, distance: 4 });
  await page.locator('fourdvt-viewer').evaluate((viewer) => viewer.shadowRoot.querySelector('.stage').focus());
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowUp');
  assert.deepEqual(await orbit(), { azimuth: 40, elevation: 20, distance: 4 });
  await page.keyboard.press('+');
  assert.ok((await orbit()).distance < 4);
  await page.keyboard.press('Home');
  assert.deepEqual(await orbit(), { azimuth: 30, elevation: 10, distance: 4 });
  await page.mouse.move(200, 200);
  await page.mouse.down();
  await page.mouse.move(140, 200);
  await page.mouse.up();
  const dragged = await orbit();
  assert.ok(dragged.azimuth > 40 && dragged.elevation === 10, JSON.stringify(dragged));
  const action = await page.evaluate(() => getComputedStyle(globalThis.viewer.shadowRoot.querySelector('.stage')).touchAction);
  assert.equal(action, 'pan-y');
});

test('a wheel without focus scrolls the page, with Ctrl it zooms', async () => {
  await addSteeredViewer('0deg 0deg 4m');
  await page.evaluate(() => {
    globalThis.prevented = [];
    globalThis.viewer.addEventListener('wheel', (e) => globalThis.prevented.push(e.defaultPrevented));
  });
  const wheel = (ctrlKey) => page.evaluate((ctrlKey) => {
    const stage = globalThis.viewer.shadowRoot.querySelector('.stage');
    stage.dispatchEvent(new WheelEvent('wheel', { deltaY: -100, ctrlKey, bubbles: true, composed: true, cancelable: true }));
    globalThis.viewer.jumpCameraToGoal();
    return globalThis.viewer.getCameraOrbit().distance;
  }, ctrlKey);
  assert.equal(await wheel(false), 4);
  assert.ok((await wheel(true)) < 4);
  assert.deepEqual(await page.evaluate(() => globalThis.prevented), [false, true]);
});

test('a scene that cannot be drawn is refused where it is set, and the last one stays', async () => {
  const answers = await page.evaluate(() => {
    const viewer = document.createElement('fourdvt-viewer');
    viewer.scene = [{ corners: Array(18).fill(0.5) }];
    const tried = [[18, NaN], [18, Infinity], [18, 1e39], [17, 0]].map(([length, last]) => {
      try {
        viewer.scene = [{ corners: [...Array(length - 1).fill(0.5), last] }];
        return 'accepted';
      } catch (error) {
        return error.name;
      }
    });
    return [...tried, viewer.scene[0].corners[17]];
  });
  assert.deepEqual(answers, ['RangeError', 'RangeError', 'RangeError', 'RangeError', 0.5]);
});

test('labels and progress are there for assistive technology', async () => {
  const seen = await page.evaluate(async () => {
    const viewer = document.createElement('fourdvt-viewer');
    viewer.setAttribute('alt', 'A dancer turns');
    viewer.src = 'nofiles.gltf';
    document.body.append(viewer);
    await Promise.resolve(); // the page lets it load
    const root = viewer.shadowRoot;
    const stage = root.querySelector('.stage');
    const bar = root.querySelector('[role=progressbar]');
    const picture = [stage.role, stage.tabIndex];
    viewer.toggleAttribute('camera-controls', true);
    return [stage.getAttribute('aria-label'), picture, [stage.role, stage.tabIndex], bar.getAttribute('aria-valuenow'), bar.getAttribute('aria-label')];
  });
  assert.deepEqual(seen, ['A dancer turns', ['img', -1], ['application', 0], '0', 'Loading']);
});

// Runs in the page: elements from before the script, with properties that a page or a framework has set on them.
async function defineLate() {
  const [viewer, companion] = ['fourdvt-viewer', 'fourdvt-character'].map((name) => document.createElement(name));
  const set = { src: 'nofiles.gltf', sequence: 'run', autoplay: true, loop: true, muted: true, volume: 0.5, playbackRate: 0.5, defaultPlaybackRate: 2, currentTime: 0.3, travel: true,
    renderOptions: { samples: 2 }, scene: [{ corners: Array(18).fill(0.5) }], sign: (url) => `${url}?signed`, placement: { x: 1, z: 2 }, poster: 'p.png', note: 'of the page' };
  Object.assign(viewer, set, { volumes: 3 });
  viewer.play = 'wrapped';
  viewer.playbackRate = 99; // refused
  viewer.readyState = 7; // nobody can set it
  Object.assign(companion, { placement: { x: 3, z: 4 }, heading: 90 });
  const uncaught = [];
  addEventListener('error', (e) => { uncaught.push(e.error?.name); e.preventDefault(); });
  document.body.append(viewer);
  viewer.append(companion);
  await import('/fourdvt-viewer/fourdvt-viewer.js');
  await new Promise((next) => setTimeout(next, 0));
  const own = [viewer, companion].map((element) => Object.keys(element).sort());
  const { src, sequence, autoplay, loop, muted, volume, playbackRate, defaultPlaybackRate, currentTime, travel, renderOptions: { samples }, scene, placement, poster } = viewer;
  const { x, z, heading } = companion.placement;
  viewer.loop = false;
  return { own, src, sequence, autoplay, loop, muted, volume, playbackRate, defaultPlaybackRate, currentTime, travel, samples, meshes: scene.length, at: [placement.x, placement.z], poster,
    signed: await viewer.sign('a'), companion: [x, z, heading], uncaught, loopAttribute: viewer.getAttribute('loop') };
}

test('properties that were set before the elements were defined are theirs', async () => {
  const page = await browser.newPage({ viewport: { width: 400, height: 500 } });
  await page.route('**/late.html', (route) => route.fulfill({ contentType: 'text/html', body: '<!doctype html><title>late</title><body></body>' }));
  await page.goto(`${server.url}late.html`);
  const seen = await page.evaluate(defineLate);
  await page.close();
  assert.deepEqual(seen, {
    own: [['note', 'play', 'volumes'], []], src: 'nofiles.gltf', sequence: 'run', autoplay: true, loop: true, muted: true, volume: 0.5, playbackRate: 1, defaultPlaybackRate: 2,
    currentTime: 0.3, travel: true, samples: 2, meshes: 1, at: [1, 2], poster: 'p.png', signed: 'a?signed', companion: [3, 4, 90], uncaught: ['RangeError', 'TypeError'], loopAttribute: 'false',
  });
});

test('a boolean attribute that says "false" is off', async () => {
  const seen = await page.evaluate(() => {
    const viewer = document.createElement('fourdvt-viewer');
    document.body.append(viewer);
    const stage = viewer.shadowRoot.querySelector('.stage');
    const look = () => [viewer.autoplay, viewer.loop, viewer.defaultMuted, viewer.travel, stage.getAttribute('role'), stage.classList.contains('orbits')];
    const rows = ['false', 'true', ''].map((value) => {
      for (const name of ['autoplay', 'loop', 'muted', 'travel', 'camera-controls']) viewer.setAttribute(name, value);
      return look();
    });
    viewer.setAttribute('camera-controls', 'false');
    viewer.setAttribute('motion-controls', 'false');
    rows.push(look());
    viewer.setAttribute('motion-controls', 'true');
    return [...rows, look()];
  });
  const [on, off] = [[true, true, true, true], [false, false, false, false]];
  assert.deepEqual(seen, [[...off, 'img', false], [...on, 'application', true], [...on, 'application', true], [...on, 'img', false], [...on, 'application', false]]);
});

test('a poster of another origin is shown on any page: isolated, with and without crossorigin, whether its server allows reading or not', async () => {
  const picture = { width: 2, height: 2, data: new Uint8Array(16).fill(255) };
  writeFileSync(join(folder, 'poster.png'), encodePng(picture));
  const open = { 'Access-Control-Allow-Origin': '*' }, isolated = { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' };
  const hosts = { open: await serve(folder, 0, { headers: open }), closed: await serve(folder) };
  const html = '<!doctype html><title>poster</title><script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script><body></body>';
  const site = await serve(folder, 0, { pages: { '/plain.html': { html }, '/isolated.html': { html, headers: isolated } } });
  const shows = async (name, host, crossorigin, file = 'poster.png') => {
    const page = await browser.newPage();
    await page.goto(`${site.url}${name}.html`);
    const width = await page.evaluate(async ({ poster, crossorigin }) => {
      await customElements.whenDefined('fourdvt-viewer');
      const viewer = document.createElement('fourdvt-viewer');
      if (crossorigin) viewer.setAttribute('crossorigin', crossorigin);
      Object.assign(viewer, { poster, src: 'nofiles.gltf' });
      viewer.setAttribute('preload', 'none');
      document.body.append(viewer);
      const picture = viewer.shadowRoot.querySelector('img');
      while (!picture.hidden && !(picture.complete && picture.naturalWidth)) await new Promise((next) => setTimeout(next, 20));
      return picture.hidden ? null : picture.naturalWidth;
    }, { poster: `${hosts[host].url}${file}`, crossorigin });
    await page.close();
    return width;
  };
  try {
    assert.equal(await shows('plain', 'closed', null), 2);
    assert.equal(await shows('plain', 'closed', 'anonymous'), 2);
    assert.equal(await shows('isolated', 'open', null), 2);
    assert.equal(await shows('isolated', 'open', 'anonymous'), 2);
    assert.equal(await shows('plain', 'open', null, 'none.png'), null, 'one that is not there is left out');
  } finally {
    await Promise.all([site, ...Object.values(hosts)].map((server) => server.close()));
  }
});

test('the page is alive: no uncaught error, no policy violation', () => {
  assert.deepEqual(troubles, []);
});
