// SPDX-License-Identifier: Apache-2.0
// First seconds of a visit: a paused viewer becomes sharp, motion does not wait for deferred loads, and viewers below the
// fold load when they are near.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, outputFolder } from './harness.mjs';
import { serve } from './server.mjs';

const kHtml = (attributes) => `<!doctype html><meta charset="utf-8"><title>viewer</title><link rel="icon" href="data:,">
<style>body { margin: 0 } fourdvt-viewer { width: 360px; height: 480px }</style>
<script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script><fourdvt-viewer src="/character/character.gltf" ${attributes}></fourdvt-viewer>`;
const kLowest = /\.384-\d+\.[0-9a-f]+\.mp4$/;

let server, browser;
const pages = { '/standing.html': { html: kHtml('camera-controls'), headers: {} }, '/playing.html': { html: kHtml('autoplay loop'), headers: {} } };
before(async () => {
  server = await serve(environment('SITE'), 0, { pages });
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 30 });

// Frames that the viewer shows until there are so many of this motion.
const framesOf = (page, sequence, wanted) => until(page, ({ sequence, wanted }) => {
  const viewer = document.querySelector('fourdvt-viewer'), seen = ((globalThis.framesSeen ??= {})[sequence] ??= new Set());
  if (viewer.sequence === sequence) seen.add(viewer.frame);
  return seen.size >= wanted;
}, { sequence, wanted });

// Texture detail of the picture: mean difference of neighbouring pixels of the figure.
const detail = (page) => page.evaluate(() => {
  const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas[part=canvas]'), { width, height } = canvas;
  const copy = new OffscreenCanvas(width, height).getContext('2d');
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, width, height);
  let sum = 0, count = 0;
  for (let i = 0; i + 4 < data.length; i += 4) {
    if (data[i + 3] < 255 || data[i + 7] < 255) continue;
    sum += Math.abs(data[i + 1] - data[i + 5]);
    ++count;
  }
  return sum / count;
});

