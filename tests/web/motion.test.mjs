// SPDX-License-Identifier: Apache-2.0
// The character's motion as a visitor steers it: the speed slider while orbiting, transitions, keys, several characters
// in one canvas; and the same parameter, phase, camera and alignment natively.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';

import { closeSite, environment, kFovDeg, kPatienceMs, openPage, openSite, outputFolder, readCanvas, waitForEvent, writePicture } from './harness.mjs';
import { decodePng } from './png.mjs';
import { coverage, ssim } from './ssim.mjs';

const run = promisify(execFile);
const kSsim = 0.98;
const kOther = 0.99;     // two alignments: below; native and browser agree to 0.997
const kStall = 240;      // turns of the page without a new frame: 4 s at 60 Hz, and longer where a busy machine gives fewer

let site, server, browser, page;
before(async () => {
  site = await openSite({ width: 480, height: 900 });
  ({ server, browser, page } = site);
  await until(() => document.querySelector('fourdvt-viewer').parameters.length > 0);
});
after(() => closeSite(site));

const until = (condition, argument, on = page) => on.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });
const shot = async (name, on = page) => {
  const picture = await readCanvas(on);
  writePicture(join(outputFolder('motion'), `${name}.png`), picture);
  return picture;
};

// Starts to watch which frames are shown, and the most turns of the page (animation frames) between two of them.
const watch = (on = page) => on.evaluate(() => {
  const viewer = document.querySelector('fourdvt-viewer');
  const seen = (globalThis.frameWatch = { frames: 0, stall: 0, last: -1, turns: 0, on: true });
  const look = () => {
    seen.stall = Math.max(seen.stall, ++seen.turns);
    if (viewer.frame !== seen.last) seen.last = viewer.frame, seen.turns = 0, ++seen.frames;
    if (seen.on) requestAnimationFrame(look);
  };
  look();
});
const watched = (on = page) => on.evaluate(() => {
  const seen = globalThis.frameWatch;
  seen.on = false;
  return { frames: seen.frames, stall: seen.stall };
});

test('the slider comes first: speed in metres a second, from walk to run', async () => {
  const { min, max, name } = (await page.evaluate(() => document.querySelector('fourdvt-viewer').parameters))[0];
  assert.equal(name, 'speed_mps');
  assert.ok(min > 1 && min < 1.4 && max > 2.4 && max < 3, `${min} to ${max}`);
  assert.match(await page.inputValue('#parameter'), /^1\./);
  assert.match(await page.textContent('#parameter-value'), /m\/s/);
});

test('dragging the slider up and down again while orbiting: no stall, the parameter follows', async () => {
  const slider = await page.locator('#parameter').boundingBox();
  const viewer = await page.locator('fourdvt-viewer').boundingBox();
  const y = slider.y + slider.height / 2;
  const at = (share) => slider.x + 8 + (slider.width - 16) * share;
  await watch();
  const speeds = [];
  for (const stops of [[0, 0.25, 0.5, 0.75, 1], [1, 0.5, 0]]) {
    await page.mouse.move(at(stops[0]), y);
    await page.mouse.down();
    for (const stop of stops) {
      await page.mouse.move(at(stop), y, { steps: 4 });
      await until(() => {
        const slider = document.getElementById('parameter');
        return Math.abs(document.querySelector('fourdvt-viewer').getParameter(slider.dataset.name) - Number(slider.value)) < 0.02;
      });
      speeds.push(await page.evaluate(() => document.querySelector('fourdvt-viewer').getParameter('speed_mps')));
      await shot(`slider-${speeds.length}`);
    }
    await page.mouse.up();
    await page.mouse.move(viewer.x + viewer.width / 2, viewer.y + viewer.height / 2);
    await page.mouse.down();
    await page.mouse.move(viewer.x + viewer.width / 2 + 130, viewer.y + viewer.height / 2, { steps: 8 });
    await page.mouse.up();
  }
  const { frames, stall } = await watched();
  console.log(`speeds shown: ${speeds.map((v) => v.toFixed(2)).join(' ')}; ${frames} frames, longest pause ${stall} turns`);
  assert.ok(speeds[4] > speeds[0] + 1, 'the slider reaches the run');
  assert.ok(speeds.at(-1) < speeds[4] - 1, 'and comes back to the walk');
  assert.ok(frames > 20 && stall < kStall, `${frames} frames, longest pause ${stall} turns of the page`);
});

test('a one-off motion is entered by a transition and left by itself', async () => {
  await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    globalThis.motions = [];
    for (const type of ['transitionstart', 'transitionend']) {
      viewer.addEventListener(type, () => globalThis.motions.push(`${type} ${viewer.state}`));
    }
  });
  await page.locator('#motions input[value=pickup]').click();
  await until(() => document.querySelector('fourdvt-viewer').inTransition);
  await shot('transition');
  await until(() => document.querySelector('fourdvt-viewer').sequence === 'pickup');
  await until(() => document.querySelector('fourdvt-viewer').sequence === 'locomotion');
  await until(() => !document.querySelector('fourdvt-viewer').inTransition);
  const motions = await page.evaluate(() => globalThis.motions);
  assert.ok(motions.length >= 4, `${motions}`);
});

