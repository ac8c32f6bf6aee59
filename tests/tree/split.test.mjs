// SPDX-License-Identifier: Apache-2.0
// Parts of wasm/split.mjs that need no build: which functions and which texts go into the player's second part.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { callGraph, chooseFunctions, cutTexts } from '../../wasm/split.mjs';

test('marked texts are cut out with their closing 0, and what lies between them stays at its address', () => {
  const bytes = Buffer.from('ab\0//m\nX\0//m\nYY\0cd\0//m\nZ\0', 'latin1');
  const { kept, moved } = cutTexts([{ address: 100, bytes }, { address: 300, bytes: Buffer.from('e') }], '//m\n');
  const shown = (segments) => segments.map(({ address, bytes: part }) => [address, part.toString('latin1')]);
  assert.deepEqual(shown(kept), [[100, 'ab\0'], [116, 'cd\0'], [300, 'e']]);
  assert.deepEqual(shown(moved), [[103, '//m\nX\0//m\nYY\0'], [119, '//m\nZ\0']]);
});

test('calls, table, exports and references are read from the text form', () => {
  const { callers, pinned } = callGraph([
    ' (elem (i32.const 1) $a $b)', ' (export "x" (func $c))',
    ' (func $c (param $0 i32)', '  (call $d', '   (ref.func $e)', '  )', ' )', ' (func $d', '  (return_call $f)', ' )'].join('\n'));
  assert.deepEqual([...pinned].sort(), ['a', 'b', 'c', 'e']);
  assert.deepEqual([...callers.get('d')], ['c']);
  assert.deepEqual([...callers.get('f')], ['d']);
});

test('functions go by their sources; one that may stand for another goes with all its callers only', () => {
  const big = 1000;
  const bytes = new Map([['more', big], ['more.1', big], ['both', big], ['kept', big], ['small', 10], ['template', big], ['shared', big], ['helper', big],
    ['exported', big], ['core', big]]);
  const callers = new Map(Object.entries({ small: ['more'], template: ['more', 'core'], shared: ['more', 'core'], helper: ['template2', 'more'], core: ['exported'] })
    .map(([name, list]) => [name, new Set(list)]));
  callers.set('helper', new Set(['more', 'small']));
  const symbols = (plain, shared = []) => ({ plain: new Set(plain), shared: new Set(shared) });
  const chosen = chooseFunctions({ bytes, callers, pinned: new Set(['exported', 'more', 'both', 'kept']) },
    symbols(['core', 'both', 'exported']), symbols(['more', 'both', 'kept', 'small'], ['template']), new Set(['kept']));
  assert.deepEqual(chosen.sort(), ['helper', 'more', 'more.1', 'small']);
});
