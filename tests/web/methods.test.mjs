// SPDX-License-Identifier: Apache-2.0
// Methods of characters from cameras: native against browser for each, the fallback on a device without half-float
// render targets, and the page with two methods on one view.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openCharacter, openPage, outputFolder, readCanvas, renderNative, showPose, writePicture } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage, ssim } from './ssim.mjs';

const kSsim = 0.98;
const kPose = { sequence: 'run', frame: 5, azimuth: 25, elevation: 8, distance: 4.2 };
const kSize = { width: 360, height: 480 };      // against native pictures
const kCompared = { width: 270, height: 360 };  // of the page's pictures with each other
const kAside = 60;             // degrees by which the view turns before a picture of what follows it with time
const kRedraws = 2;
const kLayeredPatienceMs = 20_000;
const kStillFrames = 5;       // of the page, without a draw: what follows with time draws in every one
const kWithoutHalfFloat = { lumigraph: 'lumigraph', montage4d: 'lumigraph', floating: 'lumigraph', sweep: 'sweep' };

// As the tool lists them: "… must be A, B, C or layered, not …".
function methodNames() {
  const { stderr } = spawnSync(environment('BIN'), ['render', 'x', '-o', 'x.png', '--method', '?'], { encoding: 'utf8' });
  const list = stderr.match(/--method must be (.*) or layered/);
  assert.ok(list, stderr);
  return list[1].split(', ');
}

