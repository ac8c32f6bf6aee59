// SPDX-License-Identifier: Apache-2.0
// node site/docs/make.mjs [--check]: generates parts of the documents from the code: layering.svg from
// native/layering.txt, tables of errors.md from native/base/result.h, native/base/result.cpp, web/src/report/errors.ts.
// --check writes nothing and exits with 1 if one of the files would change.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { errorTables } from './errors.mjs';
import { layeringPicture } from './layering.mjs';

/** Returns [path, text] of every generated file. */
export function made(root) {
  const read = (path) => readFileSync(join(root, path), 'utf8');
  const tables = errorTables(read('native/base/result.h'), read('native/base/result.cpp'), read('web/src/report/errors.ts'));
  return [
    ['site/docs/layering.svg', layeringPicture(read('native/layering.txt'))],
    ['site/docs/errors.md', read('site/docs/errors.md').replace(/<!-- made:(\w+) -->[\s\S]*?<!-- \/made -->/g,
      (_, name) => `<!-- made:${name} -->\n${tables[name]}\n<!-- /made -->`)],
  ];
}

/** Returns the paths of outdated files; writes them unless `check`. */
export function run(root, check) {
  return made(root).filter(([path, text]) => {
    let old = '';
    try { old = readFileSync(join(root, path), 'utf8'); } catch { /* made for the first time */ }
    if (old !== text && !check) writeFileSync(join(root, path), text);
    return old !== text;
  }).map(([path]) => path);
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [option, ...rest] = process.argv.slice(2);
  if (rest.length || (option && option !== '--check')) {
    console.error('usage: node site/docs/make.mjs [--check]');
    process.exit(2);
  }
  const check = option === '--check';
  const changed = run(fileURLToPath(new URL('../..', import.meta.url)), check);
  for (const path of changed) console.log(check ? `${path} differs from the code; run: node site/docs/make.mjs` : `wrote ${path}`);
  process.exit(check && changed.length ? 1 : 0);
}