// The class in its highest rendition, paused, at once; returns the frame that is shown.
const pose = (view) => page.evaluate(async ({ speed, phase, azimuth, fov }) => {
  const viewer = document.querySelector('fourdvt-viewer');
  viewer.pause();
  viewer.quality = 'highest';
  viewer.renderOptions = { groundShadow: false };
  viewer.setAttribute('field-of-view', `${fov}deg`);
  viewer.setAttribute('camera-orbit', `${azimuth}deg 8deg 4.4m`);
  viewer.jumpCameraToGoal();
  viewer.setParameter('speed_mps', speed, true);
  const frames = viewer.sequences.find((s) => s.name === 'locomotion').frames;
  const wanted = Math.floor(phase * frames);
  const seeked = new Promise((done) => viewer.addEventListener('seeked', done, { once: true }));
  viewer.seekFrame(wanted);
  await seeked;
  for (let i = 0; i < 4; ++i) await new Promise((next) => requestAnimationFrame(next));
  return viewer.frame;
}, { fov: kFovDeg, ...view });

const native = async (name, { width, height }, { speed, azimuth }, frame, align = 'baked') => {
  const file = join(outputFolder('motion'), `${name}.png`);
  await run(environment('BIN'), ['render', environment('CHARACTER'), '--class', 'locomotion', '--parameter', `speed_mps=${speed}`,
    '--frame', String(frame), '--azimuth', String(azimuth), '--elevation', '8', '--distance', '4.4', '--size',
    `${width}x${height}`, '--no-shadow', '--align', align, '-o', file], { timeout: kPatienceMs });
  return decodePng(readFileSync(file));
};

for (const view of [{ speed: 1.9, phase: 0.3, azimuth: 30 }, { speed: 2.4, phase: 0.75, azimuth: -120 }]) {
  const { speed, phase } = view;
  test(`native and browser agree at ${speed} m/s, phase ${phase}`, async () => {
    const frame = await pose(view);
    const shown = await shot(`parity-${speed}-browser`);
    const { all, foreground } = ssim(shown, await native(`parity-${speed}-native`, shown, view, frame));
    console.log(`${speed} m/s, frame ${frame}: SSIM ${all.toFixed(4)} whole picture, ${foreground.toFixed(4)} on the silhouettes`);
    assert.ok(foreground >= kSsim, `SSIM ${foreground.toFixed(4)} is below ${kSsim}`);
  });
}

test('optical flow: native and browser agree, on a picture that no other alignment gives', async () => {
  const view = { speed: 1.97, phase: 0.3, azimuth: 30 };
  const frame = await pose(view);
  const align = (name) => page.evaluate(async (name) => {
    document.querySelector('fourdvt-viewer').align = name;
    for (let i = 0; i < 4; ++i) await new Promise((next) => requestAnimationFrame(next));
  }, name);
  await align('none');
  const plain = await shot('align-none-browser');
  for (const name of ['flow-gpu', 'flow-dis', 'flow-opencv']) {
    await align('baked');
    const baked = await shot('align-baked-browser');
    await align(name);
    // No event says that the module is here.
    let shown, toBaked = 1;
    for (const end = Date.now() + kPatienceMs; toBaked > kOther && Date.now() < end;) {
      await page.waitForTimeout(200);
      shown = await shot(`align-${name}-browser`);
      toBaked = ssim(shown, baked).foreground;
    }
    const toPlain = ssim(shown, plain).foreground;
    const { foreground } = ssim(shown, await native(`align-${name}-native`, shown, view, frame, name));
    console.log(`${name}, frame ${frame}: SSIM ${foreground.toFixed(4)} to native; ${toBaked.toFixed(4)} to baked, ${toPlain.toFixed(4)} to none`);
    assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').frame), frame);
    assert.ok(toBaked <= kOther && toPlain <= kOther, `${name} is not applied: SSIM ${toBaked} to baked, ${toPlain} to none`);
    assert.ok(foreground >= kSsim, `${name}: SSIM ${foreground.toFixed(4)} is below ${kSsim}`);
  }
  await align('baked');
});

