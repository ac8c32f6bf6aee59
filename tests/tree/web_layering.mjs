// SPDX-License-Identifier: Apache-2.0
// node tests/tree/web_layering.mjs ROOT: every file of web/src stands in the layers of web/README.md and imports only
// files of lower layers, so that there is no import circle. A module from outside counts as the file that declares it.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';

const IMPORT = /\b(?:from|import)\s*\(?\s*(['"])([^'"]+)\1/g;

const web = join(process.argv[2] ?? '.', 'web');
const source = join(web, 'src');
const problems = [];

function readLayers() {
  const [, list] = /^## Layers$[^]*?^```\n([^]*?)^```$/m.exec(readFileSync(join(web, 'README.md'), 'utf8')) ?? [];
  if (!list) return new Map();
  return new Map(list.trim().split('\n').flatMap((line, layer) => line.split(' · ').map((name) => [name, layer])));
}

function sourceFiles(folder = '') {
  return readdirSync(join(source, folder), { withFileTypes: true }).flatMap((entry) => {
    const name = folder + entry.name;
    if (entry.isDirectory()) return sourceFiles(`${name}/`);
    return name.endsWith('.ts') ? [name.replace(/(\.d)?\.ts$/, '')] : [];
  });
}

function fileOf(name) {
  return [`${name}.ts`, `${name}.d.ts`].map((file) => join(source, file)).find((file) => existsSync(file));
}

function checkImport(layers, name, specifier) {
  const wanted = specifier.startsWith('.') ? normalize(join(dirname(name), specifier)).replace(/\.js$/, '') : specifier;
  if (!layers.has(wanted)) problems.push(`${name} imports ${wanted}, which is in no layer of web/README.md`);
  else if (layers.get(wanted) >= layers.get(name)) problems.push(`${name} imports ${wanted}, which is not below it`);
}

const layers = readLayers();
if (!layers.size) problems.push('web/README.md has no list of layers');
let imports = 0;
for (const name of sourceFiles()) {
  const text = readFileSync(fileOf(name), 'utf8').replace(/^\s*\/\/.*$/gm, '');
  const found = [...text.matchAll(IMPORT)].map((match) => match[2]);
  imports += found.length;
  if (!layers.has(name)) problems.push(`${name} is in no layer of web/README.md`);
  else for (const specifier of found) checkImport(layers, name, specifier);
}
for (const name of layers.keys()) {
  const made = name.startsWith('generated/'); // during the build
  if (!made && !fileOf(name)) problems.push(`web/README.md lists ${name}, which does not exist`);
}
if (!imports) problems.push('no import found to check');
for (const problem of problems) console.error(problem);
console.log(`${imports} imports checked, ${problems.length} problems`);
process.exit(problems.length ? 1 : 0);
