#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Latency of commands on a throttled network: time from a seek, a move of the slider or a change of the motion to the
// first picture of the target, and the bytes fetched in vain meanwhile. Headless Chromium, cold cache, DevTools'
// throttling, texts and wasm with gzip; a page with one tag. Every run is a new visit.
//   node seeking.mjs SITE [--other SITE2] [--names now,before] [--runs 5] [--rates 2000/150] [--commands seek,…]
//                    [--motion pickup] [--out FILE.json]
// SITE, SITE2: assembled sites (site/assemble.mjs), of any version of the player. --motion: the one sought in; the
// first one if the character lacks it. A visit takes 10 to 30 s; with --out every visit is saved, and a killed run
// resumes after it. Commands are skipped if the character lacks the motions for them:
//   seek       the motion plays; to three quarters of it at its first pictures. A short motion is held by then
//   twice      the motion plays; to its end at its first pictures, and 200 ms later to the middle: counted from the latter
//   elsewhere  the first motion plays; three quarters of --motion at once: its header and one GOP
//   slider     the class plays; its first parameter from least to most (it glides for 0.7 s by design)
//   to-class   the first motion plays; the class by the motion graph, and the most of its first parameter, which is the end
//   select     the first motion plays; another at once
//   instead    the same, and 600 ms later --motion: counted from the latter
//   go         the first motion plays; another by the motion graph: the transition's first picture, and its end
// Columns: fetched: all bytes between command and picture; begun before: those of requests older than the command;
// thrown away: bytes received by requests that were cancelled between the first command and the picture.
import { existsSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

import { machineText, timed, timedTitle } from '../../site/measured/yardstick.mjs';
import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';
import { commitOfTree, median, openThrottled, pageWithTag, rateOf, table } from './throttled.mjs';
import { besideYardstick } from './yardstick.mjs';

const kPatienceMs = 60_000;
const kSettledMs = 4000; // the first motion is held, and the motion graph
const kCommands = {  // in: motion that plays; motions: minimum number in the character; class: needs one
  seek: { in: 'motion', afterMs: 0 }, twice: { in: 'motion', afterMs: 0 },
  elsewhere: { in: 'first', afterMs: kSettledMs, motions: 2 }, slider: { in: 'class', afterMs: kSettledMs, class: true },
  'to-class': { in: 'first', afterMs: kSettledMs, class: true }, select: { in: 'first', afterMs: kSettledMs, motions: 3 },
  instead: { in: 'first', afterMs: kSettledMs, motions: 3 }, go: { in: 'first', afterMs: kSettledMs, motions: 3 },
};

const { values: options, positionals: [site] } = parseArgs({
  allowPositionals: true,
  options: {
    other: { type: 'string' }, names: { type: 'string', default: 'now,before' }, runs: { type: 'string', default: '5' },
    rates: { type: 'string', default: '2000/150' }, commands: { type: 'string', default: Object.keys(kCommands).join() },
    motion: { type: 'string', default: 'pickup' }, out: { type: 'string' },
  },
});
const missing = [site, options.other].filter(Boolean).map((folder) => join(folder, 'character/character.gltf')).find((path) => !existsSync(path));
if (missing) {
  console.error(`seeking.mjs: ${missing} is missing; assemble the site first: node site/assemble.mjs OUT DIST CHARACTER`);
  process.exit(2);
}
const unknown = options.commands.split(',').find((name) => !kCommands[name]);
if (!site || unknown) {
  if (unknown) console.error(`seeking.mjs: no command is named "${unknown}"; the commands are ${Object.keys(kCommands).join(', ')}`);
  console.error('usage: seeking.mjs SITE [--other SITE2] [--runs N] [--rates KBPS/MS,…] [--commands NAME,…] [--out FILE.json]');
  process.exit(2);
}

// Measures in the page. Returns times in ms: of the first command, of the counted one, of its target's first picture
// and of the end.
async function command({ name, motion, patienceMs }) {
  const viewer = document.querySelector('fourdvt-viewer');
  const once = (...types) => new Promise((done) => {
    for (const type of types) viewer.addEventListener(type, () => done(performance.now()), { once: true });
  });
  const until = (holds) => new Promise((done) => {
    const look = () => (holds() ? done(performance.now()) : requestAnimationFrame(look));
    look();
  });
  const wait = (ms) => new Promise((done) => setTimeout(done, ms, NaN));
  const frameAt = (share) => Math.round(share * (viewer.sequences.find((s) => s.name === motion).frames - 1));
  const another = viewer.sequences.slice(1).find((s) => s.members.length <= 1 && s.name !== motion)?.name;
  const { name: className, parameters: [parameter] = [] } = viewer.sequences.find((s) => s.parameters.length > 0) ?? {};
  const arrived = (wanted) => () => viewer.sequence === wanted && !viewer.inTransition;
  const atMost = () => arrived(className)() && viewer.getParameter(parameter.name) > parameter.max - 0.01 * (parameter.max - parameter.min);
  const raise = () => viewer.setParameter(parameter.name, parameter.max);
  const select = (wanted) => { viewer.sequence = wanted; };
  const changed = () => once('transitionstart', 'sequencechange');
  const actions = {  // act: what counts; before, pauseMs: what precedes it; seen: the picture; over: the end, if later
    seek: { act: () => viewer.seekFrame(frameAt(0.75)), seen: () => once('seeked') },
    twice: { before: () => viewer.seekFrame(frameAt(1)), pauseMs: 200, act: () => viewer.seekFrame(frameAt(0.5)), seen: () => once('seeked') },
    elsewhere: { act: () => { select(motion); viewer.seekFrame(frameAt(0.75)); }, seen: () => once('seeked', 'sequencechange') },
    slider: { act: raise, seen: () => until(atMost) },
    'to-class': { act: () => { viewer.goTo(className); raise(); }, seen: changed, over: () => until(atMost) },
    select: { act: () => select(another), seen: () => once('sequencechange') },
    instead: { before: () => select(another), pauseMs: 600, act: () => select(motion), seen: () => once('sequencechange') },
    go: { act: () => viewer.goTo(another), seen: changed, over: () => until(arrived(another)) },
  };
  const { before, pauseMs, act, seen, over } = actions[name], first = performance.now();
  if (before) before(), await wait(pauseMs);
  const from = performance.now(), late = wait(patienceMs), picture = seen();
  act();
  const pictureMs = await Promise.race([picture, late]);
  return { originMs: performance.timeOrigin, first, from, picture: pictureMs, over: over ? await Promise.race([over(), late]) : pictureMs };
}

// Sums the bytes received until the picture.
function bytesOf(requests, { first, from, picture }) {
  const sum = (list, holds) => list.flatMap(({ parts }) => parts).filter(holds).reduce((all, { bytes }) => all + bytes, 0);
  const during = ({ atMs }) => atMs >= from && !(atMs > picture), files = {};
  for (const request of requests) {
    const bytes = sum([request], during);
    if (bytes) files[request.name] = (files[request.name] ?? 0) + bytes;
  }
  const cancelled = requests.filter((r) => r.cancelled && r.endMs >= first && !(r.endMs > picture));
  return { fetched: sum(requests, during), older: sum(requests.filter((r) => r.atMs < from), during),
    thrown: sum(cancelled, () => true), cancelled: cancelled.length, files };
}

// Finds the motion that each kind of page plays, and the commands for which the character has motions.
async function motionsOf(server) {
  const manifest = await (await fetch(`${server.url}character/character.gltf`)).json();
  const { sequences } = manifest.extensions.FOURDVT_layered_video_texture;
  const played = { first: sequences[0].name, motion: options.motion, class: sequences.find((s) => s.parameterSpace)?.name };
  if (!sequences.some((s) => s.name === played.motion)) played.motion = played.first;
  const count = sequences.filter((s) => !s.parameterSpace).length;
  const can = (name) => (kCommands[name].motions ?? 1) <= count && (!kCommands[name].class || played.class);
  return { played, commands: options.commands.split(',').filter(can) };
}

async function visit(browser, server, rate, name, motion) {
  const { in: where, afterMs } = kCommands[name];
  const opened = await openThrottled(browser, `${server.url}${where}.html`, rate, { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2 });
  try {
    const { page, traffic } = opened;
    await page.waitForFunction(() => document.querySelector('fourdvt-viewer')?.stats?.framesShown > 1, null, { timeout: kPatienceMs, polling: 20 });
    await page.waitForTimeout(afterMs);
    const times = await page.evaluate(command, { name, motion, patienceMs: kPatienceMs });
    await page.waitForTimeout(300); // DevTools' events arrive late
    return { picture_ms: times.picture - times.from, end_ms: times.over - times.from, ...bytesOf(traffic.requestsSince(times.originMs), times) };
  } finally {
    await opened.close();
  }
}

const { visits, yardstick_runs: yardstickRuns = [] } = options.out && existsSync(options.out) ? JSON.parse(readFileSync(options.out, 'utf8')) : { visits: [] };
const commit = commitOfTree();
function keep(more = {}) {
  if (!options.out) return;
  writeFileSync(`${options.out}.part`, `${JSON.stringify({ commit, ...more, yardstick_runs: yardstickRuns, visits }, null, 1)}\n`);
  renameSync(`${options.out}.part`, options.out);
}
const visitsOf = (label, rate, command) => visits.filter((v) => v.label === label && v.rate === rate && v.command === command);

async function visitAll(browser, server, label, { played, commands }) {
  for (const rate of options.rates.split(',')) {
    for (const name of commands) {
      for (let i = visitsOf(label, rate, name).length; i < Number(options.runs); ++i) {
        const result = await visit(browser, server, rateOf(rate), name, played.motion);
        visits.push({ label, rate, command: name, commit, ...result });
        keep();
        console.error(`${label} ${rate} ${name}: ${Math.round(result.picture_ms)} ms, ${result.fetched} bytes, ${result.thrown} thrown away`);
      }
    }
  }
}

async function visitSite(browser, label, folder) {
  const pages = {}, server = await serve(folder, 0, { gzip: true, pages });
  const motions = await motionsOf(server);
  for (const [where, sequence] of Object.entries(motions.played)) pages[`/${where}.html`] = pageWithTag('character/character.gltf', `loop sequence="${sequence}"`);
  await visitAll(browser, server, label, motions);
  await server.close();
}

const names = options.names.split(',');
const sites = [[names[0] ?? 'now', site], ...(options.other ? [[names[1] ?? 'before', options.other]] : [])];
const { yardstick } = await besideYardstick(async () => {
  const browser = await launch();
  try {
    for (const [label, folder] of sites) await visitSite(browser, label, folder);
  } finally {
    await browser.close();
  }
}, yardstickRuns);

function medians(rate, command, label) {
  const runs = visitsOf(label, rate, command);
  const numbers = ['picture_ms', 'end_ms', 'fetched', 'older', 'thrown'].map((key) => [key, median(runs.map((v) => v[key]))]);
  return { rate, command, label, runs: runs.length, ...Object.fromEntries(numbers) };
}
const rows = options.rates.split(',').flatMap((rate) => options.commands.split(',').flatMap((command) => sites.map(([label]) => medians(rate, command, label))))
  .filter(({ runs }) => runs);
keep({ yardstick, medians: rows });
const seconds = (ms) => timed([ms / 1000], 's', 2, yardstick), kilobytes = (bytes) => (bytes / 1000).toFixed(0);
console.log(`Commit ${commit}, medians of ${options.runs}:\n`);
console.log(table(['kbit/s / ms', 'command', 'player', ...['picture, s', 'end, s'].map((title) => timedTitle(title, yardstick)), 'fetched, kB', 'begun before, kB', 'thrown away, kB'],
  rows.map((r) => [r.rate, r.command, r.label, seconds(r.picture_ms), seconds(r.end_ms), ...['fetched', 'older', 'thrown'].map((key) => kilobytes(r[key]))])));
console.log(`\nyardstick: ${machineText(yardstick)}`);
