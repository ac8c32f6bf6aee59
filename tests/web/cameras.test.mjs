// SPDX-License-Identifier: Apache-2.0
// Characters from cameras in the page: native against browser, the second part of the player, the attributes that
// choose how they are drawn, damaged files, and the page that shows them beside the layered character.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openCharacter, openPage, outputFolder, readCanvas, renderNative, showPose, waitForEvent, writePicture } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage, ssim } from './ssim.mjs';

const kSsim = 0.99;
const kPoses = [
  { sequence: 'run', frame: 5, azimuth: 25, elevation: 8, distance: 4.2 },
  { sequence: 'run', frame: 12, azimuth: 165, elevation: 25, distance: 4.2 },
];

let site, server, browser;
before(async () => {
  // A copy, because files are damaged in it.
  site = mkdtempSync(join(tmpdir(), 'fourdvt-cameras-'));
  cpSync(environment('SITE'), site, { recursive: true });
  server = await serve(site);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
  if (site) rmSync(site, { recursive: true, force: true });
});

const secondPart = () => server.requests.filter(({ path }) => path.includes('fourdvt-more')).length;

for (const surface of ['hull', 'refined']) {
  test(`native and browser agree on the ${surface} character, and it plays`, async () => {
    const out = outputFolder('cameras');
    const { page, outcome } = await openCharacter(browser, server.url, `cameras/${surface}/character.gltf`);
    assert.equal(outcome, 'canplay');
    await page.waitForFunction(() => {
      const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
      return canvas.width === 720 && canvas.height === 960;
    });
    for (const pose of kPoses) {
      await showPose(page, pose);
      const shown = await readCanvas(page);
      const name = join(out, `${surface}-${pose.frame}`);
      writePicture(`${name}-browser.png`, shown);
      const native = await renderNative(environment('BIN'), join(site, 'cameras', surface), pose, shown.width, shown.height, `${name}-native.png`);
      const { foreground } = ssim(shown, native);
      console.log(`${surface} frame ${pose.frame}: SSIM ${foreground.toFixed(4)} on the silhouettes`);
      assert.ok(foreground >= kSsim, `SSIM ${foreground.toFixed(4)} on the silhouettes is below ${kSsim}; pictures in ${out}`);
    }
    const before = await page.evaluate(() => {
      const viewer = document.querySelector('fourdvt-viewer');
      void viewer.play();
      return viewer.stats.framesShown;
    });
    await page.waitForFunction((n) => document.querySelector('fourdvt-viewer').stats.framesShown >= n + 5, before, { timeout: kPatienceMs });
    assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').stats.barcodeMismatches), 0);
    assert.deepEqual(page.troubles, []);
    await page.close();
  });
}

test('layered characters play and move on without the second part of the player, and fetch it after the first picture', async () => {
  const files = ['fourdvt-more.js', 'fourdvt-more.wasm'].map((name) => join(site, 'fourdvt-viewer', name));
  for (const file of files) renameSync(file, `${file}.away`);
  const page = await openPage(browser);
  await page.goto(`${server.url}steer.html`);
  await waitForEvent(page, 'canplay');
  await page.evaluate(() => document.querySelector('fourdvt-viewer').play());
  const names = await page.evaluate(() => document.querySelector('fourdvt-viewer').sequences.map(({ name }) => name));
  for (const name of names) {
    await page.evaluate((name) => { document.querySelector('fourdvt-viewer').sequence = name; }, name);
    await page.waitForFunction((name) => {
      const viewer = document.querySelector('fourdvt-viewer');
      return viewer.sequence === name && viewer.frame > 2;
    }, name, { timeout: kPatienceMs });
  }
  await page.waitForFunction(() => document.querySelector('fourdvt-viewer').stats.framesShown >= 4, null, { timeout: kPatienceMs });
  const state = await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    for (const { name, max } of viewer.parameters) viewer.setParameter(name, max, true);
    return { shown: viewer.stats.framesShown, error: viewer.error };
  });
  for (const file of files) renameSync(`${file}.away`, file);
  assert.equal(state.error, null);
  assert.ok(state.shown >= 4);
  assert.ok(secondPart() > 0, 'it was asked for');
  await page.close();
});

