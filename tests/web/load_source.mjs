// SPDX-License-Identifier: Apache-2.0
// Loads parts of the element without a browser, from a bundle of the source that is removed when the process ends.
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { requireFromWeb } from './harness.mjs';

const { buildSync } = requireFromWeb('esbuild');
const folder = mkdtempSync(join(tmpdir(), 'fourdvt-source-'));
const kNoPlayer = join(folder, 'no-player.mjs');
writeFileSync(kNoPlayer, 'export default () => { throw new Error("the player is not part of this"); };\n');
writeFileSync(join(folder, 'package.json'), '{"type": "module"}'); // .js files here are modules, also for Node 18
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

/** The module of web/src/NAME.ts. NAME?WORD: a copy of its own. */
export async function load(source) {
  const [name] = source.split('?');
  const outfile = join(folder, `${encodeURIComponent(source)}.mjs`);
  const entry = fileURLToPath(new URL(`../../web/src/${name}.ts`, import.meta.url));
  buildSync({ entryPoints: [entry], outfile, bundle: true, format: 'esm', logLevel: 'silent' });
  return import(pathToFileURL(outfile).href);
}

/** Several modules of web/src as one, which share what they import. */
export async function loadTogether(...names) {
  const source = fileURLToPath(new URL('../../web/src/', import.meta.url)), outfile = join(folder, `${encodeURIComponent(names.join('+'))}.mjs`);
  const contents = names.map((name) => `export * from './${name}.ts';`).join('\n');
  // None of them runs the player.
  const define = { FOURDVT_VERSION: '""', FOURDVT_STAMP: '""', FOURDVT_OPENCV: 'true' };
  buildSync({ stdin: { contents, resolveDir: source }, outfile, bundle: true, format: 'esm', logLevel: 'silent', define, alias: { 'fourdvt-wasm': kNoPlayer } });
  return import(pathToFileURL(outfile).href);
}
