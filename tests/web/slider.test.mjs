// SPDX-License-Identifier: Apache-2.0
// The page with one slider for two characters: both walk, run and draw at the slider's speed, turn together, and pause at one frame.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, outputFolder } from './harness.mjs';
import { serve } from './server.mjs';

const kMinFigure = 0.01; // share of the picture
const kMinChange = 0.003; // share of the picture that differs between walk and run

let server, browser;
before(async () => {
  server = await serve(environment('SITE'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

// Shares of the viewers' canvases: covered by the figure, and changed since the last call.
const readPictures = (page) => page.evaluate(() => [...document.querySelectorAll('fourdvt-viewer')].map((viewer) => {
  const canvas = viewer.shadowRoot.querySelector('canvas'), copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height), last = viewer.lastPicture;
  viewer.lastPicture = data;
  let covered = 0, changed = 0;
  for (let i = 3; i < data.length; i += 4) {
    covered += data[i] > 200;
    changed += Boolean(last) && (data[i] > 200) !== (last[i] > 200);
  }
  return { covered: covered / (canvas.width * canvas.height), changed: changed / (canvas.width * canvas.height) };
}));
const speedsOf = (page) => page.$$eval('fourdvt-viewer', (viewers) => viewers.map((viewer) => viewer.getParameter('speed_mps')));
const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs });

test('one slider sets the speed of both characters, by keys, too', async () => {
  const page = await openPage(browser, { viewport: { width: 820, height: 900 } });
  await page.goto(`${server.url}slider.html`);
  const slider = page.locator('#speed');
  assert.ok(await slider.isDisabled());
  await until(page, () => !document.getElementById('speed').disabled);
  await until(page, () => [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.sequence === 'locomotion' && v.stats.framesShown > 1));
  const [min, max] = await slider.evaluate((element) => [Number(element.min), Number(element.max)]);
  assert.ok(min > 0.8 && min < 1.6 && max > 2.2 && max < 3.4, `from ${min} to ${max} m/s`);
  assert.ok(Math.abs(Number(await slider.inputValue()) - min) < 0.001);

  // The same frame of both, at the lowest and at the highest speed.
  await page.evaluate(() => document.getElementById('given').pause());
  await until(page, () => {
    const [found, given] = document.querySelectorAll('fourdvt-viewer');
    return found.paused && given.paused && found.frame === given.frame && !found.seeking && !given.seeking;
  });
  await readPictures(page);
  await slider.focus();
  await page.keyboard.press('End');
  await until(page, (max) => [...document.querySelectorAll('fourdvt-viewer')].every((v) => Math.abs(v.getParameter('speed_mps') - max) < 0.01), max);
  assert.equal(await page.locator('#speed-text').textContent(), `${max.toFixed(2)} m/s`);
  assert.equal(await slider.getAttribute('aria-valuetext'), `${max.toFixed(2)} m/s`);
  await page.evaluate(async () => { for (let i = 0; i < 5; ++i) await new Promise((next) => requestAnimationFrame(next)); });
  for (const { covered, changed } of await readPictures(page)) {
    assert.ok(covered > kMinFigure, `${covered} of the picture is covered`);
    assert.ok(changed > kMinChange, `${changed} of the picture has changed`);
  }
  await page.screenshot({ path: join(outputFolder('slider'), 'run.png') });

  await page.keyboard.press('ArrowLeft');
  await until(page, (max) => [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.getParameter('speed_mps') < max - 0.001), max);
  const [found, given] = await speedsOf(page);
  assert.ok(Math.abs(found - given) < 0.05, `${found} and ${given} m/s`);

  // Both play on, and turn together.
  const shown = () => page.$$eval('fourdvt-viewer', (viewers) => viewers.map((viewer) => viewer.stats.framesShown));
  const before = await shown();
  await page.evaluate(() => void document.getElementById('given').play());
  await until(page, (before) => [...document.querySelectorAll('fourdvt-viewer')].every((v, i) => v.stats.framesShown > before[i] + 5), before);
  await page.evaluate(() => document.getElementById('found').setAttribute('camera-orbit', '70deg 10deg 4m'));
  await until(page, () => Math.abs(document.getElementById('given').getCameraOrbit().azimuth - 70) < 1);
  assert.ok(await page.locator('#notice').isHidden());
  assert.deepEqual(page.troubles, []);
  await page.close();
});
