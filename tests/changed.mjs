// SPDX-License-Identifier: Apache-2.0
// node tests/changed.mjs [BASE] [--list]: prints the tests that a change can touch, as a regular expression for ctest's -R, or with
// --list a line each; tests/run.sh --changed builds and runs them. BASE: a commit; the change is what differs from it in the
// working tree. Default: HEAD where the tree has changes, else HEAD~1. Needs one whole run of tests/run.sh before it, whose
// builds' graphs it reads.
//
// A file touches a test by Ninja's graph of the three builds (sources and headers → objects → libraries → programs), by
// the files and folders that the test declares (ctest's REQUIRED_FILES), by the imports of tests/web, or by kDerived.
// Tests of the tree always run. Only a whole run tests pages and commands with characters of a changed bake, and runs long
// tests with sanitizers, or long tests whose declared files have not changed.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join, posix } from 'node:path';
import { fileURLToPath } from 'node:url';

import { inputsOf, kRoot, kSanitized, labelsOf, nameOf, readTests } from './needed.mjs';

const kBuilds = ['build/release', ...kSanitized, 'build/wasm'];

// Results that are made outside of Ninja: [regular expression of an input, result].
const kDerived = [
  [/^web\/(src\/|build\.mjs|package)/, 'web/dist'],
  [/^build\/wasm\/wasm\/(opencv\/)?fourdvt[^/]*\.(js|wasm)$/, 'web/dist'],
  [/^web\/dist$/, 'build/site'],
  [/^site\/(?!sample\/|measured\/|docs\/)[^/]+\.(html|js|css|mjs)$/, 'build/site'],
  [/^web\/examples\//, 'build/site'],
  [/^site\/sample\//, 'build/character'],
  [/^site\/cameras\.sh$/, 'build/cameras'],
  [/^build\/(character|cameras)$/, 'build/site'],
];

const git = (...args) => execFileSync('git', args, { cwd: kRoot, encoding: 'utf8' }).split('\n').filter(Boolean);

export function changedFiles(base) {
  return [...new Set([...git('diff', '--name-only', base), ...git('ls-files', '--others', '--exclude-standard')])];
}

// Edges of a build folder, as pairs [input, output]: those of build.ninja, and the headers of the last build.
export function edgesOf(manifest, deps, folder) {
  const edges = [];
  for (const line of manifest.replaceAll('$\n', '').split('\n')) {
    const found = /^build ((?:[^:$]|\$.)+): (\S+)(.*)$/.exec(line);
    if (!found || found[2] === 'RERUN_CMAKE') continue;
    const words = (text) => text.trim().split(/\s+/).filter((word) => word && word !== '|');
    const outputs = words(found[1]), inputs = words(found[3].split(' || ')[0]);
    for (const input of inputs) for (const output of outputs) edges.push([nameOf(folder, input), nameOf(folder, output)]);
  }
  let object = '';
  for (const line of deps.split('\n')) {
    if (line.startsWith(' ')) edges.push([nameOf(folder, line.trim()), object]);
    else object = nameOf(folder, line.split(': #deps')[0]);
  }
  return edges;
}

// Returns all results that depend on the files, and the files themselves.
export function closure(files, edges, derived = kDerived) {
  const outputs = new Map();
  for (const [input, output] of edges) outputs.set(input, [...(outputs.get(input) ?? []), output]);
  const reached = new Set(files), open = [...files];
  while (open.length) {
    const path = open.pop();
    const next = [...(outputs.get(path) ?? []), ...derived.filter(([from]) => from.test(path)).map(([, to]) => to)];
    for (const output of next) if (!reached.has(output)) reached.add(output), open.push(output);
  }
  return reached;
}

// Replaces a file that no build has read yet, perhaps a new one, by all files of its folder.
export function withFolders(files, edges) {
  const inputs = new Set(edges.map(([input]) => input));
  return files.flatMap((file) => {
    if (inputs.has(file) || !/^(native|shaders|wasm|tests)\/.*(\.(cpp|h|frag|vert|glsl|cmake|txt)|CMakeLists\.txt)$/.test(file)) return [file];
    const folder = posix.dirname(file);
    return [file, ...[...inputs].filter((input) => posix.dirname(input) === folder)];
  });
}

export function touchedTests(tests, reached) {
  return tests.filter((test) => {
    return labelsOf(test).includes('tree') || inputsOf(test).some((path) => reached.has(path) || [...reached].some((file) => file.startsWith(`${path}/`)));
  });
}

function fail(message) {
  console.error(`tests/changed.mjs: ${message}`);
  process.exit(2);
}

function readEdges() {
  return kBuilds.flatMap((folder) => {
    const manifest = join(kRoot, folder, 'build.ninja');
    if (folder === 'build/fuzz32' && !existsSync(manifest)) return [];  // only long tests use it
    if (!existsSync(manifest)) fail(`${folder} is not built yet; run bash tests/run.sh once`);
    const deps = execFileSync('ninja', ['-C', join(kRoot, folder), '-t', 'deps'], { encoding: 'utf8', maxBuffer: 1 << 30 });
    return edgesOf(readFileSync(manifest, 'utf8'), deps.replace(/^ninja: .*\n/, ''), folder);
  });
}

function main() {
  const words = process.argv.slice(2), list = words.includes('--list');
  const base = words.find((word) => !word.startsWith('-')) ?? (git('status', '--porcelain').length ? 'HEAD' : 'HEAD~1');
  const edges = readEdges();
  const files = changedFiles(base), reached = closure(withFolders(files, edges), edges);
  const isLeft = (test) => labelsOf(test).includes('long') && inputsOf(test).some((path) => kSanitized.some((folder) => path.startsWith(folder)));
  const tests = touchedTests(readTests(), reached).filter((test) => !isLeft(test));
  console.error(`${files.length} files differ from ${base}; ${tests.length} tests can be touched`);
  if (list) return tests.forEach((test) => console.log(`  ${test.name}`));
  console.log(`^(${tests.map((test) => test.name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')).join('|')})$`);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main();
