// SPDX-License-Identifier: Apache-2.0
// The element with a real character in adverse conditions: a lost GL context, a slow upload path, a server without byte
// ranges, an element that leaves the screen.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, readCanvas, waitForEvent } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage } from './ssim.mjs';

let server, browser, page;
before(async () => { browser = await launch(); });
after(() => browser?.close());
afterEach(async () => {
  await page?.close();
  await server?.close();
});

// A blank page of the site with one viewer in it.
async function open({ serving = {}, before = () => undefined, attributes = {}, uploadPath = 'auto' } = {}) {
  server = await serve(environment('SITE'), 0, serving);
  page = await openPage(browser, { viewport: { width: 320, height: 420 } }, uploadPath);
  await page.addInitScript(before);
  await page.route('**/blank.html', (route) => route.fulfill({
    contentType: 'text/html', body: '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">' }));
  await page.goto(`${server.url}blank.html`);
  await page.evaluate(async (attributes) => {
    await import('/fourdvt-viewer/fourdvt-viewer.js');
    const viewer = document.createElement('fourdvt-viewer');
    for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
    viewer.src = 'character/character.gltf';
    document.body.append(viewer);
  }, attributes);
  await waitForEvent(page, 'canplay');
}
const viewer = (what) => page.evaluate((what) => document.querySelector('fourdvt-viewer')[what], what);
const until = (condition) => page.waitForFunction(condition, null, { timeout: kPatienceMs, polling: 50 });
const visible = async () => coverage(await readCanvas(page)) > 0.02;

test('a lost GL context comes back with the same sequence and frame', async () => {
  await open({ attributes: { sequence: 'run' } });
  await page.evaluate(async () => {
    const viewer = document.querySelector('fourdvt-viewer');
    const seeked = new Promise((done) => viewer.addEventListener('seeked', done, { once: true }));
    viewer.seekFrame(5);
    await seeked;
    globalThis.viewerEvents.length = 0;
    const gl = viewer.shadowRoot.querySelector('canvas').getContext('webgl2');
    const extension = gl.getExtension('WEBGL_lose_context');
    extension.loseContext();
    setTimeout(() => extension.restoreContext(), 100);
  });
  await waitForEvent(page, 'canplay');
  await until(() => document.querySelector('fourdvt-viewer').frame === 5);
  await page.waitForTimeout(300);
  assert.equal(await viewer('sequence'), 'run');
  assert.ok(await visible());
  assert.deepEqual(page.troubles.filter((line) => !line.includes('CONTEXT_LOST')), []);
});

const slowPlanes = () => {
  const native = VideoFrame.prototype.copyTo;
  VideoFrame.prototype.copyTo = async function (...rest) {
    const layout = await native.apply(this, rest);
    await new Promise((next) => setTimeout(next, 400));
    return layout;
  };
};

test('where copying planes is slow, the browser uploads frames itself, and nothing is downloaded twice', async () => {
  await open({ attributes: { autoplay: '' }, before: slowPlanes });
  await until(() => document.querySelector('fourdvt-viewer').stats?.uploadPath.startsWith('rgba'));
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > 5);
  assert.ok(await visible());
  // The motion graph is fetched when there is nothing better to do: it may be under way when the path changes.
  const ranges = server.requests.filter((r) => r.range && !/\/motion\.\S*bin$/.test(r.path)).map((r) => `${r.path} ${r.range}`);
  assert.equal(new Set(ranges).size, ranges.length, ranges.join('\n'));
  assert.deepEqual(page.troubles, []);
});

test('a server without byte ranges works, each file once', async () => {
  await open({ serving: { ranges: false }, attributes: { autoplay: '' } });
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > 5);
  assert.ok(await visible());
  const videos = server.requests.filter((r) => r.path.endsWith('.mp4')).map((r) => r.path);
  // The second GOP is asked for before the first answer has come.
  for (const path of new Set(videos)) assert.ok(videos.filter((other) => other === path).length <= 2, videos.join(' '));
  assert.deepEqual(page.troubles, []);
});

test('off-screen the clock stands still, back on screen it goes on', async () => {
  await open({ attributes: { autoplay: '' } });
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > 2);
  await page.evaluate(async () => {
    document.querySelector('fourdvt-viewer').style.marginTop = `${innerHeight + 50}px`;
    await new Promise((next) => setTimeout(next, 500));
    globalThis.shown = document.querySelector('fourdvt-viewer').stats.framesShown;
  });
  await page.waitForTimeout(800);
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').stats.framesShown - globalThis.shown), 0);
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').style.marginTop = '0'; });
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > globalThis.shown + 2);
});

test('far from the screen its memory is freed and its picture stays, back on screen it goes on where it was', async () => {
  await open({ attributes: { autoplay: '', loop: '', sequence: 'walk' } });
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > 2);
  const bytes = await page.evaluate(() => document.querySelector('fourdvt-viewer').stats.textureBytes);
  assert.ok(bytes > 1e6);
  await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    globalThis.suspended = 0;
    viewer.addEventListener('suspend', () => ++globalThis.suspended);
    viewer.goTo('run');
    viewer.setAttribute('camera-orbit', '80deg 10deg 3m');
    viewer.jumpCameraToGoal();
    viewer.style.marginTop = `${6 * innerHeight}px`;
  });
  await until(() => document.querySelector('fourdvt-viewer').stats === null);
  const { paused, suspended, canvases } = await page.evaluate(() => {
    const { shadowRoot, paused } = document.querySelector('fourdvt-viewer');
    return { paused, suspended: globalThis.suspended, canvases: shadowRoot.querySelectorAll('canvas').length };
  });
  assert.deepEqual({ paused, suspended, canvases }, { paused: false, suspended: 1, canvases: 1 });
  assert.ok(await visible(), 'its last picture stays');
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').style.marginTop = '0'; });
  await until(() => document.querySelector('fourdvt-viewer').stats?.framesShown > 2);
  const back = await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    return { sequence: viewer.sequence, azimuth: viewer.getCameraOrbit().azimuth, paused: viewer.paused };
  });
  assert.deepEqual(back, { sequence: 'run', azimuth: 80, paused: false });
  assert.deepEqual(page.troubles, []);
});

