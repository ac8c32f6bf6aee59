// SPDX-License-Identifier: Apache-2.0
// Packs the player's two parts (split.mjs) for the download, after all optimisation:
// - Functions of the first part that the second calls get a table entry instead of an exported name: the second part
//   imports them by table index (web/src/player/wasm-module.ts).
// - Functions of the first part are sorted by length and type, so that similar ones are adjacent: 2 % less to download.
//   (The second part gains nothing.)
// - Data segments with few zeros between them are merged.
//   node pack.mjs --first FILE.wasm --second FILE.wasm --wasm-dis wasm-dis --wasm-opt wasm-opt
// Replaces both files; keeps function names.
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import {
  FEATURES, functionsOf, KIND, moduleOf, readElements, readExports, readImports, readLimits, readSegments, SECTION, sectionsOf, u32, writeElements, writeExports, writeImports, writeLimits, writeSegments,
} from './binary.mjs';

const FIRST = 'first', MARK = '%'; // names set by split.mjs
const MAX_ZEROS = 256; // maximum between two merged segments; a segment's header does not compress

const find = (sections, id) => sections.find((section) => section.id === id);

/** Sorts the functions of a module's text form by length (`lengths`, by name), then by type. */
export function orderFunctions(text, lengths) {
  const rest = [], functions = [];
  let lines = null, place = 0; // lines of the current function; insertion point for all
  for (const line of text.split('\n')) {
    const [, name, type] = /^ \(func \$(\S+)(.*)/.exec(line) ?? [];
    if (name) {
      if (!functions.length) place = rest.length;
      functions.push({ type: type.replace(/\$\d+ /g, ''), length: lengths.get(name), lines: (lines = []) });
    }
    (lines ?? rest).push(line);
    if (line === ' )') lines = null;
  }
  functions.sort((a, b) => a.length - b.length || (a.type < b.type ? -1 : Number(a.type > b.type)));
  return [...rest.slice(0, place), ...functions.flatMap(({ lines: own }) => own), ...rest.slice(place)].join('\n');
}

// Reorders the file's functions. A text form loses the results of the last two passes, which are repeated.
function order(file, dis, opt) {
  const lengths = new Map(functionsOf(readFileSync(file)).map(({ name, code }) => [name, code.length]));
  const quiet = { maxBuffer: 1 << 28, stdio: ['pipe', 'pipe', 'ignore'] };
  const text = orderFunctions(execFileSync(dis, [file], { encoding: 'utf8', ...quiet }), lengths);
  writeFileSync(`${file}.wat`, text);
  execFileSync(opt, [...FEATURES, '-g', '--generate-stack-ir', '--optimize-stack-ir', `${file}.wat`, '-o', file], quiet);
  rmSync(`${file}.wat`);
}

/** Merges segments with at most this many zeros between them. */
export function joinSegments(segments, zeros = MAX_ZEROS) {
  const joined = [];
  for (const { address, bytes } of [...segments].sort((a, b) => a.address - b.address)) {
    const last = joined.at(-1), gap = last ? address - last.address - last.bytes.length : Infinity;
    if (gap <= zeros) last.bytes = Buffer.concat([last.bytes, Buffer.alloc(gap), bytes]);
    else joined.push({ address, bytes });
  }
  return joined;
}

/** Appends functions to the table: { places: table index by function, elements, size }. */
export function placeFunctions(elements, size, functions) {
  const places = new Map();
  for (const { offset, functions: list } of elements) list.forEach((index, i) => places.has(index) || places.set(index, offset + i));
  const added = [...new Set(functions)].filter((index) => !places.has(index)).sort((a, b) => a - b);
  added.forEach((index, i) => places.set(index, size + i));
  return { places, elements: added.length ? [...elements, { offset: size, functions: added }] : elements, size: size + added.length };
}

/** Packs both parts: [first, second]. */
export function pack(first, second) {
  const [one, two] = [sectionsOf(first), sectionsOf(second)];
  const exported = readExports(find(one, SECTION.exports).bytes);
  const isCalled = ({ name, kind }) => kind === KIND.function && name.startsWith(MARK);
  const table = find(one, SECTION.table), elements = find(one, SECTION.elements), data = find(one, SECTION.data);
  const limits = readLimits(table.bytes, 2); // after table count and type
  const called = exported.filter(isCalled);
  const { places, elements: all, size } = placeFunctions(readElements(elements.bytes), limits.min, called.map(({ index }) => index));
  const grown = { min: size, max: limits.max === null ? null : Math.max(limits.max, size) };
  table.bytes = Buffer.concat([table.bytes.subarray(0, 2), writeLimits(grown)]);
  elements.bytes = writeElements(all);
  find(one, SECTION.exports).bytes = writeExports(exported.filter((entry) => !isCalled(entry)));
  const segments = joinSegments(readSegments(data.bytes)), count = find(one, SECTION.dataCount);
  data.bytes = writeSegments(segments);
  if (count) count.bytes = u32(segments.length);

  const numbers = new Map(called.map(({ name, index }) => [name, String(places.get(index))]));
  const imports = find(two, SECTION.imports);
  imports.bytes = writeImports(readImports(imports.bytes).map((entry) => {
    if (entry.module !== FIRST) return entry;
    if (entry.kind === KIND.table) return { ...entry, type: Buffer.concat([entry.type.subarray(0, 1), writeLimits(grown)]) };
    return { ...entry, name: numbers.get(entry.name) ?? entry.name };
  }));
  return [moduleOf(one), moduleOf(two)];
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const names = ['first', 'second', 'wasm-dis', 'wasm-opt'];
  const { values } = parseArgs({ options: Object.fromEntries(names.map((name) => [name, { type: 'string' }])) });
  try {
    for (const name of names) if (!values[name]) throw new Error(`--${name} is missing`);
    order(values.first, values['wasm-dis'], values['wasm-opt']);
    const [first, second] = pack(readFileSync(values.first), readFileSync(values.second));
    writeFileSync(values.first, first);
    writeFileSync(values.second, second);
  } catch (problem) {
    console.error(`pack.mjs: ${problem.message}`);
    process.exit(1);
  }
}
