// SPDX-License-Identifier: Apache-2.0
// Plays the sample on one upload path with loops, seeks, rungs, motions and a class's slider, and times what a visitor
// sees: from picture to picture, over loops, over rungs, from a seek to its frame.
import { kPatienceMs } from './harness.mjs';
import { serve } from './server.mjs';

const kViewer = { width: 160, height: 220 };

/** The site, with a blank page for the viewer. */
export const servePlain = (site) => serve(site, 0, { pages: { '/blank.html': {
  html: `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><style>fourdvt-viewer { width: ${kViewer.width}px; height: ${kViewer.height}px; }</style><main></main>`, headers: {} } } });

/** The page shows the sample on this path and plays. host: in place of the server's address. */
export async function openOnPath(page, server, path, host = '127.0.0.1') {
  await page.goto(`${server.url.replace('127.0.0.1', host)}blank.html`);
  const outcome = await page.evaluate(async (path) => {
    await import('/fourdvt-viewer/fourdvt-viewer.js');
    const viewer = (globalThis.viewer = document.createElement('fourdvt-viewer'));
    const attributes = { autoplay: '', loop: '', sequence: 'walk', src: '/character/character.gltf', ...(path ? { 'upload-path': path } : {}) };
    for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
    const end = new Promise((done) => {
      viewer.addEventListener('canplay', () => done('canplay'), { once: true });
      viewer.addEventListener('error', (e) => done(JSON.stringify(e.detail)));
    });
    document.querySelector('main').append(viewer);
    return end;
  }, path);
  if (outcome !== 'canplay') throw new Error(outcome);
}

/**
 * Shows at least so many frames, with each kind of change at least once. { frames, checked, mismatches, late, path, play,
 * loops, seeks, rungs }: the last four are lists of ms. For a rung it is the longest time between pictures in the second after the change.
 */
export function playOnPath(page, frames) {
  return page.evaluate(async ({ frames, patienceMs }) => {
    const viewer = globalThis.viewer;
    const out = { play: [], loops: [], seeks: [], rungs: [], errors: [] };
    const onError = (e) => out.errors.push(e.detail);
    viewer.addEventListener('error', onError);
    let random = 7;
    const below = (n) => (random = (random * 16807) % 2147483647) % n;
    const once = (type, ms = patienceMs) => new Promise((done, fail) => {
      const timer = setTimeout(() => fail(new Error(`no ${type} in ${ms} ms: ${JSON.stringify({ ...viewer.stats, frame: viewer.frame, sequence: viewer.sequence, errors: out.errors })}`)), ms);
      viewer.addEventListener(type, () => { clearTimeout(timer); done(); }, { once: true });
    });
    let shownBefore = viewer.stats.framesShown, frameBefore = viewer.frame, at = performance.now(), kind = '', longest = 0, on = true;
    const first = { ...viewer.stats };
    const watch = (now) => {
      const { framesShown } = viewer.stats;
      if (framesShown !== shownBefore) {
        const gap = now - at, frame = viewer.frame;
        longest = Math.max(longest, gap);
        if (kind === 'play') out[frame < frameBefore ? 'loops' : 'play'].push(gap);
        shownBefore = framesShown;
        frameBefore = frame;
        at = now;
      }
      if (on) requestAnimationFrame(watch);
    };
    requestAnimationFrame(watch);
    const pause = (ms) => new Promise((done) => setTimeout(done, ms));
    const length = () => viewer.sequences.find(({ name }) => name === viewer.sequence).frames;
    await viewer.play();
    const isDone = (rounds) => out.errors.length || (rounds >= 6 && viewer.stats.framesShown - first.framesShown >= frames);
    for (let round = 0; !isDone(round); ++round) {
      kind = 'play';
      await pause(1200);
      kind = '';
      const start = performance.now();
      switch (round % 6) {
        case 0: case 3: {
          const sought = once('seeked');
          const wanted = below(length());
          viewer.seekFrame(wanted);
          await sought;
          out.seeks.push(performance.now() - start);
          break;
        }
        case 1: {
          longest = 0;
          viewer.quality = round % 4 === 1 ? 'highest' : '0';
          await pause(1000);
          out.rungs.push(longest);
          break;
        }
        case 2: {
          const changed = once('sequencechange');
          viewer.sequence = viewer.sequence === 'walk' ? 'locomotion' : 'walk';
          await changed;
          break;
        }
        case 4: {
          viewer.pause();
          const sought = once('seeked');
          const wanted = below(length());
          viewer.seekFrame(wanted);
          await sought;
          out.seeks.push(performance.now() - start);
          if (viewer.frame !== wanted) out.errors.push(`sought ${wanted}, shown ${viewer.frame}`);
          await viewer.play();
          break;
        }
        case 5: {
          const [parameter] = viewer.parameters ?? [];
          if (parameter) viewer.setParameter(parameter.name, parameter.min + (parameter.max - parameter.min) * below(100) / 100);
          break;
        }
      }
      at = performance.now();
    }
    on = false;
    viewer.removeEventListener('error', onError);
    const last = viewer.stats;
    return { ...out, frames: last.framesShown - first.framesShown, checked: last.barcodeChecked - first.barcodeChecked,
      mismatches: last.barcodeMismatches - first.barcodeMismatches, late: last.framesLate - first.framesLate, path: last.uploadPath };
  }, { frames, patienceMs: kPatienceMs });
}

/** Firefox whose pages have no WebCodecs. */
export const kNoWebCodecs = { 'dom.media.webcodecs.enabled': false };
