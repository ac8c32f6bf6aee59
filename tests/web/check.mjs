// SPDX-License-Identifier: Apache-2.0
// node tests/web/check.mjs SITE OUT FOURDVT CHARACTER: the last step of `bash site/demo.sh --check`.
// Opens the served site, orbits walk and run, compares the silhouette's size with native stills, watches frames advance,
// measures the front page's layout.
// node tests/web/check.mjs --first SITE OUT: only tests that a site with one motion plays, before the rest is baked.
import { mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { gzipSync } from 'node:zlib';

import { kPatienceMs, launch, openPage, readCanvas, renderNative, showPose, waitForEvent, writePicture } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage } from './ssim.mjs';

const kAzimuths = [0, 90, 180, 270];
const kFrame = 7;
const kElevation = 10;
const kDistance = 4.6;       // the whole performer is in the picture
const kCoverageTolerance = 0.1;
const kDistinctFrames = 5;
const kWindows = [{ width: 1280, height: 800 }, { width: 390, height: 844 }];
const kMinShare = 0.25;    // of the window's height, for the viewer

const words = process.argv.slice(2), first = words[0] === '--first', paths = words.slice(first ? 1 : 0).map((path) => resolve(path));
if (paths.length !== (first ? 2 : 4)) {
  console.error('usage: node tests/web/check.mjs SITE OUT FOURDVT CHARACTER, or node tests/web/check.mjs --first SITE OUT');
  process.exit(2);
}
const [site, out, binary, character] = paths;
const failures = [];

function report(ok, text) {
  console.log(`${ok ? 'ok  ' : 'FAIL'} ${text}`);
  if (!ok) failures.push(text);
}

function playerBytes() {
  const folder = join(site, 'fourdvt-viewer');
  const files = readdirSync(folder).filter((name) => /^fourdvt-viewer\.(js|wasm)$/.test(name)); // the rest is fetched when asked for
  return files.reduce((sum, name) => sum + gzipSync(readFileSync(join(folder, name)), { level: 9 }).length, 0);
}

async function comparePose(page, pose) {
  await showPose(page, pose);
  const shown = await readCanvas(page);
  const name = `${pose.sequence}-${String(pose.azimuth).padStart(3, '0')}`;
  writePicture(join(out, `${name}.png`), shown);
  const native = await renderNative(binary, character, pose, shown.width, shown.height, join(out, `${name}-native.png`));
  const [here, there] = [coverage(shown), coverage(native)];
  const percent = (fraction) => `${(100 * fraction).toFixed(2)} %`;
  report(there > 0.005 && Math.abs(here - there) <= kCoverageTolerance * there,
    `${pose.sequence} from ${pose.azimuth}°: covers ${percent(here)} of ${shown.width}×${shown.height}, native ${percent(there)}`);
}

// Distinct frames shown while playing, until there are enough or patience ends.
async function watchFrames(page, sequence) {
  const seen = await page.evaluate(async ({ sequence, wanted, patience }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.sequence = sequence;
    viewer.play();
    const frames = new Set();
    const end = performance.now() + patience;
    while (frames.size < wanted && performance.now() < end) {
      if (viewer.sequence === sequence) frames.add(viewer.frame);
      await new Promise((next) => setTimeout(next, 10));
    }
    viewer.pause();
    return [...frames];
  }, { sequence, wanted: kDistinctFrames, patience: kPatienceMs });
  report(seen.length >= kDistinctFrames, `${sequence} plays: frames ${seen.join(', ')} seen`);
}

// Moves the class's slider from end to end: the parameter follows, frames advance, the character stays in the picture.
async function sweepSlider(page) {
  const steps = await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    const motion = viewer.sequences.find((s) => s.parameters.length > 0);
    if (!motion) return null;
    viewer.sequence = motion.name;
    viewer.play();
    const [{ name, min, max }] = motion.parameters;
    return { motion: motion.name, name, values: [min, (min + max) / 2, max, min] };
  });
  if (!steps) return report(true, 'no class of motions: no slider');
  const { motion, name, values } = steps;
  await page.waitForFunction((wanted) => document.querySelector('fourdvt-viewer').sequence === wanted, motion);
  const frames = new Set();
  for (const [i, value] of values.entries()) {
    await page.evaluate(({ name, value }) => document.querySelector('fourdvt-viewer').setParameter(name, value), { name, value });
    await page.waitForFunction(({ name, value, range }) => Math.abs(document.querySelector('fourdvt-viewer').getParameter(name) - value) < 0.01 * range,
      { name, value, range: values[2] - values[0] });
    frames.add(await page.evaluate(() => document.querySelector('fourdvt-viewer').frame));
    const picture = await readCanvas(page);
    writePicture(join(out, `${motion}-${i}.png`), picture);
    const covered = coverage(picture);
    report(covered > 0.005, `${motion} at ${name} = ${value.toFixed(2)}: covers ${(100 * covered).toFixed(2)} %`);
  }
  report(frames.size > 1, `${motion} plays while the slider moves: frames ${[...frames].join(', ')}`);
}

