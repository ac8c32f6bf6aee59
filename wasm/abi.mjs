// SPDX-License-Identifier: Apache-2.0
// Generates code from the list of the C ABI (format: abi.txt):
//   node abi.mjs header FILE            C++: enumerations, structs, checks of their layout, declarations
//   node abi.mjs exports MODULES FILE   Emscripten's exports, one symbol per line; MODULES: NAME,NAME
//   node abi.mjs typescript FILE        declarations of functions, names of enumerations, access to records
// Its exports also compute the stamp shared by script and wasm files of one build.
// Generated files are never committed.
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const LIST = fileURLToPath(new URL('abi.txt', import.meta.url));
const NOTE = `// SPDX-License-Identifier: Apache-2.0
// Made by wasm/abi.mjs from wasm/abi.txt during the build. Edit the list instead.`;

// Types of fields. `c`: C++ type; `ts`: TypeScript type; `size`: bytes in wasm32, also the alignment without `align`.
const FIELDS = {
  i32: { c: 'int32_t', size: 4, ts: 'number' },
  u32: { c: 'uint32_t', size: 4, ts: 'number' },
  f64: { c: 'double', size: 8, ts: 'number' },
  bool: { c: 'int32_t', size: 4, ts: 'boolean' },
  text: { c: 'Text', size: 8, align: 4, ts: 'string' },
  bytes: { c: 'Bytes', size: 8, align: 4, ts: 'Uint8Array' },
};
// C++ types of parameters and results. A pair is two parameters, address and length.
const PAIRS = { text: 'const char*', bytes: 'const uint8_t*' };
const POINTERS = {
  handle: 'fourdvt::Instance*', handles: 'fourdvt::Instance* const*', block: 'void*', pixels: 'const uint8_t*',
  floats: 'const float*', field: 'float*',
};

const upperCamel = (name) => name.split(/[_-]/).map((word) => word[0].toUpperCase() + word.slice(1)).join('');
const lowerCamel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());
const roundUp = (value, step) => Math.ceil(value / step) * step;

// ---- list ----

