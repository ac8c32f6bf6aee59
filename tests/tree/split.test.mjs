// SPDX-License-Identifier: Apache-2.0
// Parts of wasm/split.mjs and wasm/pack.mjs that need no build: selection of functions and texts for the player's second
// part, and packing of both parts.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { joinSegments, orderFunctions, placeFunctions } from '../../wasm/pack.mjs';
import { callGraph, chooseFunctions, cutTexts, cutTextsOf, moveNamed, numbersOf } from '../../wasm/split.mjs';

test('marked texts are cut out with their closing 0, and what lies between them stays at its address', () => {
  const bytes = Buffer.from('ab\0//m\nX\0//m\nYY\0cd\0//m\nZ\0', 'latin1');
  const { kept, moved } = cutTexts([{ address: 100, bytes }, { address: 300, bytes: Buffer.from('e') }], '//m\n');
  const shown = (segments) => segments.map(({ address, bytes: part }) => [address, part.toString('latin1')]);
  assert.deepEqual(shown(kept), [[100, 'ab\0'], [116, 'cd\0'], [300, 'e']]);
  assert.deepEqual(shown(moved), [[103, '//m\nX\0//m\nYY\0'], [119, '//m\nZ\0']]);
});

test('texts go that the second part alone refers to: not by the first, nor by a pointer in the data, nor without a reference', () => {
  const text = (name) => `${name} ${'x'.repeat(30)}\0`, step = text('a').length;
  const pointer = Buffer.alloc(4);
  pointer.writeUInt32LE(1000 + 3 * step);
  const texts = ['a', 'b', 'c', 'd', 'e'].map(text).join('');
  const segments = [{ address: 1000, bytes: Buffer.from(`${texts}short\0`, 'latin1') }, { address: 4000, bytes: pointer }];
  const numbers = new Map([['more', [1000, 1000 + step, 1000 + 2 * step + 5, 1000 + 3 * step, 1000 + 5 * step]], ['core', [1000 + step + 7]]]);
  const { kept, moved } = cutTextsOf(segments, numbers, new Set(['more']));
  assert.deepEqual(moved.map(({ address, bytes }) => [address, bytes.toString('latin1')]), [[1000, text('a')], [1000 + 2 * step, text('c')]]);
  const none = '\0'.repeat(step);
  assert.deepEqual(kept.map(({ address }) => address), [1000, 4000]);
  assert.equal(kept[0].bytes.toString('latin1'), `${none}${text('b')}${none}${text('d')}${text('e')}short\0`);
});

test('short texts go from a row of many; alone they may be numbers', () => {
  const row = Buffer.from(Array.from({ length: 20 }, (_, i) => `u_name_${i + 10}\0`).join(''), 'latin1');
  const segments = [{ address: 1000, bytes: row }, { address: 4000, bytes: Buffer.from('\0\0u_name_9\0\0', 'latin1') }];
  const { moved } = cutTextsOf(segments, new Map([['more', [1000 + 10 * 10, 4002]]]), new Set(['more']));
  assert.deepEqual(moved.map(({ address, bytes }) => [address, bytes.toString('latin1')]), [[1100, 'u_name_20\0']]);
});

test('functions stand by length and type; what is round them stays', () => {
  const named = (name, type = '') => [` (func $${name}${type}`, `  (call $${name})`, ' )'];
  const text = ['(module', ' (memory $0 1)', ...named('a'), ...named('b', ' (param $0 i64)'), ...named('c', ' (param $0 i32)'), ' (export "x" (func $a))', ')'];
  const ordered = orderFunctions(text.join('\n'), new Map([['a', 9], ['b', 3], ['c', 3]])).split('\n');
  assert.deepEqual(ordered, ['(module', ' (memory $0 1)', ...named('c', ' (param $0 i32)'), ...named('b', ' (param $0 i64)'), ...named('a'), ' (export "x" (func $a))', ')']);
});

test('functions get places behind the table, each once, in their order; segments with few zeros between them are one', () => {
  const { places, elements, size } = placeFunctions([{ offset: 1, functions: [7, 3] }], 5, [9, 3, 4, 9]);
  assert.deepEqual([...places], [[7, 1], [3, 2], [4, 5], [9, 6]]);
  assert.deepEqual([elements.at(-1), size], [{ offset: 5, functions: [4, 9] }, 7]);
  const segments = [{ address: 8, bytes: Buffer.from('cd') }, { address: 2, bytes: Buffer.from('ab') }, { address: 15, bytes: Buffer.from('e') }];
  const shown = joinSegments(segments, 4).map(({ address, bytes }) => [address, bytes.toString('latin1')]);
  assert.deepEqual(shown, [[2, 'ab\0\0\0\0cd'], [15, 'e']]);
});

test('numbers in the code are constants and offsets, by function', () => {
  const numbers = numbersOf([' (memory $0 1)', ' (func $a (param $0 i32)', '  (i32.store offset=24', '   (i32.const 1000)', ' )',
    ' (global $g i32 (i32.const 7))', ' (func $b', '  (i32.const 5)', ' )'].join('\n'));
  assert.deepEqual([...numbers], [['a', [24, 1000]], ['b', [5]]]);
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
  const moved = chooseFunctions({ bytes, callers, pinned: new Set(['exported', 'core']) }, symbols(['core', 'exported']), symbols([]), new Set(), ['cor']);
  assert.ok(moved.includes('core') && !moved.includes('exported'));
});

test('functions of the first sources go by their qualified names, with what stands in them, or with their class', () => {
  const first = { plain: new Map([['a', 'f::Ladder::judge(unsigned int, bool) T 0'], ['b', 'f::Ladder::judge(unsigned int, bool)::$_0::operator()() const t 0'],
    ['c', 'f::Ladder::judgeAll() T 0'], ['d', 'f::Steps::take() T 0'], ['e', 'vtable for f::Steps D 0'], ['p', 'f::Pass<&f::Ladder::judge>::call() W 0']]), shared: new Map() };
  const more = { plain: new Map(), shared: new Map() };
  assert.deepEqual(moveNamed(['f::Ladder::judge', 'f::Steps::', 'f::Ladder::jud', 'f::Pass<'], first, more), ['f::Ladder::jud']);
  assert.deepEqual([[...more.plain.keys()], [...first.plain.keys()]], [['a', 'b', 'd', 'p'], ['c', 'e']]);
  const bytes = new Map([['d', 10], ['p', 10], ['judged', 1000]]), callers = new Map([['judged', new Set(['p'])]]);
  assert.deepEqual(chooseFunctions({ bytes, callers, pinned: new Set(['d', 'p']) }, first, more, new Set()), ['p', 'judged'], 'a short one may be an equal one of the first part');
});
