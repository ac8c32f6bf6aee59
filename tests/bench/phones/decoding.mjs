// SPDX-License-Identifier: Apache-2.0
// Time of decoding one frame's geometry in a page: in the worker, and without one in slices of the main thread. Draw
// calls are omitted, so that the software rasteriser uses no core.
import { launch, openPage } from '../../web/harness.mjs';
import { openOnPath, servePlain } from '../../web/play_path.mjs';
import { drawNothing, withoutWorkers } from './tasks.mjs';

// Runs in the page before its scripts: records messages of workers.
function noteMessages() {
  globalThis.said = [];
  globalThis.Worker = class extends Worker {
    constructor(...words) {
      super(...words);
      this.addEventListener('message', ({ data }) => globalThis.said.push(data));
    }
  };
}

// Reloads the character with this motion and seeks the last frame of each half, so that all GOPs are decoded. Returns
// ms per frame.
async function decodeAll(sequence) {
  const viewer = globalThis.viewer;
  const once = (type, action) => new Promise((done) => {
    viewer.addEventListener(type, done, { once: true });
    action();
  });
  viewer.removeAttribute('autoplay');
  viewer.setAttribute('sequence', sequence);
  const before = globalThis.said?.length;
  await once('canplay', () => viewer.load());
  await new Promise((next) => setTimeout(next, 500));
  const { frames } = viewer.sequences.find(({ name }) => name === sequence);
  for (const part of [0.5, 1]) await once('seeked', () => viewer.seekFrame(Math.ceil(part * frames) - 1));
  if (before === undefined) return viewer.stats.decodeMs;
  const decoded = globalThis.said.slice(before).filter(({ kind }) => kind === 'frame');
  return (1000 * decoded.reduce((sum, { seconds }) => sum + seconds, 0)) / decoded.length;
}

// Milliseconds per frame: of the first load, and of later ones, after the browser has optimised the code.
async function decodeIn(browser, server, sequence, worker, rounds) {
  const page = await openPage(browser, {}, 'i420');
  await page.addInitScript(drawNothing);
  await page.addInitScript(worker ? noteMessages : withoutWorkers);
  await openOnPath(page, server, '');
  if (worker) await page.waitForFunction(() => globalThis.said.some(({ kind }) => kind === 'ready'));
  const out = [];
  for (let round = 0; round < rounds; ++round) out.push(await page.evaluate(decodeAll, sequence));
  await page.close();
  const [first, ...later] = out;
  return { first, later };
}

/** { motion: { worker, page } }, each { first, later: [] } in ms per frame, for a plain motion and for a class. */
export async function measureDecoding(site, rounds = 6) {
  const server = await servePlain(site);
  const browser = await launch();
  try {
    const out = {};
    for (const motion of ['pickup', 'locomotion']) {
      out[motion] = {};
      for (const place of ['worker', 'page']) out[motion][place] = await decodeIn(browser, server, motion, place === 'worker', rounds);
    }
    return out;
  } finally {
    await browser.close();
    await server.close();
  }
}