test('a scene that comes before the second part is drawn once that is there', async () => {
  const page = await openPage(browser);
  let release;
  const released = new Promise((done) => { release = done; });
  await page.route('**/fourdvt-more.wasm*', async (route) => {
    await released;
    await route.continue();
  });
  await page.goto(server.url);
  await waitForEvent(page, 'canplay');
  const bytes = () => page.evaluate(async () => (await document.querySelector('fourdvt-viewer').toBlob({ width: 64, height: 64 })).size);
  // The page would go on to its class of motions, and what stands to a higher rendition.
  await page.waitForFunction(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    if (viewer.stats.framesShown < 2) return false;
    viewer.quality = '0';
    viewer.sequence = 'walk';
    viewer.pause();
    return true;
  }, null, { timeout: kPatienceMs });
  await page.evaluate(() => new Promise((done) => {
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.addEventListener('seeked', done, { once: true });
    viewer.seekFrame(0);
  }));
  const plain = await bytes();
  await page.evaluate(() => {
    const corner = (x, y) => [x, y, 0, 1, 0, 0], sides = [[-1, 0], [1, 0], [0, 2], [-1, 0], [0, 2], [1, 0]];
    document.querySelector('fourdvt-viewer').scene = [{ corners: Float32Array.from(sides.flatMap(([x, y]) => corner(x, y))) }];
  });
  assert.equal(await bytes(), plain, 'it waits');
  release();
  for (const until = Date.now() + kPatienceMs; (await bytes()) === plain; await new Promise((next) => setTimeout(next, 200))) {
    assert.ok(Date.now() < until, 'the scene is never drawn');
  }
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('a character from cameras without a start file shows the poster of its manifest', async () => {
  const folder = join(site, 'cameras', 'without-start');
  cpSync(join(site, 'cameras', 'hull'), folder, { recursive: true });
  const manifest = join(folder, 'character.gltf'), gltf = JSON.parse(readFileSync(manifest));
  delete gltf.extensions.FOURDVT_layered_video_texture.start;
  writeFileSync(manifest, JSON.stringify(gltf));
  const posters = [];
  for (const name of ['without-start', 'hull']) {
    const { page } = await openCharacter(browser, server.url, `cameras/${name}/character.gltf`);
    await page.evaluate((src) => new Promise((done) => {
      const viewer = document.querySelector('fourdvt-viewer');
      viewer.removeAttribute('poster');
      viewer.addEventListener('canplay', done, { once: true });
      viewer.src = src;
    }), `cameras/${name}/character.gltf`);
    posters.push(await page.evaluate(() => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('.picture').getAttribute('src')));
    await page.close();
  }
  assert.match(posters[0], /without-start\/poster\.webp$/);
  assert.equal(posters[1], null, 'the first picture comes as soon');
});

test('method, cameras and visibility choose how it is drawn; an unknown method is refused', async () => {
  const { page } = await openCharacter(browser, server.url, 'cameras/hull/character.gltf');
  await showPose(page, kPoses[0]);
  const set = async (name, value) => {
    await page.evaluate(async ([name, value]) => {
      document.querySelector('fourdvt-viewer').setAttribute(name, value);
      for (let i = 0; i < 3; ++i) await new Promise((next) => requestAnimationFrame(next));
    }, [name, value]);
    return readCanvas(page);
  };
  const textured = await readCanvas(page);
  const isWhite = ({ data }) => {
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] === 255 && data[i] + data[i + 1] + data[i + 2] < 750) return false;
    return true;
  };
  const silhouette = await set('method', 'silhouette');
  assert.ok(isWhite(silhouette));
  assert.ok(Math.abs(coverage(silhouette) - coverage(textured)) < 0.002);
  assert.ok(!isWhite(await set('method', 'wireframe')));
  const again = await set('method', 'sweep');
  assert.deepEqual(again.data, textured.data);
  assert.notDeepEqual((await set('method', 'fvvr')).data, textured.data);
  await set('method', 'sweep');
  assert.notDeepEqual((await set('cameras', '1')).data, textured.data);
  await set('cameras', '4');
  assert.notDeepEqual((await set('visibility', 'none')).data, textured.data);
  assert.deepEqual((await set('visibility', 'offset')).data, textured.data);
  const refused = await page.evaluate(async () => {
    const viewer = document.querySelector('fourdvt-viewer');
    const error = new Promise((done) => viewer.addEventListener('error', (e) => done(e.detail), { once: true }));
    viewer.method = 'no-such-method';
    return error;
  });
  assert.equal(refused.id, 'invalid-argument');
  await page.close();
});

test('a second part that does not load, and a chunk that is damaged, are one error each', async () => {
  const more = join(site, 'fourdvt-viewer', 'fourdvt-more.wasm');
  const kept = readFileSync(more);
  rmSync(more);
  const { page, outcome } = await openCharacter(browser, server.url, 'cameras/hull/character.gltf');
  assert.equal(outcome.id, 'fetch-failed');
  assert.match(outcome.message, /fourdvt-more/);
  await page.close();
  writeFileSync(more, kept);

  cpSync(join(site, 'cameras', 'hull'), join(site, 'cameras', 'damaged'), { recursive: true });
  const manifest = JSON.parse(readFileSync(join(site, 'cameras', 'damaged', 'character.gltf')));
  const { uri } = manifest.extensions.FOURDVT_layered_video_texture.sequences[0].stream;
  const stream = join(site, 'cameras', 'damaged', uri);
  const bytes = readFileSync(stream);
  bytes[bytes.length - 100] ^= 255;
  writeFileSync(stream, bytes);
  const { page: other, outcome: error } = await openCharacter(browser, server.url, 'cameras/damaged/character.gltf');
  assert.equal(error.id, 'files-differ');
  assert.ok(error.message.includes(uri), error.message);
  await other.close();
});

test('the page beside the layered character: surfaces and methods are switched, both viewers turn together and show one frame', async () => {
  const out = outputFolder('cameras');
  const page = await openPage(browser, { viewport: { width: 1280, height: 1000 } });
  await page.goto(`${server.url}cameras.html`);
  const bothPlay = () => page.waitForFunction(() =>
    [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.stats?.framesShown > 1), null, { timeout: kPatienceMs });
  await bothPlay();
  await page.screenshot({ path: join(out, 'page-hull.png') });
  await page.click('input[value=refined]');
  await page.waitForFunction(() => document.getElementById('cameras').src.includes('refined'));
  await bothPlay();
  await page.click('input[value=wireframe]');
  await page.evaluate(() => document.getElementById('cameras').setAttribute('camera-orbit', '70deg 10deg 4m'));
  await page.waitForFunction(() => Math.abs(document.getElementById('layers').getCameraOrbit().azimuth - 70) < 1, null, { timeout: kPatienceMs });
  await page.screenshot({ path: join(out, 'page-refined.png') });
  await page.evaluate(() => document.getElementById('cameras').pause());
  await page.waitForFunction(() => {
    const [cameras, layers] = document.querySelectorAll('fourdvt-viewer');
    return cameras.paused && layers.paused && cameras.frame === layers.frame;
  }, null, { timeout: kPatienceMs });
  assert.deepEqual(page.troubles, []);
  await page.close();
});
