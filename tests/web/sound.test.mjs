// SPDX-License-Identifier: Apache-2.0
// Synchronisation of sound and picture: finds clicks in the page's output, sample by sample, and compares them with the
// media time of the picture on screen, over loops, seeks, rates, changes of the motion, and the steps of a class.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { kClicks, kDurations, kPaces, openClicks, set, until, wait } from './click_track.mjs';

const kMaxOffsetMs = 40;
const kDisplayMs = 1000 / 60, kWindowMs = 900;

let site;
before(async () => { site = await openClicks(); });
after(() => site?.close());

// Pictures from before a seek say nothing of the time after it.
const sought = (page) => until(page, () => {
  if (document.querySelector('fourdvt-viewer').seeking) return false;
  globalThis.pictures.length = 0;
  return true;
});

// Measures offsets in ms of the next `count` clicks; positive: the sound is late. A picture counts as shown one frame of the display after the turn
// that draws it. A turn may draw a frame late, by up to the time between turns, never early: of the pictures before a click, the one that is furthest
// ahead gives the motion's clock.
async function offsets(page, motion, count) {
  await until(page, () => globalThis.listens).catch(async (reason) => {
    const found = await page.evaluate(() => {
      const { paused, muted, ended, seeking, readyState, stats } = document.querySelector('fourdvt-viewer');
      return { paused, muted, ended, seeking, readyState, stats, active: navigator.userActivation.hasBeenActive };
    });
    throw new Error(`nothing is played: ${JSON.stringify(found)} ${page.troubles.join('; ')}`, { cause: reason });
  });
  const since = await page.evaluate(() => globalThis.clicks.length);
  await until(page, (n) => globalThis.clicks.length >= n, since + count);
  await wait(100);
  const { clicks, pictures } = await page.evaluate(() => ({ clicks: globalThis.clicks, pictures: globalThis.pictures }));
  const durationS = kDurations[motion];
  return clicks.slice(since).flatMap((atMs) => {
    const before = pictures.filter((p) => p.atMs + kDisplayMs <= atMs && p.atMs > atMs - kWindowMs / Math.min(1, p.rate));
    const last = before.at(-1);
    if (before.length < 4 || before.some(({ rate }) => rate !== last.rate)) return [];
    const pace = kPaces[motion] * last.rate;
    const ahead = before.map((p) => {
      const aheadS = p.mediaS - last.mediaS + pace * (last.atMs - p.atMs) / 1000;
      return aheadS - Math.round(aheadS / durationS) * durationS; // the loop may have begun again since
    });
    const mediaS = last.mediaS + Math.max(...ahead) + pace * (atMs - last.atMs - kDisplayMs) / 1000;
    const each = kClicks[motion].map((click) => {
      const off = (mediaS - click) / durationS;
      return 1000 * durationS * (off - Math.round(off)) / pace;
    });
    return [each.reduce((a, b) => (Math.abs(a) < Math.abs(b) ? a : b))];
  });
}
// A page that stutters shows single pictures late, which is no fault of the sound's: four fifths must be within the bound.
function check(name, list, least) {
  const sorted = list.map(Math.abs).sort((a, b) => a - b), median = [...list].sort((a, b) => a - b)[list.length >> 1];
  console.log(`${name}: ${list.length} clicks, median offset ${median?.toFixed(1)} ms, largest ${sorted.at(-1)?.toFixed(1)} ms`);
  assert.ok(list.length >= least, `${name}: only ${list.length} clicks could be compared`);
  assert.ok(sorted[Math.ceil(0.8 * list.length) - 1] <= kMaxOffsetMs, `${name}: ${list.map((ms) => ms.toFixed(0))} ms`);
}

test('clicks are heard with their pictures: loops, rates, seeks, another motion, the steps of a class', async () => {
  const page = await site.open('plays');
  await page.mouse.click(250, 250);
  check('loops', await offsets(page, 'walk', 20), 16);
  for (const rate of [0.5, 2]) {
    await set(page, { playbackRate: rate });
    await wait(1000); // of pictures at the new rate, by which the clicks are judged
    check(`rate ${rate}`, await offsets(page, 'walk', 12), 7);
  }
  await set(page, { playbackRate: 1 });
  for (const time of [0.6, 2.4, 0.02]) {
    await set(page, { currentTime: time });
    await sought(page);
    check(`after a seek to ${time} s`, await offsets(page, 'walk', 6), 3);
  }
  await page.evaluate(() => document.querySelector('fourdvt-viewer').pause());
  await set(page, { currentTime: 1.3 });
  await sought(page);
  await page.evaluate(() => document.querySelector('fourdvt-viewer').play());
  check('after a seek while it was paused', await offsets(page, 'walk', 6), 3);
  await set(page, { sequence: 'run' });
  await until(page, () => document.querySelector('fourdvt-viewer').shown === 'run');
  await wait(1000); // the fade between the motions
  check('another motion', await offsets(page, 'run', 8), 6);
  await set(page, { sequence: 'locomotion' });
  await until(page, () => document.querySelector('fourdvt-viewer').shown === 'locomotion');
  await wait(1500);
  check('steps of a class', await offsets(page, 'locomotion', 6), 5);
  assert.deepEqual(page.troubles, []);
  await page.close();
});
