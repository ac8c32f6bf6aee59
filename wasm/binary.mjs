// SPDX-License-Identifier: Apache-2.0
// Reads and writes the part of WebAssembly's binary format that the programs of this folder need.
export const SECTION = { custom: 0, imports: 2, table: 4, exports: 7, elements: 9, code: 10, data: 11, dataCount: 12 };
const FUNCTION_NAMES = 1;

/** Options of Binaryen's programs: WebAssembly features of the player's modules. */
export const FEATURES = ['simd', 'bulk-memory', 'sign-ext', 'mutable-globals', 'nontrapping-float-to-int'].map((f) => `--enable-${f}`);

export class Cursor {
  constructor(bytes, at = 0) {
    this.bytes = bytes;
    this.at = at;
  }
  u32() {
    let value = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = this.bytes[this.at++];
      value += (byte & 127) * 2 ** shift;
      if (byte < 128) return value;
    }
  }
  i32() {
    let value = 0;
    for (let shift = 0; ; ) {
      const byte = this.bytes[this.at++];
      value |= (byte & 127) << shift;
      shift += 7;
      if (byte < 128) return shift < 32 && byte & 64 ? value | (-1 << shift) : value;
    }
  }
  take(length) { return this.bytes.subarray(this.at, (this.at += length)); }
  text() { return this.take(this.u32()).toString('utf8'); }
}

export function u32(value) {
  const out = [];
  do out.push((value & 127) | (value > 127 ? 128 : 0)); while ((value >>>= 7));
  return Buffer.from(out);
}
export function i32(value) {
  const out = [];
  for (let more = true; more; value >>= 7) {
    more = !((value >> 7 === 0 && !(value & 64)) || (value >> 7 === -1 && value & 64));
    out.push((value & 127) | (more ? 128 : 0));
  }
  return Buffer.from(out);
}

/** Sections of a module in order: { id, bytes }. */
export function sectionsOf(wasm) {
  const cursor = new Cursor(wasm, 8), sections = [];
  while (cursor.at < wasm.length) {
    const id = cursor.bytes[cursor.at++];
    sections.push({ id, bytes: cursor.take(cursor.u32()) });
  }
  return sections;
}
/** Assembles a module from its sections. */
export const moduleOf = (sections) => Buffer.concat([Buffer.from('\0asm\x01\0\0\0', 'latin1'),
  ...sections.flatMap(({ id, bytes }) => [Buffer.from([id]), u32(bytes.length), bytes])]);

/** Names of functions by index, imported ones first. */
export function functionNames(sections) {
  for (const { id, bytes } of sections) {
    const cursor = new Cursor(bytes);
    if (id !== SECTION.custom || cursor.text() !== 'name') continue;
    while (cursor.at < bytes.length) {
      const kind = bytes[cursor.at++], part = new Cursor(cursor.take(cursor.u32()));
      if (kind === FUNCTION_NAMES) return Array.from({ length: part.u32() }, () => (part.u32(), part.text()));
    }
  }
  throw new Error('the module has no names of functions: link it with --profiling-funcs');
}

/** Strips the name section, which only these programs read. */
export const withoutNames = (wasm) => moduleOf(sectionsOf(wasm).filter(({ id, bytes }) => id !== SECTION.custom || new Cursor(bytes).text() !== 'name'));

/** Functions defined in the module: { name, code }. */
export function functionsOf(wasm) {
  const sections = sectionsOf(wasm), names = functionNames(sections);
  const cursor = new Cursor(sections.find(({ id }) => id === SECTION.code).bytes);
  const codes = Array.from({ length: cursor.u32() }, () => cursor.take(cursor.u32()));
  return codes.map((code, i) => ({ name: names[names.length - codes.length + i], code }));
}

/** Data segments with a fixed address: { address, bytes }. */
export function readSegments(bytes) {
  const cursor = new Cursor(bytes);
  return Array.from({ length: cursor.u32() }, () => {
    if (cursor.u32() !== 0 || cursor.bytes[cursor.at++] !== 0x41) throw new Error('a data segment has no fixed address');
    const address = cursor.i32();
    if (cursor.bytes[cursor.at++] !== 0x0b) throw new Error('a data segment has no fixed address');
    return { address, bytes: cursor.take(cursor.u32()) };
  });
}
export const writeSegments = (segments) => Buffer.concat([u32(segments.length), ...segments.flatMap(({ address, bytes }) =>
  [Buffer.from([0, 0x41]), i32(address), Buffer.from([0x0b]), u32(bytes.length), bytes])]);

const nameOf = (text) => Buffer.concat([u32(Buffer.byteLength(text)), Buffer.from(text)]);
export const KIND = { function: 0, table: 1, memory: 2, global: 3 };

/** Imports of a module: { module, name, kind, type }; type: bytes after the kind. */
export function readImports(bytes) {
  const cursor = new Cursor(bytes);
  return Array.from({ length: cursor.u32() }, () => {
    const [module, name, kind, at] = [cursor.text(), cursor.text(), cursor.bytes[cursor.at++], cursor.at];
    if (kind === KIND.function) cursor.u32();
    else if (kind === KIND.global) cursor.at += 2;
    else {
      if (kind === KIND.table) cursor.at++;
      cursor.at = readLimits(bytes, cursor.at).end;
    }
    return { module, name, kind, type: bytes.subarray(at, cursor.at) };
  });
}
export const writeImports = (imports) => Buffer.concat([u32(imports.length), ...imports.flatMap(({ module, name, kind, type }) =>
  [nameOf(module), nameOf(name), Buffer.from([kind]), type])]);

/** Exports of a module: { name, kind, index }. */
export function readExports(bytes) {
  const cursor = new Cursor(bytes);
  return Array.from({ length: cursor.u32() }, () => ({ name: cursor.text(), kind: cursor.bytes[cursor.at++], index: cursor.u32() }));
}
export const writeExports = (exports) => Buffer.concat([u32(exports.length), ...exports.flatMap(({ name, kind, index }) =>
  [nameOf(name), Buffer.from([kind]), u32(index)])]);

/** Limits of a table or a memory, from `at` to `end`: max: null without a maximum. */
export function readLimits(bytes, at) {
  const cursor = new Cursor(bytes, at + 1), min = cursor.u32();
  return { min, max: bytes[at] & 1 ? cursor.u32() : null, end: cursor.at };
}
export const writeLimits = ({ min, max }) => Buffer.concat([Buffer.from([max === null ? 0 : 1]), u32(min), ...(max === null ? [] : [u32(max)])]);

/** Active function segments of the first table: { offset, functions }. */
export function readElements(bytes) {
  const cursor = new Cursor(bytes);
  return Array.from({ length: cursor.u32() }, () => {
    if (cursor.u32() !== 0 || cursor.bytes[cursor.at++] !== 0x41) throw new Error('a segment of the table has no fixed place');
    const offset = cursor.i32();
    cursor.at++; // end
    return { offset, functions: Array.from({ length: cursor.u32() }, () => cursor.u32()) };
  });
}
export const writeElements = (segments) => Buffer.concat([u32(segments.length), ...segments.flatMap(({ offset, functions }) =>
  [Buffer.from([0, 0x41]), i32(offset), Buffer.from([0x0b]), u32(functions.length), ...functions.map(u32)])]);
