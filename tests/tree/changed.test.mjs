// SPDX-License-Identifier: Apache-2.0
// tests/changed.mjs on a small graph: the results and tests that a file reaches. tests/needed.mjs: builds that tests need,
// and the label that is due.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { closure, edgesOf, touchedTests, withFolders } from '../changed.mjs';
import { modulesOf, neededBy, shareAt } from '../needed.mjs';

const kManifest = `
build liba.a: AR native/a/one.cpp.o $
    native/a/two.cpp.o
build native/a/one.cpp.o: CXX ../../native/a/one.cpp | pch.h || order_only
build native/a/two.cpp.o: CXX ../../native/a/two.cpp
build tests/unit_a: LINK tests/a_test.cpp.o | liba.a
build tests/a_test.cpp.o: CXX ../../tests/unit/a/a_test.cpp
build tests/unit_b: LINK tests/b_test.cpp.o
`;
const kDeps = `native/a/one.cpp.o: #deps 2, deps mtime 1 (VALID)
    ../../native/a/one.cpp
    ../../native/a/one.h

`;
const edges = edgesOf(kManifest, kDeps, 'build/release');

test('a header reaches the programs of the library', () => {
  const reached = closure(['native/a/one.h'], edges);
  for (const path of ['build/release/native/a/one.cpp.o', 'build/release/liba.a', 'build/release/tests/unit_a']) assert.ok(reached.has(path), path);
  assert.ok(!reached.has('build/release/native/a/two.cpp.o') && !reached.has('build/release/tests/unit_b'));
});

test('order-only inputs do not count', () => {
  assert.equal(closure(['build/release/order_only'], edges).size, 1);
});

test('a file that no build has read counts as its folder', () => {
  assert.ok(closure(withFolders(['native/a/new.h'], edges), edges).has('build/release/tests/unit_a'));
  assert.deepEqual(withFolders(['native/b/new.h', 'README.md'], edges), ['native/b/new.h', 'README.md']);
});

test('what is made outside of Ninja is reached, too', () => {
  for (const path of ['web/src/session/session.ts', 'build/wasm/wasm/fourdvt.wasm', 'build/wasm/wasm/fourdvt-more.wasm']) assert.ok(closure([path], edges).has('build/site'), path);
  assert.ok(!closure(['site/docs/where.md'], edges).has('build/site'));
});

test('tests are taken by program, by script with its imports, by declared files; those of the tree always', () => {
  const named = (name, command, labels, files) => ({ name, command, properties: [{ name: 'LABELS', value: labels }, { name: 'REQUIRED_FILES', value: files }] });
  const tests = [named('unit/a', ['build/release/tests/unit_a'], ['unit'], []), named('unit/b', ['build/release/tests/unit_b'], ['unit'], []),
    named('web/x', ['node', '--test', 'tests/web/visit.test.mjs'], ['web'], ['build/site']), named('tree/t', ['bash', 't.sh'], ['tree'], [])];
  const names = (reached) => touchedTests(tests, new Set(reached)).map((t) => t.name);
  assert.deepEqual(names(['build/release/tests/unit_a']), ['unit/a', 'tree/t']);
  assert.deepEqual(names(['build/site']), ['web/x', 'tree/t']);
  assert.deepEqual(names(['tests/web/server.mjs']), ['web/x', 'tree/t']);
  assert.ok(modulesOf('tests/web/visit.test.mjs').has('tests/web/server.mjs'));
});

const labelled = (command, ...labels) => ({ name: command[0], command, properties: [{ name: 'LABELS', value: labels }] });

test('a test needs its programs, by build folder, and the site if a browser opens it', () => {
  const needed = neededBy([labelled(['build/release/tests/unit_a'], 'unit'), labelled(['node', 'tests/fuzz/run.mjs', 'build/asan/tests/fuzz/b_fuzz', 'corpus'], 'fuzz'),
    labelled(['node', '--test', 'x.test.mjs'], 'web', 'web_plain')]);
  assert.deepEqual([...needed].map(([folder, targets]) => [folder, ...targets]), [['build/release', 'tests/unit_a'], ['build/asan', 'tests/fuzz/b_fuzz']]);
  assert.ok(neededBy([labelled(['node', '--test', 'x.test.mjs'], 'web')]).has('site'));
});

test('the shares of long tests take turns, each as often', () => {
  const tests = ['long_b', 'long_a', 'unit', 'long_c'].map((label) => labelled(['x'], 'long', label));
  const turns = Array.from({ length: 6 }, (_, i) => shareAt(3600 * 3 * i, tests));
  assert.deepEqual(turns, ['long_a', 'long_b', 'long_c', 'long_a', 'long_b', 'long_c']);
});
