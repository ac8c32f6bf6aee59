// SPDX-License-Identifier: Apache-2.0
// Methods of characters from cameras: native against browser for each, what a device shows that cannot draw into
// half-float textures, and the page with two methods on one view.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openCharacter, openPage, outputFolder, readCanvas, renderNative, showPose, writePicture } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage, ssim } from './ssim.mjs';

const kSsim = 0.98;
// Lines a pixel wide: where two triangles meet, the rasterisers differ in the derivatives that the width comes from.
const kFloors = { wireframe: 0.8 };
const kPose = { sequence: 'run', frame: 5, azimuth: 25, elevation: 8, distance: 4.2 };
const kSize = { width: 360, height: 480 };
const kSettles = 12;          // redraws of a still view after which nothing follows with time any more
const kNeedHalfFloat = ['linear', 'floating', 'floating-pairs', 'floating-static', 'montage4d', 'montage4d-seams', 'montage4d-weights'];

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

const openRefined = (prepare) => openCharacter(browser, server.url, 'cameras/refined/character.gltf', { ...kSize, prepare });

/** Shows the method on the posed view and waits until it has settled. */
async function show(page, name) {
  await page.evaluate(async ({ name, settles }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    let problem = '';
    viewer.addEventListener('error', (e) => { problem ||= e.detail.message; });
    viewer.method = name;
    for (let i = 0; i < settles; ++i) {
      viewer.renderOptions = {}; // asks for another picture
      await new Promise((next) => setTimeout(() => requestAnimationFrame(next), 50));
    }
    if (problem) throw new Error(`${name}: ${problem}`);
  }, { name, settles: name.startsWith('montage4d') ? 2 * kSettles : 3 });
  return readCanvas(page);
}

test('native and browser agree by every method', async () => {
  const out = outputFolder('methods');
  const { page, outcome } = await openRefined();
  assert.equal(outcome, 'canplay');
  await page.waitForFunction(({ width, height }) => {
    const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
    return canvas.width === width && canvas.height === height;
  }, kSize);
  await showPose(page, kPose);
  const below = [];
  for (const name of methodNames()) {
    const shown = await show(page, name);
    writePicture(join(out, `${name}-browser.png`), shown);
    const native = await renderNative(environment('BIN'), join(environment('SITE'), 'cameras', 'refined'), kPose, kSize.width,
      kSize.height, join(out, `${name}-native.png`), ['--method', name]);
    const { foreground } = ssim(shown, native);
    console.log(`${name}: SSIM ${foreground.toFixed(4)} on the silhouettes`);
    if (!(foreground >= (kFloors[name] ?? kSsim))) below.push(name);
  }
  assert.deepEqual(below, [], `too different; pictures in ${out}`);
  assert.deepEqual(page.troubles, []);
  await page.close();
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
  for (const name of methodNames()) {
    const fallbacks = await page.evaluate(() => globalThis.fallbacks.splice(0));
    assert.deepEqual(fallbacks, [], `before ${name}`);
    const shown = await show(page, name);
    const [fallback] = await page.evaluate(() => globalThis.fallbacks.splice(0));
    assert.ok(coverage(shown) > 0.05, name);
    assert.equal(fallback !== undefined, kNeedHalfFloat.includes(name), `${name}: ${JSON.stringify(fallback)}`);
    if (!fallback) continue;
    const message = `this device cannot draw into half-float textures: lumigraph is drawn in place of ${name}`;
    assert.deepEqual(fallback, { target: 'fourdvt-viewer', wanted: name, drawn: 'lumigraph', message });
    assert.deepEqual(shown.data, lumigraph.data, name);
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

    await page.screenshot({ path: join(out, `page-${device}-first.png`), fullPage: true });
    await page.selectOption('#left-method', 'wireframe');
    await page.click('#pairs button:first-child');
    await page.selectOption('#right-method', 'silhouette');
    assert.equal(await page.$eval('#right', (viewer) => viewer.method), 'silhouette');
    await page.click('input[value=refined]');
    await page.waitForFunction(() => [...document.querySelectorAll('fourdvt-viewer')].every((v) => v.src.includes('refined')));
    await bothPlay();

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
    assert.ok(await page.$eval('#notice', (notice) => notice.hidden));
    assert.deepEqual(page.troubles, []);
    await page.close();
  });
}
