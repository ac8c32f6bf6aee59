// SPDX-License-Identifier: Apache-2.0
// The list of the C ABI and the code generated from it: offsets, readers and writers; a field or function on one side
// only is refused by a compiler or by the build.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { cppHeader, exportList, parseAbi, stampOf, stampWasm, typeScript } from '../../wasm/abi.mjs';
import { requireFromWeb } from './harness.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kList = readFileSync(join(kRoot, 'wasm/abi.txt'), 'utf8');
const kSmall = `
enum colour: red dark-blue
record inner
  bool on
  text name
record outer
  colour paint
  f64 size_m
  inner part
  i32 count
  f64[2] pair
  bytes data
record given
  colour paint
  f64[3] at
module player
outer fdvt_look(handle h, given wanted, text name)
module other
void fdvt_run(f64 time_s)
`;

let folder;
before(() => { folder = mkdtempSync(join(tmpdir(), 'fourdvt-abi-')); });
after(() => rmSync(folder, { recursive: true, force: true }));

// Writes the TypeScript module of a list, beside records.ts as in web/src.
function writePage(name, list) {
  const page = join(folder, name);
  mkdirSync(join(page, 'generated'), { recursive: true });
  cpSync(join(kRoot, 'web/src/wasm/records.ts'), join(page, 'records.ts'));
  writeFileSync(join(page, 'generated/abi.ts'), typeScript(parseAbi(list)));
  return page;
}

function compileCpp(header, code) {
  writeFileSync(join(folder, 'abi.h'), header);
  writeFileSync(join(folder, 'use.cpp'), `#include "abi.h"\n${code}\n`);
  return spawnSync('em++', ['-std=c++20', '-fsyntax-only', '-Werror=missing-prototypes', 'use.cpp'],
    { cwd: folder, encoding: 'utf8', env: { NODE_PATH: '/usr/share/nodejs', ...process.env } });
}

function compileTypeScript(page, code) {
  writeFileSync(join(page, 'use.ts'), code);
  const tsc = requireFromWeb.resolve('typescript/package.json').replace('package.json', 'bin/tsc');
  return spawnSync(process.execPath, [tsc, '--noEmit', '--strict', '--target', 'ES2022', '--module', 'ESNext',
    '--moduleResolution', 'bundler', 'use.ts'], { cwd: page, encoding: 'utf8' });
}

test('fields lie as in wasm32', () => {
  const { records } = parseAbi(kSmall);
  const fields = [...records.get('outer').fields].map(([field, { offset }]) => [field, offset]);
  assert.deepEqual(Object.fromEntries(fields), { paint: 0, size_m: 8, part: 16, count: 28, pair: 32, data: 48 });
  assert.equal(records.get('outer').size, 56);
  assert.equal(records.get('inner').size, 12);
});

test('the compiler lays the real records out at the same offsets', () => {
  const { status, stderr } = compileCpp(cppHeader(parseAbi(kList)), 'fourdvt::abi::State state;');
  assert.equal(status, 0, stderr);
});

for (const [what, list, complaint] of [
  ['an unknown type', 'record a\n  i33 b', /abi\.txt:2: no type i33/],
  ['a field outside of a record', '  i32 a', /abi\.txt:1: a field outside/],
  ['a name that is there twice', 'record a\n  i32 b\n  i32 b', /abi\.txt:3: b is there twice/],
  ['a parameter without a name', 'module m\nok fdvt_a(handle)', /abi\.txt:2: fdvt_a: no type handle/],
  ['a line that is nothing', 'function a', /abi\.txt:1: neither/],
]) {
  test(`the list is refused: ${what}`, () => assert.throws(() => parseAbi(list), { message: complaint }));
}

test('readers and writers agree with the offsets', async () => {
  const page = writePage('small', kSmall);
  const outfile = join(folder, 'small.mjs');
  const entryPoints = [join(page, 'generated/abi.ts')];
  requireFromWeb('esbuild').buildSync({ entryPoints, outfile, bundle: true, format: 'esm' });
  const { readOuter, bytesOfGiven } = await import(pathToFileURL(outfile).href);
  const memory = new Uint8Array(256);
  const view = new DataView(memory.buffer);
  memory.set(new TextEncoder().encode('née'), 200);
  const integers = [[64, 1], [80, 1], [84, 200], [88, 4], [92, -3], [112, 201], [116, 2]];
  for (const [at, value] of integers) view.setInt32(at, value, true);
  for (const [at, value] of [[72, 1.75], [96, 2.5], [104, -8]]) view.setFloat64(at, value, true);
  assert.deepEqual(readOuter(memory, 64), {
    paint: 'dark-blue', sizeM: 1.75, part: { on: true, name: 'née' }, count: -3, pair: [2.5, -8],
    data: memory.subarray(201, 203),
  });
  const write = (paint) => new DataView(bytesOfGiven({ paint, at: [1, 2, 3] }).buffer);
  const given = write('dark-blue');
  assert.deepEqual([given.byteLength, given.getInt32(0, true), given.getFloat64(24, true)], [32, 1, 3]);
  assert.equal(write('pink').getInt32(0, true), 0, 'an unknown name is written as the first');
});

