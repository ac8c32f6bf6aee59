// SPDX-License-Identifier: Apache-2.0
// Looks in the page, and Montage4D over layers: native against browser, on a layered character and on one from cameras;
// values and pictures that cannot be used; the front page's controls.
import assert from 'node:assert/strict';
import { existsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, launch, openPage, outputFolder, readCanvas, renderNative, showPose, waitForEvent, writePicture } from './harness.mjs';
import { encodePng } from './png.mjs';
import { serve } from './server.mjs';
import { ssim } from './ssim.mjs';

const kSsim = 0.98;
const kPatience = 60_000;
const kWalk = { sequence: 'walk', frame: 7, azimuth: 30, elevation: 10, distance: 4.2 };
const kRun = { sequence: 'run', frame: 5, azimuth: 25, elevation: 8, distance: 4.2 };

// Warm from the left, blue from above and behind.
function lightPicture(width, height) {
  const data = new Uint8Array(4 * width * height);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const left = x < width / 2;
      data.set([left ? 250 : 30, left ? 180 : 60, y < height / 2 ? 220 : 20, 255], 4 * (y * width + x));
    }
  }
  return encodePng({ width, height, data });
}

let server, browser, page;
before(async () => {
  server = await serve(environment('SITE'));
  browser = await launch();
  page = await openPage(browser);
  await page.route('**/lights/*.png', (route) => {
    const [width, height] = route.request().url().endsWith('square.png') ? [32, 32] : [64, 32];
    return route.fulfill({ body: lightPicture(width, height), contentType: 'image/png' });
  });
  await page.goto(server.url);
  await waitForEvent(page, 'canplay');
  await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    Object.assign(viewer.style, { position: 'fixed', inset: 'auto', left: '0', top: '0', width: '480px', height: '640px', zIndex: 9 });
  });
  await page.waitForFunction(() => {
    const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
    return canvas.width === 480 && canvas.height === 640;
  });
});
after(async () => {
  await browser?.close();
  await server?.close();
});

/** Sets the attributes; null removes one. */
const set = (attributes) => page.evaluate((wanted) => {
  const viewer = document.querySelector('fourdvt-viewer');
  for (const [name, value] of Object.entries(wanted)) {
    if (value === null) viewer.removeAttribute(name);
    else viewer.setAttribute(name, value);
  }
}, attributes);

/** Likewise, and the error event that comes of it. */
async function errorOf(attributes) {
  const error = page.evaluate(() => new Promise((done) => {
    document.querySelector('fourdvt-viewer').addEventListener('error', (e) => done(e.detail), { once: true });
  }));
  await set(attributes);
  return error;
}

/** Waits until the canvas shows what the tool draws; a look takes effect when all that it needs is loaded. */
async function expectNative(name, character, pose, options) {
  const out = outputFolder('looks');
  const native = await renderNative(environment('BIN'), character, pose, 480, 640, join(out, `${name}-native.png`), options);
  const until = Date.now() + kPatience;
  for (;;) {
    const shown = await readCanvas(page);
    const { foreground } = ssim(shown, native);
    if (foreground >= kSsim) return void console.log(`${name}: SSIM ${foreground.toFixed(4)} on the silhouettes`);
    if (Date.now() > until) {
      writePicture(join(out, `${name}-browser.png`), shown);
      assert.fail(`${name}: SSIM ${foreground.toFixed(4)} on the silhouettes is below ${kSsim}; pictures in ${out}`);
    }
    await new Promise((next) => setTimeout(next, 200));
  }
}