/** Parses the list to { enums, records, functions }, maps by name. Throws an Error with the line. */
export function parseAbi(text) {
  const abi = { enums: new Map(), records: new Map(), functions: new Map(), module: '', record: null };
  text.split('\n').forEach((line, index) => {
    const code = line.replace(/#.*/, '').trimEnd();
    if (!code) return;
    try {
      parseLine(abi, code);
    } catch (problem) {
      throw new Error(`abi.txt:${index + 1}: ${problem.message}`);
    }
  });
  return abi;
}

const LINES = [
  [/^ {2}(\S+) (\w+)$/, addField],
  [/^module (\w+)$/, (abi, name) => { abi.module = name; }],
  [/^enum (\w+): ([\w -]+)$/, (abi, name, values) => define(abi.enums, name, values.split(' '))],
  [/^record (\w+)$/, (abi, name) => {
    abi.record = { fields: new Map(), end: 0, align: 1, size: 0 };
    define(abi.records, name, abi.record);
  }],
  [/^(\w+) (fdvt_\w+)\((.*)\)$/, addFunction],
];

function parseLine(abi, code) {
  if (!code.startsWith(' ')) abi.record = null;
  for (const [pattern, add] of LINES) {
    const found = pattern.exec(code);
    if (found) return add(abi, ...found.slice(1));
  }
  throw new Error('neither a module, an enumeration, a record, a field nor a function');
}

function define(map, name, value) {
  if (map.has(name)) throw new Error(`${name} is there twice`);
  map.set(name, value);
}

function addField({ record, ...abi }, typeName, name) {
  const type = fieldType(abi, typeName);
  if (!record) throw new Error('a field outside of a record');
  if (!type) throw new Error(`no type ${typeName} for a field`);
  const offset = roundUp(record.end, type.align);
  define(record.fields, name, { ...type, offset });
  record.end = offset + type.size;
  record.align = Math.max(record.align, type.align);
  record.size = roundUp(record.end, record.align);
}

// Returns a field's type. `access`: name of its methods in Reader and Writer (web/src/wasm/records.ts).
function fieldType({ enums, records }, name) {
  const camel = upperCamel(name);
  if (records.has(name)) return { ...records.get(name), c: camel, ts: `${camel}Record`, record: camel };
  if (enums.has(name)) return { size: 4, align: 4, c: camel, ts: camel, enumeration: listName(name) };
  const [, element, count] = /^(\w+)(?:\[(\d+)\])?$/.exec(name) ?? [];
  const type = FIELDS[element] && { align: FIELDS[element].size, access: element, ...FIELDS[element] };
  if (!type || !count) return type;
  const ts = `[${Array(Number(count)).fill(type.ts).join(', ')}]`;
  return { ...type, size: type.size * count, ts, access: `${element}s`, count };
}

function addFunction(abi, result, name, list) {
  const parameters = list.split(', ').map((part) => part.split(' '));
  for (const [type, parameter] of [[result, 'result'], ...parameters]) {
    if (!parameter || !isType(abi, type)) throw new Error(`${name}: no type ${type} for a parameter or result`);
  }
  define(abi.functions, name, { module: abi.module, result, parameters });
}

function isType({ enums, records }, type) {
  return [FIELDS, POINTERS, { ok: 1, void: 1 }].some((types) => type in types) || enums.has(type) || records.has(type);
}

// ---- C++ ----

export function cppHeader(abi) {
  const enums = [...abi.enums].map(([name, values]) =>
    `enum class ${upperCamel(name)} : int32_t { ${values.map(upperCamel).join(', ')} };`);
  const pairs = Object.entries(PAIRS).map(([name, c]) =>
    `struct ${upperCamel(name)} {\n  ${c} data = nullptr;\n  uint32_t size = 0;\n};`);
  const records = [...abi.records].map(([name, record]) => cppRecord(upperCamel(name), record));
  const functions = [...abi.functions].map(([name, declared]) => cppDeclaration(abi, name, declared));
  return `${NOTE}
#pragma once

#include <cstddef>
#include <cstdint>

namespace fourdvt {
struct Instance;
namespace abi {

${[...enums, ...pairs, ...records].join('\n')}

}  // namespace abi
}  // namespace fourdvt

extern "C" {
${functions.join('\n')}
}
`;
}

function cppRecord(name, { fields, size }) {
  const members = [...fields].map(([field, { c, count }]) => `  ${c} ${field}${count ? `[${count}]` : ''} = {};\n`);
  const checks = [...fields].map(([field, { offset }]) => `offsetof(${name}, ${field}) == ${offset} &&\n`);
  return `struct ${name} {\n${members.join('')}};
static_assert(${checks.join('              ')}              sizeof(${name}) == ${size},
              "the page reads ${name} at other offsets");`;
}

function cppDeclaration(abi, name, { result, parameters }) {
  const list = parameters.flatMap(([type, parameter]) => (type in PAIRS
    ? [`${PAIRS[type]} ${parameter}`, `uint32_t ${parameter}_size`]
    : [`${cppType(abi, type)} ${parameter}`]));
  return `${result === 'text' ? 'const fourdvt::abi::Text*' : cppType(abi, result)} ${name}(${list.join(', ')});`;
}

function cppType(abi, type) {
  if (type === 'void') return 'void';
  if (type === 'ok') return 'int32_t';
  if (abi.records.has(type)) return `const fourdvt::abi::${upperCamel(type)}*`;
  return abi.enums.has(type) ? `fourdvt::abi::${upperCamel(type)}` : POINTERS[type] ?? FIELDS[type].c;
}

export function exportList(abi, module) {
  const names = [...abi.functions].filter(([, f]) => f.module === module).map(([name]) => `_${name}\n`);
  if (!names.length) throw new Error(`abi.txt has no module ${module}`);
  return names.join('');
}

// ---- TypeScript ----

const listName = (enumeration) => `${enumeration.toUpperCase()}S`.replace(/YS$/, 'IES');

/** Makes the TypeScript module for the page; it imports records.ts of web/src/wasm from the folder above its own. */
export function typeScript(abi) {
  const given = new Set([...abi.functions.values()].flatMap((f) => f.parameters.map(([type]) => type)));
  const modules = new Set([...abi.functions.values()].map((f) => f.module));
  return [
    NOTE,
    "import { Reader, Writer } from '../records.js';\n",
    ...[...abi.enums].map(([name, values]) => tsEnum(name, values.map((value) => `'${value}'`))),
    ...[...abi.records].flatMap(([name, record]) => [
      tsInterface(upperCamel(name), record), (given.has(name) ? tsWriter : tsReader)(upperCamel(name), record)]),
    ...[...modules].map((module) => tsModule(module, [...abi.functions].filter(([, f]) => f.module === module))),
  ].join('\n');
}

function tsEnum(name, values) {
  const type = upperCamel(name);
  return `export type ${type} = ${values.join(' | ')};
export const ${listName(name)}: readonly ${type}[] = [${values.join(', ')}];`;
}

function tsInterface(name, { fields }) {
  const members = [...fields].map(([field, { ts }]) => `  ${lowerCamel(field)}: ${ts};\n`);
  return `\nexport interface ${name}Record {\n${members.join('')}}`;
}

function tsReader(name, { fields }) {
  const reads = [...fields].map(([field, type]) => `    ${lowerCamel(field)}: ${tsRead(type)},\n`);
  return `export function read${name}(memory: Uint8Array, at: number): ${name}Record {
  const r = new Reader(memory, at);
  return {\n${reads.join('')}  };\n}`;
}

function tsRead({ offset, access, count, ts, record, enumeration }) {
  if (record) return `read${record}(memory, at + ${offset})`;
  if (enumeration) return `${enumeration}[r.i32(${offset})]!`;
  return count ? `r.${access}(${offset}, ${count}) as ${ts}` : `r.${access}(${offset})`;
}

// Serialises a record into bytes for wasm memory.
function tsWriter(name, { fields, size }) {
  const writes = [...fields].map(([field, type]) => `  ${tsWrite(type, `record.${lowerCamel(field)}`)};\n`);
  return `export function bytesOf${name}(record: ${name}Record): Uint8Array {
  const w = new Writer(${size});\n${writes.join('')}  return w.bytes;\n}`;
}

function tsWrite({ offset, access, enumeration }, value) {
  if (enumeration) return `w.i32(${offset}, Math.max(0, ${enumeration}.indexOf(${value})))`;
  return `w.${access}(${offset}, ${value})`;
}

function tsModule(module, functions) {
  return `\nexport interface ${upperCamel(module)}Exports {\n${functions.map(tsDeclaration).join('')}}\n`;
}

function tsDeclaration([name, { result, parameters }]) {
  const names = parameters.flatMap(([type, parameter]) => [parameter, ...(type in PAIRS ? [`${parameter}_size`] : [])]);
  const list = names.map((parameter) => `${lowerCamel(parameter)}: number`).join(', ');
  return `  _${name}(${list}): ${result === 'void' ? 'void' : 'number'};\n`;
}

// ---- stamps ----

/** Hashes texts or bytes to 8 hexadecimal digits. */
export function stampOf(...parts) {
  const hash = createHash('sha256');
  for (const part of parts) hash.update(part);
  return hash.digest('hex').slice(0, 8);
}

/** Adds the stamp to the wasm file as a custom section, for a script to verify that both are of one build. */
export function stampWasm(wasm, stamp) {
  const name = Buffer.from('fourdvt'), size = 1 + name.length + stamp.length; // below 128: one byte
  return Buffer.concat([wasm, Buffer.from([0, size, name.length]), name, Buffer.from(stamp)]);
}

// ---- files ----

function write(file, make) {
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, make(parseAbi(readFileSync(LIST, 'utf8'))));
}

/** Writes the TypeScript module for web/build.mjs and the tests. */
export function writeTypeScript(file) {
  write(file, typeScript);
}

function main([kind, ...rest]) {
  const file = rest.at(-1);
  const make = { header: cppHeader, typescript: typeScript, exports: (abi) => rest[0].split(',').map((name) => exportList(abi, name)).join('') }[kind];
  if (!make || !file) throw new Error('usage: node abi.mjs header|typescript|exports MODULES FILE');
  write(file, make);
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  try {
    main(process.argv.slice(2));
  } catch (problem) {
    console.error(`abi.mjs: ${problem.message}`);
    process.exit(1);
  }
}
