// SPDX-License-Identifier: Apache-2.0
// node tests/needed.mjs [CTEST…]: prints what must be built for the tests that these arguments of ctest select: one line
// per build folder with its targets, and "site" if a test opens the site or reads a baked character. build/release must be
// configured.
// node tests/needed.mjs --share SECONDS: prints the label of the long tests due at this time (since 1970); it changes
// every three hours, so that all of them run over some landings.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join, posix, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

export const kRoot = fileURLToPath(new URL('..', import.meta.url));
export const kSanitized = ['build/asan', ...(process.arch === 'x64' ? ['build/fuzz32'] : [])];
const kShareSeconds = 3 * 3600;

// Paths below the root stay relative to it, others absolute.
export const nameOf = (folder, path) => {
  const name = relative(kRoot, resolve(kRoot, folder, path));
  return name.startsWith('..') ? resolve(kRoot, folder, path) : name;
};

// Modules that a JavaScript file imports, itself included; paths relative to the root.
export function modulesOf(file, seen = new Set()) {
  if (seen.has(file) || !existsSync(join(kRoot, file))) return seen;
  seen.add(file);
  for (const found of readFileSync(join(kRoot, file), 'utf8').matchAll(/(?:from |import\()'(\.[^']+)'/g)) {
    modulesOf(posix.join(posix.dirname(file), found[1]), seen);
  }
  return seen;
}

const property = (test, name) => [test.properties?.find((p) => p.name === name)?.value ?? []].flat();
export const labelsOf = (test) => property(test, 'LABELS');

// Returns the files that a test reads: its program or script with all imports, and those that it declares.
export function inputsOf(test) {
  const words = (test.command ?? []).map((word) => nameOf('.', word));
  const scripts = words.filter((word) => word.endsWith('.mjs')).flatMap((word) => [...modulesOf(word)]);
  return [...words, ...scripts, ...property(test, 'REQUIRED_FILES').map((path) => nameOf('.', path))];
}

export const readTests = (args = []) => JSON.parse(execFileSync('ctest', ['--test-dir', join(kRoot, 'build/release'), '--show-only=json-v1', ...args],
  { encoding: 'utf8', maxBuffer: 1 << 28 })).tests;

/** Returns targets by build folder, also for tests that are not built yet; "site" has no targets. */
export function neededBy(tests) {
  const needed = new Map();
  for (const test of tests) {
    for (const path of inputsOf(test)) {
      const folder = ['build/release', ...kSanitized].find((name) => path.startsWith(`${name}/`));
      if (folder) needed.set(folder, (needed.get(folder) ?? new Set()).add(path.slice(folder.length + 1)));
    }
    if (labelsOf(test).includes('web') && !labelsOf(test).includes('web_plain')) needed.set('site', new Set());
  }
  return needed;
}

/** Returns the due label among those that begin with long_. */
export function shareAt(seconds, tests) {
  const labels = [...new Set(tests.flatMap(labelsOf))].filter((label) => label.startsWith('long_')).sort();
  return labels[Math.floor(seconds / kShareSeconds) % labels.length];
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const args = process.argv.slice(2);
  if (args[0] === '--share') console.log(shareAt(Number(args[1]), readTests()));
  else for (const [folder, targets] of neededBy(readTests(args))) console.log([folder, ...targets].join(' '));
}
