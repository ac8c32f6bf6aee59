// SPDX-License-Identifier: Apache-2.0
// Bytes that a page copies and uploads per shown picture, and bytes that it holds: counted in the page's calls of
// WebCodecs, WebGL and typed arrays, while the sample's class plays at the end and in the middle of its slider.
import { launch, openPage } from '../../web/harness.mjs';
import { openOnPath, servePlain } from '../../web/play_path.mjs';

// Runs in the page before its scripts. Ignores copies below 64 kB: meshes, messages and records.
function count() {
  const counts = (globalThis.counts = { decoderCopies: 0, heapCopies: 0, uploads: 0, videoUploads: 0, memory: null });
  const copyTo = VideoFrame.prototype.copyTo;
  VideoFrame.prototype.copyTo = function (target, ...rest) {
    counts.decoderCopies += this.allocationSize();
    return copyTo.call(this, target, ...rest);
  };
  const set = Uint8Array.prototype.set;
  Uint8Array.prototype.set = function (from, at) {
    if (from.length >= 65536) counts.heapCopies += from.length;
    return set.call(this, from, at);
  };
  const channels = { 0x1908: 4, 0x1903: 1, 0x8227: 2, 0x8d94: 1 }; // RGBA, RED, RG, RED_INTEGER
  const bytes = { 0x1401: 1, 0x1406: 4, 0x1405: 4 }; // unsigned bytes, floats, unsigned integers
  for (const name of ['texSubImage2D', 'texImage2D']) {
    const original = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...args) {
      const source = args.find((arg) => arg instanceof VideoFrame || arg instanceof HTMLVideoElement);
      if (source) counts.videoUploads += 4 * (source.displayWidth ?? source.videoWidth) * (source.displayHeight ?? source.videoHeight);
      else if (name === 'texSubImage2D' && args.length >= 9) counts.uploads += args[4] * args[5] * (channels[args[6]] ?? 4) * (bytes[args[7]] ?? 1);
      return original.apply(this, args);
    };
  }
  const instantiate = WebAssembly.instantiate;
  WebAssembly.instantiate = async (...args) => {
    const made = await instantiate(...args);
    const instance = made.instance ?? made;
    for (const exported of Object.values(instance.exports)) if (exported instanceof WebAssembly.Memory) counts.memory = exported;
    return made;
  };
}

async function playAt(share, seconds) {
  const viewer = globalThis.viewer, { counts } = globalThis;
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  const [{ name, min, max }] = viewer.parameters;
  viewer.setParameter(name, min + share * (max - min), true);
  await pause(1000);
  const before = { ...counts, shown: viewer.stats.framesShown, checked: viewer.stats.barcodeChecked };
  await pause(1000 * seconds);
  const shown = viewer.stats.framesShown - before.shown;
  const each = (key) => Math.round((counts[key] - before[key]) / shown);
  return { shown, decoded: viewer.stats.barcodeChecked - before.checked, decoderCopies: each('decoderCopies'), heapCopies: each('heapCopies'),
    uploads: each('uploads') + each('videoUploads'), textures: viewer.stats.textureBytes, wasm: counts.memory?.buffer.byteLength ?? 0 };
}

/** Bytes by slider position: per shown picture, and held in memory. quality: the viewer's attribute. */
export async function measureUploads(site, path, quality, seconds = 6) {
  const server = await servePlain(site);
  const browser = await launch();
  try {
    const page = await openPage(browser, { viewport: { width: 240, height: 280 } }, 'auto');
    await page.addInitScript(count);
    // Earlier versions of the player read the path from the tab's session storage.
    await page.addInitScript((path) => { try { sessionStorage.setItem('fourdvt-upload-path', path); } catch { /* none */ } }, path);
    await openOnPath(page, server, path);
    await page.evaluate(async (quality) => {
      const viewer = globalThis.viewer;
      const changed = new Promise((done) => viewer.addEventListener('sequencechange', done, { once: true }));
      viewer.quality = quality;
      viewer.sequence = 'locomotion';
      await changed;
      await viewer.play();
    }, quality);
    return { end: await page.evaluate(`(${playAt})(0, ${seconds})`), middle: await page.evaluate(`(${playAt})(0.5, ${seconds})`) };
  } finally {
    await browser.close();
    await server.close();
  }
}
