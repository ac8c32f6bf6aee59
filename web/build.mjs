// SPDX-License-Identifier: Apache-2.0
// Builds dist/ from src/, the list of the ABI (wasm/abi.txt) and the wasm modules: the player (an ES module, its .wasm
// and its types), and what a page fetches only when it needs optical flow or characters from cameras. Prints the sizes; the budget is for what
// every visitor downloads.
//   node build.mjs [--wasm FOLDER: the build of wasm/, default build/wasm/wasm]
//                  [--opencv FOLDER with fourdvt-opencv.js and .wasm, default opencv/ in there] [--out FOLDER]
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readFileSync, rmSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

import { writeTypeScript } from '../wasm/abi.mjs';

const BUDGET_GZIP_BYTES = 150_000;
const here = dirname(fileURLToPath(import.meta.url));

function option(name, fallback) {
  const at = process.argv.indexOf(name);
  return resolve(at > 0 && process.argv[at + 1] ? process.argv[at + 1] : fallback);
}

const wasmFolder = option('--wasm', join(here, '../build/wasm/wasm'));
const opencvFolder = option('--opencv', join(wasmFolder, 'opencv'));
const out = option('--out', join(here, 'dist'));
const hasOpencv = existsSync(join(opencvFolder, 'fourdvt-opencv.js'));
function fail(message) {
  console.error(`build.mjs: ${message}`);
  process.exit(1);
}
for (const name of ['abi.ts', 'fourdvt.js', 'fourdvt.wasm', 'fourdvt-full.js', 'fourdvt-full.wasm']) {
  if (existsSync(join(wasmFolder, name))) continue;
  fail(`${join(wasmFolder, name)} is missing: build the CMake preset wasm first, or name its folder with --wasm`);
}
if (process.argv.includes('--opencv') && !hasOpencv) {
  fail(`${join(opencvFolder, 'fourdvt-opencv.js')} is missing: build the CMake preset wasm with OPENCV_WASM_DIR`);
}
const abi = join(here, 'src/generated/abi.ts');
writeTypeScript(abi);
if (!readFileSync(abi).equals(readFileSync(join(wasmFolder, 'abi.ts')))) {
  fail(`the modules in ${wasmFolder} have another ABI than wasm/abi.txt: build the CMake preset wasm again`);
}

function bundle(entry, outfile, more = {}) {
  return build({
    entryPoints: [entry],
    outfile: join(out, outfile),
    bundle: true,
    minify: true,
    format: 'esm',
    target: ['es2022', 'chrome94', 'safari16.4', 'firefox130'],
    banner: { js: `/*! ${outfile.replace('.js', '')}, Apache-2.0 */` },
    legalComments: 'none',
    logLevel: 'warning',
    ...more,
  });
}

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
await bundle(join(here, 'src/fourdvt-viewer.ts'), 'fourdvt-viewer.js', { alias: { 'fourdvt-wasm': join(wasmFolder, 'fourdvt.js') } });
copyFileSync(join(wasmFolder, 'fourdvt.wasm'), join(out, 'fourdvt-viewer.wasm'));
const extras = [[wasmFolder, 'fourdvt-full'], ...(hasOpencv ? [[opencvFolder, 'fourdvt-opencv']] : [])];
for (const [folder, name] of extras) {
  const script = join(folder, `${name}.js`);
  const full = name === 'fourdvt-full';
  await bundle(full ? join(here, 'src/full.ts') : script, `${name}.js`, full ? { alias: { 'fourdvt-wasm': script } } : {});
  copyFileSync(join(folder, `${name}.wasm`), join(out, `${name}.wasm`));
}
execFileSync(process.execPath, [join(here, 'node_modules/typescript/bin/tsc'), '-p', here, '--emitDeclarationOnly',
  '--outDir', join(out, 'types')], { stdio: 'inherit' });

function printSizes(title, names) {
  let total = 0;
  for (const name of names) {
    const bytes = readFileSync(join(out, name));
    const gzip = gzipSync(bytes, { level: 9 }).length;
    total += gzip;
    console.log(`${name.padEnd(22)} ${String(bytes.length).padStart(8)} bytes, ${String(gzip).padStart(7)} gzip`);
  }
  console.log(`${title.padEnd(22)} ${' '.repeat(8)}        ${String(total).padStart(7)} gzip`);
  return total;
}

const pair = (name) => [`${name}.js`, `${name}.wasm`];
for (const [, name] of extras) printSizes(`on demand: ${name.slice('fourdvt-'.length)}`, pair(name));
const download = printSizes('player download', pair('fourdvt-viewer'));
if (download > BUDGET_GZIP_BYTES) fail(`the player exceeds its budget of ${BUDGET_GZIP_BYTES} bytes by ${download - BUDGET_GZIP_BYTES}`);
console.log(`budget ${BUDGET_GZIP_BYTES}: kept`);
