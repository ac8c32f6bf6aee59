// SPDX-License-Identifier: Apache-2.0
// One step of a start or of playback makes no progress: an event and a note name the step, the note ends when it
// progresses, and a fallback is used where there is one. The test controls the clock.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';

import { installClock } from './clock.mjs';
import { environment, kPatienceMs, launch, openPage } from './harness.mjs';
import { load } from './load_source.mjs';
import { serve } from './server.mjs';

const kPatienceS = 20;
let server, browser, page;
before(async () => {
  browser = await launch();
  server = await serve(environment('SITE'), 0, { pages: { '/blank.html': { html: '<!doctype html><html lang="en"><meta charset="utf-8"><link rel="icon" href="data:,">', headers: {} } } });
});
after(async () => {
  await browser?.close();
  await server?.close();
});
afterEach(() => page?.close());

test('it counts seconds without progress, and stops where nothing is awaited', async () => {
  const { Watchdog } = await load('report/watchdog');
  const { setInterval: real, clearInterval: clear } = globalThis;
  let tick = null, awaited = { step: 'files', progress: '1' };
  globalThis.setInterval = (run) => ((tick = run), 1);
  globalThis.clearInterval = () => { tick = null; };
  try {
    const reports = [], dog = new Watchdog(() => awaited, (step) => reports.push(step));
    const pass = (seconds) => { for (let i = 0; i < seconds; ++i) tick?.(); };
    dog.wake();
    pass(kPatienceS);
    assert.deepEqual(reports, []);
    awaited = { step: 'files', progress: '2' };
    pass(kPatienceS);
    assert.deepEqual(reports, [], 'something has come');
    pass(1);
    assert.deepEqual(reports, ['files']);
    pass(kPatienceS);
    assert.deepEqual(reports, ['files', 'files'], 'again');
    awaited = { step: 'decoder', progress: '2' };
    pass(1);
    assert.deepEqual(reports.splice(0), ['files', 'files', null], 'another step');
    pass(kPatienceS);
    awaited = null;
    pass(1);
    assert.deepEqual(reports.splice(0), ['decoder', null]);
    assert.equal(tick, null, 'nothing to watch');
    awaited = { step: 'more', progress: '' };
    dog.wake();
    pass(kPatienceS + 1);
    dog.stop();
    assert.deepEqual([reports, tick], [['more', null], null]);
  } finally {
    Object.assign(globalThis, { setInterval: real, clearInterval: clear });
  }
});

// hang: runs in the page before its scripts, and lets something come to nothing while globalThis.hangs is true; calls globalThis.hung()
// when that has begun.
async function open(hang, { uploadPath = 'i420', attributes = { autoplay: '' } } = {}) {
  page = await openPage(browser, { viewport: { width: 320, height: 420 } }, uploadPath);
  await page.addInitScript(installClock);
  await page.addInitScript(() => {
    globalThis.hangs = true;
    globalThis.hung = () => { globalThis.hasHung = true; };
    globalThis.stalls = [];
    addEventListener('stalled', (e) => { if (e.detail) globalThis.stalls.push(e.detail); }, true);
  });
  await page.addInitScript(hang);
  await page.goto(`${server.url}blank.html`);
  await page.evaluate(async (attributes) => {
    await import('/fourdvt-viewer/fourdvt-viewer.js');
    const viewer = (globalThis.viewer = document.createElement('fourdvt-viewer'));
    for (const [name, value] of Object.entries({ ...attributes, src: '/character/character.gltf', sequence: 'walk', loop: '' })) viewer.setAttribute(name, value);
    document.body.append(viewer);
  }, attributes);
  await until(() => globalThis.hasHung);
}
const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });
const note = () => page.evaluate(() => {
  const line = globalThis.viewer.shadowRoot.querySelector('.note');
  return line.hidden ? null : line.textContent;
});
// An animation frame, which has no clock of the test's; on a page that gives none, a moment.
const frame = () => Promise.race([
  page.evaluate(() => new Promise((next) => requestAnimationFrame(next))).catch(() => undefined), new Promise((next) => setTimeout(next, 500)),
]);
// Turns the clock until the condition holds, with a frame of the page for each second.
async function turnUntil(condition, maxS = 120) {
  for (let s = 0; s < maxS && !(await page.evaluate(condition)); ++s) {
    await page.evaluate(() => globalThis.testClock.turn(1000));
    await frame();
  }
  assert.ok(await page.evaluate(condition), `${condition}`);
}
async function expectStall(step, text) {
  await turnUntil(() => globalThis.stalls.length > 0);
  const [stall] = await page.evaluate(() => globalThis.stalls);
  assert.equal(stall.step, step);
  assert.match(stall.message, /^20 s without progress: .*reload the page$/);
  return text && assert.equal(await note(), text);
}
async function expectGoingOn() {
  await page.evaluate(() => { globalThis.hangs = false; });
  await turnUntil(() => globalThis.viewer.stats?.framesShown > 3);
  await turnUntil(() => globalThis.viewer.shadowRoot.querySelector('.note').hidden);
  assert.deepEqual(await page.evaluate(() => globalThis.viewer.error), null);
}

