// SPDX-License-Identifier: Apache-2.0
// Builds dist/ from src/, the list of the ABI (wasm/abi.txt) and the wasm modules: the player (an ES module, its .wasm
// and its types), its second part, which a page loads after the first picture, the worker that decodes geometry, and
// OpenCV's optical flow, loaded on demand. Prints the sizes and writes them to sizes.json. Sizes have one budget for the
// files before the first picture and one for the rest.
//   node build.mjs [--wasm FOLDER: the build of wasm/, default build/wasm/wasm]
//                  [--opencv FOLDER with fourdvt-opencv.js and .wasm, default opencv/ in there] [--out FOLDER]
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import { bundlePlayer } from './bundle.mjs';

const FIRST_GZIP_BYTES = 150_000, MORE_GZIP_BYTES = 260_000;
const here = dirname(fileURLToPath(import.meta.url));

function option(name, fallback) {
  const at = process.argv.indexOf(name);
  return resolve(at > 0 && process.argv[at + 1] ? process.argv[at + 1] : fallback);
}

const wasmFolder = option('--wasm', join(here, '../build/wasm/wasm'));
const out = option('--out', join(here, 'dist'));
function fail(message) {
  console.error(`build.mjs: ${message}`);
  process.exit(1);
}
const opencvFolder = option('--opencv', join(wasmFolder, 'opencv'));
const hasOpencv = process.argv.includes('--opencv') || existsSync(join(opencvFolder, 'fourdvt-opencv.js'));

await bundlePlayer({ wasmFolder, opencvFolder: hasOpencv ? opencvFolder : undefined, out }).catch((reason) => {
  if (reason.errors) process.exit(1); // esbuild has printed them
  fail(reason.message);
});
execFileSync(process.execPath, [join(here, 'node_modules/typescript/bin/tsc'), '-p', here, '--emitDeclarationOnly',
  '--outDir', join(out, 'types')], { stdio: 'inherit' });

// Sizes of one part of the player, the files that a page loads at the same time. limit_gzip_bytes: null: no limit.
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