test('steering with keys: it turns, speeds up, travels over the ground and picks up', async () => {
  const steer = await openPage(browser, { viewport: { width: 800, height: 560 } });
  await steer.goto(`${server.url}steer.html`);
  await waitForEvent(steer, 'canplay');
  await until(() => document.querySelector('fourdvt-viewer').parameters.length > 0, undefined, steer);
  const place = () => steer.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    return { ...viewer.placement, speed: viewer.getParameter('speed_mps'), state: viewer.state };
  });
  const start = await place();
  await until((z) => document.querySelector('fourdvt-viewer').placement.z > z + 0.5, start.z, steer);
  await watch(steer);
  await steer.keyboard.down('ArrowUp');
  await until((v) => document.querySelector('fourdvt-viewer').getParameter('speed_mps') > v + 0.6, start.speed, steer);
  await shot('steer-fast', steer);
  await steer.keyboard.up('ArrowUp');
  const straight = await place();
  await steer.keyboard.down('a');
  await until((h) => document.querySelector('fourdvt-viewer').heading > h + 50, straight.heading, steer);
  await steer.keyboard.up('a');
  await shot('steer-turn', steer);
  const before = await place();
  await until(({ x, z }) => {
    const { placement } = document.querySelector('fourdvt-viewer');
    return Math.hypot(placement.x - x, placement.z - z) > 0.5;
  }, before, steer);
  const then = await place();
  const along = Math.atan2(then.x - before.x, then.z - before.z) * 180 / Math.PI;
  assert.ok(Math.abs((((along - then.heading) % 360) + 540) % 360 - 180) < 35, `went ${along}°, heading ${then.heading}°`);
  await steer.keyboard.press(' ');
  await until(() => document.querySelector('fourdvt-viewer').sequence === 'pickup', undefined, steer);
  await shot('steer-pickup', steer);
  const { frames, stall } = await watched(steer);
  console.log(`steering: ${frames} frames, longest pause ${stall} turns`);
  assert.ok(stall < kStall, `longest pause ${stall} turns of the page`);
  await steer.click('#company');
  await until(() => document.querySelector('fourdvt-character').present, undefined, steer);
  const companion = () => steer.evaluate(() => document.querySelector('fourdvt-character').placement);
  const from = await companion();
  await until(({ x, z }) => {
    const { placement } = document.querySelector('fourdvt-character');
    return Math.hypot(placement.x - x, placement.z - z) > 0.3;
  }, from, steer);
  await shot('steer-company', steer);
  const left = await steer.evaluate(async () => {
    const companion = document.querySelector('fourdvt-character');
    const viewer = companion.parentElement;
    companion.remove();
    await Promise.resolve(); // it might be a move
    const { present } = companion;
    viewer.append(companion);
    return { present, framesShown: viewer.stats.framesShown };
  });
  assert.equal(left.present, false);
  await until(() => document.querySelector('fourdvt-character').present, undefined, steer);
  await until((shown) => document.querySelector('fourdvt-viewer').stats.framesShown > shown, left.framesShown, steer);
  assert.deepEqual(steer.troubles, []);
  await steer.close();
});

test('a seek shows the key of the frame\'s GOP first, then the frame; geometry is decoded in a worker', async () => {
  const seen = await page.evaluate(async (patienceMs) => {
    const viewer = document.querySelector('fourdvt-viewer');
    const once = (type) => new Promise((done) => viewer.addEventListener(type, done, { once: true }));
    const wait = (promise) => Promise.race([promise, new Promise((_, fail) => setTimeout(() => fail(new Error('patience')), patienceMs))]);
    viewer.pause();
    const changes = once('sequencechange');
    if (viewer.sequence !== 'pickup') await wait((viewer.sequence = 'pickup', changes));
    const seek = async (frame) => {
      const end = once('seeked');
      viewer.seekFrame(frame);
      await wait(end);
    };
    await seek(0);
    // The decoder gets the last samples once the key has been seen: on a busy machine its pictures come sooner than the next turn.
    const { decode, flush } = VideoDecoder.prototype;
    const held = [];
    let since = 0;
    const calls = {
      decode(chunk) {
        since = chunk.type === 'key' ? 0 : since + 1;
        if (since > 6) held.push(() => decode.call(this, chunk));
        else decode.call(this, chunk);
      },
      flush() {
        return held.length ? new Promise((done) => held.push(() => done(flush.call(this)))) : flush.call(this);
      },
    };
    Object.assign(VideoDecoder.prototype, calls);
    const frames = [0], endMs = performance.now() + 10_000;
    const watch = () => {
      if (viewer.frame !== frames.at(-1)) frames.push(viewer.frame);
      if (viewer.frame !== 20 && performance.now() < endMs) return void requestAnimationFrame(watch);
      Object.assign(VideoDecoder.prototype, { decode, flush });
      for (const call of held.splice(0)) call();
    };
    watch();
    await seek(37);
    return { frames, last: viewer.frame, stats: viewer.stats };
  }, kPatienceMs);
  assert.equal(seen.last, 37);
  assert.deepEqual(seen.frames, [0, 20]);
  assert.ok(seen.stats.decodeMs > 0 && seen.stats.workerFrames > 0, JSON.stringify(seen.stats));
});

test('no console errors, no unhandled rejections', () => assert.deepEqual(page.troubles, []));
