// SPDX-License-Identifier: Apache-2.0
// background="room": the sample character in a painted room, as `fourdvt render` draws it; turned on and off, missing,
// damaged, loaded again.
import assert from 'node:assert/strict';
import { cpSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { digits, fnv1a } from './content_hash.mjs';
import { environment, launch, openPage, outputFolder, readCanvas, renderNative, showPose, waitForEvent, writePicture } from './harness.mjs';
import { encodePng } from './png.mjs';
import { serve } from './server.mjs';
import { ssim } from './ssim.mjs';

const kExtension = 'FOURDVT_layered_video_texture';
const kFace = 128, kCell = 144; // texels
const kSsim = 0.99;
const kPatience_ms = 60_000;
const kPoses = [
  { sequence: 'walk', frame: 7, azimuth: 30, elevation: 10, distance: 3.5 },
  { sequence: 'run', frame: 12, azimuth: 200, elevation: 35, distance: 9 }, // from outside
];

// Squares of two colours, other ones on every face.
function paintRoom() {
  const width = 2 * kCell, height = 3 * kCell;
  const data = new Uint8Array(4 * width * height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const face = 2 * Math.floor(y / kCell) + Math.floor(x / kCell), at = 4 * (y * width + x);
      const dark = (Math.floor((x % kCell) / 16) + Math.floor((y % kCell) / 16)) % 2 ? 1 : 0.6;
      data.set([40 + 35 * face, 220 - 30 * face, face % 2 ? 60 : 190].map((level) => level * dark), at);
      data[at + 3] = 255;
    }
  return { width, height, data };
}

function giveRoom(folder, bytes, { width, height }) {
  const file = join(folder, 'character.gltf');
  const gltf = JSON.parse(readFileSync(file, 'utf8'));
  gltf.extensions[kExtension].room = {
    min: [-3, gltf.extensions[kExtension].groundY, -3], max: [3, 3, 3], uri: 'room.png', byteLength: bytes.length,
    hash: digits(fnv1a(bytes)), width, height,
    faces: Array.from({ length: 6 }, (_, f) => [kCell * (f % 2) + 8, kCell * Math.floor(f / 2) + 8, kFace, kFace]),
  };
  writeFileSync(file, JSON.stringify(gltf));
  writeFileSync(join(folder, 'room.png'), bytes);
}

let folder, server, browser, page;
before(async () => {
  folder = outputFolder('room');
  cpSync(join(environment('SITE'), 'fourdvt-viewer'), join(folder, 'fourdvt-viewer'), { recursive: true });
  const picture = paintRoom();
  const bytes = encodePng(picture);
  for (const name of ['plain', 'inside', 'damaged']) {
    cpSync(environment('CHARACTER'), join(folder, name), { recursive: true });
    if (name !== 'plain') giveRoom(join(folder, name), bytes, picture);
  }
  const broken = Buffer.from(bytes);
  broken[bytes.length >> 1] ^= 1;
  writeFileSync(join(folder, 'damaged/room.png'), broken);
  const html = (attributes) => `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
    <style>body { margin: 0 } fourdvt-viewer { width: 480px; height: 640px; }</style>
    <script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script><fourdvt-viewer ${attributes}></fourdvt-viewer>`;
  const pages = {};
  for (const name of ['plain', 'inside', 'damaged'])
    pages[`/${name}.html`] = { html: html(`src="/${name}/character.gltf" background="room"`) };
  server = await serve(folder, 0, { pages });
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

// Runs in the page before its scripts: counts pictures that are decoded and not closed.
function countPictures() {
  globalThis.openPictures = globalThis.decodedPictures = 0;
  const decode = globalThis.createImageBitmap;
  globalThis.createImageBitmap = async (...values) => {
    const picture = await decode(...values);
    ++globalThis.decodedPictures;
    ++globalThis.openPictures;
    return picture;
  };
  const { close } = ImageBitmap.prototype;
  ImageBitmap.prototype.close = function () {
    if (this.width) --globalThis.openPictures;
    close.call(this);
  };
}

async function open(name, event = 'canplay') {
  await page?.close();
  page = await openPage(browser);
  await page.addInitScript(countPictures);
  page.warnings = [];
  page.on('console', (line) => { if (line.type() === 'warning') page.warnings.push(line.text()); });
  await page.goto(new URL(`/${name}.html`, server.url).href);
  await waitForEvent(page, event);
}

// Waits until the top left pixel is opaque, or is not.
async function cornerBecomes(opaque) {
  for (const end = Date.now() + kPatience_ms; ;) {
    const { data } = await readCanvas(page);
    if ((data[3] === 255) === opaque) return;
    assert.ok(Date.now() < end, `the background is ${opaque ? 'not drawn' : 'still drawn'}`);
    await new Promise((done) => setTimeout(done, 100));
  }
}

test('the room is drawn as natively, from inside and from outside', async () => {
  await open('inside');
  await cornerBecomes(true);
  for (const pose of kPoses) {
    await showPose(page, pose);
    const name = `${pose.sequence}-${pose.frame}`;
    const shown = await readCanvas(page);
    writePicture(join(folder, `${name}-browser.png`), shown);
    const native = await renderNative(environment('BIN'), join(folder, 'inside'), pose, shown.width, shown.height,
      join(folder, `${name}-native.png`), ['--background', 'room']);
    const { all } = ssim(shown, native);
    console.log(`${name}: SSIM ${all.toFixed(4)}`);
    assert.ok(all >= kSsim, `SSIM ${all.toFixed(4)} is below ${kSsim}; pictures in ${folder}`);
  }
  assert.deepEqual(page.troubles, []);
});

test('the attribute works at run time, and the room comes again with the character', async () => {
  await open('inside');
  await cornerBecomes(true);
  const set = (value) => page.evaluate((room) => {
    const viewer = document.querySelector('fourdvt-viewer');
    if (room === null) viewer.removeAttribute('background');
    else viewer.setAttribute('background', room);
  }, value);
  await set(null);
  await cornerBecomes(false);
  for (const value of ['room', null, 'room']) await set(value); // faster than it can be loaded
  await cornerBecomes(true);
  await set('sea');
  await cornerBecomes(false);
  await set('room');
  await cornerBecomes(true);
  await page.evaluate(() => document.querySelector('fourdvt-viewer').load());
  await cornerBecomes(false);
  await cornerBecomes(true);
  assert.deepEqual(await page.evaluate(() => [globalThis.decodedPictures > 3, globalThis.openPictures]), [true, 0], 'every picture is closed');
  assert.deepEqual(page.troubles, []);
});

test('a character without a room is shown without one', async () => {
  await open('plain');
  await cornerBecomes(false);
  assert.ok(page.warnings.some((line) => line.includes('has no room')), page.warnings.join());
  assert.deepEqual(page.troubles, []);
  assert.equal(await page.evaluate(() => document.querySelector('fourdvt-viewer').error), null);
});

test('a damaged picture is an error event, and the character is shown without a room', async () => {
  await open('damaged', 'error');
  const error = await page.evaluate(() => globalThis.viewerEvents.find(({ type }) => type === 'error').detail);
  assert.equal(error.id, 'files-differ');
  await showPose(page, kPoses[0]);
  await cornerBecomes(false);
});
