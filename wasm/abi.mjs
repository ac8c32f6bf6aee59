// SPDX-License-Identifier: Apache-2.0
// Makes code from the list of the C ABI (abi.txt, which explains its own format):
//   node abi.mjs header FILE            C++: enumerations, structs, checks of their layout, declarations
//   node abi.mjs exports MODULE FILE    what Emscripten exports, one symbol a line
//   node abi.mjs typescript FILE        declarations of the functions, names of enumerations, readers and writers of records
// A last argument --list LIST reads another list. What is made is never committed.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const LIST = fileURLToPath(new URL('abi.txt', import.meta.url));
const NOTE = '// SPDX-License-Identifier: Apache-2.0\n// Made by wasm/abi.mjs from wasm/abi.txt when it was built. Edit the list instead.\n';

// In wasm32. `c`: C++ type; `size` in bytes, which is also the alignment unless `align` is given; `ts`: TypeScript type.
const FIELDS = {
  i32: { c: 'int32_t', size: 4, ts: 'number' },
  u32: { c: 'uint32_t', size: 4, ts: 'number' },
  f64: { c: 'double', size: 8, ts: 'number' },
  bool: { c: 'int32_t', size: 4, ts: 'boolean' },
  text: { c: 'Text', size: 8, align: 4, ts: 'string' },
  bytes: { c: 'Bytes', size: 8, align: 4, ts: 'Uint8Array' },
};
const POINTERS = {
  handle: 'fourdvt::Instance*', handles: 'fourdvt::Instance* const*', block: 'void*', pixels: 'const uint8_t*',
  floats: 'const float*', field: 'float*',
};
const PAIRS = { text: 'const char*', bytes: 'const uint8_t*' };

const upperCamel = (name) => name.split(/[_-]/).map((word) => word[0].toUpperCase() + word.slice(1)).join('');
const listName = (enumeration) => `${enumeration.toUpperCase()}S`;
const lowerCamel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