let server, browser;
before(async () => {
  server = await serve(environment('SITE'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const openRefined = (prepare, size = kCompared) => openCharacter(browser, server.url, 'cameras/refined/character.gltf', { ...size, prepare });

const countDraws = (page) => page.addInitScript(() => {
  globalThis.draws = 0;
  for (const name of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced']) {
    const original = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...values) {
      ++globalThis.draws;
      return original.apply(this, values);
    };
  }
});

/** Shows the method on the posed view. */
async function show(page, name) {
  await page.evaluate(async ({ name, redraws }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    let problem = '';
    viewer.addEventListener('error', (e) => { problem ||= e.detail.message; });
    viewer.method = name;
    for (let i = 0; i < redraws; ++i) {
      viewer.renderOptions = {}; // asks for another picture
      await new Promise((next) => setTimeout(() => requestAnimationFrame(next), 50));
    }
    if (problem) throw new Error(`${name}: ${problem}`);
  }, { name, redraws: kRedraws });
  return readCanvas(page);
}

/**
 * Likewise, after the paused view has turned to the pose: what the method leaves on the canvas, with no redraw asked for.
 * Not for the pictures of what is behind a method: their colours are those of the slots that cameras were given on the way.
 */
async function showTurned(page, name, { azimuth, elevation, distance }) {
  const turn = (degrees, stillFrames) => page.evaluate(async ({ orbit, stillFrames }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    const nextFrame = () => new Promise((next) => requestAnimationFrame(next));
    let before = globalThis.draws;
    viewer.setAttribute('camera-orbit', orbit);
    viewer.jumpCameraToGoal();
    while (globalThis.draws === before) await nextFrame();
    for (let still = 0; still < stillFrames; still = globalThis.draws === before ? still + 1 : 0) {
      before = globalThis.draws;
      await nextFrame();
    }
  }, { orbit: `${degrees}deg ${elevation}deg ${distance}m`, stillFrames });
  await turn(azimuth + kAside, 0);
  await show(page, name);
  await turn(azimuth, kStillFrames);
  return readCanvas(page);
}

test('native and browser agree by every method', async () => {
  const out = outputFolder('methods');
  const { page, outcome } = await openRefined(countDraws, kSize);
  assert.equal(outcome, 'canplay');
  await page.waitForFunction(({ width, height }) => {
    const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
    return canvas.width === width && canvas.height === height;
  }, kSize);
  await showPose(page, kPose);
  const below = [];
  for (const name of methodNames()) {
    const [shown, native] = await Promise.all([
      name === 'montage4d' ? showTurned(page, name, kPose) : show(page, name),
      renderNative(environment('BIN'), join(environment('SITE'), 'cameras', 'refined'), kPose, kSize.width, kSize.height,
        join(out, `${name}-native.png`), ['--method', name]),
    ]);
    writePicture(join(out, `${name}-browser.png`), shown);
    const { foreground } = ssim(shown, native);
    console.log(`${name}: SSIM ${foreground.toFixed(4)} on the silhouettes`);
    if (!(foreground >= kSsim)) below.push(name);
  }
  assert.deepEqual(below, [], `too different; pictures in ${out}`);
  assert.deepEqual(page.troubles, []);
  await page.close();
});

/** Opens the refined hull with this method in its manifest; none: without. Notes fallbacks. */
const openWithMethod = (method) => openRefined(async (page) => {
  await page.route('**/cameras/refined/character.gltf', async (route) => {
    const response = await route.fetch(), gltf = await response.json();
    const { FOURDVT_layered_video_texture: extension } = gltf.extensions;
    if (method) extension.method = method;
    else delete extension.method;
    await route.fulfill({ response, json: gltf });
  });
  await page.addInitScript(() => {
    globalThis.fallbacks = [];
    addEventListener('methodfallback', (e) => globalThis.fallbacks.push(e.detail), true);
  });
});

test('the method of the manifest is drawn unless the page names another, and one that is not known is replaced', async () => {
  const asItIs = async (method) => {
    const { page, outcome } = await openWithMethod(method);
    assert.equal(outcome, 'canplay');
    await showPose(page, kPose);
    return { page, name: await page.$eval('fourdvt-viewer', (viewer) => viewer.method), picture: await readCanvas(page) };
  };
  const own = await asItIs({ name: 'fvvr' });
  assert.equal(own.name, 'fvvr');
  const [fvvr, sweep] = [await show(own.page, 'fvvr'), await show(own.page, 'sweep')];
  assert.deepEqual(own.picture.data, fvvr.data);
  assert.notDeepEqual(own.picture.data, sweep.data);
  assert.equal(await own.page.$eval('fourdvt-viewer', (viewer) => viewer.method), 'sweep');
  assert.deepEqual((await show(own.page, '')).data, fvvr.data, 'the page names none any more');
  assert.deepEqual(await own.page.evaluate(() => globalThis.fallbacks), []);
  await own.page.close();
  for (const method of [undefined, { name: 'of-tomorrow' }, { name: 'sweep', sweepBand: 0.032 }]) {
    const { page, name, picture } = await asItIs(method);
    assert.equal(name, 'sweep', JSON.stringify(method));
    assert.deepEqual(picture.data, sweep.data, JSON.stringify(method));
    const fallbacks = await page.evaluate(() => globalThis.fallbacks.map(({ wanted, drawn }) => [wanted, drawn]));
    assert.deepEqual(fallbacks, method?.name === 'of-tomorrow' ? [['of-tomorrow', 'sweep']] : []);
    assert.deepEqual(page.troubles, []);
    await page.close();
  }
});

test('a device without half-float targets shows the lumigraph and says so', async () => {
  const { page, outcome } = await openRefined((p) => p.addInitScript(() => {
    const isFloat = (name) => /color_buffer_(half_)?float$/i.test(name);
    const { getExtension, getSupportedExtensions } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.getExtension = function (name) { return isFloat(name) ? null : getExtension.call(this, name); };
    WebGL2RenderingContext.prototype.getSupportedExtensions = function () {
      return getSupportedExtensions.call(this).filter((name) => !isFloat(name));
    };
    globalThis.fallbacks = [];
    addEventListener('methodfallback', (e) => globalThis.fallbacks.push({ target: e.target.localName, ...e.detail }), true);
  }));
  assert.equal(outcome, 'canplay');
  await showPose(page, kPose);
  const lumigraph = await show(page, 'lumigraph');
  assert.ok(coverage(lumigraph) > 0.05);
  for (const [name, drawn] of Object.entries(kWithoutHalfFloat)) {
    const fallbacks = await page.evaluate(() => globalThis.fallbacks.splice(0));
    assert.deepEqual(fallbacks, [], `before ${name}`);
    const shown = await show(page, name);
    const [fallback] = await page.evaluate(() => globalThis.fallbacks.splice(0));
    assert.ok(coverage(shown) > 0.05, name);
    assert.equal(fallback?.drawn ?? name, drawn, `${name}: ${JSON.stringify(fallback)}`);
    if (!fallback) continue;
    const message = `this device cannot draw into half-float textures: lumigraph is drawn in place of ${name}`;
    assert.deepEqual(fallback, { target: 'fourdvt-viewer', wanted: name, drawn: 'lumigraph', message });
    assert.deepEqual(shown.data, lumigraph.data, name);
  }
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').method = 'montage4d'; });
  for (const src of ['character/character.gltf', 'character/character.gltf?again']) {
    await page.evaluate((wanted) => {
      globalThis.fallbacks.length = 0;
      document.querySelector('fourdvt-viewer').src = wanted;
    }, src);
    await page.waitForFunction(() => globalThis.fallbacks.length, null, { timeout: kLayeredPatienceMs });
    const [fallback] = await page.evaluate(() => globalThis.fallbacks);
    assert.deepEqual([fallback.wanted, fallback.drawn], ['montage4d', 'layered'], src);
  }
  assert.deepEqual(page.troubles, []);
  await page.close();
});

for (const [device, options] of Object.entries({
  desktop: { viewport: { width: 1280, height: 1000 } },
  phone: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
})) {
  test(`the page of methods on a ${device}: the line moves, methods and surfaces are switched, both show one view`, async () => {
    const out = outputFolder('methods');
    const page = await openPage(browser, options);
    await page.goto(`${server.url}methods.html`);
    const bothPlay = () => page.waitForFunction(() =>
      [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.stats?.framesShown > 1), null, { timeout: kPatienceMs });
    await bothPlay();
    assert.deepEqual(await page.$$eval('#left-method option', (all) => all.map(({ value }) => value).sort()), methodNames().sort());
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the screen');

    const handle = page.locator('#handle');
    const { x, y, width, height } = await handle.boundingBox();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2 - 60, y + height / 2);
    await page.mouse.up();
    const line = () => handle.getAttribute('aria-valuenow').then(Number);
    const dragged = await line();
    assert.ok(dragged < 50 && dragged > 20, `${dragged} %`);
    assert.ok(await handle.evaluate((element) => element === document.activeElement));
    await page.keyboard.press('ArrowRight');
    assert.equal(await line(), dragged + 2);
    await page.keyboard.press('End');
    assert.equal(await line(), 100);
    for (let i = 0; i < 25; ++i) await page.keyboard.press('ArrowLeft');
    assert.match(await handle.getAttribute('aria-valuetext'), /50 % .+ the rest .+/);

    await page.selectOption('#left-method', 'wireframe');
    await page.click('#pairs button:first-child');
    await page.selectOption('#right-method', 'silhouette');
    assert.equal(await page.$eval('#right', (viewer) => viewer.method), 'silhouette');
    if (device === 'desktop') { // nothing of it depends on the device
      await page.click('input[value=refined]');
      await page.waitForFunction(() => [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.src.includes('refined')));
      await bothPlay();
    }

    await page.evaluate(() => document.getElementById('right').setAttribute('camera-orbit', '70deg 10deg 4m'));
    await page.waitForFunction(() => Math.abs(document.getElementById('left').getCameraOrbit().azimuth - 70) < 1, null, { timeout: kPatienceMs });
    await page.click('#play');
    await page.waitForFunction(() => {
      const [left, right] = document.querySelectorAll('fourdvt-viewer');
      return left.paused && right.paused && left.frame === right.frame;
    }, null, { timeout: kPatienceMs });
    await page.$eval('#scrub', (scrub) => { scrub.value = '3'; scrub.dispatchEvent(new Event('input')); });
    await page.waitForFunction(() => [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.frame === 3), null, { timeout: kPatienceMs });
    await page.screenshot({ path: join(out, `page-${device}.png`), fullPage: true });
    const isQuiet = () => page.$eval('#notice', (notice) => notice.hidden);
    assert.ok(await isQuiet());
    await page.$eval('#left', (left) => left.dispatchEvent(new CustomEvent('methodfallback', { detail: { message: 'another is drawn' } })));
    assert.ok(!(await isQuiet()));
    await page.selectOption('#left-method', 'fvvr');
    assert.ok(await isQuiet(), 'another method is chosen');
    assert.deepEqual(page.troubles, []);
    await page.close();
  });
}
