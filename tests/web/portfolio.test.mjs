// SPDX-License-Identifier: Apache-2.0
// Many viewers on one page: all share one GL context and one instance of the player; viewers far from the screen are freed
// and play again when they return; a fault of one does not affect the others.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, outputFolder } from './harness.mjs';
import { fill, holdings, openPortfolio, pictures, pressPhone, scrollTo, servePortfolio } from './portfolio.mjs';

let server, browser;
before(async () => {
  server = await servePortfolio(environment('SITE'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});
const until = (page, check, argument) => page.waitForFunction(check, argument, { timeout: kPatienceMs, polling: 50 }).catch(async (problem) => {
  const states = await page.evaluate(() => globalThis.viewers.map(({ stats, paused, networkState, error, shadowRoot }) => [stats, paused, networkState, error, shadowRoot.querySelector('.note').textContent]));
  throw new Error(`${check}: ${JSON.stringify(states)}`, { cause: problem });
});
const coverageOf = (page, number) => page.evaluate((number) => {
  const canvas = globalThis.viewers[number].shadowRoot.querySelector('canvas'), copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  return data.filter((value, i) => i % 4 === 3 && value > 128).length / (data.length / 4);
}, number);

test('24 viewers: one context, one module, no error, the first is alive after scrolling back', async () => {
  const page = await openPortfolio(browser, server.url);
  await fill(page, 24, undefined, { sequence: 'walk' });
  await scrollTo(page, 0);
  await page.screenshot({ path: join(outputFolder('portfolio'), 'top.png') });
  const first = await page.evaluate(() => globalThis.viewers[0].stats.framesShown);
  assert.ok(first > 0);
  assert.ok(await page.evaluate(() => globalThis.viewers[23].stats === null), 'the last is far away');
  for (const y of [300, 800, 1e6]) await scrollTo(page, y);
  await until(page, () => globalThis.viewers[0].stats === null);
  await scrollTo(page, 0);
  await page.evaluate(() => void globalThis.viewers[0].play());
  await until(page, () => globalThis.viewers[0].stats.framesShown > 3);
  for (const number of [0, 4]) assert.ok(await coverageOf(page, number) > 0.05, `viewer ${number} is empty`);
  const { contexts, modules, errors, maxDecoders } = await holdings(page);
  assert.deepEqual({ contexts, modules, errors }, { contexts: 1, modules: 1, errors: [] });
  assert.ok(maxDecoders <= 12, `${maxDecoders} decoders`);
  assert.deepEqual([...page.troubles, ...page.reported], []);
  await page.close();
});

test('on a phone that shows more than fits, the page frees viewers until its memory is kept', async () => {
  const { page, loaded, pictures: shown, bytes, most } = await pressPhone(browser, server.url, 15);
  console.log(`${loaded} of 15 loaded, ${(bytes / 1e6).toFixed(0)} MB; at most ${most.loaded} and ${(most.bytes / 1e6).toFixed(0)} MB`);
  assert.ok(bytes <= 160e6, `${bytes} bytes`);
  assert.ok(loaded >= 3 && shown === loaded && most.loaded > loaded, JSON.stringify({ loaded, shown, most }));
  const { maxDecoders, errors } = await holdings(page);
  assert.ok(maxDecoders <= 8, `${maxDecoders} decoders`);
  assert.deepEqual(errors, []);
  await page.close();
});

test('every viewer shows its own view of its own motion', async () => {
  const page = await openPortfolio(browser, server.url);
  await fill(page, 3, undefined, { sequence: 'walk' });
  await scrollTo(page, 0);
  const turn = (orbit) => page.evaluate((orbit) => {
    globalThis.viewers[1].setAttribute('camera-orbit', orbit);
    for (const viewer of globalThis.viewers) viewer.jumpCameraToGoal();
  }, orbit);
  const once = async (isRight) => {
    for (const end = Date.now() + kPatienceMs; Date.now() < end; await page.waitForTimeout(100)) {
      const seen = await pictures(page);
      if (isRight(seen)) return seen;
    }
    return pictures(page);
  };
  await page.evaluate(() => { globalThis.viewers[2].sequence = 'run'; });
  await until(page, () => globalThis.viewers[2].sequence === 'run' && globalThis.viewers[2].stats.framesShown > 0);
  await turn('90deg 5deg 4m');
  const first = await once((seen) => new Set(seen).size === 3);
  assert.equal(new Set(first).size, 3);
  await turn('180deg 5deg 4m');
  const second = await once((seen) => seen[1] !== first[1]);
  assert.deepEqual(second.map((picture, i) => picture === first[i]), [true, false, true]);
  const sizes = await page.evaluate(async () => {
    const blobs = await Promise.all(globalThis.viewers.map((viewer, i) => viewer.toBlob({ width: 100 + i, height: 120 })));
    return Promise.all(blobs.map(async (blob) => { const { width, height } = await createImageBitmap(blob); return [width, height]; }));
  });
  assert.deepEqual(sizes, [[100, 120], [101, 120], [102, 120]]);
  assert.deepEqual(await pictures(page), second, 'snapshots leave what is shown');
  await page.close();
});

// The next call of the player traps, or the next one from a decoder's callback. The viewer whose call that is has the error; the others begin anew.
async function trap(page, where) {
  await page.evaluate((where) => { globalThis.trapNext = where; }, where);
  await until(page, () => globalThis.counts.errors.length === 1);
  await until(page, () => globalThis.viewers.filter(({ stats }) => stats?.framesShown > 2).length === 2);
  const [{ id }] = await page.evaluate(() => globalThis.counts.errors);
  assert.equal(id, 'internal');
  await page.evaluate(() => globalThis.viewers.find(({ stats }) => !stats).load());
  await play(page);
}
const play = (page) => until(page, () => globalThis.viewers.every(({ stats }) => stats?.framesShown > 2));
// A trap while the second part is being loaded is no error: viewers do without it.
const complete = (page, modules) => until(page, (modules) => globalThis.counts.completed === modules, modules);

test('a lost context, and a player that traps, bring every visible viewer back', async () => {
  const page = await openPortfolio(browser, server.url);
  await fill(page, 3);
  await scrollTo(page, 0);
  await play(page);
  await complete(page, 1);
  await page.evaluate(async () => {
    const extension = globalThis.contextOfPage.getExtension('WEBGL_lose_context');
    extension.loseContext();
    await new Promise((next) => setTimeout(next, 300));
    globalThis.gone = globalThis.viewers.filter(({ stats }) => stats).length;
    extension.restoreContext();
  });
  assert.equal(await page.evaluate(() => globalThis.gone), 0);
  await play(page);
  assert.deepEqual(await page.evaluate(() => globalThis.counts.errors), []);
  await complete(page, 2);
  await trap(page, 'any');
  const { contexts, modules } = await holdings(page);
  assert.deepEqual({ contexts, modules }, { contexts: 2, modules: 3 }, 'the first one came back in its canvas');
  await page.close();
});

test('a player that traps while a picture is copied brings every visible viewer back', async () => {
  const page = await openPortfolio(browser, server.url);
  await fill(page, 3);
  await scrollTo(page, 0);
  await play(page);
  await trap(page, 'output');
  assert.equal(await page.evaluate(() => globalThis.counts.errors.length), 1);
  const { contexts, modules } = await holdings(page);
  assert.deepEqual({ contexts, modules }, { contexts: 2, modules: 2 });
  await page.close();
});

test('loading: eager loads at once and stays, lazy waits for the screen', async () => {
  const page = await openPortfolio(browser, server.url);
  await page.evaluate(() => { document.querySelector('main').style.marginTop = `${2.5 * innerHeight}px`; });
  await fill(page, 3);
  await page.evaluate(() => ['eager', 'lazy', 'auto'].forEach((mode, i) => { globalThis.viewers[i].loading = mode; }));
  await until(page, () => globalThis.viewers[0].stats?.framesShown > 0);
  const loaded = () => page.evaluate(() => globalThis.viewers.map(({ stats }) => stats !== null));
  assert.deepEqual(await loaded(), [true, false, false]);
  await page.evaluate(() => scrollTo(0, innerHeight));
  await until(page, () => globalThis.viewers[2].stats !== null);
  assert.deepEqual(await loaded(), [true, false, true]);
  await scrollTo(page, 1e6);
  assert.deepEqual(await loaded(), [true, true, true]);
  await page.close();
});

test('what nobody has looked at costs nothing', async () => {
  const page = await openPortfolio(browser, server.url);
  const before = server.requests.length;
  await page.evaluate(() => { document.querySelector('main').style.marginTop = `${20 * innerHeight}px`; });
  await fill(page, 3, undefined, { autoplay: '', loading: 'lazy' });
  await page.waitForTimeout(700);
  const fetched = server.requests.slice(before).map(({ path }) => path).filter((path) => !/viewer\.js|blank/.test(path));
  assert.deepEqual(fetched, []);
  await page.close();
});

test('five from layers and one from cameras side by side: one context, one module, each with its own pictures', async () => {
  const page = await openPortfolio(browser, server.url, { width: 480, height: 330 });
  await fill(page, 6, [...Array(5).fill('/character/character.gltf'), '/cameras/refined/character.gltf'], { autoplay: '', loop: '', sequence: 'run' });
  await scrollTo(page, 0, kPatienceMs);
  await until(page, () => globalThis.viewers.every(({ stats }) => stats?.framesShown > 3));
  await page.screenshot({ path: join(outputFolder('portfolio'), 'layers-and-cameras.png') });
  for (const number of [0, 4, 5]) assert.ok(await coverageOf(page, number) > 0.05, `viewer ${number} is empty`);
  const { contexts, modules, errors, loaded } = await holdings(page);
  assert.deepEqual({ contexts, modules, errors, loaded }, { contexts: 1, modules: 1, errors: [], loaded: 6 });
  assert.deepEqual(await page.evaluate(() => globalThis.viewers.map(({ method }) => method !== '')), [false, false, false, false, false, true]);
  await page.close();
});

test('a viewer whose manifest fails leaves the stage, which ends with the last viewer; one that is put back loads again', async () => {
  const page = await openPortfolio(browser, server.url);
  await page.route('**/gone.gltf', (route) => route.fulfill({ status: 404, body: '' }));
  await fill(page, 2, ['/gone.gltf', '/character/character.gltf']);
  await until(page, () => globalThis.viewers[0].error && globalThis.viewers[1].stats?.framesShown > 0);
  const leave = () => page.evaluate(() => { for (const viewer of globalThis.viewers) viewer.remove(); });
  const putBack = async () => {
    await page.evaluate(() => document.querySelector('main').append(globalThis.viewers[1]));
    await until(page, () => globalThis.viewers[1].stats?.framesShown > 3);
  };
  await leave();
  await page.waitForTimeout(100);
  await putBack();
  assert.equal(await page.evaluate(() => globalThis.counts.contexts), 1, 'the stage waits a moment for others');
  await leave();
  await until(page, () => globalThis.contextOfPage.isContextLost());
  await putBack();
  assert.equal(await page.evaluate(() => globalThis.counts.contexts), 2, 'no slot was left on the first');
  assert.deepEqual(await page.evaluate(() => globalThis.counts.errors.map(({ id }) => id)), ['fetch-failed']);
  page.reported.length = 0;
  await page.close();
});

test('the note about the network goes when the network is back, also in a viewer that was freed meanwhile', async () => {
  const page = await openPortfolio(browser, server.url);
  let open = false;
  await page.route('**/character.gltf', (route) => (open ? route.continue() : route.fulfill({ status: 503, body: '' })));
  await fill(page, 1);
  const note = () => page.evaluate(() => globalThis.viewers[0].shadowRoot.querySelector('.note').hidden);
  await until(page, () => !globalThis.viewers[0].shadowRoot.querySelector('.note').hidden);
  await page.evaluate(() => { document.querySelector('main').style.marginTop = `${20 * innerHeight}px`; });
  await until(page, () => globalThis.viewers[0].shadowRoot.querySelector('.note').hidden);
  open = true;
  await page.evaluate(() => { document.querySelector('main').style.marginTop = '0'; });
  await until(page, () => globalThis.viewers[0].stats?.framesShown > 2);
  assert.equal(await note(), true);
  await page.close();
});
