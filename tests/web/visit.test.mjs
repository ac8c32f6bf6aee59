// SPDX-License-Identifier: Apache-2.0
// The page as a visitor uses it. Nothing may be written to the console as an error, no promise may be left rejected.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';

import { closeSite, environment, kPatienceMs, openPage, openSite, outputFolder, readCanvas, waitForEvent, writePicture } from './harness.mjs';
import { coverage } from './ssim.mjs';

let site, server, browser, page;
before(async () => {
  site = await openSite({ width: 390, height: 844 });
  ({ server, browser, page } = site);
});
after(() => closeSite(site));

const viewerState = () => page.evaluate(() => {
  const viewer = document.querySelector('fourdvt-viewer');
  const { sequence, frame, paused, currentTime } = viewer;
  return { sequence, frame, paused, currentTime, orbit: viewer.getCameraOrbit(), stats: viewer.stats };
});

const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });

// Frames of a motion shown since now.
const framesAdvance = (sequence, wanted) => page.evaluate(async ({ sequence, wanted, patience }) => {
  const viewer = document.querySelector('fourdvt-viewer');
  const frames = new Set();
  const end = performance.now() + patience;
  while (frames.size < wanted && performance.now() < end) {
    if (viewer.sequence === sequence) frames.add(viewer.frame);
    await new Promise((next) => setTimeout(next, 10));
  }
  return frames.size;
}, { sequence, wanted, patience: kPatienceMs });

test('plays on its own, and the figures are the report\'s', async () => {
  assert.ok(await framesAdvance('locomotion', 3) >= 3);
  const report = await (await fetch(`${server.url}character.report/report.json`)).json();
  await until(() => !document.getElementById('figures-text').hidden);
  const text = (await page.textContent('#figures-text')).replace(/\s+/g, ' ');
  assert.match(text, new RegExp(`the ${report.options.layers} best of ${report.cameras} camera views`));
});

test('dragging turns the character', async () => {
  const box = await page.locator('fourdvt-viewer').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const from = (await viewerState()).orbit.azimuth;
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 120, y, { steps: 6 });
  await page.mouse.up();
  await until((before) => Math.abs(document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth - before) > 10, from);
  assert.ok((await viewerState()).orbit.azimuth < from, 'dragging to the right brings the left side to the front');
});

test('keys turn, zoom and pause', async () => {
  await page.locator('fourdvt-viewer').locator('css=.stage').focus();
  // The drag of the test before may still glide on, against the keys.
  await page.evaluate(() => document.querySelector('fourdvt-viewer').jumpCameraToGoal());
  const { orbit } = await viewerState();
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
  await until((from) => document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth > from + 20, orbit.azimuth);
  await page.keyboard.press('+');
  await until((from) => document.querySelector('fourdvt-viewer').getCameraOrbit().distance < from * 0.95, orbit.distance);
  await page.keyboard.press(' ');
  await until(() => document.querySelector('fourdvt-viewer').paused);
  assert.equal(await page.getAttribute('#play', 'aria-label'), 'Play');
  await page.keyboard.press(' ');
  await until(() => !document.querySelector('fourdvt-viewer').paused);
});

test('motions can be chosen by mouse and by keys', async () => {
  const offered = await page.locator('#motions input').evaluateAll((inputs) => inputs.map((input) => input.value));
  assert.deepEqual(offered.sort(), ['locomotion', 'pickup'], 'the ends of the slider are no motions of their own');
  for (const sequence of ['pickup', 'locomotion']) {
    await page.locator(`#motions input[value=${sequence}]`).click();
    await until((wanted) => document.querySelector('fourdvt-viewer').sequence === wanted, sequence);
    assert.ok(await framesAdvance(sequence, 3) >= 3, `${sequence} moves`);
  }
  assert.ok(await page.isChecked('#motions input[value=locomotion]'));
  await page.locator('#motions input[value=locomotion]').focus();
  await page.keyboard.press('ArrowLeft');
  await until(() => document.querySelector('fourdvt-viewer').state === 'pickup');
});

