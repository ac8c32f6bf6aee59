// SPDX-License-Identifier: Apache-2.0
// Sound in a page: states without sound, the browser's autoplay policy, files that cannot be loaded, and the sample's own
// sound in two browsers' decoders.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { extensionOf, listen, openClicks, set, until, wait } from './click_track.mjs';
import { kPatienceMs, launch, launchFirefox, launchQuiet, openPage } from './harness.mjs';

let site, server;
before(async () => {
  site = await openClicks();
  ({ server } = site);
});
after(() => site?.close());

const heardFiles = () => server.requests.filter(({ path }) => path.endsWith('.wav')).length;

test('a pause, a mute and a hidden tab are silent; the volume counts; a muted viewer fetches no sound', async () => {
  server.requests.length = 0;
  const page = await site.open('muted');
  await page.mouse.click(250, 250);
  await wait(1500);
  assert.equal(heardFiles(), 0);
  assert.deepEqual(await page.evaluate(() => globalThis.clicks), []);
  await set(page, { muted: false });
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').hasSound), true);
  await until(page, () => globalThis.clicks.length > 2);
  assert.ok(heardFiles() > 0);
  const silent = async (name) => {
    await wait(400);
    const before = await page.evaluate(() => globalThis.clicks.length);
    await wait(1300);
    assert.equal(await page.evaluate(() => globalThis.clicks.length), before, name);
  };
  const heardAgain = async () => until(page, (n) => globalThis.clicks.length > n + 1, await page.evaluate(() => globalThis.clicks.length));
  await page.evaluate(() => document.querySelector('fourdvt-viewer').pause());
  await silent('paused');
  await page.evaluate(() => document.querySelector('fourdvt-viewer').play());
  await heardAgain();
  await set(page, { volume: 0.05 }); // below the finder's threshold
  await silent('volume 0.05');
  await set(page, { volume: 1, playbackRate: 0 });
  await silent('rate 0');
  await set(page, { playbackRate: 1 });
  await heardAgain();
  await set(page, { muted: true });
  await silent('muted');
  await set(page, { muted: false });
  await heardAgain();
  await set(page, { sequence: 'pickup', loop: true }); // it has no sound
  await until(page, () => document.querySelector('fourdvt-viewer').shown === 'pickup');
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').hasSound), false);
  await silent('a motion without sound');
  await set(page, { sequence: 'walk' });
  await heardAgain();
  await page.evaluate(() => document.querySelector('fourdvt-viewer').remove());
  await silent('removed');
  assert.deepEqual(page.troubles, []);
  await page.close();
});

// Every call of Playwright's into the page counts as a visitor's touch: until the press the page reports by itself.
test('the picture plays before the visitor lets the page be heard; the button says so, and a press of it is enough', async () => {
  const quiet = await launchQuiet(), page = await openPage(quiet, { viewport: { width: 300, height: 300 } });
  await page.addInitScript(listen);
  await page.addInitScript(() => {
    addEventListener('loadedmetadata', () => setInterval(() => {
      const viewer = document.querySelector('fourdvt-viewer'), button = viewer.shadowRoot.querySelector('[part=mute]');
      if (button?.hidden !== false || viewer.stats.framesShown < 15) return;
      const { left, top, width, height } = button.getBoundingClientRect(), { muted } = viewer;
      console.log('state', JSON.stringify({ x: left + width / 2, y: top + height / 2, label: button.ariaLabel, clicks: globalThis.clicks.length, muted }));
    }, 100), { capture: true, once: true });
  });
  const states = [];
  page.on('console', (message) => { if (message.text().startsWith('state ')) states.push(JSON.parse(message.text().slice(6))); });
  const next = async (condition) => {
    const first = states.length, end = Date.now() + kPatienceMs;
    for (;;) {
      const found = states.slice(first).find(condition);
      if (found) return found;
      assert.ok(Date.now() < end, `waiting for ${condition}: ${JSON.stringify(states.slice(-3))}`);
      await wait(50);
    }
  };
  await page.goto(`${server.url}plays.html`);
  const blocked = await next(({ label }) => label === 'Unmute');
  await wait(1500);
  assert.deepEqual({ clicks: states.at(-1).clicks, muted: states.at(-1).muted, label: states.at(-1).label }, { clicks: 0, muted: false, label: 'Unmute' });
  await page.mouse.click(blocked.x, blocked.y);
  assert.equal((await next(({ label, clicks }) => label === 'Mute' && clicks > 2)).muted, false);
  await page.mouse.click(blocked.x, blocked.y);
  assert.equal((await next(({ label }) => label === 'Unmute')).muted, true);
  await set(page, { sequence: 'pickup' });
  await until(page, () => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('[part=mute]').hidden);
  assert.deepEqual(page.troubles, []);
  await quiet.close();
});

