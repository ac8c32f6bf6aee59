// SPDX-License-Identifier: Apache-2.0
// CPU time of the longest tasks of a page's main thread, from Chromium's trace: until the first picture, at the first
// seek in a class, at the first use of its slider, during playback, at a change of motion and of rung. Draw calls are
// omitted (the page's WebGL functions are replaced) to exclude the software rasteriser; CPU time of the thread excludes
// other programs.
import { readFileSync } from 'node:fs';

import { launch, openPage } from '../../web/harness.mjs';
import { openOnPath, servePlain } from '../../web/play_path.mjs';

const kViewport = { width: 240, height: 280 };

// Both run in the page before its scripts.
export function drawNothing() {
  for (const name of ['drawArrays', 'drawElements']) WebGL2RenderingContext.prototype[name] = () => {};
}

export function withoutWorkers() {
  delete globalThis.Worker;
}

// Plays the scenes in the page; each is marked in the trace by its name.
async function playScenes(rounds) {
  const viewer = globalThis.viewer;
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  const once = (type) => new Promise((done) => viewer.addEventListener(type, done, { once: true }));
  const scene = async (name, action, ms) => {
    performance.mark(`${name} begins`);
    await action();
    await pause(ms);
    performance.mark(`${name} ends`);
  };
  performance.mark('start ends');
  for (let round = 0; round < rounds; ++round) {
    // Replaces the player, so that nothing is decoded yet.
    viewer.setAttribute('sequence', 'locomotion');
    const ready = once('canplay');
    viewer.load();
    await ready;
    viewer.pause();
    await pause(300);
    const { frames } = viewer.sequences.find(({ name }) => name === 'locomotion');
    await scene('seek', () => { const seeked = once('seeked'); viewer.seekFrame(Math.floor(0.97 * frames)); return seeked; }, 500);
    const [{ name, min, max }] = viewer.parameters;
    await scene('slider', () => viewer.setParameter(name, (min + max) / 2), 800);
    await scene('play', () => viewer.play(), 1500);
    await scene('motion', () => { const changed = once('sequencechange'); viewer.sequence = 'pickup'; return changed; }, 800);
    await scene('rung', () => { viewer.quality = round % 2 ? '0' : 'highest'; }, 1500);
  }
}

// Tasks of the marks' thread, in ms of its CPU.
function readTrace(events) {
  const marks = events.filter(({ cat, name }) => cat?.includes('blink.user_timing') && / (begins|ends)$/.test(name));
  if (!marks.length) throw new Error('the trace has no marks');
  const { pid, tid } = marks[0];
  const tasks = events.filter((e) => e.pid === pid && e.tid === tid && e.ph === 'X' && e.name === 'ThreadControllerImpl::RunTask');
  const ended = marks.filter(({ name }) => name.endsWith(' ends')).map((end) => {
    const scene = end.name.slice(0, -' ends'.length);
    const begin = marks.filter(({ name, ts }) => name === `${scene} begins` && ts < end.ts).pop()?.ts ?? 0;
    return { scene, longest: Math.max(0, ...tasks.filter(({ ts }) => ts >= begin && ts <= end.ts).map(({ tdur = 0 }) => tdur / 1000)) };
  });
  const scenes = {};
  for (const { scene, longest } of ended) (scenes[scene] ??= []).push(longest);
  return scenes;
}

/** { start, seek, slider, play, motion, rung }: ms of the longest task of each scene, a list over the rounds. */
export async function measureTasks(site, rounds = 4, worker = true) {
  const server = await servePlain(site);
  const browser = await launch();
  const page = await openPage(browser, { viewport: kViewport }, 'i420');
  await page.addInitScript(drawNothing);
  if (!worker) await page.addInitScript(withoutWorkers);
  const file = '/tmp/fourdvt-trace.json';
  try {
    await browser.startTracing(page, { path: file, categories: ['toplevel', 'blink.user_timing'] });
    await openOnPath(page, server, '');
    await page.evaluate(playScenes, rounds);
    const buffer = await browser.stopTracing();
    return readTrace(JSON.parse(String(buffer?.length ? buffer : readFileSync(file))).traceEvents);
  } finally {
    await browser.close();
    await server.close();
  }
}