test('the scrub bar and the play button steer time', async () => {
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').sequence = 'pickup'; });
  await until(() => document.querySelector('fourdvt-viewer').sequence === 'pickup');
  if (!(await viewerState()).paused) await page.click('#play');
  await until(() => document.querySelector('fourdvt-viewer').paused);
  await page.locator('#scrub').fill('20');
  await until(() => document.querySelector('fourdvt-viewer').frame === 20);
  assert.match(await page.inputValue('#scrub'), /^20$/);
  await page.locator('#scrub').press('ArrowRight');
  await until(() => document.querySelector('fourdvt-viewer').frame === 21);
  await page.click('#play');
  await until(() => document.querySelector('fourdvt-viewer').paused && document.querySelector('fourdvt-viewer').frame === 39);
  await page.click('#play');
  await until(() => document.querySelector('fourdvt-viewer').frame < 30);
});

test('the picture follows the window', async () => {
  await page.setViewportSize({ width: 1200, height: 800 });
  await until(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    const canvas = viewer.shadowRoot.querySelector('canvas');
    return Math.abs(canvas.width - viewer.clientWidth) <= 1 && Math.abs(canvas.height - viewer.clientHeight) <= 1;
  });
  await page.waitForTimeout(500);
  const picture = await readCanvas(page);
  writePicture(join(outputFolder('visit'), 'resized.png'), picture);
  assert.ok(coverage(picture) > 0.01, 'the character is in the resized picture');
});

test('nothing is fetched or drawn after removal, and a second visit works', async () => {
  await page.evaluate(() => {
    globalThis.removed = document.querySelector('fourdvt-viewer');
    globalThis.place = { parent: globalThis.removed.parentElement, next: globalThis.removed.nextSibling };
    globalThis.removed.remove();
  });
  await page.waitForTimeout(300);
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  await page.waitForTimeout(1500);
  assert.deepEqual(requests, []);
  await page.evaluate(() => {
    globalThis.viewerEvents.length = 0;
    globalThis.place.parent.insertBefore(globalThis.removed, globalThis.place.next);
  });
  await waitForEvent(page, 'canplay');
});

test('frames paired without a mistake; no console errors, no unhandled rejections', async () => {
  const { stats } = await viewerState();
  assert.equal(stats.barcodeMismatches, 0);
  assert.deepEqual(page.troubles, []);
});

test('reduced motion: the page waits for the visitor', async () => {
  const calm = await openPage(browser, { viewport: { width: 390, height: 844 }, reducedMotion: 'reduce' });
  await calm.goto(server.url);
  await waitForEvent(calm, 'canplay');
  await calm.waitForTimeout(1000);
  assert.ok(await calm.evaluate(() => document.querySelector('fourdvt-viewer').paused));
  assert.equal(await calm.getAttribute('#play', 'aria-label'), 'Play');
  assert.deepEqual(calm.troubles, []);
  await calm.close();
});

test('sizes.json lists every script and module of the player, with the bytes that they have', () => {
  const dist = join(environment('SITE'), 'fourdvt-viewer'), parts = Object.values(JSON.parse(readFileSync(join(dist, 'sizes.json'), 'utf8')));
  const files = parts.flatMap((part) => part.files), read = (name) => readFileSync(join(dist, name));
  assert.deepEqual(files.map(({ name }) => name).sort(), readdirSync(dist).filter((name) => /\.(js|wasm)$/.test(name)).sort());
  for (const { name, bytes, gzip_bytes } of files) assert.deepEqual([bytes, gzip_bytes], [read(name).length, gzipSync(read(name), { level: 9 }).length], name);
  for (const { title, files: own, gzip_bytes, limit_gzip_bytes } of parts) {
    assert.equal(gzip_bytes, own.reduce((sum, file) => sum + file.gzip_bytes, 0), title);
    assert.ok(gzip_bytes <= (limit_gzip_bytes ?? Infinity), title);
  }
});