/** The list as { enums, records, functions }. Throws an Error that names the line. */
export function parseAbi(text) {
  const abi = { enums: new Map(), records: new Map(), functions: new Map() };
  let record = null;
  let module = null;
  text.split('\n').forEach((line, index) => {
    const complain = (what) => { throw new Error(`abi.txt:${index + 1}: ${what}`); };
    const define = (map, name, value) => {
      if (map.has(name)) complain(`${name} is there twice`);
      map.set(name, value);
    };
    const code = line.replace(/#.*/, '').trimEnd();
    let found;
    if (!code) return;
    if ((found = /^ {2}(\S+) (\w+)$/.exec(code))) {
      if (!record) complain('a field outside of a record');
      const { size, align, ...type } = fieldType(abi, found[1]) ?? complain(`no type ${found[1]} for a field`);
      const offset = roundUp(record.end, align);
      define(record.fields, found[2], { ...type, offset });
      record.end = offset + size;
      record.align = Math.max(record.align, align);
      record.size = roundUp(record.end, record.align);
      return;
    }
    record = null;
    if ((found = /^enum (\w+): ([\w -]+)$/.exec(code))) define(abi.enums, found[1], found[2].split(' '));
    else if ((found = /^record (\w+)$/.exec(code))) define(abi.records, found[1], (record = { fields: new Map(), end: 0, align: 1, size: 0 }));
    else if ((found = /^module (\w+)$/.exec(code))) module = found[1];
    else if ((found = /^(\w+) (fdvt_\w+)\((.*)\)$/.exec(code))) {
      const parameters = found[3].split(', ').map((part) => part.split(' '));
      for (const [type, name] of [[found[1], 'result'], ...parameters]) {
        if (!name || !knows(abi, type)) complain(`${found[2]}: no type ${type} for a parameter or result`);
      }
      define(abi.functions, found[2], { module, result: found[1], parameters });
    } else complain('neither a module, an enumeration, a record, a field nor a function');
  });
  return abi;
}

const roundUp = (value, step) => Math.ceil(value / step) * step;

function fieldType(abi, name) {
  const record = abi.records.get(name);
  if (record) return { c: upperCamel(name), size: record.size, align: record.align, ts: `${upperCamel(name)}Record`, record: true };
  if (abi.enums.has(name)) return { c: upperCamel(name), size: 4, align: 4, ts: upperCamel(name), enumeration: name };
  const [, element, count] = /^(\w+)(?:\[(\d+)\])?$/.exec(name) ?? [];
  const type = FIELDS[element] && { align: FIELDS[element].size, access: element, ...FIELDS[element] };
  if (!type || !count) return type;
  const ts = `[${Array(Number(count)).fill(type.ts).join(', ')}]`;
  return { ...type, size: type.size * count, ts, access: `${element}s`, count };
}

const knows = (abi, type) => type in FIELDS || type in POINTERS || type === 'ok' || type === 'void' || abi.enums.has(type) || abi.records.has(type);

// --- C++ ---

export function cppHeader(abi) {
  const out = [NOTE, '#pragma once\n\n#include <cstddef>\n#include <cstdint>\n\nnamespace fourdvt {\nstruct Instance;\nnamespace abi {\n'];
  for (const [name, values] of abi.enums) out.push(`enum class ${upperCamel(name)} : int32_t { ${values.map(upperCamel).join(', ')} };`);
  out.push('struct Text {\n  const char* data = nullptr;\n  uint32_t size = 0;\n};\nstruct Bytes {\n  const uint8_t* data = nullptr;\n  uint32_t size = 0;\n};');
  for (const [name, record] of abi.records) out.push(cppRecord(upperCamel(name), record));
  out.push('\n}  // namespace abi\n}  // namespace fourdvt\n\nextern "C" {');
  for (const [name, declared] of abi.functions) out.push(cppDeclaration(abi, name, declared));
  return `${out.join('\n')}\n}\n`;
}

function cppRecord(name, { fields, size }) {
  const members = [...fields].map(([field, { c, count }]) => `  ${c} ${field}${count ? `[${count}]` : ''} = {};\n`);
  const checks = [...fields].map(([field, { offset }]) => `offsetof(${name}, ${field}) == ${offset}`);
  return `struct ${name} {\n${members.join('')}};\nstatic_assert(${[...checks, `sizeof(${name}) == ${size}`].join(' &&\n              ')},\n              "the page reads ${name} at other offsets");`;
}

function cppDeclaration(abi, name, { result, parameters }) {
  const list = parameters.flatMap(([type, parameter]) => (type in PAIRS
    ? [`${PAIRS[type]} ${parameter}`, `uint32_t ${parameter}_size`]
    : [`${cppType(abi, type)} ${parameter}`]));
  const returned = result === 'text' ? 'const fourdvt::abi::Text*' : cppType(abi, result);
  return `${returned} ${name}(${list.join(', ')});`;
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

// --- TypeScript ---

export function typeScript(abi) {
  const out = [NOTE, "import { Reader, Writer } from '../records.js';\n"];
  for (const [name, values] of abi.enums) {
    out.push(`export type ${upperCamel(name)} = ${values.map((value) => `'${value}'`).join(' | ')};`);
    out.push(`export const ${listName(name)}: readonly ${upperCamel(name)}[] = [${values.map((value) => `'${value}'`).join(', ')}];`);
  }
  const written = new Set([...abi.functions.values()].flatMap((f) => f.parameters.map(([type]) => type)));
  for (const [name, record] of abi.records) {
    out.push(tsInterface(upperCamel(name), record), (written.has(name) ? tsWriter : tsReader)(upperCamel(name), record));
  }
  for (const module of new Set([...abi.functions.values()].map((f) => f.module))) {
    out.push(`\nexport interface ${upperCamel(module)}Exports {`);
    for (const [name, f] of abi.functions) if (f.module === module) out.push(tsDeclaration(name, f));
    out.push('}');
  }
  return `${out.join('\n')}\n`;
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
  if (record) return `read${ts.replace('Record', '')}(memory, at + ${offset})`;
  if (enumeration) return `${listName(enumeration)}[r.i32(${offset})]!`;
  return count ? `r.${access}(${offset}, ${count}) as ${ts}` : `r.${access}(${offset})`;
}

// The record as bytes, to be put into wasm memory.
function tsWriter(name, { fields, size }) {
  const writes = [...fields].map(([field, { offset, access, enumeration }]) => {
    const value = `record.${lowerCamel(field)}`;
    return enumeration ? `  w.i32(${offset}, Math.max(0, ${listName(enumeration)}.indexOf(${value})));\n` : `  w.${access}(${offset}, ${value});\n`;
  });
  return `export function bytesOf${name}(record: ${name}Record): Uint8Array {
  const w = new Writer(${size});\n${writes.join('')}  return w.bytes;\n}`;
}

function tsDeclaration(name, { result, parameters }) {
  const list = parameters.flatMap(([type, parameter]) => [parameter, ...(type in PAIRS ? [`${parameter}_size`] : [])]);
  return `  _${name}(${list.map((parameter) => `${lowerCamel(parameter)}: number`).join(', ')}): ${result === 'void' ? 'void' : 'number'};`;
}

// --- command line ---

export function readAbi(list = LIST) {
  return parseAbi(readFileSync(list, 'utf8'));
}

/** Writes the TypeScript half, as web/build.mjs and the unit tests need it. */
export function writeTypeScript(file, list = LIST) {
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, typeScript(readAbi(list)));
}

function main(words) {
  const at = words.indexOf('--list');
  const list = at >= 0 ? words.splice(at, 2)[1] : LIST;
  const [kind, ...rest] = words;
  const file = rest.pop();
  const make = { header: cppHeader, typescript: typeScript, exports: (abi) => exportList(abi, rest[0]) }[kind];
  if (!make || !file || !list) throw new Error('usage: node abi.mjs header|typescript|exports MODULE FILE [--list LIST]');
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, make(readAbi(list)));
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  try {
    main(process.argv.slice(2));
  } catch (problem) {
    console.error(`abi.mjs: ${problem.message}`);
    process.exit(1);
  }
}
