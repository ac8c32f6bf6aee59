// SPDX-License-Identifier: Apache-2.0
// Prints the composition of the player's first part, built by CMake and web/build.mjs: functions by source folder,
// data, other sections, the page's modules; with --functions N also the N longest functions.
//   node sizes.mjs [--wasm FOLDER: the build of wasm/, default ../build/wasm/wasm] [--functions N]
// gzip: each row is compressed separately, then scaled so that the rows add up to the whole file's gzip size.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { gzipSync } from 'node:zlib';

import { functionsOf, readSegments, SECTION, sectionsOf, withoutNames } from './binary.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const FOLDERS = [
  [/^(fdvt_|\(anonymous namespace\)::|fourdvt::(abi|Instance|Canvas|cameraOf))/, 'wasm'],
  [/^(.* )?fourdvt::(package|render|gpu|motion)::/, (match) => `native/${match[2]}`],
  [/^(.* )?fourdvt::(Error|Flat|PinholeCamera|ByteReader|clipFrom|computeVertex|Mesh\b)/, 'native/base'],
  [/^(.* )?fourdvt::/, 'native/player'],
  [/\bdraco::/, 'Draco'],
  [/^(.* )?glm::|^byn\$mgfn-shared\$_ZN3glm/, 'GLM'],
  [/\bstd::|^byn\$|^operator |__cxxabi|^_?_?Z/, 'C++ library'],
];

function folderOf(name) {
  for (const [pattern, folder] of FOLDERS) {
    const match = pattern.exec(name);
    if (match) return typeof folder === 'string' ? folder : folder(match);
  }
  return 'C library';
}

const gzip = (bytes) => gzipSync(bytes, { level: 9 }).length;

// Rows of a file: [name, bytes, gzip], the longest first, and their sum. parts: [name, Buffer].
function rowsOf(file, parts, whole) {
  const groups = new Map();
  for (const [what, bytes] of parts) groups.set(what, [...(groups.get(what) ?? []), bytes]);
  const rows = [...groups].map(([what, list]) => [what, Buffer.concat(list)]).map(([what, bytes]) => [what, bytes.length, gzip(bytes)]);
  const scale = gzip(whole) / rows.reduce((sum, [, , zipped]) => sum + zipped, 0);
  const scaled = rows.map(([what, bytes, zipped]) => [what, bytes, Math.round(zipped * scale)]).sort((a, b) => b[2] - a[2]);
  return [...scaled, [file, whole.length, gzip(whole)]];
}

// Parts of a module, and its functions: [readable name, length].
function partsOfModule(wasm) {
  const sections = sectionsOf(wasm), functions = functionsOf(wasm);
  const names = execFileSync('c++filt', { input: functions.map(({ name }) => name).join('\n'), encoding: 'utf8', maxBuffer: 1 << 28 }).split('\n');
  const isText = (text) => text.length > 3 && /^[\n -~]+$/.test(text);
  const data = readSegments(sections.find(({ id }) => id === SECTION.data).bytes).flatMap(({ bytes }) =>
    bytes.toString('latin1').split(/(?<=\0)/).map((text) => {
      const what = text.includes('gl_Position') || /\bo_\w+\s*[;=]/.test(text) ? 'data: shaders' : isText(text.slice(0, -1)) ? 'data: texts' : 'data: numbers, zeros';
      return [what, Buffer.from(text, 'latin1')];
    }));
  const others = { [SECTION.imports]: 'imports', [SECTION.exports]: 'exports', [SECTION.elements]: 'table of functions' };
  const rest = sections.filter(({ id }) => ![SECTION.custom, SECTION.code, SECTION.data].includes(id)).map(({ id, bytes }) => [others[id] ?? 'types and the like', bytes]);
  return {
    parts: [...functions.map(({ code }, i) => [`code: ${folderOf(names[i])}`, code]), ...data, ...rest],
    functions: functions.map(({ code }, i) => [names[i], code.length]),
  };
}

const { values } = parseArgs({ options: { wasm: { type: 'string', default: join(here, '../build/wasm/wasm') }, functions: { type: 'string', default: '0' } } });
try {
  const wasm = readFileSync(join(values.wasm, 'fourdvt.wasm')), { modules, script } = JSON.parse(readFileSync(join(values.wasm, 'modules.json'), 'utf8'));
  const { parts, functions } = partsOfModule(wasm), page = readFileSync(script);
  // The bundler returns lengths without positions: a module's share of the gzipped script is proportional to its
  // length.
  const pageGzip = gzip(page), total = Object.values(modules).reduce((sum, bytes) => sum + bytes, 0);
  const pageRows = Object.entries(modules).map(([name, bytes]) => [`script: ${name}`, bytes, Math.round((bytes / total) * pageGzip)]).sort((a, b) => b[1] - a[1]);
  for (const [what, bytes, zipped] of [...rowsOf('fourdvt-viewer.wasm', parts, withoutNames(wasm)), ...pageRows, [basename(script), page.length, pageGzip]]) {
    console.log(`${what.padEnd(34)} ${String(bytes).padStart(7)} ${String(zipped).padStart(7)} gzip`);
  }
  for (const [name, bytes] of functions.sort((a, b) => b[1] - a[1]).slice(0, Number(values.functions))) console.log(`${String(bytes).padStart(7)} ${name.slice(0, 160)}`);
} catch (problem) {
  console.error(`sizes.mjs: ${problem.message}; build the CMake preset wasm, then run web/build.mjs`);
  process.exit(1);
}
