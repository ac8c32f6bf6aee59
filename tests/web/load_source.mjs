// SPDX-License-Identifier: Apache-2.0
// Parts of the element without a browser: bundled from source, and gone when the process ends.
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { requireFromWeb } from './harness.mjs';

const { buildSync } = requireFromWeb('esbuild');
const folder = mkdtempSync(join(tmpdir(), 'fourdvt-source-'));
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