// The viewer is within the window and large enough, and words and controls lie beside it, with few dials and with all.
async function checkLayout(page) {
  for (const window of kWindows) {
    await page.setViewportSize(window);
    for (const dials of ['few', 'all']) {
      const problems = await page.evaluate(({ hidden, minShare }) => {
        for (const id of ['look-dials', 'light-dial']) document.getElementById(id).hidden = hidden;
        const viewer = document.getElementById('viewer').getBoundingClientRect();
        const found = [];
        if (viewer.left < 0 || viewer.top < 0 || viewer.right > innerWidth || viewer.bottom > innerHeight) found.push('is not within the window');
        if (viewer.height < minShare * innerHeight) found.push(`is ${viewer.height} pixels high`);
        for (const other of document.querySelectorAll('.intro, .controls, .stage nav a')) {
          const box = other.getBoundingClientRect();
          if (box.left < viewer.right && box.right > viewer.left && box.top < viewer.bottom && box.bottom > viewer.top)
            found.push(`lies under ${other.matches('a') ? other.textContent : other.className}`);
        }
        if (document.documentElement.scrollWidth > innerWidth) found.push('is on a page that scrolls sideways');
        return found;
      }, { hidden: dials === 'few', minShare: kMinShare });
      report(problems.length === 0, `layout at ${window.width}×${window.height}, ${dials} dials: the viewer ${problems.join(', ') || 'has its place'}`);
    }
  }
}

// Checks barcodes on the plane path, which a browser's measurement might not select.
async function checkPairing(browser, address) {
  const page = await openPage(browser, {}, 'i420');
  await page.goto(address);
  await waitForEvent(page, 'canplay');
  for (const sequence of ['walk', 'run']) await watchFrames(page, sequence);
  const stats = await page.evaluate(() => document.querySelector('fourdvt-viewer').stats);
  report(stats.barcodeChecked > 0 && stats.barcodeMismatches === 0,
    `frame pairing: ${stats.barcodeMismatches} mismatches in ${stats.barcodeChecked} pictures`);
  report(page.troubles.length === 0, `browser console: ${page.troubles.join(' | ') || 'no errors'}`);
}

async function openFirstPicture(page, address) {
  await page.goto(address);
  const ms = await waitForEvent(page, 'canplay');
  console.log(`time to first picture: ${(ms / 1000).toFixed(2)} s (headless, software GL)`);
}

async function checkFirst(page, address) {
  await openFirstPicture(page, address);
  await watchFrames(page, 'walk');
  const covered = coverage(await readCanvas(page));
  report(covered > 0.005, `the first motion covers ${(100 * covered).toFixed(2)} %`);
  report(page.troubles.length === 0, `browser console: ${page.troubles.join(' | ') || 'no errors'}`);
}

async function check(page, address) {
  await openFirstPicture(page, address);
  for (const sequence of ['walk', 'run']) {
    for (const azimuth of kAzimuths) {
      await comparePose(page, { sequence, frame: kFrame, azimuth, elevation: kElevation, distance: kDistance });
    }
  }
  await sweepSlider(page);
  for (const sequence of ['walk', 'run']) await watchFrames(page, sequence);
  await checkLayout(page);
  const path = await page.evaluate(() => document.querySelector('fourdvt-viewer').stats.uploadPath);
  console.log(`upload path measured as the faster: ${path}`);
  report(page.troubles.length === 0, `browser console: ${page.troubles.join(' | ') || 'no errors'}`);
  await page.close();
}

mkdirSync(out, { recursive: true });
const server = await serve(site);
const browser = await launch();
try {
  await (first ? checkFirst : check)(await openPage(browser, {}, 'auto'), server.url);
  if (!first) await checkPairing(browser, server.url);
} catch (error) {
  report(false, error.message);
} finally {
  await browser.close();
  await server.close();
}
console.log(`player: ${(playerBytes() / 1024).toFixed(1)} KiB gzip (JavaScript + wasm)`);
console.log(`screenshots: ${out}`);
if (failures.length) console.error(`${failures.length} of the checks failed`);
process.exit(failures.length ? 1 : 0);
