// SPDX-License-Identifier: Apache-2.0
// HTMLMediaElement's interface, tested with the controls of media-chrome (the package itself), which drive any element
// that implements it.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { environment, kPatienceMs, launch, openPage, outputFolder, requireFromWeb } from './harness.mjs';
import { serve } from './server.mjs';

const kPage = `<!doctype html><html lang="en"><meta charset="utf-8"><title>media</title><link rel="icon" href="data:,">
<style>media-controller { width: 480px; height: 520px } fourdvt-viewer { width: 100%; height: 100% }</style>
<script type="module" src="/media-chrome.js"></script><script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script>
<media-controller>
  <fourdvt-viewer slot="media" src="/character/character.gltf" sequence="walk" autoplay loop muted upload-path="i420"></fourdvt-viewer>
  <media-control-bar>
    <media-play-button></media-play-button><media-time-range></media-time-range><media-time-display showduration></media-time-display>
    <media-mute-button></media-mute-button><media-volume-range></media-volume-range>
    <media-playback-rate-button rates="0.5 1 2"></media-playback-rate-button><media-fullscreen-button></media-fullscreen-button>
  </media-control-bar>
</media-controller>`;
const kEvents = ['loadstart', 'durationchange', 'loadedmetadata', 'loadeddata', 'canplay', 'canplaythrough', 'progress', 'play', 'playing',
  'pause', 'seeking', 'seeked', 'timeupdate', 'ended', 'ratechange', 'volumechange', 'emptied', 'abort', 'waiting', 'error', 'sequencechange'];

let server, browser, page;
before(async () => {
  const { outputFiles } = await requireFromWeb('esbuild').build({
    stdin: { contents: "import 'media-chrome';", resolveDir: fileURLToPath(new URL('../../web', import.meta.url)) },
    bundle: true, format: 'esm', write: false, logLevel: 'error',
  });
  server = await serve(environment('SITE'), 0, { pages: { '/media.html': { html: kPage, headers: {} } } });
  browser = await launch();
  page = await openPage(browser, { viewport: { width: 520, height: 560 } });
  await page.route('**/media-chrome.js', (route) => route.fulfill({ body: outputFiles[0].text, contentType: 'text/javascript' }));
  await page.addInitScript((names) => {
    const fetchFile = fetch, credentials = (globalThis.credentials = []);
    globalThis.fetch = (url, options) => {
      credentials.push(options?.credentials);
      return fetchFile(url, options);
    };
    globalThis.heard = [];
    for (const name of names) addEventListener(name, (e) => { if (e.target.localName === 'fourdvt-viewer') heard.push(name); }, true);
  }, kEvents);
  await page.goto(`${server.url}media.html`);
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const state = () => page.evaluate(() => {
  const v = document.querySelector('fourdvt-viewer'), c = document.querySelector('media-controller');
  return JSON.stringify({ heard: globalThis.heard, time: v.currentTime, duration: v.duration, seeking: v.seeking, paused: v.paused, frame: v.frame, shown: c.getAttribute('mediacurrenttime') });
});
const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 30 })
  .catch(async ({ message }) => { throw new Error(`${message}: ${await state()}`); });
const viewer = (read, argument) => page.evaluate(`(${read})(document.querySelector('fourdvt-viewer'), ${JSON.stringify(argument)})`);
const controller = (name) => page.evaluate((name) => document.querySelector('media-controller').getAttribute(name), name);
const heard = async () => (await page.evaluate(() => globalThis.heard)).filter((name) => name !== 'progress' && name !== 'timeupdate');
const forget = () => page.evaluate(() => { globalThis.heard.length = 0; });
const press = async (name) => {
  await page.hover('media-controller');
  await page.click(name);
};