test('native and browser agree on the looks of a layered character, and on Montage4D over layers', async () => {
  const character = environment('CHARACTER');
  await showPose(page, kWalk);
  for (const look of ['', 'none']) await set({ look });
  await set({ look: 'sketch' });
  await expectNative('layered-sketch', character, kWalk, ['--look', 'sketch']);
  const light = join(outputFolder('looks'), 'light.png');
  writeFileSync(light, lightPicture(64, 32));
  await set({ look: 'relit', light: 'lights/wide.png', 'light-turn': '70', 'look-strength': '0.8' });
  await expectNative('layered-relit', character, kWalk,
    ['--look', 'relit', '--light', light, '--light-turn', '70', '--look-strength', '0.8']);
  await set({ look: '', light: null, 'light-turn': null, 'look-strength': null });
  await expectNative('layered-as-filmed', character, kWalk, []);
  await set({ method: 'montage4d' });
  await expectNative('layered-montage4d', character, kWalk, ['--method', 'montage4d']);
  await set({ method: null });
  assert.deepEqual(page.troubles, []);
});

test('values and pictures that cannot be used are one error each, and nothing changes', async () => {
  await set({ look: 'relit' });
  assert.match((await errorOf({ look: 'blurred' })).message, /look must be/);
  await set({ look: 'relit' });
  const strength = await errorOf({ 'look-strength': '3' });
  assert.equal(strength.id, 'invalid-argument');
  await set({ 'look-strength': null });
  assert.equal((await errorOf({ 'light-turn': 'left' })).id, 'invalid-argument');
  await set({ 'light-turn': null });
  const missing = await errorOf({ light: 'no-such-picture.png' });
  assert.equal(missing.id, 'fetch-failed');
  assert.match(missing.message, /no-such-picture/);
  assert.match((await errorOf({ light: 'lights/square.png' })).message, /twice as wide/);
  await set({ light: null });
  await expectNative('layered-relit-still', environment('CHARACTER'), kWalk, ['--look', 'relit']);
  await set({ look: null });
  page.troubles = page.troubles.filter((line) => !/404/.test(line));
  assert.deepEqual(page.troubles, []);
});

test('native and browser agree on the looks of a character from cameras', async () => {
  const folder = join(environment('SITE'), 'cameras', 'hull');
  assert.ok(existsSync(folder));
  await set({ look: 'relit', sequence: null });
  await page.evaluate(() => new Promise((done) => {
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.addEventListener('canplay', done, { once: true });
    viewer.src = 'cameras/hull/character.gltf';
  }));
  await showPose(page, kRun);
  await expectNative('cameras-relit', folder, kRun, ['--look', 'relit']);
  await set({ look: 'sketch', 'look-strength': '0.7' });
  await expectNative('cameras-sketch', folder, kRun, ['--look', 'sketch', '--look-strength', '0.7']);
  await set({ look: null, 'look-strength': null });
});

test('the front page: a choice of looks, sliders for those that have them', async () => {
  const phone = await openPage(browser, { viewport: { width: 390, height: 844 } });
  await phone.goto(server.url);
  await waitForEvent(phone, 'canplay');
  const choose = (value) => phone.evaluate((v) => document.querySelector(`input[name="look"][value="${v}"]`).click(), value);
  const shown = (id) => phone.evaluate((i) => document.getElementById(i).offsetParent !== null, id);
  assert.ok(!(await shown('look-strength')));
  await choose('relit');
  assert.ok(await shown('look-strength') && await shown('light-turn'));
  await phone.evaluate(() => {
    const slider = document.getElementById('light-turn');
    slider.value = '90';
    slider.dispatchEvent(new Event('input'));
  });
  assert.deepEqual(await phone.evaluate(() => {
    const viewer = document.getElementById('viewer');
    return [viewer.getAttribute('look'), viewer.getAttribute('light-turn'), document.getElementById('light-turn-value').value];
  }), ['relit', '90', '90°']);
  assert.ok(await phone.evaluate(() => [...document.querySelectorAll('.stage output, .stage select, nav a')]
    .every((part) => part.getBoundingClientRect().right <= 390)), 'nothing sticks out');
  await choose('sketch');
  assert.ok(await shown('look-strength') && !(await shown('light-turn')));
  await choose('');
  assert.ok(!(await shown('look-strength')));
  assert.equal(await phone.evaluate(() => document.getElementById('viewer').hasAttribute('look')), false);
  assert.deepEqual(phone.troubles, []);
  await phone.close();
});
