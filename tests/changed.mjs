// SPDX-License-Identifier: Apache-2.0
// node tests/changed.mjs [BASE] [--list] [-- CTEST…]: builds and runs the tests that a change can touch; tests/run.sh --changed calls it.
// BASE: a commit; the change is what differs from it in the working tree. Default: HEAD where the tree has changes, else
// HEAD~1. --list prints the plan only; CTEST: arguments of ctest. Needs one whole run of tests/run.sh before it, whose builds it goes on with.
//
// How a file touches a test: by Ninja's graph of the three builds (sources and headers → objects → libraries →
// programs), by the files and folders that a test declares to be for (ctest's REQUIRED_FILES), by the imports of tests/web,
// and by kDerived. Tests of the tree always run. Left to the whole run: what pages and commands do with characters of a
// changed bake, and long tests where a change lies outside of what they are for.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { cpus } from 'node:os';
import { join, posix, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const kRoot = fileURLToPath(new URL('..', import.meta.url));
const kSanitized = ['build/asan', ...(process.arch === 'x64' ? ['build/fuzz32'] : [])];
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

// Paths below the root stay relative to it, others absolute.
const nameOf = (folder, path) => {
  const name = relative(kRoot, resolve(kRoot, folder, path));
  return name.startsWith('..') ? resolve(kRoot, folder, path) : name;
};

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

// Everything that is made from the files, the files included.
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

// A file that no build has read yet counts as every file of its folder: it may be new there.
export function withFolders(files, edges) {
  const inputs = new Set(edges.map(([input]) => input));
  return files.flatMap((file) => {
    if (inputs.has(file) || !/^(native|shaders|wasm|tests)\/.*(\.(cpp|h|frag|vert|glsl|cmake|txt)|CMakeLists\.txt)$/.test(file)) return [file];
    const folder = posix.dirname(file);
    return [file, ...[...inputs].filter((input) => posix.dirname(input) === folder)];
  });
}

// Modules that a JavaScript file imports, itself included; paths relative to the root.
export function modulesOf(file, seen = new Set()) {
  if (seen.has(file) || !existsSync(join(kRoot, file))) return seen;
  seen.add(file);
  for (const found of readFileSync(join(kRoot, file), 'utf8').matchAll(/(?:from |import\()'(\.[^']+)'/g)) {
    modulesOf(posix.join(posix.dirname(file), found[1]), seen);
  }
  return seen;
}

const property = (test, name) => test.properties?.find((p) => p.name === name)?.value;

// Files that a test reads: its program or script with what that imports, and those that it declares.
function inputsOf(test) {
  const words = (test.command ?? []).map((word) => nameOf('.', word));
  const scripts = words.filter((word) => word.endsWith('.mjs')).flatMap((word) => [...modulesOf(word)]);
  const required = [property(test, 'REQUIRED_FILES') ?? []].flat().map((path) => nameOf('.', path));
  return [...words, ...scripts, ...required];
}

export function touchedTests(tests, reached) {
  return tests.filter((test) => {
    const labels = [property(test, 'LABELS') ?? []].flat();
    return labels.includes('tree') || inputsOf(test).some((path) => reached.has(path) || [...reached].some((file) => file.startsWith(`${path}/`)));
  });
}

function run(command, args, options = {}) {
  const done = spawnSync(command, args, { cwd: kRoot, stdio: 'inherit', ...options });
  if (done.status !== 0) process.exit(done.status ?? 1);
}

function fail(message) {
  console.error(`tests/changed.mjs: ${message}`);
  process.exit(2);
}

function readEdges() {
  return kBuilds.flatMap((folder) => {
    const manifest = join(kRoot, folder, 'build.ninja');
    if (!existsSync(manifest)) fail(`${folder} is not built yet; run bash tests/run.sh once`);
    const deps = execFileSync('ninja', ['-C', join(kRoot, folder), '-t', 'deps'], { encoding: 'utf8', maxBuffer: 1 << 30 });
    return edgesOf(readFileSync(manifest, 'utf8'), deps.replace(/^ninja: .*\n/, ''), folder);
  });
}

const ctestJson = () => JSON.parse(execFileSync('ctest', ['--test-dir', join(kRoot, 'build/release'), '--show-only=json-v1'], { encoding: 'utf8', maxBuffer: 1 << 28 })).tests;

// Also brings up to date what an earlier change left behind in the programs and the site of these tests.
function build(tests) {
  const needed = new Set(tests.flatMap(inputsOf));
  const env = { ...process.env, NODE_PATH: '/usr/share/nodejs' };
  for (const folder of ['build/release', ...kSanitized]) {
    const programs = [...needed].filter((path) => path.startsWith(`${folder}/`)).map((path) => path.slice(folder.length + 1));
    if (programs.length) run('cmake', ['--build', folder, '--target', ...programs]);
  }
  if (!tests.some((test) => [property(test, 'LABELS') ?? []].flat().includes('web'))) return;
  run('cmake', ['--build', 'build/wasm'], { env });
  run('node', ['web/build.mjs', '--wasm', join(kRoot, 'build/wasm/wasm')]);
  const cameras = existsSync(join(kRoot, 'build/cameras')) ? ['build/cameras'] : [];
  run('node', ['site/assemble.mjs', 'build/site', 'web/dist', 'build/character', ...cameras]);
}

function main() {
  const all = process.argv.slice(2), words = all.includes('--') ? all.slice(0, all.indexOf('--')) : all;
  const list = words.includes('--list'), further = all.slice(words.length + 1);
  const dirty = git('status', '--porcelain').length > 0;
  const base = words.find((word) => !word.startsWith('-')) ?? (dirty ? 'HEAD' : 'HEAD~1');
  const edges = readEdges();
  const files = changedFiles(base), reached = closure(withFolders(files, edges), edges);
  const tests = touchedTests(ctestJson(), reached);
  console.log(`${files.length} files differ from ${base}; ${tests.length} tests can be touched`);
  if (list) return tests.forEach((test) => console.log(`  ${test.name}`));
  const began = Date.now();
  build(tests);
  console.log(`== Built in ${((Date.now() - began) / 1000).toFixed(0)} s`);
  const names = tests.map((test) => test.name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&'));
  run('ctest', ['--preset', 'release', '-j', String(cpus().length), '-R', `^(${names.join('|')})$`, ...further]);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main();
