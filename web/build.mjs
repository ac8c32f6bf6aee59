// SPDX-License-Identifier: Apache-2.0
// src/*.ts + Emscripten's fourdvt.js and fourdvt.wasm → dist/: one ES module, one .wasm, types. Prints download sizes.
//   node build.mjs [--wasm FOLDER with fourdvt.js and fourdvt.wasm] [--out FOLDER]
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readFileSync, rmSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

const BUDGET_GZIP_BYTES = 150_000;
const here = dirname(fileURLToPath(import.meta.url));

function option(name, fallback) {
  const at = process.argv.indexOf(name);
  return resolve(at > 0 && process.argv[at + 1] ? process.argv[at + 1] : fallback);
}

const wasmFolder = option('--wasm', join(here, '../build/wasm/wasm'));
const out = option('--out', join(here, 'dist'));
for (const name of ['fourdvt.js', 'fourdvt.wasm']) {
  if (existsSync(join(wasmFolder, name))) continue;
  console.error(`build.mjs: ${join(wasmFolder, name)} is missing: build the CMake preset wasm first, or name its folder with --wasm`);
  process.exit(1);
}

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
await build({
  entryPoints: [join(here, 'src/fourdvt-viewer.ts')],
  outfile: join(out, 'fourdvt-viewer.js'),
  alias: { 'fourdvt-wasm': join(wasmFolder, 'fourdvt.js') },
  bundle: true,
  minify: true,
  format: 'esm',
  target: ['es2022', 'chrome94', 'safari16.4', 'firefox130'],
  banner: { js: '/*! fourdvt-viewer, Apache-2.0 */' },
  legalComments: 'none',
  logLevel: 'warning',
});
copyFileSync(join(wasmFolder, 'fourdvt.wasm'), join(out, 'fourdvt-viewer.wasm'));
execFileSync(process.execPath, [join(here, 'node_modules/typescript/bin/tsc'), '-p', here, '--emitDeclarationOnly',
  '--outDir', join(out, 'types')], { stdio: 'inherit' });

let total = 0;
for (const name of ['fourdvt-viewer.js', 'fourdvt-viewer.wasm']) {
  const bytes = readFileSync(join(out, name));
  const gzip = gzipSync(bytes, { level: 9 }).length;
  total += gzip;
  console.log(`${name.padEnd(22)} ${String(bytes.length).padStart(8)} bytes, ${String(gzip).padStart(7)} gzip`);
}
console.log(`${'player download'.padEnd(22)} ${' '.repeat(8)}        ${String(total).padStart(7)} gzip (goal ${BUDGET_GZIP_BYTES})`);