test('C++ alone: a field, a function, another signature are refused', () => {
  const header = cppHeader(parseAbi(kSmall));
  const define = (parameters) => `const fourdvt::abi::Outer* fdvt_look(${parameters}) { return nullptr; }`;
  const right = 'fourdvt::Instance* h, const fourdvt::abi::Given* wanted, const char* name, uint32_t name_size';
  assert.equal(compileCpp(header, define(right)).status, 0);
  const longer = header.replace('  double size_m', '  double extra = {};\n  double size_m');
  const more = compileCpp(longer, define(right));
  assert.ok(more.status && more.stderr.includes('the page reads Outer at other offsets'), more.stderr);
  const field = compileCpp(header, `${define(right)}\nstatic int extra = fourdvt::abi::Outer().extra;`);
  assert.ok(field.status && field.stderr.includes("no member named 'extra'"), field.stderr);
  const signature = compileCpp(header, define(right.replace('uint32_t name_size', 'double name_size')));
  assert.ok(signature.status, 'another signature is another function, without a declaration');
  const stray = compileCpp(header, 'void fdvt_stray() {}');
  assert.ok(stray.status && stray.stderr.includes('fdvt_stray'), stray.stderr);
});

test('the page alone: a field, a function, another signature are refused', () => {
  const page = writePage('types', kSmall);
  const use = (code) => compileTypeScript(page, `import { readOuter, type PlayerExports } from './generated/abi.js';
    export const use = (player: PlayerExports, memory: Uint8Array) => ${code};`);
  const right = use('readOuter(memory, player._fdvt_look(1, 2, 3, 4)).sizeM');
  assert.equal(right.status, 0, right.stdout);
  assert.match(use('readOuter(memory, player._fdvt_look(1, 2, 3, 4)).extra').stdout, /'extra' does not exist/);
  assert.match(use('player._fdvt_look(1, 2, 3)').stdout, /Expected 4 arguments/);
  assert.match(use('player._fdvt_stray(1)').stdout, /'_fdvt_stray' does not exist/);
  assert.match(use('player._fdvt_run(1)').stdout, /'_fdvt_run' does not exist/, 'a function of another module');
});

test('each module exports its own functions', () => {
  const abi = parseAbi(kSmall);
  assert.equal(exportList(abi, 'player'), '_fdvt_look\n');
  assert.equal(exportList(abi, 'other'), '_fdvt_run\n');
  assert.throws(() => exportList(abi, 'none'), /no module none/);
});

test('a wasm file carries the stamp of the ABI that it was built with', () => {
  const stamp = stampOf(typeScript(parseAbi(kSmall)), 'script');
  assert.match(stamp, /^[0-9a-f]{8}$/);
  assert.notEqual(stampOf(typeScript(parseAbi(kSmall.replace('  bool on\n', ''))), 'script'), stamp);
  assert.notEqual(stampOf(typeScript(parseAbi(kSmall)), 'another script'), stamp);
  const module = new WebAssembly.Module(stampWasm(Uint8Array.of(0, 0x61, 0x73, 0x6d, 1, 0, 0, 0), stamp));
  assert.deepEqual(WebAssembly.Module.customSections(module, 'fourdvt').map((section) => Buffer.from(section).toString()), [stamp]);
});

test('the build refuses modules that were built with another list', () => {
  const modules = join(folder, 'modules');
  mkdirSync(join(modules, 'worker'), { recursive: true });
  const names = ['fourdvt.js', 'fourdvt.wasm', 'fourdvt-more.wasm', 'worker/fourdvt-worker.wasm'];
  for (const name of names) writeFileSync(join(modules, name), '');
  const changed = kList.replace('record state\n', 'record state\n  i32 extra\n');
  assert.notEqual(changed, kList);
  writeFileSync(join(modules, 'abi.ts'), typeScript(parseAbi(changed)));
  const { status, stderr } = spawnSync(process.execPath,
    [join(kRoot, 'web/build.mjs'), '--wasm', modules, '--out', join(folder, 'dist')], { encoding: 'utf8' });
  assert.equal(status, 1);
  assert.match(stderr, /have another ABI than wasm\/abi\.txt: build the CMake preset wasm again\n$/);
});
