// SPDX-License-Identifier: Apache-2.0
// The pages of web/examples on the site: each draws the character, and its controls have their effects.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';

import { environment, kPatienceMs, launch, openPage, outputFolder, waitForEvent, writePicture } from './harness.mjs';
import { serve } from './server.mjs';

const kMinShare = 0.02;  // of a canvas that the character covers; background alone is transparent
const kMinTones = 200;   // of different colours: a flat patch has a few

let server, browser;
before(async () => {
  server = await serve(environment('SITE'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

async function openExample(name) {
  const page = await openPage(browser, { viewport: { width: 360, height: 480 } });
  await page.goto(`${server.url}examples/${name}.html`);
  await waitForEvent(page, 'canplay');
  return page;
}

const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });

// The canvas of the viewer with this index, as a small straight-alpha picture.
async function canvasOf(page, index = 0) {
  const { width, height, bytes } = await page.evaluate((at) => {
    const canvas = document.querySelectorAll('fourdvt-viewer')[at].shadowRoot.querySelector('canvas');
    const [width, height] = [Math.ceil(canvas.width / 4), Math.ceil(canvas.height / 4)];
    const copy = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0, width, height);
    return { width, height, bytes: [...copy.getImageData(0, 0, width, height).data] };
  }, index);
  return { width, height, data: Uint8Array.from(bytes) };
}

// Waits for the character in the canvas: opaque pixels of many colours.
async function expectCharacter(page, name, index = 0) {
  let share = 0, tones = new Set();
  const end = Date.now() + kPatienceMs;
  while (Date.now() < end) {
    const picture = await canvasOf(page, index);
    const pixels = new Uint32Array(picture.data.buffer);
    const opaque = pixels.filter((pixel) => pixel >>> 24 === 255);
    share = opaque.length / pixels.length;
    tones = new Set(opaque);
    writePicture(join(outputFolder('examples'), `${name}.png`), picture);
    if (share >= kMinShare && tones.size >= kMinTones) return picture;
    await new Promise((next) => setTimeout(next, 200));
  }
  assert.fail(`${name}: the canvas shows no character: ${share} of it is opaque, in ${tones.size} colours`);
}

const differ = (a, b) => a.data.reduce((sum, value, i) => sum + Math.abs(value - b.data[i]), 0) / a.data.length;

async function finish(page) {
  assert.deepEqual(page.troubles, []);
  await page.close();
}

test('embed: opened as a file it says that it needs a server', async () => {
  const page = await browser.newPage();
  await page.goto(pathToFileURL(join(environment('SITE'), 'examples/embed.html')).href);
  assert.match(await page.locator('fourdvt-viewer').innerText(), /a web server/);
  await page.close();
});

test('embed: plays, and turns under the pointer', async () => {
  const page = await openExample('embed');
  await expectCharacter(page, 'embed');
  await until(page, () => !document.querySelector('fourdvt-viewer').paused);
  const azimuth = () => page.evaluate(() => document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth);
  const before = await azimuth();
  await page.evaluate(() => document.querySelector('fourdvt-viewer').pause());
  const still = await canvasOf(page);
  await page.mouse.move(150, 240);
  await page.mouse.down();
  await page.mouse.move(270, 240, { steps: 6 });
  await page.mouse.up();
  await page.evaluate(() => document.querySelector('fourdvt-viewer').jumpCameraToGoal());
  await page.waitForTimeout(500);
  assert.notEqual(await azimuth(), before);
  const turned = await expectCharacter(page, 'embed-turned');
  assert.ok(differ(still, turned) > 1, `the picture changes by ${differ(still, turned)} levels`);
  await finish(page);
});

test('steer: keys change speed and direction, and the page shows the speed', async () => {
  const page = await openExample('steer');
  await until(page, () => document.querySelector('fourdvt-viewer').parameters.length > 0);
  await expectCharacter(page, 'steer');
  await until(page, () => /^\d\.\d m\/s$/.test(document.querySelector('#speed').value));
  const state = () => page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    return { speed: viewer.getParameter(viewer.parameters[0].name), heading: viewer.heading };
  });
  const before = await state();
  await page.keyboard.down('ArrowUp');
  await until(page, (speed) => {
    const viewer = document.querySelector('fourdvt-viewer');
    return viewer.getParameter(viewer.parameters[0].name) > speed + 0.2;
  }, before.speed);
  await page.keyboard.up('ArrowUp');
  await page.keyboard.down('ArrowRight');
  await until(page, (heading) => Math.abs(document.querySelector('fourdvt-viewer').heading - heading) > 5, before.heading);
  await page.keyboard.up('ArrowRight');
  await until(page, () => {
    const viewer = document.querySelector('fourdvt-viewer');
    return document.querySelector('#speed').value === `${viewer.getParameter(viewer.parameters[0].name).toFixed(1)} m/s`;
  });
  await expectCharacter(page, 'steer-faster');
  await finish(page);
});

test('gallery: every figure shows its motion, and one plays at a time', async () => {
  const page = await openExample('gallery');
  const count = await page.locator('fourdvt-viewer').count();
  assert.equal(count, 3);
  for (let i = 0; i < count; ++i) {
    await page.locator('fourdvt-viewer').nth(i).scrollIntoViewIfNeeded();
    await expectCharacter(page, `gallery-${i}`, i);
  }
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('fourdvt-viewer')].map((viewer) => viewer.sequence)),
    ['walk', 'run', 'pickup']);
  for (const chosen of [0, 1]) {
    await page.locator('button').nth(chosen).click();
    await until(page, (at) => [...document.querySelectorAll('fourdvt-viewer')].every((viewer, i) => viewer.paused === (i !== at)), chosen);
    const frame = await page.evaluate((at) => document.querySelectorAll('fourdvt-viewer')[at].frame, chosen);
    await until(page, ([at, shown]) => document.querySelectorAll('fourdvt-viewer')[at].frame !== shown, [chosen, frame]);
  }
  await finish(page);
});

test('own controls: button, slider and list do what they say', async () => {
  const page = await openExample('own-controls');
  await expectCharacter(page, 'own-controls');
  assert.deepEqual(await page.locator('#motion option').allTextContents(),
    await page.evaluate(() => document.querySelector('fourdvt-viewer').sequences.map(({ name }) => name)));
  await page.click('#play');
  await until(page, () => !document.querySelector('fourdvt-viewer').paused && document.querySelector('#play').textContent === 'Pause');
  await until(page, () => Number(document.querySelector('#time').value) > 0);
  await page.click('#play');
  await until(page, () => document.querySelector('fourdvt-viewer').paused && document.querySelector('#play').textContent === 'Play');

  const still = await canvasOf(page);
  const other = await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer'), time = document.querySelector('#time');
    const wanted = (viewer.currentTime + viewer.duration / 2) % viewer.duration;
    time.value = wanted;
    time.dispatchEvent(new Event('input'));
    return wanted;
  });
  await until(page, (wanted) => Math.abs(document.querySelector('fourdvt-viewer').currentTime - wanted) < 0.05, other);
  await page.waitForTimeout(500);
  const moved = await expectCharacter(page, 'own-controls-moved');
  assert.ok(differ(still, moved) > 0.5, `the picture changes by ${differ(still, moved)} levels`);

  await page.selectOption('#motion', 'pickup');
  await until(page, () => document.querySelector('fourdvt-viewer').sequence === 'pickup' &&
    Number(document.querySelector('#time').max) === document.querySelector('fourdvt-viewer').duration);
  await expectCharacter(page, 'own-controls-pickup');
  await finish(page);
});