test('it loads in the order of a media element, and plays by itself', async () => {
  await until(() => globalThis.heard.includes('canplaythrough'));
  await until(() => globalThis.heard.includes('playing'));
  const order = ['loadstart', 'durationchange', 'loadedmetadata', 'loadeddata', 'canplay'];
  const names = await heard();
  assert.deepEqual(names.filter((name) => order.includes(name)), order);
  assert.deepEqual(names.filter((name) => name === 'play' || name === 'playing').slice(0, 2), ['play', 'playing']);
  const state = await viewer((v) => ({ ready: v.readyState, network: v.networkState, buffered: [v.buffered.length, v.buffered.start(0), v.buffered.end(0)],
    seekable: v.seekable.end(0), duration: v.duration, src: v.currentSrc, paused: v.paused, error: v.error, cross: v.crossOrigin, preload: v.preload }));
  assert.equal(state.ready, 4);
  assert.ok([1, 2].includes(state.network));
  assert.deepEqual(state.buffered, [1, 0, state.duration], 'the sample is short: all of it is held');
  assert.equal(state.seekable, state.duration);
  assert.equal(state.src, `${server.url}character/character.gltf`);
  assert.deepEqual([state.paused, state.error, state.cross, state.preload], [false, null, null, 'auto']);
  assert.equal(await controller('mediapaused'), null);
  await until((duration) => Number(document.querySelector('media-controller').getAttribute('mediaduration')) === duration, state.duration);
  await until(() => document.querySelector('media-controller').getAttribute('mediabuffered')?.startsWith('0'));
});

test('the play button pauses and plays', async () => {
  await forget();
  await press('media-play-button');
  await until(() => document.querySelector('media-controller').hasAttribute('mediapaused'));
  assert.deepEqual(await heard(), ['pause']);
  const frame = await viewer((v) => v.frame);
  await page.waitForTimeout(300);
  assert.equal(await viewer((v) => v.frame), frame);
  const played = await viewer((v) => v.played.length && v.played.end(v.played.length - 1) - v.played.start(0));
  assert.ok(played > 0, `${played} s have been played`);
  await press('media-play-button');
  await until(() => !document.querySelector('media-controller').hasAttribute('mediapaused'));
  await until(() => globalThis.heard.includes('playing'));
  assert.deepEqual(await heard(), ['pause', 'play', 'playing']);
  await press('media-play-button');
});

test('the time range seeks, also while it is paused', async () => {
  await until(() => document.querySelector('media-controller').hasAttribute('mediapaused'));
  await forget();
  const { x, y, width, height } = await page.locator('media-time-range').boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  await until(() => globalThis.heard.includes('seeked'));
  const { time, duration, seeking } = await viewer((v) => ({ time: v.currentTime, duration: v.duration, seeking: v.seeking }));
  assert.ok(Math.abs(time / duration - 0.5) < 0.12, `${time} of ${duration}`);
  assert.equal(seeking, false);
  assert.ok((await page.evaluate(() => globalThis.heard)).includes('timeupdate'));
  await until((time) => Math.abs(Number(document.querySelector('media-controller').getAttribute('mediacurrenttime')) - time) < 1e-6, time);
  await page.screenshot({ path: join(outputFolder('media'), 'paused.png') });
});

test('mute, volume and rate', async () => {
  await press('media-mute-button');
  await until(() => !document.querySelector('fourdvt-viewer').muted);
  const { x, y, width, height } = await page.locator('media-volume-range').boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  await until(() => Math.abs(document.querySelector('fourdvt-viewer').volume - 0.5) < 0.1);
  await press('media-playback-rate-button');
  await until(() => document.querySelector('fourdvt-viewer').playbackRate === 2);
  assert.equal(await controller('mediaplaybackrate'), '2');
  await viewer((v) => { v.playbackRate = 1; });
});

test('at rate 0 it plays, and the frame stays', async () => {
  await viewer((v) => v.play());
  await viewer((v) => { v.playbackRate = 0; });
  await page.waitForTimeout(200);
  const frame = await viewer((v) => v.frame);
  await page.waitForTimeout(500);
  assert.deepEqual(await viewer((v) => [v.frame, v.paused, v.playbackRate]), [frame, false, 0]);
  await viewer((v) => { v.playbackRate = 1; });
  await until((frame) => document.querySelector('fourdvt-viewer').frame !== frame, frame);
});

test('another motion has its duration on the bar', async () => {
  await forget();
  await viewer((v) => { v.sequence = 'pickup'; });
  await until(() => globalThis.heard.includes('sequencechange'));
  const duration = await viewer((v) => v.sequences.find(({ name }) => name === 'pickup').duration);
  await until((duration) => Number(document.querySelector('media-controller').getAttribute('mediaduration')) === duration, duration);
  assert.ok((await heard()).indexOf('durationchange') <= (await heard()).indexOf('sequencechange'));
});

