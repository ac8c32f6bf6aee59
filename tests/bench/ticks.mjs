#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Time for which the player blocks a page: the longest tick of a seek to undecoded geometry, the times until another
// picture and until the wanted one is shown; and the longest tick of the following two seconds of playback. Headless
// Chromium. A tick decodes geometry and uploads meshes; it does not draw.
//   node ticks.mjs SITE [--other SITE2] [--names now,before] [--runs 5] [--frame 19]
// SITE, SITE2: assembled sites (site/assemble.mjs), of any version of the player. For every motion of the character:
// paused at frame 0, then seeks --frame, or the last one. Each run opens a new page; medians.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

import { machineText, timed, timedTitle } from '../../site/measured/yardstick.mjs';
import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';
import { median, pageWithTag, table } from './throttled.mjs';
import { besideYardstick } from './yardstick.mjs';

const { values: options, positionals: [site] } = parseArgs({
  allowPositionals: true,
  options: {
    other: { type: 'string' }, names: { type: 'string', default: 'now,before' }, runs: { type: 'string', default: '5' },
    frame: { type: 'string', default: '19' },
  },
});
const sites = [site, options.other].filter(Boolean);
const missing = sites.map((folder) => join(folder, 'character/character.gltf')).find((path) => !existsSync(path));
if (!site || missing) {
  console.error(missing ? `ticks.mjs: ${missing} is missing; assemble the site first: node site/assemble.mjs OUT DIST CHARACTER`
    : 'usage: ticks.mjs SITE [--other SITE2] [--names NOW,BEFORE] [--runs N] [--frame N]');
  process.exit(2);
}

// Runs before the page's scripts: times every call of the player's tick, whatever its exported name is.
function timeTicks(name) {
  globalThis.ticks = [];
  const instantiate = WebAssembly.instantiate;
  WebAssembly.instantiate = async (...all) => {
    const instance = await instantiate(...all);
    const tick = instance.exports?.[name];
    if (!tick) return instance;
    const timed = (...values) => {
      const from = performance.now();
      tick(...values);
      globalThis.ticks.push({ from, ms: performance.now() - from });
    };
    return { exports: { ...instance.exports, [name]: timed } };
  };
}

async function seek({ motion, frame }) {
  const viewer = document.querySelector('fourdvt-viewer');
  const once = (type) => new Promise((done) => viewer.addEventListener(type, () => done(performance.now()), { once: true }));
  const longest = (from) => Math.max(...globalThis.ticks.filter((tick) => tick.from >= from).map(({ ms }) => ms));
  viewer.pause();
  if (viewer.sequence !== motion) {
    viewer.sequence = motion;
    await once('sequencechange');
  }
  const at = performance.now(), before = viewer.frame, seeked = once('seeked');
  viewer.seekFrame(frame);
  const another = new Promise((done) => {
    const look = () => (viewer.frame !== before ? done(performance.now()) : setTimeout(look, 1));
    look();
  });
  const result = { another: (await another) - at, wanted: (await seeked) - at, tick: longest(at) };
  const from = performance.now(), shown = viewer.stats.framesShown;
  viewer.play();
  await new Promise((done) => setTimeout(done, 2000));
  return { ...result, playing: longest(from), shown: viewer.stats.framesShown - shown };
}

async function visit(browser, folder, motion) {
  const [, name] = /\bbeforeTick\([^;]*?\),this\.#\w+\.(\w+)\(/.exec(readFileSync(join(folder, 'fourdvt-viewer/fourdvt-viewer.js'), 'utf8'));
  const server = await serve(folder, 0, { pages: { '/one.html': pageWithTag('character/character.gltf', '') } });
  const page = await browser.newPage({ viewport: { width: 320, height: 320 } });
  try {
    await page.addInitScript(timeTicks, name);
    await page.goto(`${server.url}one.html`);
    await page.waitForFunction(() => document.querySelector('fourdvt-viewer').stats?.framesShown > 5, null, { timeout: 60_000 });
    await page.waitForTimeout(2000); // loads the second part of the player
    const frames = await page.evaluate((wanted) => document.querySelector('fourdvt-viewer').sequences.find(({ name }) => name === wanted).frames, motion);
    return await page.evaluate(seek, { motion, frame: Math.min(Number(options.frame), frames - 1) });
  } finally {
    await page.close();
    await server.close();
  }
}

const manifest = JSON.parse(readFileSync(join(site, 'character/character.gltf'), 'utf8'));
const [, ...motions] = manifest.extensions.FOURDVT_layered_video_texture.sequences.map(({ name }) => name);

// Rows: motion, name of the player, medians by key.
async function measure() {
  const browser = await launch(), rows = [];
  try {
    for (const motion of motions) {
      const runs = sites.map(() => []);
      for (let run = 0; run < Number(options.runs); ++run)
        for (const [i, folder] of sites.entries()) runs[i].push(await visit(browser, folder, motion));
      runs.forEach((of, i) => rows.push({ motion, name: options.names.split(',')[i],
        ...Object.fromEntries(['tick', 'another', 'wanted', 'playing', 'shown'].map((key) => [key, median(of.map((run) => run[key]))])) }));
    }
  } finally {
    await browser.close();
  }
  return rows;
}

const { value: rows, yardstick } = await besideYardstick(measure);
console.log(table(['motion', 'player', ...['longest tick, ms', 'another picture after, ms', 'the wanted one, ms', 'playing: longest tick, ms'].map((title) => timedTitle(title, yardstick)), 'pictures in 2 s'],
  rows.map((r) => [r.motion, r.name, ...[r.tick, r.another, r.wanted, r.playing].map((ms) => timed([ms], 'ms', 0, yardstick)), r.shown.toFixed(0)])));
console.log(`\nyardstick: ${machineText(yardstick)}`);
