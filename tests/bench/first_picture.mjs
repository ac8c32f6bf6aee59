#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Time and bytes from navigation to the first picture, time to ten pictures and until the first sequence has come whole in
// its highest rendition, and the share of time waited afterwards, in headless Chromium with a cold cache and DevTools'
// throttling; texts and wasm are sent with gzip.
//   node first_picture.mjs SITE [--runs 5] [--pages front,plain,steer,cameras] [--rates 2000/150,8000/50,700/300]
//                          [--out FILE.json]
// SITE: an assembled site (site/assemble.mjs). A page of its own is served for `plain`: one tag with the first sequence.
// Prints medians, what every byte before the first picture was, and the yardstick. FILE: { commit, yardstick, results }.
import { writeFileSync } from 'node:fs';
import { parseArgs } from 'node:util';

import { machineText } from '../../site/measured/yardstick.mjs';
import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';
import { commitOfTree, median } from './throttled.mjs';
import { besideYardstick } from './yardstick.mjs';

const kPatienceMs = 90_000, kWatchedS = 10;
const kPages = {
  front: { path: '' },
  plain: { path: 'plain.html' },
  steer: { path: 'steer.html' },
  cameras: { path: 'plain-cameras.html' },
};
const tag = (src) => `<!doctype html><meta charset="utf-8"><title>plain</title><link rel="icon" href="data:,">
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script>
<fourdvt-viewer src="${src}" autoplay loop camera-controls></fourdvt-viewer>`;

const { values: options, positionals: [site] } = parseArgs({
  allowPositionals: true,
  options: {
    runs: { type: 'string', default: '5' }, pages: { type: 'string', default: Object.keys(kPages).join() },
    rates: { type: 'string', default: '2000/150,8000/50,700/300' }, out: { type: 'string' },
  },
});

// In the page: when the viewer's counter of shown pictures has reached 1 and 10, and how much of the time after the
// first picture it waited. A viewer that is replaced counts anew.
function watch() {
  globalThis.watched = { waitingMs: 0 };
  let before = performance.now();
  const look = () => {
    const viewer = document.querySelector('fourdvt-viewer'), now = performance.now(), w = globalThis.watched;
    const shown = viewer?.stats?.framesShown ?? 0;
    if (shown >= 1) w.first ??= now;
    if (shown >= 10) w.ten ??= now;
    if (w.first !== undefined && shown === w.shown) w.still = (w.still ?? 0) + now - before;
    else w.still = 0;
    if (w.still > 120) w.waitingMs += now - before;
    w.shown = shown;
    before = now;
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

async function visit(browser, url, { kbps, latencyMs }) {
  const context = await browser.newContext({ viewport: { width: 390, height: 844 }, deviceScaleFactor: 2 });
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
  const first = await until('first'), ten = await until('ten');
  await page.waitForTimeout(kWatchedS * 1000);
  const { waitingMs } = await page.evaluate(() => globalThis.watched);
  const [origin] = [...files.values()].map(({ at }) => at);
  const before = new Map(), arrived = new Map(), highest = /\/(walk|run)(\.[0-9a-f]{8})?\.mp4$/;
  for (const { requestId, bytes, at } of parts) {
    const { name } = files.get(requestId);
    if (!highest.test(name)) continue;
    const file = arrived.get(name) ?? { bytes: 0, at: 0 };
    arrived.set(name, { bytes: file.bytes + bytes, at });
  }
  const [last] = arrived.values(), full = last ? (last.at - origin) * 1000 : NaN;
  for (const { requestId, bytes, at } of parts) {
    if ((at - origin) * 1000 > first) continue;
    const { name } = files.get(requestId);
    before.set(name, (before.get(name) ?? 0) + bytes);
  }
  await context.close();
  return { first, ten, waiting: waitingMs / (kWatchedS * 1000 + ten - first), bytes: Object.fromEntries(before), full };
}

const sum = (values) => values.reduce((a, b) => a + b, 0);

const html = (src) => ({ html: tag(src), headers: { 'Content-Type': 'text/html' } });
const results = [];

async function visitAll() {
  const server = await serve(site, 0, { gzip: true, pages: { '/plain.html': html('character/character.gltf'), '/plain-cameras.html': html('cameras/refined/character.gltf') } });
  const browser = await launch();
  try {
    for (const rate of options.rates.split(',')) {
      const [kbps, latencyMs] = rate.split('/').map(Number);
      for (const name of options.pages.split(',')) {
        const runs = [];
        for (let i = 0; i < Number(options.runs); ++i) runs.push(await visit(browser, server.url + kPages[name].path, { kbps, latencyMs }));
        const of = (get) => median(runs.map(get));
        const result = { rate, page: name, runs: runs.length, first_ms: of((r) => r.first), ten_ms: of((r) => r.ten), waiting: of((r) => r.waiting),
          full_ms: of((r) => r.full), bytes: of((r) => sum(Object.values(r.bytes))), first_all_ms: runs.map((r) => Math.round(r.first)), files: runs[0].bytes };
        results.push(result);
        console.log(`${rate.padEnd(9)} ${name.padEnd(8)} first ${(result.first_ms / 1000).toFixed(2)} s (${result.first_all_ms.join(' ')}), ten ${(result.ten_ms / 1000).toFixed(2)} s, ${(result.bytes / 1000).toFixed(0)} kB, highest whole ${(result.full_ms / 1000).toFixed(2)} s, waiting ${(100 * result.waiting).toFixed(0)} %`);
        for (const [file, bytes] of Object.entries(result.files)) console.log(`            ${String(bytes).padStart(8)}  ${file}`);
      }
    }
  } finally {
    await browser.close();
    await server.close();
  }
}

const { yardstick } = await besideYardstick(visitAll);
console.log(`yardstick: ${machineText(yardstick)}`);
if (options.out) writeFileSync(options.out, `${JSON.stringify({ commit: commitOfTree(), yardstick, results }, null, 1)}\n`);