test('a viewer that stands on a slow network is raised to the highest rendition, by a fade, and keeps its frame', async () => {
  const page = await openPage(browser);
  const held = [];
  let hold = true;
  await page.route(/\.mp4$/, (route) => (hold && !kLowest.test(route.request().url()) ? held.push(route) : route.continue()));
  await page.addInitScript(() => {
    performance.getEntriesByType = () => []; // no throughput is known: it begins with the lowest
    globalThis.covers = [];
    globalThis.heard = [];
    addEventListener('sharper', () => globalThis.heard.push('sharper'), true);
    addEventListener('loadstart', (e) => new MutationObserver(() => {
      const stage = e.target.shadowRoot.querySelector('.stage');
      globalThis.covers.push(`${stage.className} ${stage.querySelectorAll('canvas').length}`);
    }).observe(e.target.shadowRoot.querySelector('.stage'), { attributes: true, childList: true }), { capture: true, once: true });
  });
  await page.goto(`${server.url}standing.html`);
  await until(page, () => globalThis.viewerEvents.some(({ type }) => type === 'canplay'));
  await until(page, () => document.querySelector('fourdvt-viewer').stats.framesShown >= 1);
  const low = await detail(page);
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').stats.rendition), 0);
  hold = false;
  for (const route of held.splice(0)) await route.continue();
  await until(page, () => document.querySelector('fourdvt-viewer').stats.rendition === 2);
  await until(page, () => !document.querySelector('fourdvt-viewer').shadowRoot.querySelector('.cover'));
  const high = await detail(page);
  console.log(`detail ${low.toFixed(2)}, then ${high.toFixed(2)}`);
  assert.ok(high > 1.15 * low, `detail ${low}, then ${high}`);
  const state = await page.evaluate(() => { const { frame, paused, seeking } = document.querySelector('fourdvt-viewer'); return { frame, paused, seeking }; });
  assert.deepEqual(state, { frame: 0, paused: true, seeking: false });
  assert.deepEqual(await page.evaluate(() => globalThis.heard), [], "it is the player's own event");
  const covers = await page.evaluate(() => globalThis.covers);
  assert.ok(covers.some((c) => /covered 2/.test(c)) && covers.some((c) => /fading 2/.test(c)), `the old picture fades: ${covers}`);
  assert.equal(await page.evaluate(() => globalThis.viewerEvents.filter(({ type }) => type === 'seeked').length), 0);
  await page.screenshot({ path: join(outputFolder('first_seconds'), 'standing.png') });
  await page.evaluate(() => document.querySelector('fourdvt-viewer').play());
  await framesOf(page, 'walk', 5);
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('on a fast network it begins with the highest, once', async () => {
  const page = await openPage(browser), videos = [];
  page.on('request', (request) => { if (/\.mp4$/.test(request.url())) videos.push(request.url()); });
  await page.addInitScript(() => {
    performance.getEntriesByType = () => [{ transferSize: 1e6, responseStart: performance.now() - 50, responseEnd: performance.now() }];
  });
  await page.goto(`${server.url}standing.html`);
  await until(page, () => document.querySelector('fourdvt-viewer').stats?.rendition === 2);
  assert.equal(videos.filter((url) => kLowest.test(url) && /walk/.test(url)).length, 0, videos.join('\n'));
  await page.close();
});

test('a motion that is asked for at once comes by a transition: until the second part is there, the first motion plays', async () => {
  const page = await openPage(browser), held = [];
  let hold = true;
  await page.route(/fourdvt-more\.(js|wasm)/, (route) => (hold ? held.push(route) : route.continue()));
  await page.addInitScript(() => addEventListener('canplay', (e) => e.target.goTo('locomotion'), { capture: true, once: true }));
  await page.goto(`${server.url}playing.html`);
  await framesOf(page, 'walk', 10);
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').state), 'locomotion', 'what is asked for');
  hold = false;
  for (const route of held.splice(0)) await route.continue();
  await framesOf(page, 'locomotion', 5);
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('a motion that is selected, or sought in, meanwhile is not left again', async () => {
  const page = await openPage(browser), held = [];
  let hold = true;
  await page.route(/fourdvt-more\.(js|wasm)/, (route) => (hold ? held.push(route) : route.continue()));
  await page.goto(`${server.url}playing.html`);
  await framesOf(page, 'walk', 2);
  await page.evaluate(() => { const viewer = document.querySelector('fourdvt-viewer'); viewer.goTo('locomotion'); viewer.sequence = 'run'; });
  hold = false;
  for (const route of held.splice(0)) await route.continue();
  await framesOf(page, 'run', 5);
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').state), 'run');
  const state = await page.evaluate(async () => {
    const viewer = document.createElement('fourdvt-viewer');
    Object.assign(viewer, { src: '/character/character.gltf', autoplay: true, loop: true });
    viewer.addEventListener('canplay', () => {
      viewer.goTo('locomotion');
      viewer.pause();
      viewer.seekFrame(7);
    }, { once: true });
    document.querySelector('fourdvt-viewer').replaceWith(viewer);
    await new Promise((done) => viewer.addEventListener('seeked', done, { once: true }));
    for (let i = 0; i < 30; ++i) await new Promise((next) => requestAnimationFrame(next));
    return [viewer.sequence, viewer.frame, viewer.state];
  });
  assert.deepEqual(state, ['walk', 7, 'walk']);
  await page.close();
});

test('the steer page shows its performer before the second part, and the front page leaves pictures below the fold', async () => {
  const page = await openPage(browser, { viewport: { width: 390, height: 844 } }), late = [];
  page.on('request', (request) => { if (/layers\.jpg$/.test(request.url())) late.push(request.url()); });
  await page.route(/fourdvt-more\.(js|wasm)/, () => undefined);
  await page.goto(`${server.url}steer.html`);
  await until(page, () => document.querySelector('fourdvt-viewer').stats?.framesShown >= 1);
  await page.unroute(/fourdvt-more\.(js|wasm)/);
  await page.goto(server.url);
  await framesOf(page, 'walk', 5);
  assert.deepEqual(late, []);
  await page.evaluate(() => document.querySelector('img[data-late]').scrollIntoView());
  await until(page, () => document.querySelector('img[data-late]').naturalWidth > 0);
  assert.equal(late.length, 1);
  await page.close();
});
