#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Time and bytes from navigation to the first picture, time to ten pictures and until the first sequence has arrived
// whole in its highest rendition, and the share of later time spent waiting, in headless Chromium with a cold cache and
// DevTools' throttling; texts and wasm are sent with gzip.
//   node first_picture.mjs SITE [--runs 5] [--pages front,plain,paused,steer,cameras] [--rates 2000/150,8000/50,700/300]
//                          [--watch SECONDS] [--pictures FOLDER] [--out FILE.json]
// SITE: an assembled site (site/assemble.mjs). `plain`: a generated page of one tag with the first sequence. `paused`:
// stands at the poster's view without playing; its time ends when the picture no longer changes.
// SECONDS: period after the tenth picture in which waiting is counted (default 10).
// Prints medians, the bytes before the first and before the tenth picture by kind, and the yardstick. FOLDER: receives
// pictures of the first run of each page at 1, 2, 3 and 5 s; those of `paused` are compared with the poster (SSIM).
// FILE: { commit, yardstick, results }.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

import { machineText } from '../../site/measured/yardstick.mjs';
import { launch } from '../web/harness.mjs';
import { decodePng } from '../web/png.mjs';
import { serve } from '../web/server.mjs';
import { ssim } from '../web/ssim.mjs';
import { commitOfTree, median } from './throttled.mjs';
import { besideYardstick } from './yardstick.mjs';

const kPatienceMs = 90_000;
const kPictureTimesS = [1, 2, 3, 5];
const kPoster = { width: 480, height: 640 }; // its view: 25deg 8deg auto, field of view 30deg
const kPages = {
  front: { path: '' },
  plain: { path: 'plain.html' },
  paused: { path: 'paused.html', stands: true },
  steer: { path: 'steer.html' },
  cameras: { path: 'plain-cameras.html' },
};
const tag = (src, attributes = 'autoplay loop camera-controls') => `<!doctype html><meta charset="utf-8"><title>plain</title><link rel="icon" href="data:,">
<style>body { margin: 0 } .poster { width: ${kPoster.width}px; height: ${kPoster.height}px }</style>
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script>
<fourdvt-viewer src="${src}" ${attributes}></fourdvt-viewer>`;

const { values: options, positionals: [site] } = parseArgs({
  allowPositionals: true,
  options: {
    runs: { type: 'string', default: '5' }, pages: { type: 'string', default: Object.keys(kPages).join() },
    rates: { type: 'string', default: '2000/150,8000/50,700/300' }, out: { type: 'string' }, pictures: { type: 'string' }, watch: { type: 'string', default: '10' },
  },
});
const kWatchedS = Number(options.watch);

