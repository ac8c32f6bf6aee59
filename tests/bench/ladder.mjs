#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Renditions shown under a changing throughput: plays one motion of a character, too long to be held whole, in headless
// Chromium with DevTools' throttling; each throughput lasts an equal part of the time. Prints rungs and bytes held over
// time, stalls, frames shown and late, mismatched pairs of picture and geometry (by barcode), and, with --pictures, the
// change of the pictures at a switch against that between other frames.
//   node ladder.mjs CHARACTER [--sequence NAME] [--seconds 90] [--rates 8000,2000,8000] [--latency 50] [--dist DIST]
//                   [--pictures FOLDER] [--out FILE.json]
// CHARACTER: a baked folder; --dist: the built web package that plays it (default: that of web/). Time starts at the
// first picture. --pictures: the frames before and after every switch, as PNG; playback is not paused for them.
import { existsSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { machineText } from '../../site/measured/yardstick.mjs';
import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';
import { commitOfTree, median, openThrottled, pageWithTag, table } from './throttled.mjs';
import { besideYardstick } from './yardstick.mjs';

const kPatienceMs = 120_000, kSampleMs = 250, kRowMs = 5000;
const kSide = { width: 360, height: 480 };  // tall enough for the highest rendition

const { values: options, positionals: [character] } = parseArgs({
  allowPositionals: true,
  options: {
    sequence: { type: 'string' }, seconds: { type: 'string', default: '90' }, rates: { type: 'string', default: '8000,2000,8000' },
    latency: { type: 'string', default: '50' }, dist: { type: 'string', default: fileURLToPath(new URL('../../web/dist', import.meta.url)) },
    pictures: { type: 'string' }, out: { type: 'string' },
  },
});
if (!character) {
  console.error('usage: ladder.mjs CHARACTER [--sequence NAME] [--seconds S] [--rates KBPS,…] [--pictures FOLDER] [--out FILE.json]');
  process.exit(2);
}
for (const [path, remedy] of [[join(character, 'character.gltf'), 'bake a character first: fourdvt bake CAPTURE -o CHARACTER'], [join(options.dist, 'fourdvt-viewer.js'), 'build the web package first: node web/build.mjs']]) {
  if (existsSync(path)) continue;
  console.error(`ladder.mjs: ${path} is missing; ${remedy}`);
  process.exit(2);
}
const rates = options.rates.split(',').map(Number), latencyMs = Number(options.latency);

// Runs in the page, before its scripts: records samples, switches, stalls; on request pictures of the frames around a
// switch.
function watch({ sampleMs, pictures }) {
  const kept = (globalThis.kept = { samples: [], switches: [], stalls: [], changes: [] });
  const original = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, more) {
    return original.call(this, kind, kind.startsWith('webgl') ? { ...more, preserveDrawingBuffer: true } : more);
  };
  const copies = [0, 1].map(() => document.createElement('canvas')), pixels = [];
  let turn = 0, before = null, stall = null;
  addEventListener('waiting', () => { stall ??= { ms: performance.now() }; }, true);

  // Mean change of the opaque pixels since the frame before, in levels.
  function changeOf(canvas) {
    turn = 1 - turn;
    const { width, height } = Object.assign(copies[turn], { width: canvas.width, height: canvas.height });
    const context = copies[turn].getContext('2d', { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    const now = (pixels[turn] = context.getImageData(0, 0, width, height).data), then = pixels[1 - turn];
    if (now.length !== then?.length) return NaN;
    let sum = 0, count = 0;
    for (let i = 0; i < now.length; i += 4) {
      if (!now[i + 3] && !then[i + 3]) continue;
      sum += Math.abs(now[i] - then[i]) + Math.abs(now[i + 1] - then[i + 1]) + Math.abs(now[i + 2] - then[i + 2]);
      count += 3;
    }
    return sum / count;
  }
  function onFrame(viewer, now) {
    const change = pictures ? changeOf(viewer.shadowRoot.querySelector('canvas')) : NaN;
    const { ms, rendition } = now;
    if (before && rendition !== before.rendition) {
      const shots = pictures ? [copies[1 - turn], copies[turn]].map((copy) => copy.toDataURL()) : [];
      kept.switches.push({ ms, from: before.rendition, to: rendition, frame: now.frame, step: now.shown - before.shown, change, shots });
    } else if (before && now.shown - before.shown === 1 && Number.isFinite(change)) {
      kept.changes.push(change);
    }
    if (stall && before && now.shown > before.shown) {
      if (kept.first !== undefined) kept.stalls.push({ atMs: stall.ms, ms: ms - stall.ms });
      stall = null;
    }
    kept.first ??= ms;
    before = now;
  }
  const look = () => {
    const viewer = document.querySelector('fourdvt-viewer'), stats = viewer?.stats, ms = performance.now();
    if (stats?.framesShown) {
      const now = { ms, rendition: stats.rendition, shown: stats.framesShown, frame: viewer.frame };
      if (now.shown !== before?.shown || now.rendition !== before.rendition) onFrame(viewer, now);
      if (!(ms - kept.samples.at(-1)?.ms < sampleMs)) kept.samples.push({ ms, frame: now.frame, ...stats });
    }
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

// Assembles a site of player and character.
function siteOf(folder) {
  const site = mkdtempSync(join(tmpdir(), 'fourdvt-ladder-'));
  symlinkSync(resolve(options.dist), join(site, 'fourdvt-viewer'));
  symlinkSync(resolve(folder), join(site, 'character'));
  return site;
}

// Returns the page's records, with times in ms since the first picture.
async function play(browser, url) {
  const prepare = (page) => page.addInitScript(watch, { sampleMs: kSampleMs, pictures: Boolean(options.pictures) });
  const opened = await openThrottled(browser, url, { kbps: rates[0], latencyMs }, { viewport: kSide, prepare });
  const { page, setRate } = opened;
  await page.waitForFunction(() => globalThis.kept?.first, null, { timeout: kPatienceMs, polling: 20 });
  const set = [];
  for (const kbps of rates) {
    await setRate({ kbps, latencyMs });
    set.push({ ms: await page.evaluate(() => performance.now()), kbps });
    await page.waitForTimeout((Number(options.seconds) * 1000) / rates.length);
  }
  const kept = await page.evaluate(() => globalThis.kept), error = await page.evaluate(() => document.querySelector('fourdvt-viewer').error);
  await opened.close();
  for (const one of [...kept.samples, ...kept.switches, ...set]) one.ms -= kept.first;
  for (const one of kept.stalls) one.atMs -= kept.first;
  return { ...kept, set, error };
}

function writePictures(switches) {
  for (const one of switches) {
    const shots = one.shots;
    delete one.shots;
    if (!shots.length) continue;
    mkdirSync(options.pictures, { recursive: true });
    one.pictures = ['before', 'after'].map((when, i) => {
      const path = join(options.pictures, `${(one.ms / 1000).toFixed(1)}s-${one.from}-to-${one.to}-${when}.png`);
      writeFileSync(path, Buffer.from(shots[i].split(',')[1], 'base64'));
      return path;
    });
  }
}

// Rows every few seconds and at every switch.
function rowsOf({ samples, switches, set }) {
  const at = [...switches.map(({ ms }) => ms), ...samples.filter(({ ms }, i) => i === 0 || Math.floor(ms / kRowMs) > Math.floor(samples[i - 1].ms / kRowMs)).map(({ ms }) => ms)];
  return at.toSorted((a, b) => a - b).map((ms) => {
    const sample = samples.find((s) => s.ms >= ms) ?? samples.at(-1), { kbps } = set.findLast((s) => s.ms <= ms) ?? set[0];
    const change = switches.find((s) => s.ms === ms);
    return [(ms / 1000).toFixed(1), kbps, change ? `**${change.from} → ${change.to}**` : sample.rendition, (sample.encodedBytesHeld / 1000).toFixed(0), sample.framesShown, sample.framesLate];
  });
}

// Result of play() on a site of its own.
async function playOnce() {
  const site = siteOf(character);
  const attributes = `loop style="position:fixed;inset:0;width:${kSide.width}px;height:${kSide.height}px"${options.sequence ? ` sequence="${options.sequence}"` : ''}`;
  const server = await serve(site, 0, { gzip: true, pages: { '/ladder.html': pageWithTag('character/character.gltf', attributes) } });
  const browser = await launch();
  try {
    return await play(browser, `${server.url}ladder.html`);
  } finally {
    await browser.close();
    await server.close();
    rmSync(site, { recursive: true });
  }
}

const { value: played, yardstick } = await besideYardstick(playOnce);
writePictures(played.switches);
const { samples, switches, stalls, changes } = played, last = samples.at(-1), commit = commitOfTree();
const totals = {
  seconds: last.ms / 1000, switches: switches.length, stalls: stalls.length, stalled_ms: stalls.reduce((sum, { ms }) => sum + ms, 0),
  longest_stall_ms: Math.max(0, ...stalls.map(({ ms }) => ms)), frames_shown: last.framesShown, frames_late: last.framesLate,
  pairs_checked: last.barcodeChecked, pairs_wrong: last.barcodeMismatches, max_bytes_held: Math.max(...samples.map((s) => s.encodedBytesHeld)),
  bytes_fetched: last.bytesFetched, change_levels: median(changes), change_levels_95: changes.toSorted((a, b) => a - b)[Math.floor(0.95 * changes.length)],
};
if (options.out) writeFileSync(options.out, `${JSON.stringify({ commit, yardstick, character: resolve(character), dist: resolve(options.dist), rates, latency_ms: latencyMs, error: played.error, totals, switches, stalls, set: played.set, samples }, null, 1)}\n`);
console.log(`Commit ${commit}, ${options.rates} kbit/s, ${latencyMs} ms; yardstick: ${machineText(yardstick)}:\n`);
console.log(table(['s', 'kbit/s', 'rung', 'held, kB', 'frames shown', 'late'], rowsOf(played)));
console.log(`\n${table(['', ''], Object.entries(totals).map(([name, value]) => [name.replaceAll('_', ' '), Number.isInteger(value) ? value : value?.toFixed(2) ?? '–']))}`);
const wide = switches.filter(({ change }) => Number.isFinite(change));
if (wide.length) console.log(`\n${table(['switch at, s', 'rungs', 'frame', 'change, levels'], wide.map((s) => [(s.ms / 1000).toFixed(1), `${s.from} → ${s.to}`, s.frame, s.change.toFixed(2)]))}`);
if (played.error) console.log(`\nerror: ${played.error.id}: ${played.error.message}`);
