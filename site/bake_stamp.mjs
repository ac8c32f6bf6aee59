// SPDX-License-Identifier: Apache-2.0
// node site/bake_stamp.mjs [FOLDER…]: prints a hash of the sources on which results of these folders of native/ depend
// (default: `bake`): the folders, those that native/layering.txt allows them to include, directly or not, shaders named in
// either, and the command's own files. Not included: the player, other commands and shaders, compiler and libraries.
import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { parseLayering } from './docs/layering.mjs';

const kCommand = ['native/tools/bake_command.cpp', 'native/tools/planned_commands.h', 'native/tools/common_options.cpp'];
const kCode = /(\.(cpp|h|inc)|CMakeLists\.txt)$/;

/** The folders and those below them that native/layering.txt allows, in its order. Errors: a folder that it does not list. */
export function foldersBelow(layering, folders) {
  const { folders: lines } = parseLayering(layering);
  const wanted = new Set(folders), unknown = folders.find((folder) => !lines.some(([name]) => name === folder));
  if (unknown) throw new Error(`native/layering.txt has no folder ${unknown}`);
  for (const [name, allowed] of [...lines].reverse()) if (wanted.has(name)) allowed.forEach((below) => wanted.add(below));
  return lines.map(([name]) => name).filter((name) => wanted.has(name));
}

// Finds the shaders whose names are string literals in the code, and those that they include.
function shadersOf(root, code) {
  const found = new Set();
  const add = (name) => {
    const path = `shaders/gles/${name}`;
    if (found.has(path) || !existsSync(join(root, path))) return;
    found.add(path);
    for (const [, part] of readFileSync(join(root, path), 'utf8').matchAll(/#include "([\w.]+)"/g)) add(part);
  };
  for (const [, name] of code.matchAll(/"(\w+\.(?:vert|frag))"/g)) add(name);
  return [...found].sort();
}

/** Paths of the files that a result of the folders depends on. */
export function sourcesOf(root, folders = ['bake']) {
  const below = foldersBelow(readFileSync(join(root, 'native/layering.txt'), 'utf8'), folders);
  const files = below.flatMap((folder) => readdirSync(join(root, 'native', folder)).filter((name) => kCode.test(name)).sort().map((name) => `native/${folder}/${name}`));
  const command = folders.includes('bake') ? kCommand.filter((path) => existsSync(join(root, path))) : [];
  const code = files.map((path) => readFileSync(join(root, path), 'utf8')).join('\n');
  return [...files, ...command, ...shadersOf(root, code)];
}

export function bakeStamp(root, folders) {
  const hash = createHash('sha256');
  for (const path of sourcesOf(root, folders)) hash.update(`${path}\n`).update(readFileSync(join(root, path)));
  return hash.digest('hex').slice(0, 16);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const folders = process.argv.slice(2);
  console.log(bakeStamp(join(dirname(fileURLToPath(import.meta.url)), '..'), folders.length ? folders : undefined));
}