// Runs in the page: records when the viewer's counter of shown pictures reaches 1 and 10, when each rendition is first
// shown, and the time spent waiting after the first picture. Counts restart when a viewer is replaced.
function watch() {
  globalThis.watched = { waitingMs: 0, renditions: {} };
  let before = performance.now();
  const look = () => {
    const viewer = document.querySelector('fourdvt-viewer'), now = performance.now(), w = globalThis.watched;
    const shown = viewer?.stats?.framesShown ?? 0;
    if (shown >= 1) w.first ??= now;
    if (shown >= 10) w.ten ??= now;
    if (shown >= 1) w.renditions[viewer.stats.rendition] ??= now;
    if (w.first !== undefined && shown === w.shown) w.still = (w.still ?? 0) + now - before;
    else w.still = 0;
    if (w.still > 120) w.waitingMs += now - before;
    w.shown = shown;
    before = now;
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

// Pictures of the page at each of the times, { seconds: PNG }; `stands`: of the viewer alone, transparent around the
// figure.
async function takePictures(page, stands) {
  const pictures = {};
  for (const s of kPictureTimesS) {
    await page.waitForFunction((ms) => performance.now() >= ms, 1000 * s, { polling: 20 });
    pictures[s] = await page.screenshot(stands ? { clip: { x: 0, y: 0, ...kPoster }, omitBackground: true } : {});
  }
  return pictures;
}
// SSIM, inside the figures, between each picture of a standing viewer and the poster, which is then shown in the
// viewer's place.
async function comparePoster(page, pictures) {
  await page.evaluate(async () => {
    const image = Object.assign(new Image(), { src: 'character/poster.webp', className: 'poster' });
    await image.decode();
    document.body.replaceChildren(image);
  });
  const png = await page.screenshot({ clip: { x: 0, y: 0, ...kPoster }, omitBackground: true }), poster = decodePng(png);
  writeFileSync(join(options.pictures, 'poster.png'), png);
  return Object.fromEntries(Object.entries(pictures).map(([s, png]) => [s, ssim(decodePng(png), poster).foreground]));
}

async function visit(browser, url, { kbps, latencyMs }, stands, looks) {
  const context = await browser.newContext(stands ? { viewport: kPoster, deviceScaleFactor: 1 } : { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2 });
  const page = await context.newPage(), cdp = await context.newCDPSession(page);
  const files = new Map(), parts = [];
  await cdp.send('Network.enable');
  await cdp.send('Network.setCacheDisabled', { cacheDisabled: true });
  const rate = (kbps * 1000) / 8;
  await cdp.send('Network.emulateNetworkConditions', { offline: false, latency: latencyMs, downloadThroughput: rate, uploadThroughput: rate });
  cdp.on('Network.requestWillBeSent', ({ requestId, request, timestamp }) => {
    files.set(requestId, { name: new URL(request.url).pathname.slice(1) || 'index.html', at: timestamp });
  });
  cdp.on('Network.dataReceived', ({ requestId, encodedDataLength, timestamp }) => {
    if (encodedDataLength > 0) parts.push({ requestId, bytes: encodedDataLength, at: timestamp });
  });
  await page.addInitScript(watch);
  await page.goto(url, { waitUntil: 'commit' });
  const until = (name) => page.waitForFunction((n) => globalThis.watched?.[n], name, { timeout: kPatienceMs, polling: 50 }).then((h) => h.jsonValue());
  const pictures = looks ? await takePictures(page, stands) : {};
  const first = await until('first'), ten = stands ? NaN : await until('ten');
  await page.waitForTimeout(kWatchedS * 1000);
  const { waitingMs, renditions } = await page.evaluate(() => globalThis.watched);
  const likeness = stands && looks ? await comparePoster(page, pictures) : undefined;
  const [origin] = [...files.values()].map(({ at }) => at);
  const before = new Map(), beforeTen = new Map(), arrived = new Map(), highest = /\/(walk|run)(\.[0-9a-f]{8})?\.mp4$/;
  for (const { requestId, bytes, at } of parts) {
    const { name } = files.get(requestId);
    if (!highest.test(name)) continue;
    const file = arrived.get(name) ?? { bytes: 0, at: 0 };
    arrived.set(name, { bytes: file.bytes + bytes, at });
  }
  const [last] = arrived.values(), full = last ? (last.at - origin) * 1000 : NaN;
  for (const { requestId, bytes, at } of parts) {
    const { name } = files.get(requestId), ms = (at - origin) * 1000;
    if (ms <= first) before.set(name, (before.get(name) ?? 0) + bytes);
    if (ms <= ten) beforeTen.set(name, (beforeTen.get(name) ?? 0) + bytes);
  }
  await context.close();
  return { first, ten, waiting: waitingMs / (kWatchedS * 1000 + ten - first), bytes: Object.fromEntries(before), tenBytes: Object.fromEntries(beforeTen), full, renditions, likeness, pictures };
}

const sum = (values) => values.reduce((a, b) => a + b, 0);

const html = (src, attributes) => ({ html: tag(src, attributes), headers: { 'Content-Type': 'text/html' } });
const results = [];

async function visitAll() {
  const server = await serve(site, 0, { gzip: true, pages: { '/plain.html': html('character/character.gltf'), '/paused.html': html('character/character.gltf', 'class="poster" controls="none" camera-orbit="25deg 8deg auto" field-of-view="30deg"'), '/plain-cameras.html': html('cameras/refined/character.gltf') } });
  const browser = await launch();
  try {
    for (const rate of options.rates.split(',')) {
      const [kbps, latencyMs] = rate.split('/').map(Number);
      for (const name of options.pages.split(',')) {
        const runs = [];
        const { path, stands } = kPages[name];
        for (let i = 0; i < Number(options.runs); ++i) runs.push(await visit(browser, server.url + path, { kbps, latencyMs }, stands, options.pictures && i === 0));
        for (const [s, png] of Object.entries(runs[0].pictures)) writeFileSync(join(options.pictures, `${name}-${kbps}-${s}s.png`), png);
        const of = (get) => median(runs.map(get));
        const result = { rate, page: name, runs: runs.length, first_ms: of((r) => r.first), ten_ms: of((r) => r.ten), ten_bytes: of((r) => sum(Object.values(r.tenBytes))), renditions_ms: runs[0].renditions, likeness: runs[0].likeness, waiting: of((r) => r.waiting),
          full_ms: of((r) => r.full), bytes: of((r) => sum(Object.values(r.bytes))), first_all_ms: runs.map((r) => Math.round(r.first)), files: runs[0].bytes, ten_files: runs[0].tenBytes };
        results.push(result);
        console.log(`${rate.padEnd(9)} ${name.padEnd(8)} first ${(result.first_ms / 1000).toFixed(2)} s (${result.first_all_ms.join(' ')}), ten ${(result.ten_ms / 1000).toFixed(2)} s (${(result.ten_bytes / 1000).toFixed(0)} kB), ${(result.bytes / 1000).toFixed(0)} kB, highest whole ${(result.full_ms / 1000).toFixed(2)} s, waiting ${(100 * result.waiting).toFixed(0)} %`);
        console.log(`            renditions from ${Object.entries(result.renditions_ms).map(([r, ms]) => `${r}: ${(ms / 1000).toFixed(2)} s`).join(', ')}${result.likeness ? `; SSIM to the poster ${Object.entries(result.likeness).map(([s, v]) => `${s} s ${v.toFixed(3)}`).join(', ')}` : ''}`);
        for (const file of Object.keys({ ...result.files, ...result.ten_files })) {
          console.log(`            ${String(result.files[file] ?? 0).padStart(8)} ${String(result.ten_files[file] ?? '').padStart(8)}  ${file}`);
        }
      }
    }
  } finally {
    await browser.close();
    await server.close();
  }
}

if (options.pictures) mkdirSync(options.pictures, { recursive: true });
const { yardstick } = await besideYardstick(visitAll);
console.log(`yardstick: ${machineText(yardstick)}`);
if (options.out) writeFileSync(options.out, `${JSON.stringify({ commit: commitOfTree(), yardstick, results }, null, 1)}\n`);
