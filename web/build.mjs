// SPDX-License-Identifier: Apache-2.0
// Builds dist/ from src/, the list of the ABI (wasm/abi.txt) and the wasm modules: the player (an ES module, its .wasm
// and its types), its second part, which a page loads after the first picture, the worker that decodes geometry, and OpenCV's
// optical flow, which it loads when it is asked for. Prints the sizes and writes them to sizes.json; there is a budget for what comes before the first
// picture and one for the rest.
//   node build.mjs [--wasm FOLDER: the build of wasm/, default build/wasm/wasm]
//                  [--opencv FOLDER with fourdvt-opencv.js and .wasm, default opencv/ in there] [--out FOLDER]
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

import { stampOf, stampWasm, writeTypeScript } from '../wasm/abi.mjs';

const FIRST_GZIP_BYTES = 150_000, MORE_GZIP_BYTES = 260_000;
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
for (const name of ['abi.ts', 'fourdvt.js', 'fourdvt.wasm', 'fourdvt-more.wasm', 'worker/fourdvt-worker.wasm']) {
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

// Emscripten's script defines every export of the module by a function of its own, which its first call replaces by the
// export. A table defines them alike.
function tabulateExports(script) {
  const stub = /var (\w+)=Module\["\1"\]=function\(\)\{return\(\1=Module\["\1"\]=Module\["asm"\]\["([\w$]+)"\]\)\.apply\(null,arguments\)\};/g;
  const isUsed = (name) => script.split(new RegExp(`\\b${name}\\b`)).length > 6; // five times in its own definition
  const names = [];
  const rest = script.replace(stub, (definition, name, short) => {
    if (isUsed(name)) return definition;
    names.push(`${name} ${short}`);
    return '';
  });
  const at = rest.indexOf('var calledRun;');
  if (names.length < 50 || at < 0) fail("Emscripten's script defines its exports in another way than this program reads");
  return `${rest.slice(0, at)}for(const e of "${names}".split(",")){const[n,s]=e.split(" ");Module[n]=(...a)=>(Module[n]=Module["asm"][s])(...a)}${rest.slice(at)}`;
}

// Leaves out how Emscripten's script fetches the module: the page does it.
function leaveOutFetching(script) {
  const cuts = [['var read_,readAsync,', 'var out='], ['var dataURIPrefix=', 'function createWasm('],
    ['function receiveInstantiationResult(', 'if(Module["instantiateWasm"])'], ['instantiateAsync().catch(readyPromiseReject);', 'return{}}']];
  return cuts.reduce((text, [from, to]) => {
    const begin = text.indexOf(from), end = text.indexOf(to, begin);
    if (begin < 0 || end < 0) fail(`Emscripten's script has no ${from} before ${to}`);
    return text.slice(0, begin) + text.slice(end);
  }, script);
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
// Emscripten's script is part of the stamp: it and the module share short names, which differ from build to build.
const stamp = stampOf(...['abi.ts', 'fourdvt.js'].map((name) => readFileSync(join(wasmFolder, name))));
const copyWasm = (from, to) => writeFileSync(join(out, to), stampWasm(readFileSync(from), stamp));
copyWasm(join(wasmFolder, 'fourdvt.wasm'), 'fourdvt-viewer.wasm');
copyWasm(join(wasmFolder, 'fourdvt-more.wasm'), 'fourdvt-more.wasm');
const workerWasm = readFileSync(join(wasmFolder, 'worker/fourdvt-worker.wasm'));
const workerStamp = stampOf(stamp, workerWasm);
writeFileSync(join(out, 'fourdvt-worker.wasm'), stampWasm(workerWasm, workerStamp));
const define = { FOURDVT_WORKER: `"${workerStamp}"` };
await bundle(join(here, 'src/more.ts'), 'fourdvt-more.js', { define });
await bundle(join(here, 'src/geometry-worker.ts'), 'fourdvt-worker.js', { format: 'iife', define });
if (hasOpencv) {
  await bundle(join(opencvFolder, 'fourdvt-opencv.js'), 'fourdvt-opencv.js');
  copyWasm(join(opencvFolder, 'fourdvt-opencv.wasm'), 'fourdvt-opencv.wasm');
}
const version = stampOf(...readdirSync(out).sort().map((name) => readFileSync(join(out, name))));
const script = join(out, 'fourdvt-wasm.js');
writeFileSync(script, leaveOutFetching(tabulateExports(readFileSync(join(wasmFolder, 'fourdvt.js'), 'utf8'))));
await bundle(join(here, 'src/fourdvt-viewer.ts'), 'fourdvt-viewer.js', {
  alias: { 'fourdvt-wasm': script },
  define: { FOURDVT_STAMP: `"${stamp}"`, FOURDVT_VERSION: `"?v=${version}"`, FOURDVT_OPENCV: String(hasOpencv) },
});
rmSync(script);
// Bundlers would take the second part's script for one of theirs; the minifier drops the comments that prevent it.
const viewer = join(out, 'fourdvt-viewer.js'), parts = readFileSync(viewer, 'utf8').split(/(?<=\bimport\()(?=\w+\))/);
if (parts.length !== 2) fail(`${viewer} has ${parts.length - 1} dynamic imports, not one`);
writeFileSync(viewer, parts.join('/* webpackIgnore: true *//* @vite-ignore */'));
// For the page's <head>: begins the downloads before the script asks for them.
writeFileSync(join(out, 'preload.html'), `<link rel="modulepreload" href="fourdvt-viewer/fourdvt-viewer.js">
<link rel="preload" as="fetch" crossorigin href="fourdvt-viewer/fourdvt-viewer.wasm?v=${version}">
<link rel="preload" as="fetch" crossorigin href="character/character.gltf">
<link rel="preload" as="fetch" crossorigin href="character/character.start.bin">
`);
execFileSync(process.execPath, [join(here, 'node_modules/typescript/bin/tsc'), '-p', here, '--emitDeclarationOnly',
  '--outDir', join(out, 'types')], { stdio: 'inherit' });

// A part of the player: files that a page loads at the same time. No limit: null.
function sizesOf(title, names, limit_gzip_bytes) {
  const files = names.map((name) => {
    const bytes = readFileSync(join(out, name));
    return { name, bytes: bytes.length, gzip_bytes: gzipSync(bytes, { level: 9 }).length };
  });
  return { title, files, gzip_bytes: files.reduce((sum, { gzip_bytes }) => sum + gzip_bytes, 0), limit_gzip_bytes };
}

function printSizes({ title, files, gzip_bytes: total }) {
  for (const { name, bytes, gzip_bytes: gzip } of files) console.log(`${name.padEnd(22)} ${String(bytes).padStart(8)} bytes, ${String(gzip).padStart(7)} gzip`);
  console.log(`${title.padEnd(22)} ${' '.repeat(8)}        ${String(total).padStart(7)} gzip`);
}

const pair = (name) => [`${name}.js`, `${name}.wasm`];
const sizes = {
  ...(hasOpencv && { demand: sizesOf('on demand: opencv', pair('fourdvt-opencv'), null) }),
  first: sizesOf('before the first picture', pair('fourdvt-viewer'), FIRST_GZIP_BYTES),
  more: sizesOf('after it', [...pair('fourdvt-more'), ...pair('fourdvt-worker')], MORE_GZIP_BYTES),
};
Object.values(sizes).forEach(printSizes);
writeFileSync(join(out, 'sizes.json'), `${JSON.stringify(sizes, null, 1)}\n`);
for (const [part, what] of [['first', 'what the first picture needs'], ['more', 'what comes after it']]) {
  const over = sizes[part].gzip_bytes - sizes[part].limit_gzip_bytes;
  if (over > 0) fail(`${what} exceeds its budget of ${sizes[part].limit_gzip_bytes} bytes by ${over}`);
}
console.log(`budgets ${FIRST_GZIP_BYTES} and ${MORE_GZIP_BYTES}: kept`);
