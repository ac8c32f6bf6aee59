#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Seconds from saving a shader, TypeScript or C++ file to a changed picture of the front page, in headless Chromium
// under web/develop.mjs; with --whole by a complete build instead: build/wasm, web/build.mjs, site/assemble.mjs,
// reload.
//   node tests/bench/save_to_picture.mjs [--runs 3] [--kinds shader,TypeScript,C++] [--whole] [--site build/site]
// Edits files of this tree so that the picture becomes magenta, and restores them. Needs an assembled site
// (site/demo.sh --prepare), and for C++ build/wasm-dev, which web/develop.mjs builds. --whole assembles build/site
// anew.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { loadavg } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { launch, openPage } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';

const kRoot = resolve(dirname(fileURLToPath(import.meta.url)), '../..'), kPatienceMs = 600_000;
const kEdits = {
  shader: { file: 'shaders/gles/layered_shade.glsl', from: 'o_color = vec4(color, 1.0)', to: 'o_color = vec4(1.0, 0.0, 1.0, 1.0)' },
  TypeScript: { file: 'web/src/player/wasm-player.ts', from: 'bytesOfOptions(options)', to: 'bytesOfOptions({ ...options, background: [1, 0, 1, 1] })' },
  'C++': { file: 'native/render/recipe.cpp', from: '.color = recipe.background', to: '.color = glm::vec4(1, 0, 1, 1)' },
};

const { values: options } = parseArgs({
  options: {
    runs: { type: 'string', default: '3' }, kinds: { type: 'string', default: Object.keys(kEdits).join() },
    whole: { type: 'boolean', default: false }, site: { type: 'string', default: join(kRoot, 'build/site') },
  },
});

// Runs in the page: true if at least a hundredth of the canvas is magenta.
function isMagenta() {
  const viewer = document.querySelector('fourdvt-viewer'), canvas = viewer?.shadowRoot?.querySelector('canvas');
  if (!canvas?.width || !(viewer.stats?.framesShown > 0)) return null;
  const small = new OffscreenCanvas(32, 32), context = small.getContext('2d');
  context.imageSmoothingEnabled = false;
  context.drawImage(canvas, 0, 0, 32, 32);
  const { data } = context.getImageData(0, 0, 32, 32);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += data[i] > 240 && data[i + 1] < 15 && data[i + 2] > 240 && data[i + 3] > 240;
  return count > 10;
}

async function until(page, wanted) {
  for (const began = performance.now(); performance.now() - began < kPatienceMs; ) {
    const seen = await page.evaluate(isMagenta).catch(() => null); // null: it loads
    if (seen === wanted) return;
    await new Promise((next) => setTimeout(next, 20));
  }
  throw new Error(`the picture has not changed after ${kPatienceMs / 1000} s`);
}

function startDeveloping() {
  const child = spawn(process.execPath, [join(kRoot, 'web/develop.mjs'), '--port', '0', '--site', options.site], { stdio: ['ignore', 'pipe', 'inherit'] });
  return new Promise((done, failed) => {
    child.stdout.on('data', (text) => {
      const [url] = /http:\S+/.exec(text) ?? [];
      if (url) done({ url, close: () => child.kill(), rebuild: () => undefined });
    });
    child.on('exit', () => failed(new Error('web/develop.mjs has ended')));
  });
}

async function startWhole() {
  const server = await serve(options.site);
  const run = (command, ...args) => execFileSync(command, args, { cwd: kRoot, stdio: ['ignore', 'ignore', 'inherit'], env: { NODE_PATH: '/usr/share/nodejs', ...process.env } });
  return {
    url: server.url, close: () => server.close(),
    async rebuild(page) {
      run('cmake', '--build', 'build/wasm');
      run(process.execPath, 'web/build.mjs', '--wasm', 'build/wasm/wasm');
      run(process.execPath, 'site/assemble.mjs', options.site, 'web/dist', 'build/character');
      await page.reload();
    },
  };
}

const running = await (options.whole ? startWhole() : startDeveloping());
const browser = await launch();
const page = await openPage(browser, { viewport: { width: 480, height: 640 } });
const open = new Map(); // texts to restore
const restore = () => { for (const [path, text] of open) if (readFileSync(path, 'utf8') !== text) writeFileSync(path, text); };
for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => { restore(); process.exit(1); });
try {
  await page.goto(running.url);
  await until(page, false);
  await new Promise((next) => setTimeout(next, 3000)); // what develop.mjs builds at its start
  for (const kind of options.kinds.split(',')) {
    const { file, from, to } = kEdits[kind], path = join(kRoot, file), text = readFileSync(path, 'utf8');
    if (!text.includes(from)) throw new Error(`${file} does not contain ${from}: adapt kEdits`);
    if (kind === 'C++' && !options.whole && !existsSync(join(kRoot, 'build/wasm-dev/wasm/fourdvt.wasm'))) throw new Error('build/wasm-dev is not built: save a file of native/ under web/develop.mjs once');
    open.set(path, text);
    const seconds = [];
    for (let i = 0; i < Number(options.runs); ++i) {
      const began = performance.now();
      writeFileSync(path, text.replaceAll(from, to));
      await running.rebuild(page);
      await until(page, true);
      seconds.push((performance.now() - began) / 1000);
      writeFileSync(path, text);
      if (!options.whole || i + 1 === Number(options.runs)) await running.rebuild(page);
      if (!options.whole) await until(page, false);
      await new Promise((next) => setTimeout(next, 1500));
    }
    seconds.sort((a, b) => a - b);
    console.log(`${kind.padEnd(10)} ${seconds[Math.floor(seconds.length / 2)].toFixed(2)} s (${seconds[0].toFixed(2)} to ${seconds.at(-1).toFixed(2)}), load ${loadavg()[0].toFixed(1)}`);
  }
} finally {
  restore();
  await browser.close();
  await running.close();
}
