#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Resources that a page holds after long use: ten minutes of playback, 50 viewers in sequence, 200 motion changes, lost
// contexts, a hidden tab.
// node endurance.mjs SITE [--minutes 10] [--loads 50] [--changes 200] [--losses 10] [--hidden-s 120] [--out FILE.json]
// Counted in the page: wasm memory (which never shrinks), its allocated part, JavaScript's heap after a collection,
// live WebGL textures with their bytes, buffers and programs, open video decoders and frames, contexts that are not
// lost.
import { writeFileSync } from 'node:fs';
import { parseArgs } from 'node:util';

import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';

const kPatienceMs = 60_000;
const { values: options, positionals: [site] } = parseArgs({ allowPositionals: true, options: {
  minutes: { type: 'string', default: '10' }, loads: { type: 'string', default: '50' }, changes: { type: 'string', default: '200' },
  losses: { type: 'string', default: '10' }, 'hidden-s': { type: 'string', default: '120' }, out: { type: 'string' },
} });
if (!site) {
  console.error('usage: endurance.mjs SITE [options]');
  process.exit(2);
}

// Runs in the page before its scripts. Objects of a lost context count as released.
function count() {
  const held = (globalThis.held = { decoders: 0, frames: new Set(), memories: [], contexts: [] });
  const known = new WeakMap();
  const bytesOf = { 0x8058: 4, 0x8229: 1, 0x822b: 2, 0x8814: 16, 0x881a: 8, 0x8815: 12, 0x8c41: 3, 0x8c43: 4, 0x822e: 4, 0x8230: 8, 0x8051: 3, 0x88f0: 4, 0x81a6: 4, 0x8cac: 4 };
  const original = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, wanted) {
    const gl = original.call(this, kind, wanted);
    if (!gl || kind !== 'webgl2' || known.has(gl)) return gl;
    const alive = { gl: new WeakRef(gl), textures: new Map(), buffers: new Set(), programs: new Set() };
    known.set(gl, alive);
    held.contexts.push(alive);
    const clear = () => { for (const kept of [alive.textures, alive.buffers, alive.programs]) kept.clear(); };
    this.addEventListener('webglcontextlost', clear, true);
    for (const [name, kept] of [['Buffer', alive.buffers], ['Program', alive.programs], ['Texture', alive.textures]]) {
      const make = gl[`create${name}`].bind(gl), free = gl[`delete${name}`].bind(gl);
      gl[`create${name}`] = () => {
        const made = make();
        if (kept instanceof Map) kept.set(made, 0);
        else kept.add(made);
        return made;
      };
      gl[`delete${name}`] = (one) => { kept.delete(one); free(one); };
    }
    let bound = null;
    const bind = gl.bindTexture.bind(gl);
    gl.bindTexture = (target, texture) => { bound = texture; bind(target, texture); };
    const storage = gl.texStorage2D.bind(gl), storage3 = gl.texStorage3D.bind(gl);
    gl.texStorage2D = (target, levels, format, w, h) => { if (bound) alive.textures.set(bound, w * h * (bytesOf[format] ?? 4) * (levels > 1 ? 4 / 3 : 1)); storage(target, levels, format, w, h); };
    gl.texStorage3D = (target, levels, format, w, h, d) => { if (bound) alive.textures.set(bound, w * h * d * (bytesOf[format] ?? 4)); storage3(target, levels, format, w, h, d); };
    const image = gl.texImage2D.bind(gl);
    gl.texImage2D = (...words) => { // mutable ones: pictures of four channels
      if (bound && words.length >= 9) alive.textures.set(bound, words[3] * words[4] * 4);
      image(...words);
    };
    return gl;
  };
  if (globalThis.VideoDecoder) {
    globalThis.VideoDecoder = class extends VideoDecoder {
      #open = true;
      constructor({ output, error }) {
        super({ output: (frame) => { held.frames.add(frame); const close = frame.close.bind(frame); frame.close = () => { held.frames.delete(frame); close(); }; output(frame); },
          error: (reason) => { this.#end(); error(reason); } });
        held.decoders += 1;
      }
      #end() { if (this.#open) held.decoders -= 1; this.#open = false; }
      close() { this.#end(); super.close(); }
    };
  }
  const seen = new WeakSet(), note = (instance) => {
    const memory = Object.values(instance.exports).find((value) => value instanceof WebAssembly.Memory);
    if (memory && !seen.has(memory)) seen.add(memory), held.memories.push(new WeakRef(memory));
  };
  for (const name of ['instantiate', 'instantiateStreaming']) {
    const make = WebAssembly[name].bind(WebAssembly);
    WebAssembly[name] = async (...words) => {
      const made = await make(...words);
      note(made.instance ?? made);
      return made;
    };
  }
}

const html = `<!doctype html><meta charset="utf-8"><title>endurance</title><link rel="icon" href="data:,">
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script><body></body>`;
const page_path = '/endurance.html';
const server = await serve(site, 0, { pages: { [page_path]: { html } } });
const browser = await launch();
const context = await browser.newContext({ viewport: { width: 390, height: 600 } }), page = await context.newPage();
const cdp = await context.newCDPSession(page), errors = [];
page.on('pageerror', (error) => errors.push(error.message));
await page.addInitScript(count);
await page.goto(new URL(page_path, server.url).href);

const rows = [];
async function sample(title) {
  for (let i = 0; i < 2; ++i) await cdp.send('HeapProfiler.collectGarbage');
  const { usedSize } = await cdp.send('Runtime.getHeapUsage');
  const row = await page.evaluate(() => {
    const alive = held.contexts.filter(({ gl }) => gl.deref() && !gl.deref().isContextLost()), sum = (of) => alive.reduce((total, one) => total + of(one), 0);
    return { wasm: held.memories.reduce((total, one) => total + (one.deref()?.buffer.byteLength ?? 0), 0), textures: sum((one) => one.textures.size), texture_bytes: sum((one) => [...one.textures.values()].reduce((a, b) => a + b, 0)),
      buffers: sum((one) => one.buffers.size), programs: sum((one) => one.programs.size), contexts: alive.length, decoders: held.decoders, frames: held.frames.size,
      in_use: document.querySelector('fourdvt-viewer')?.stats?.heapBytes ?? 0, shown: document.querySelector('fourdvt-viewer')?.stats?.framesShown ?? 0, mismatches: document.querySelector('fourdvt-viewer')?.stats?.barcodeMismatches ?? 0 };
  });
  rows.push({ title, heap: usedSize, ...row });
  console.log(`${title.padEnd(34)} wasm ${(row.wasm / 1e6).toFixed(1)} MB (${(row.in_use / 1e6).toFixed(2)} in use), heap ${(usedSize / 1e6).toFixed(2)} MB, textures ${row.textures} (${(row.texture_bytes / 1e6).toFixed(1)} MB), buffers ${row.buffers}, programs ${row.programs}, contexts ${row.contexts}, decoders ${row.decoders}, frames ${row.frames}, shown ${row.shown}, mismatches ${row.mismatches}`);
}

const shown = (more = 5) => page.evaluate(({ more, patience }) => new Promise((done, fail) => {
  const viewer = document.querySelector('fourdvt-viewer'), from = viewer.stats?.framesShown ?? 0, end = performance.now() + patience;
  const look = () => {
    if ((viewer.stats?.framesShown ?? 0) >= from + more) done();
    else if (performance.now() > end) fail(new Error('no picture comes'));
    else setTimeout(look, 30);
  };
  look();
}), { more, patience: kPatienceMs });
const open = () => page.evaluate(() => {
  const viewer = document.createElement('fourdvt-viewer');
  Object.assign(viewer, { autoplay: true, loop: true, src: 'character/character.gltf' });
  viewer.style.cssText = 'display: block; width: 195px; height: 260px';
  document.body.append(viewer);
});
const close = () => page.evaluate(() => document.querySelector('fourdvt-viewer').remove());
const settle = () => page.waitForTimeout(1000);
// Repeats `action`; the first row follows after a fifth of `times`, because caches fill at first.
async function often(times, title, action, rest) {
  for (let i = 0; i < times; ++i) {
    await action(i);
    if (i + 1 !== times && i + 1 !== Math.round(times / 5)) continue;
    await rest();
    await sample(`after ${i + 1} ${title}`);
  }
}

try {
  await sample('an empty page');
  await open(); await shown(20); await close(); await settle();
  await sample('after the first viewer');
  await often(Number(options.loads), 'more viewers', async () => { await open(); await shown(3); await close(); }, settle);
  await open(); await shown(60);
  const motions = await page.evaluate(() => document.querySelector('fourdvt-viewer').sequences.map((s) => s.name ?? s));
  const change = async (i) => { await page.evaluate((name) => { document.querySelector('fourdvt-viewer').sequence = name; }, motions[i % motions.length]); await shown(3); };
  for (let i = 0; i < 2 * motions.length; ++i) await change(i);
  await change(0); await shown(30);
  await sample('playing, every motion seen');
  await often(Number(options.changes), 'motion changes', change, async () => { await change(0); await shown(30); });
  const lose = () => page.evaluate(async () => {
    const root = document.querySelector('fourdvt-viewer').shadowRoot, gl = root.querySelector('canvas').getContext('webgl2'), extension = gl.getExtension('WEBGL_lose_context');
    extension.loseContext();
    await new Promise((done) => setTimeout(done, 200));
    try { extension.restoreContext(); } catch { /* the viewer has taken another canvas */ }
  });
  for (let i = 0; i < Number(options.losses); ++i) { await lose(); await settle(); await shown(5); }
  await shown(30);
  await sample(`after ${options.losses} lost contexts`);
  const hide = (hidden) => page.evaluate((value) => {
    for (const [name, got] of [['hidden', value], ['visibilityState', value ? 'hidden' : 'visible']]) Object.defineProperty(document, name, { value: got, configurable: true });
    document.dispatchEvent(new Event('visibilitychange'));
  }, hidden);
  await hide(true);
  await page.waitForTimeout(1000 * Number(options['hidden-s']));
  await sample(`hidden for ${options['hidden-s']} s`);
  await hide(false); await shown(30);
  await sample('seen again');
  for (let minute = 1; minute <= Number(options.minutes); ++minute) {
    await page.waitForTimeout(60_000);
    if (minute === 1 || minute === Number(options.minutes)) await sample(`after ${minute} min of play`);
  }
  await close(); await settle();
  await sample('after the last viewer');
  if (errors.length) console.log(`errors: ${errors.join('; ')}`);
  if (options.out) writeFileSync(options.out, `${JSON.stringify(rows, null, 1)}\n`);
} finally {
  await browser.close();
  await server.close();
}
