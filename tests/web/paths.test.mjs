// SPDX-License-Identifier: Apache-2.0
// Every upload path of decoded pictures, with VideoDecoder and with a <video> element: pictures are paired with their
// geometry over loops, seeks, renditions, motions and a slider.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { environment, kElsewhere, kPatienceMs, launch, launchFirefox, openPage } from './harness.mjs';
import { kNoWebCodecs, openOnPath, playOnPath, servePlain } from './play_path.mjs';

const kFrames = 40; // and each kind of change once
const viewport = { width: 240, height: 280 };
let server, browser;

before(async () => {
  server = await servePlain(environment('SITE'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const maxRefused = ({ checked }, path) => (path === 'video' ? Math.max(4, checked / 50) : 0);

// Plays, once more if a <video> element had too many pictures refused: a wrong pairing has nearly all refused, each time.
async function play(page, frames, path) {
  const played = await playOnPath(page, frames);
  return path === 'video' && played.mismatches > maxRefused(played, path) ? playOnPath(page, frames) : played;
}

function judge(played, path) {
  assert.equal(played.path, path);
  assert.deepEqual(played.errors, []);
  // Pictures of a <video> element may be refused: another one takes their place while they are copied, on a busy machine
  // more often. None of them is shown. A few count for nothing in a short run.
  assert.ok(played.mismatches <= maxRefused(played, path), `${played.mismatches} pictures of ${played.checked} had no fitting number`);
  assert.ok(played.checked >= played.frames, `${played.checked} of ${played.frames} pictures were checked`);
  assert.ok(played.loops.length > 0, 'no loop was seen');
  console.log(`${path}: ${played.frames} frames, ${played.late} left out`);
}

for (const path of ['rgba', 'rgba-sub', 'video']) {
  test(`Chromium: ${path}`, async () => {
    const page = await openPage(browser, { viewport }, 'auto');
    await openOnPath(page, server, path);
    judge(await play(page, kFrames, path), path);
    assert.deepEqual([...page.troubles, ...page.reported], []);
    await page.close();
  });
}

test('Chromium: a page of plain http plays, without requestVideoFrameCallback', async () => {
  const page = await openPage(browser, { viewport }, 'auto');
  await page.addInitScript(() => { delete HTMLVideoElement.prototype.requestVideoFrameCallback; });
  await openOnPath(page, server, '', kElsewhere);
  assert.equal(await page.evaluate(() => isSecureContext), false);
  judge(await play(page, kFrames / 2, 'video'), 'video');
  await page.close();
});

// Alterations by some browsers, which protect their visitors, of pixels that a page reads back.
function alterReadback(kind) {
  const refuse = () => { if (kind === 'refused') throw new DOMException('not here', 'SecurityError'); };
  const alter = ({ buffer, byteOffset, byteLength }) => {
    const bytes = new Uint8Array(buffer, byteOffset, byteLength);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = kind === 'noise' ? 256 * Math.random() : 0;
  };
  const { copyTo } = VideoFrame.prototype, gl = WebGL2RenderingContext.prototype, { readPixels, getBufferSubData } = gl;
  VideoFrame.prototype.copyTo = async function (to, ...rest) {
    refuse();
    const layout = await copyTo.call(this, to, ...rest);
    alter(to);
    return layout;
  };
  gl.readPixels = function (...rest) {
    refuse();
    readPixels.apply(this, rest);
    if (typeof rest[6] === 'object') alter(rest[6]);
  };
  gl.getBufferSubData = function (target, from, to, at = 0, length = to.length - at) {
    refuse();
    getBufferSubData.call(this, target, from, to, at, length);
    alter(to.subarray(at, at + length));
  };
}

for (const [kind, paths] of [['noise', ['i420', 'rgba', 'video']], ['zeros', ['i420', 'video']], ['refused', ['i420', 'rgba', 'video']]]) {
  for (const path of paths) {
    test(`Chromium: it plays on ${path} where what is read back is ${kind}`, async () => {
      const page = await openPage(browser, { viewport }, 'auto');
      await page.addInitScript(alterReadback, kind);
      await openOnPath(page, server, path);
      await page.waitForFunction(() => globalThis.viewer.stats?.framesShown > 4, null, { timeout: kPatienceMs });
      const { stats, error } = await page.evaluate(() => ({ stats: globalThis.viewer.stats, error: globalThis.viewer.error }));
      assert.equal(stats.uploadPath.replace('-sub', ''), path === 'i420' ? 'rgba' : path);
      assert.deepEqual([stats.barcodeChecked, error, page.reported], [0, null, []]);
      await page.close();
    });
  }
}

test('Chromium: the decoder is freed with the element and where the page is hidden', async () => {
  const page = await openPage(browser, { viewport }, 'auto');
  await page.addInitScript(() => {
    const made = (globalThis.made = []);
    const create = document.createElement;
    document.createElement = function (name, ...rest) {
      const element = create.call(this, name, ...rest);
      if (name === 'video') made.push(element);
      return element;
    };
  });
  await openOnPath(page, server, 'video');
  const alive = () => page.evaluate(() => globalThis.made.filter((video) => video.src).length);
  assert.equal(await alive(), 1);
  await page.evaluate(() => globalThis.viewer.remove());
  assert.equal(await alive(), 0);
  await page.close();
});

test('Chromium: a policy without media-src blob: is named', async () => {
  const page = await openPage(browser, { viewport }, 'auto');
  const strict = await servePlain(environment('SITE'));
  await page.route('**/blank.html', async (route) => {
    const answer = await route.fetch();
    await route.fulfill({ response: answer, headers: { ...answer.headers(), 'content-security-policy': "default-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' data:" } });
  });
  await assert.rejects(openOnPath(page, strict, 'video'), /decoder-unsupported.*media-src blob:/);
  await strict.close();
  await page.close();
});

test('Firefox without WebCodecs', async () => {
  const firefox = await launchFirefox(kNoWebCodecs);
  try {
    const page = await firefox.newPage({ viewport });
    await openOnPath(page, server, '');
    assert.equal(await page.evaluate(() => typeof VideoDecoder), 'undefined');
    judge(await play(page, kFrames, 'video'), 'video');
  } finally {
    await firefox.close();
  }
});