test('sound that is missing, damaged or described wrongly costs the sound alone; the console names the file', async () => {
  for (const [fault, expected] of [['missing', /walk-clicks\.wav: HTTP 404/], ['damaged', /walk-clicks\.wav: this browser does not decode it/], ['described', /the sound of "walk" in character\.gltf: .*bake the character again/]]) {
    const warnings = [];
    const page = await site.open('plays', async (page) => {
      page.on('console', (message) => { if (message.type() === 'warning') warnings.push(message.text()); });
      if (fault === 'missing') await page.route('**/*.wav', (route) => route.fulfill({ status: 404 }));
      if (fault === 'damaged') await page.route('**/*.wav', async (route) => {
        const response = await route.fetch(), body = await response.body();
        return route.fulfill({ response, body: Buffer.alloc(body.length, 7) });
      });
      if (fault === 'described') await page.route('**/character.gltf', async (route) => {
        const gltf = await (await route.fetch()).json();
        extensionOf(gltf).sequences.find(({ name }) => name === 'walk').sound.segmentDuration = -1;
        return route.fulfill({ json: gltf });
      });
    });
    await page.mouse.click(250, 250);
    for (const end = Date.now() + kPatienceMs; !warnings.some((text) => expected.test(text)); await wait(50)) {
      assert.ok(Date.now() < end, `${fault}: ${warnings.join('\n')}`);
    }
    const before = await page.evaluate(() => globalThis.pictures.length);
    await until(page, (n) => globalThis.pictures.length > n + 10, before);
    assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').error), null, fault);
    await page.close();
  }
});

// First instants, in seconds, at which a segment of the sample's sound is loud, by the rule of FORMAT.md.
const onsetsOf = (page, motion) => page.evaluate(async (motion) => {
  const gltf = await (await fetch('/character/character.gltf')).json();
  const { sound } = gltf.extensions.FOURDVT_layered_video_texture.sequences.find(({ name }) => name === motion);
  const context = new OfflineAudioContext(1, 1, sound.sampleRate), audio = document.createElement('audio');
  return Promise.all(sound.encodings.map(async ({ uri, type, priming, segments }) => {
    const file = await (await fetch(`/character/${uri}`)).arrayBuffer(), [bytes, samples] = segments[0];
    const buffer = await context.decodeAudioData(file.slice(0, bytes)), data = buffer.getChannelData(0);
    const skip = buffer.length > samples + priming / 2 ? priming : 0;
    const found = [];
    for (let i = skip, quiet = 1e9; i < data.length; ++i) {
      if (Math.abs(data[i]) > 0.12) {
        if (quiet > 0.2 * sound.sampleRate) found.push((i - skip) / sound.sampleRate);
        quiet = 0;
      } else ++quiet;
    }
    return { type, plays: audio.canPlayType(type), found, skip };
  }));
}, motion);

for (const [name, start] of [['Chromium', () => launch()], ['Firefox', () => launchFirefox()]]) {
  test(`${name} decodes the sample's Opus and AAC, with the steps where feet come down`, async () => {
    const own = await start(), page = await own.newPage({ viewport: { width: 300, height: 300 } });
    try {
      await page.goto(`${server.url}paused.html`);
      for (const [motion, frames] of [['walk', [2, 16]], ['run', [6, 16]]]) {
        for (const { type, plays, found, skip } of await onsetsOf(page, motion)) {
          console.log(`${name} ${motion} ${type} (${plays}): steps at ${found.map((s) => s.toFixed(3))} s, ${skip} samples skipped`);
          assert.notEqual(plays, '');
          assert.equal(found.length, frames.length);
          found.forEach((s, i) => assert.ok(Math.abs(s - frames[i] / 25) < 0.005, `${s} instead of ${frames[i] / 25}`));
        }
      }
    } finally {
      await own.close();
    }
  });
}

test('the class of the sample has a step for each foot, half a pass apart', async () => {
  const gltf = await (await fetch(`${server.url}character/character.gltf`)).json();
  const { steps, encodings } = extensionOf(gltf).sequences.find(({ name }) => name === 'locomotion').sound;
  assert.equal(steps.length, 2);
  assert.ok(Math.abs(steps[1] - steps[0] - 0.5) < 0.03, `${steps}`);
  // Between 2 of 28 frames of the walk and 6 of 19 of the run, which lie in one phase.
  assert.ok(steps[0] > 0.05 && steps[0] < 0.32, `${steps}`);
  assert.deepEqual(encodings.map(({ segments }) => segments.length), [1, 1]);
});
