// SPDX-License-Identifier: Apache-2.0
// Splits the linked module in two: a first part with the code for every first picture, and a second part with the rest.
// The second part is instantiated with the exports of the first, the same memory and the same table, and puts its
// functions into that table; until then calls of them reach a function supplied by the page ("placeholder").
//   node split.mjs --module FILE.wasm --objects FOLDER --list more.txt --mark TEXT --nm emnm --wasm-split wasm-split --wasm-dis wasm-dis
//                  --archive FILE.a --more FILE.wasm
// --module is replaced by the first part. It must have its name section with mangled names (--profiling-funcs,
// --no-demangle). Moved functions: by name or by defining object (more.txt), and those of the archive. Moved data:
// texts whose first line is //MARK.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, relative } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { Cursor, FEATURES, functionsOf, moduleOf, readImports, readSegments, SECTION, sectionsOf, u32, writeImports, writeSegments } from './binary.mjs';

const kRoot = fileURLToPath(new URL('..', import.meta.url));
const PLACEHOLDER = 'placeholder';

/** Cuts texts that begin with the mark, including the final 0, out of the segments: { kept, moved }. */
export function cutTexts(segments, mark) {
  const kept = [], moved = [];
  const piece = ({ address, bytes }, from, to) => ({ address: address + from, bytes: bytes.subarray(from, to) });
  for (const segment of segments) {
    let done = 0;
    for (let from = segment.bytes.indexOf(mark); from >= 0; from = segment.bytes.indexOf(mark, done)) {
      const end = segment.bytes.indexOf(0, from), to = end < 0 ? segment.bytes.length : end + 1;
      if (from > done) kept.push(piece(segment, done, from));
      const last = moved.at(-1);
      const adjoins = last && last.from === segment && last.address + last.bytes.length === segment.address + from;
      if (adjoins) last.bytes = segment.bytes.subarray(last.address - segment.address, to);
      else moved.push({ ...piece(segment, from, to), from: segment });
      done = to;
    }
    if (done < segment.bytes.length) kept.push(piece(segment, done));
  }
  return { kept, moved };
}

const kText = 24; // bytes; shorter candidates may be numbers, unless they stand among texts
const kTexts = { count: 16, bytes: 8 }; // minimum run: number of texts, and mean bytes per text

// Null-terminated texts in the segments: { segment, from, to }, including the final 0.
function* textsIn(segments) {
  for (const segment of segments) {
    let row = [];
    const take = function* () {
      const isList = row.length >= kTexts.count && row.at(-1).to - row[0].from >= kTexts.bytes * row.length;
      yield* row.filter(({ from, to }) => isList || to - from > kText);
      row = [];
    };
    for (let from = 0; from < segment.bytes.length; ) {
      const end = segment.bytes.indexOf(0, from), to = end < 0 ? segment.bytes.length : end + 1;
      const text = segment.bytes.subarray(from, to - 1);
      if (end > from && text.every((c) => c === 10 || (c >= 32 && c < 127) || c >= 194)) row.push({ segment, from, to });
      else yield* take();
      from = to;
    }
    yield* take();
  }
}

/**
 * Cuts texts referenced by second-part functions only out of the segments, leaving zeros. numbers: constants in each
 * function's code, by name; chosen: the second part's functions. Conservative: any constant equal to an address counts
 * as a reference.
 */
export function cutTextsOf(segments, numbers, chosen) {
  const taken = [], used = [];
  for (const [name, values] of numbers) (chosen.has(name) ? used : taken).push(...values);
  for (const { bytes } of segments) for (let at = 0; at + 4 <= bytes.length; at++) taken.push(bytes.readUInt32LE(at)); // pointers
  taken.sort((a, b) => a - b), used.sort((a, b) => a - b);
  const refers = (sorted, from, to) => {
    let [low, high] = [0, sorted.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (sorted[middle] < from) low = middle + 1;
      else high = middle;
    }
    return sorted[low] < to;
  };
  const moved = [...textsIn(segments)].filter(({ segment: { address }, from, to }) =>
    refers(used, address + from, address + to) && !refers(taken, address + from, address + to));
  const kept = segments.map(({ address, bytes }) => ({ address, bytes: Buffer.from(bytes) }));
  for (const { segment, from, to } of moved) kept[segments.indexOf(segment)].bytes.fill(0, from, to);
  return { kept, moved: moved.map(({ segment, from, to }) => ({ address: segment.address + from, bytes: segment.bytes.subarray(from, to) })) };
}

// ---- choice of functions ----