test('removal while playing closes every decoder and picture and gives the GL context back', async () => {
  await open({
    attributes: { autoplay: '' },
    before: () => {
      const live = (globalThis.live = { decoders: 0 });
      const Native = globalThis.VideoDecoder;
      globalThis.VideoDecoder = class extends Native {
        constructor(init) { super(init); ++live.decoders; }
        close() { super.close(); --live.decoders; }
      };
    },
  });
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > 5);
  const seen = await page.evaluate(async () => {
    const viewer = document.querySelector('fourdvt-viewer');
    const gl = viewer.shadowRoot.querySelector('canvas').getContext('webgl2');
    const before = globalThis.live.decoders;
    viewer.remove();
    await new Promise((next) => setTimeout(next, 200));
    const after = globalThis.live.decoders;
    for (const end = performance.now() + 10_000; !gl.isContextLost() && performance.now() < end;) await new Promise((next) => setTimeout(next, 100));
    return { before, after, lost: gl.isContextLost(), stats: viewer.stats };
  });
  assert.deepEqual(seen, { before: 1, after: 0, lost: true, stats: null });
  assert.deepEqual(page.troubles, []);
});

// The browser's answers about the highest rendition and the one below it: unsupported, and not smooth.
const doubts = () => {
  globalThis.pending = globalThis.answered = 0;
  const noted = async (answer) => {
    ++globalThis.pending;
    return answer.finally(() => { --globalThis.pending; ++globalThis.answered; });
  };
  const supported = VideoDecoder.isConfigSupported.bind(VideoDecoder);
  VideoDecoder.isConfigSupported = (config) =>
    noted(config.codedWidth > 1000 && globalThis.doubt === 'unsupported' ? Promise.resolve({ supported: false, config }) : supported(config));
  navigator.mediaCapabilities.decodingInfo = ({ video }) =>
    noted(Promise.resolve({ supported: true, smooth: video.width < 1000 || globalThis.doubt !== 'rough', powerEfficient: false }));
};
const fetchedOfPickup = () => performance.getEntriesByType('resource').map(({ name }) => name.split('/').at(-1)).filter((name) => /^pickup\..*mp4/.test(name)).map((name) => name.replace(/\.[0-9a-f]{8}\.mp4/, '.mp4'));
for (const [doubt, name] of [['none', 'every rendition is played where the browser expects all to be smooth'],
  ['unsupported', 'renditions that the browser cannot decode are not fetched'],
  ['rough', 'renditions that the browser does not expect to be smooth are not fetched']]) {
  test(name, async () => {
    await open({ before: `globalThis.doubt = '${doubt}'; (${doubts})()` });
    // Four motions of three renditions: twelve answers about decoding, and at least four about smoothness.
    await until(() => globalThis.answered >= 16 && globalThis.pending === 0);
    await page.waitForTimeout(500); // before, the first motion may have gone up
    await page.evaluate(() => { document.querySelector('fourdvt-viewer').sequence = 'pickup'; });
    if (doubt === 'none') {
      await until(() => performance.getEntriesByType('resource').some(({ name }) => /\/pickup\.([0-9a-f]{8}\.)?mp4/.test(name)));
    } else {
      await until(() => performance.getEntriesByType('resource').some(({ name }) => /\/pickup\.384-34\.([0-9a-f]{8}\.)?mp4/.test(name)));
      await page.waitForTimeout(2000);
      assert.deepEqual(new Set(await page.evaluate(fetchedOfPickup)), new Set(['pickup.384-34.mp4']));
    }
    assert.ok(await visible());
    assert.deepEqual(page.troubles, []);
  });
}

test('another upload path: its player fetches what the browser can decode, which is looked up once', async () => {
  await open({ before: `globalThis.doubt = 'unsupported'; (${doubts})(); (${slowPlanes})()` });
  await until(() => globalThis.answered >= 16 && globalThis.pending === 0);
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').sequence = 'pickup'; });
  const answered = await page.evaluate(() => globalThis.answered);
  await until(() => document.querySelector('fourdvt-viewer').stats?.uploadPath.startsWith('rgba'));
  await until(() => document.querySelector('fourdvt-viewer').stats.framesShown > 0);
  await page.waitForTimeout(2000);
  assert.deepEqual(new Set(await page.evaluate(fetchedOfPickup)), new Set(['pickup.384-34.mp4']));
  assert.equal(await page.evaluate(() => globalThis.answered), answered);
  assert.deepEqual(page.troubles, []);
});

test('beginnings of other motions come after the first change of motion, not before', async () => {
  await open({ uploadPath: 'i420' }); // another path would begin with a player that no motion was chosen in
  await page.waitForTimeout(2500);
  const ofRun = () => performance.getEntriesByType('resource').some(({ name }) => /\/run\.384-34\.([0-9a-f]{8}\.)?mp4/.test(name));
  assert.equal(await page.evaluate(ofRun), false);
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').sequence = 'pickup'; });
  await until(ofRun);
  assert.equal(await viewer('sequence'), 'pickup');
  assert.deepEqual(page.troubles, []);
});