const hangingFetch = (name) => `
  const real = fetch;
  globalThis.fetch = (url, ...rest) => !String(url).includes('${name}') ? real(url, ...rest) : new Promise((done, fail) => {
    hung();
    const timer = setInterval(() => { if (!hangs) { clearInterval(timer); real(url, ...rest).then(done, fail); } }, 100);
  });`;
const hangingCompiler = () => {
  const real = WebAssembly.compileStreaming;
  WebAssembly.compileStreaming = (source) => new Promise((done, fail) => {
    globalThis.hung();
    const timer = setInterval(() => { if (!globalThis.hangs) { clearInterval(timer); real.call(WebAssembly, source).then(done, fail); } }, 100);
  });
};

for (const [title, hang, options, step, text] of [
  ['a manifest of which no byte comes', hangingFetch('character.gltf'), {}, 'manifest', 'Waiting for the character …'],
  ['a player that is not compiled', hangingCompiler, {}, 'player', 'Waiting for the player …'],
  ['a second part of which no byte comes', hangingFetch('fourdvt-more.wasm'), { uploadPath: 'rgba' }, 'more', 'Waiting for the rest of the player …'],
]) {
  test(`${title} is named, and awaited`, async () => {
    await open(hang, options);
    await expectStall(step, text);
    await expectGoingOn();
  });
}

const silentDecoder = () => {
  const real = VideoDecoder.prototype.decode;
  VideoDecoder.prototype.decode = function (...rest) {
    if (globalThis.hangs) globalThis.hung();
    else real.apply(this, rest);
  };
};

test('a decoder that gives no picture is named, and opened anew', async () => {
  await open(silentDecoder);
  await expectStall('decoder', 'Waiting for the video decoder …');
  await expectGoingOn();
  await page.evaluate(() => { globalThis.stalls.length = 0; globalThis.hangs = true; });
  await expectStall('decoder', 'Waiting for the video decoder …'); // while it plays
  await expectGoingOn();
});

test('decoders that never give a picture are an error in the end', async () => {
  await open(silentDecoder);
  await turnUntil(() => globalThis.viewer.error, 180);
  assert.equal(await page.evaluate(() => globalThis.viewer.error.id), 'decoder-lost');
  await turnUntil(() => globalThis.viewer.shadowRoot.querySelector('.note').hidden);
});

test('a copy that does not end is named, and replaced by the upload of the whole picture', async () => {
  await open(() => { VideoFrame.prototype.copyTo = () => { globalThis.hung(); return new Promise(() => undefined); }; });
  await expectStall('upload');
  await expectGoingOn();
  assert.match(await page.evaluate(() => globalThis.viewer.stats.uploadPath), /^rgba/);
});

test('a barcode that does not come back from the GPU is named, and done without', async () => {
  await open(() => {
    const gl = WebGL2RenderingContext.prototype;
    gl.getSyncParameter = () => { globalThis.hung(); return gl.UNSIGNALED; };
    gl.clientWaitSync = () => { globalThis.hung(); return gl.TIMEOUT_EXPIRED; };
  }, { uploadPath: 'rgba' });
  await expectStall('barcode');
  await expectGoingOn();
  assert.equal(await page.evaluate(() => globalThis.viewer.stats.barcodeChecked), 0);
});

test('animation frames that do not come are named', async () => {
  await open(() => {
    const real = requestAnimationFrame;
    globalThis.requestAnimationFrame = (run) => {
      if (!globalThis.hangs) return real(run);
      globalThis.hung();
      const timer = setInterval(() => { if (!globalThis.hangs) { clearInterval(timer); real(run); } }, 100);
      return timer;
    };
  });
  await expectStall('display', 'Waiting for the display …');
  await expectGoingOn();
});

test('a viewer that is paused, off the screen or on a hidden page awaits nothing', async () => {
  await open(() => globalThis.hung(), { attributes: {} });
  await until(() => globalThis.viewer.readyState >= 3);
  await page.evaluate(() => globalThis.testClock.turn(30_000));
  await page.evaluate(() => {
    VideoDecoder.prototype.decode = () => undefined;
    Object.defineProperty(document, 'hidden', { get: () => globalThis.hides, configurable: true });
    globalThis.hide = (hides) => {
      globalThis.hides = hides;
      document.dispatchEvent(new Event('visibilitychange'));
    };
    globalThis.hide(true);
    void globalThis.viewer.play();
  });
  await page.evaluate(() => globalThis.testClock.turn(30_000));
  await page.evaluate(async () => {
    globalThis.viewer.style.marginTop = '200vh';
    await new Promise((next) => { new IntersectionObserver(([entry]) => { if (!entry.isIntersecting) next(); }).observe(globalThis.viewer); });
    globalThis.hide(false);
  });
  await page.evaluate(() => globalThis.testClock.turn(30_000));
  assert.deepEqual(await page.evaluate(() => globalThis.stalls), []);
  await page.evaluate(() => { globalThis.viewer.style.marginTop = '0'; });
  await expectStall('decoder');
});