function readList(path) {
  const lines = readFileSync(path, 'utf8').split('\n').map((line) => line.replace(/#.*/, '').trim()).filter(Boolean);
  const after = (word) => lines.filter((line) => line.startsWith(`${word} `)).map((line) => line.slice(word.length + 1));
  const sources = lines.filter((line) => !/^(keep|move|function) /.test(line));
  return { keep: new Set(after('keep')), move: after('move'), functions: after('function'), sources };
}

// Source paths, without endings, of a CMake object: "a/b" of "a/CMakeFiles/TARGET.dir/b.cpp.o"; several of
// "a/CMakeFiles/TARGET.dir/Unity/unity_more_cxx.cxx.o", whose source includes them.
function sourcesOf(folder, object) {
  if (!object.endsWith('.cxx.o')) return [object.replace(/CMakeFiles\/[^/]+\.dir\//, '').replace(/\.cpp\.o$/, '')];
  const unity = readFileSync(join(folder, object.replace(/\.o$/, '')), 'utf8');
  return [...unity.matchAll(/#include "(.*)\.cpp"/g)].map(([, path]) => relative(kRoot, path));
}

const kMergedBytes = 100; // shorter functions may have been merged with identical ones

// Symbols by kind, each with its readable name: "plain" functions, and "shared" instances of library templates that any
// source may contain.
function symbolsOf(nm, files) {
  const list = (...more) => execFileSync(nm, ['--defined-only', '--format=posix', ...more, ...files],
    { encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'ignore'] }).split('\n');
  const found = { plain: new Map(), shared: new Map() };
  const readable = list('--demangle');
  list().forEach((line, i) => {
    const [name, type] = line.split(' ');
    if (type) (/^(void |unsigned |bool |int |auto )?(std|glm|fourdvt::Result)\b/.test(readable[i]) ? found.shared : found.plain).set(name, readable[i]);
  });
  return found;
}

/**
 * Moves listed functions from the first part's symbols to the second's: by qualified name ("a::b"), or all of a class
 * ("a::B::") or template ("a::C<"). Template functions only forward a call, as do identical ones: they move however
 * short they are. Returns the names without a match.
 */
export function moveNamed(names, first, more) {
  more.forwards = new Set();
  return names.filter((wanted) => {
    const isTemplate = wanted.endsWith('<'), isNamed = (readable) => readable.startsWith(wanted) && (isTemplate || wanted.endsWith('::') || /^[( ]/.test(readable.slice(wanted.length)));
    const found = [...first.plain].filter(([, readable]) => isNamed(readable));
    for (const [name, readable] of found) {
      first.plain.delete(name), more.plain.set(name, readable);
      if (isTemplate) more.forwards.add(name);
    }
    return !found.length;
  });
}

/** Functions of a module in WebAssembly's text form: callers by name, and functions referenced other than by a call. */
export function callGraph(text) {
  const callers = new Map(), pinned = new Set();
  let current = null;
  for (const line of text.split('\n')) {
    const opened = /^ \(func \$(\S+)/.exec(line);
    if (opened) {
      current = opened[1];
      callers.set(current, callers.get(current) ?? new Set());
    } else if (/^ \((elem|export|start)/.test(line)) {
      for (const [, name] of line.matchAll(/\$([^\s()]+)/g)) pinned.add(name);
    } else {
      for (const [, kind, name] of line.matchAll(/\((call|return_call|ref\.func) \$([^\s()]+)/g)) {
        if (kind === 'ref.func') pinned.add(name);
        else callers.set(name, (callers.get(name) ?? new Set()).add(current));
      }
    }
  }
  return { callers, pinned };
}

/** Constants and offsets in each function of a module in WebAssembly's text form, by function name. */
export function numbersOf(text) {
  const numbers = new Map();
  let current = null;
  for (const line of text.split('\n')) {
    const opened = /^ \(func \$(\S+)/.exec(line);
    if (opened) numbers.set(opened[1], (current = []));
    else if (/^ \(/.test(line)) current = null;
    if (current) for (const [, number] of line.matchAll(/(?:\(i32\.const |offset=)(\d+)/g)) current.push(Number(number));
  }
  return numbers;
}

/**
 * Names of the functions for the second part: those in the list or defined by its sources only, and those called by
 * these only. A short function or a library template may have been merged with an identical one of the first part: it
 * moves only if all its callers do. bytes: length by name. first, more: symbolsOf their objects. keep: names that stay;
 * move: prefixes of names that move.
 */
export function chooseFunctions({ bytes, callers, pinned }, first, more, keep, move = []) {
  // Link-time optimisation appends ".1" to local names that occur in several objects.
  const symbol = (name) => name.replace(/(\.\d+)+$/, '');
  const isFirst = (name) => first.plain.has(name) || first.shared.has(name) || keep.has(name);
  const goes = (name) => (bytes.get(name) >= kMergedBytes || more.forwards?.has(symbol(name))) && (move.some((part) => name.startsWith(part)) || (more.plain.has(symbol(name)) && !isFirst(symbol(name))));
  const names = [...bytes.keys()], chosen = new Set(names.filter((name) => goes(name) || !(pinned.has(name) || keep.has(symbol(name)))));
  for (let changed = true; changed; ) {
    changed = false;
    for (const name of chosen) {
      if (goes(name) || [...(callers.get(name) ?? [])].every((caller) => chosen.has(caller))) continue;
      changed = chosen.delete(name);
    }
  }
  return [...chosen];
}

function chosen(wasm, text, options) {
  const { keep, move, functions, sources } = readList(options.list);
  const files = readdirSync(options.objects, { recursive: true }).filter((path) => /\.c(pp|xx)\.o$/.test(path) && !path.startsWith('tests/'));
  const madeOf = new Map(files.map((file) => [file, sourcesOf(options.objects, file)])), built = [...madeOf.values()].flat();
  const goes = (path) => sources.some((source) => (source.endsWith('/') ? path.startsWith(source) : path === source));
  const isMore = (file) => madeOf.get(file).every(goes);
  const unused = sources.filter((source) => !built.some((path) => path.startsWith(source)));
  if (unused.length) throw new Error(`${options.list}: nothing is built from ${unused.join(', ')}`);
  const mixed = files.find((file) => madeOf.get(file).some(goes) && !isMore(file));
  if (mixed) throw new Error(`${mixed} has sources of both parts, by ${options.list}: configure the build again`);
  const symbols = (wanted, archives) => symbolsOf(options.nm, [...files.filter((file) => isMore(file) === wanted).map((file) => join(options.objects, file)), ...archives]);
  const first = symbols(false, []), more = symbols(true, [options.archive]), unknown = moveNamed(functions, first, more);
  if (unknown.length) throw new Error(`${options.list}: no function is named ${unknown.join(', ')}`);
  return chooseFunctions({ bytes: new Map(functionsOf(wasm).map(({ name, code }) => [name, code.length])), ...callGraph(text) }, first, more, keep, move);
}

// ---- the two parts ----

function moveData(first, second, mark, numbers, functions) {
  const sections = sectionsOf(first), data = sections.find(({ id }) => id === SECTION.data);
  const { kept: rest, moved: marked } = cutTexts(readSegments(data.bytes), `//${mark}\n`);
  if (!marked.length) throw new Error(`the module has no text that begins with //${mark}`);
  const { kept, moved: referred } = cutTextsOf(rest, numbers, functions);
  const moved = [...marked, ...referred];
  data.bytes = writeSegments(kept);
  const more = sectionsOf(second);
  if (more.some(({ id }) => id === SECTION.data)) throw new Error('the second part has data already');
  more.splice(more.findIndex(({ id }) => id === SECTION.code) + 1, 0, { id: SECTION.data, bytes: writeSegments(moved) });
  const counted = sections.find(({ id }) => id === SECTION.dataCount);
  if (counted) counted.bytes = u32(kept.length);
  return [moduleOf(sections), moduleOf(more)];
}

// Gives the placeholders of one function type one name: the optimiser merges them.
function shareNames(first) {
  const sections = sectionsOf(first), imports = sections.find(({ id }) => id === SECTION.imports);
  imports.bytes = writeImports(readImports(imports.bytes).map((entry) => (entry.module === PLACEHOLDER ? { ...entry, name: String(new Cursor(entry.type).u32()) } : entry)));
  return moduleOf(sections);
}

export function split(options) {
  const folder = mkdtempSync(join(tmpdir(), 'fourdvt-split-'));
  try {
    const [list, first, second] = ['functions.txt', 'first.wasm', 'second.wasm'].map((name) => join(folder, name));
    const text = execFileSync(options['wasm-dis'], [options.module], { encoding: 'utf8', maxBuffer: 1 << 28 });
    const functions = chosen(readFileSync(options.module), text, options), numbers = numbersOf(text);
    writeFileSync(list, functions.map((name) => `${name}\n`).join(''));
    execFileSync(options['wasm-split'], [...FEATURES, options.module, `--split-funcs=@${list}`, '-o1', first, '-o2', second,
      '--export-prefix=%', '--import-namespace=first', `--placeholder-namespace=${PLACEHOLDER}`, '-g'], { stdio: 'inherit' });
    const parts = moveData(readFileSync(first), readFileSync(second), options.mark, numbers, new Set(functions));
    writeFileSync(options.module, shareNames(parts[0]));
    writeFileSync(options.more, parts[1]);
    console.log(`${functions.length} functions in the second part`);
  } finally {
    rmSync(folder, { recursive: true });
  }
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const names = ['module', 'objects', 'list', 'mark', 'nm', 'wasm-split', 'wasm-dis', 'archive', 'more'];
  const { values } = parseArgs({ options: Object.fromEntries(names.map((name) => [name, { type: 'string' }])) });
  try {
    for (const name of names) if (!values[name]) throw new Error(`--${name} is missing`);
    split(values);
  } catch (problem) {
    console.error(`split.mjs: ${problem.message}`);
    process.exit(1);
  }
}
