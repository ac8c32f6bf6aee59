#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// A long motion on a network whose throughput changes, in headless Chromium under DevTools' throttling: the rendition shown over
// time, what is held, how often the player waited, and whether any picture carried another frame's barcode.
//   node ladder.mjs SITE CHARACTER [--rates 8000,2000,8000] [--seconds 90] [--latency 50] [--pictures FOLDER] [--out FILE.json]
// SITE: an assembled site, of which the player is taken; CHARACTER: a baked folder whose first sequence is long. --seconds: of
// all rates together. --pictures: screenshots before and after every change of the rendition.
import { mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { parseArgs } from 'node:util';

import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';

const kSampleMs = 250, kPatienceMs = 90_000;
const { values: options, positionals: [site, character] } = parseArgs({
  allowPositionals: true,
  options: { rates: { type: 'string', default: '8000,2000,8000' }, seconds: { type: 'string', default: '90' }, latency: { type: 'string', default: '50' },
    pictures: { type: 'string' }, out: { type: 'string' } },
});
const kPage = `<!doctype html><meta charset="utf-8"><title>long</title><link rel="icon" href="data:,"><style>fourdvt-viewer{width:390px;height:700px}</style>
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script>
<fourdvt-viewer src="long/character.gltf" autoplay loop></fourdvt-viewer>`;

const folder = mkdtempSync(join(tmpdir(), 'fourdvt-ladder-'));
symlinkSync(resolve(site, 'fourdvt-viewer'), join(folder, 'fourdvt-viewer'));
symlinkSync(resolve(character), join(folder, 'long'));
const server = await serve(folder, 0, { gzip: true, pages: { '/long.html': { html: kPage, headers: { 'Content-Type': 'text/html' } } } });
const browser = await launch();
const samples = [];
let waits;
try {
  const context = await browser.newContext({ viewport: { width: 390, height: 700 } });
  const page = await context.newPage(), cdp = await context.newCDPSession(page);
  await cdp.send('Network.enable');
  await cdp.send('Network.setCacheDisabled', { cacheDisabled: true });
  const throttle = (kbps) => cdp.send('Network.emulateNetworkConditions',
    { offline: false, latency: Number(options.latency), downloadThroughput: (kbps * 1000) / 8, uploadThroughput: (kbps * 1000) / 8 });
  const rates = options.rates.split(',').map(Number), each = Number(options.seconds) / rates.length;
  await throttle(rates[0]);
  await page.goto(`${server.url}long.html`, { waitUntil: 'commit' });
  await page.waitForFunction(() => document.querySelector('fourdvt-viewer')?.stats?.framesShown >= 1, null, { timeout: kPatienceMs, polling: 30 });
  await page.evaluate(() => {
    globalThis.waits = [];
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.addEventListener('waiting', () => globalThis.waits.push({ at: performance.now(), frame: viewer.frame }));
  });
  if (options.pictures) mkdirSync(options.pictures, { recursive: true });
  const begun = performance.now();
  let before = null, now = rates[0], last = null;
  for (let at_s = 0; at_s < Number(options.seconds); at_s = (performance.now() - begun) / 1000) {
    const rate = rates[Math.min(rates.length - 1, Math.floor(at_s / each))];
    if (rate !== now) await throttle((now = rate));
    const sample = await page.evaluate(() => {
      const { frame, stats } = document.querySelector('fourdvt-viewer');
      const { rendition, framesShown, framesLate, barcodeChecked, barcodeMismatches, encodedBytesHeld, bytesFetched } = stats;
      return { rendition, frame, framesShown, framesLate, barcodeChecked, barcodeMismatches, encodedBytesHeld, bytesFetched };
    });
    Object.assign(sample, { at_s, rate });
    samples.push(sample);
    const picture = options.pictures && (await page.screenshot());
    if (picture && before !== null && before !== sample.rendition) {
      const name = `${at_s.toFixed(1).padStart(5, '0')}s-${before}to${sample.rendition}`;
      writeFileSync(join(options.pictures, `${name}-before.png`), last);
      writeFileSync(join(options.pictures, `${name}-after.png`), picture);
    }
    last = picture;
    before = sample.rendition;
    await page.waitForTimeout(kSampleMs);
  }
  waits = await page.evaluate(() => globalThis.waits);
} finally {
  await browser.close();
  await server.close();
  rmSync(folder, { recursive: true });
}

let shown = null;
for (const sample of samples) {
  if (shown === sample.rendition) continue;
  shown = sample.rendition;
  console.log(`${sample.at_s.toFixed(1).padStart(6)} s, ${sample.rate} kbit/s: rendition ${shown}, frame ${sample.frame}, ${(sample.encodedBytesHeld / 1e6).toFixed(2)} MB held`);
}
const end = samples.at(-1), of = (name) => Math.max(...samples.map((sample) => sample[name]));
console.log(`${end.framesShown} pictures, ${end.framesLate} left out, ${waits.length} waits, ${end.barcodeMismatches} wrong of ${end.barcodeChecked} barcodes, at most ${(of('encodedBytesHeld') / 1e6).toFixed(2)} MB held, ${(end.bytesFetched / 1e6).toFixed(1)} MB fetched`);
if (options.out) writeFileSync(options.out, `${JSON.stringify({ rates: options.rates, samples, waits }, null, 1)}\n`);