test('at the end the bar offers to play again, and so does the viewer', async () => {
  await viewer((v) => { v.loop = false; v.currentTime = 0; });
  await forget();
  await until(() => globalThis.heard.includes('ended'));
  const names = await page.evaluate(() => globalThis.heard);
  assert.deepEqual(names.slice(names.lastIndexOf('pause') - 1), ['timeupdate', 'pause', 'ended']);
  assert.deepEqual(await viewer((v) => [v.ended, v.paused, v.currentTime === v.duration]), [true, true, true]);
  await until(() => document.querySelector('media-controller').hasAttribute('mediapaused') && document.querySelector('media-controller').hasAttribute('mediaended'));
  assert.equal(await viewer((v) => v.shadowRoot.querySelector('.play').hidden), false);
  await page.screenshot({ path: join(outputFolder('media'), 'ended.png') });
  await viewer((v) => { v.addEventListener('play', () => { v.loop = true; }, { once: true }); }); // it may end again before the page is looked at
  await press('media-play-button');
  await until(() => { const v = document.querySelector('fourdvt-viewer'); return v.loop && !v.paused && !v.ended; });
});

test('fullscreen shows the viewer with its bar', async () => {
  await press('media-fullscreen-button');
  await until(() => document.fullscreenElement?.localName === 'media-controller');
  await page.screenshot({ path: join(outputFolder('media'), 'fullscreen.png') });
  await page.evaluate(() => document.exitFullscreen());
  await until(() => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas').width === 480);
});

test('pictures call back with their times', async () => {
  const seen = await viewer(async (v) => {
    const list = [];
    for (let i = 0; i < 3; ++i) list.push(await new Promise((done) => v.requestVideoFrameCallback((now, metadata) => done({ now, ...metadata, frame: v.frame }))));
    const fps = v.sequences.find(({ name }) => name === v.sequence).fps;
    return list.map((one) => ({ ...one, fits: Math.abs(one.mediaTime - one.frame / fps) < 1e-6 }));
  });
  assert.deepEqual(seen.map(({ fits }) => fits), [true, true, true]);
  assert.ok(seen[1].presentedFrames > seen[0].presentedFrames && seen[2].presentedFrames > seen[1].presentedFrames);
  assert.deepEqual([seen[0].width, seen[0].height], await viewer((v) => { const c = v.shadowRoot.querySelector('canvas'); return [c.width, c.height]; }));
});

test('a motion that does not exist is an error, which another choice ends', async () => {
  await forget();
  await viewer((v) => { v.sequence = 'fly'; });
  await until(() => globalThis.heard.includes('error'));
  assert.deepEqual(await viewer((v) => [v.error.id, v.error.code]), ['invalid-argument', 4]);
  await viewer((v) => { v.sequence = 'pickup'; }); // is shown already
  assert.equal(await viewer((v) => v.error), null);
  page.reported.length = 0;
});

test('another source empties it; one that is not there has a code', async () => {
  await forget();
  await viewer((v) => {
    globalThis.credentials.length = 0;
    v.crossOrigin = 'use-credentials';
    v.src = '/nowhere/character.gltf';
  });
  await until(() => globalThis.heard.includes('error'));
  assert.deepEqual((await heard()).slice(0, 2), ['emptied', 'loadstart']);
  assert.deepEqual(await viewer((v) => [v.error.id, v.error.code, v.readyState, v.networkState]), ['fetch-failed', 2, 0, 3]);
  await until(() => document.querySelector('media-controller').getAttribute('mediaerrorcode') === '2');
  assert.deepEqual([...new Set(await page.evaluate(() => globalThis.credentials))], ['include']);
  assert.equal(await viewer((v) => { v.crossOrigin = null; return v.getAttribute('crossorigin'); }), null);
  page.reported.length = 0;
});

test('preload="none" loads once it is asked to play', async () => {
  await viewer((v) => {
    v.removeAttribute('autoplay');
    v.preload = 'none';
    v.pause();
    v.src = '/character/character.gltf';
  });
  await forget();
  await page.waitForTimeout(400);
  assert.deepEqual(await heard(), []);
  assert.deepEqual(await viewer((v) => [v.networkState, v.readyState, v.shadowRoot.querySelector('.play').hidden]), [1, 0, false]);
  await press('media-play-button');
  await until(() => globalThis.heard.includes('playing'));
  assert.deepEqual(page.reported, []);
  assert.deepEqual(page.troubles.filter((line) => !line.includes('404')), []);
});
