// SPDX-License-Identifier: Apache-2.0
// node tests/tree/web_layering.mjs ROOT: checks that every folder of web/src, and every file directly in web/src, has a
// line in the list "Layers" of web/README.md and imports only what that line allows, and that files of a folder do not
// import each other in a circle.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';

const IMPORT = /\b(?:from|import)\s*\(?\s*(['"])([^'"]+)\1/g;

const web = join(process.argv[2] ?? '.', 'web');
const source = join(web, 'src');
const problems = [];

// Lines "name: names", bottom to top; a line may name only what has a line above its own.
function readLayers() {
  const [, list = ''] = /^## Layers$[^]*?^```\n([^]*?)^```$/m.exec(readFileSync(join(web, 'README.md'), 'utf8')) ?? [];
  const layers = new Map();
  for (const line of list.trim().split('\n')) {
    const [name, names = ''] = line.split(':'), below = names.split(' ').filter(Boolean);
    for (const other of below) if (!layers.has(other)) problems.push(`web/README.md: ${name} may import ${other}, which has no line above it`);
    layers.set(name, new Set(below));
  }
  return layers;
}

function sourceFiles(folder = '') {
  return readdirSync(join(source, folder), { withFileTypes: true }).flatMap((entry) => {
    const name = folder + entry.name;
    return entry.isDirectory() ? sourceFiles(`${name}/`) : name.endsWith('.ts') ? [name] : [];
  });
}

const layerOf = (file) => file.split('/')[0];
const folderOf = (file) => (file.includes('/') ? layerOf(file) : null);

// Files that a file imports; a module from outside counts as the file that declares it.
function importsOf(file, files) {
  const text = readFileSync(join(source, file), 'utf8').replace(/^\s*\/\/.*$/gm, '');
  return [...text.matchAll(IMPORT)].map(([, , specifier]) => {
    const name = specifier.startsWith('.') ? normalize(join(dirname(file), specifier)).replace(/\.js$/, '') : specifier;
    const found = [...files, 'wasm/generated/abi.ts'].find((path) => [`${name}.ts`, `${name}.d.ts`].some((wanted) => path === wanted || path.endsWith(`/${wanted}`)));
    if (!found) problems.push(`${file} imports ${specifier}, which is no file of web/src`);
    return found;
  }).filter(Boolean);
}

function checkCircles(imports) {
  const done = new Set();
  const visit = (file, path) => {
    if (path.includes(file)) return problems.push(`circle: ${[...path.slice(path.indexOf(file)), file].join(' → ')}`);
    if (done.has(file)) return undefined;
    for (const other of imports.get(file) ?? []) visit(other, [...path, file]);
    return done.add(file);
  };
  for (const file of imports.keys()) visit(file, []);
}

const layers = readLayers(), files = sourceFiles();
const imports = new Map(files.map((file) => [file, importsOf(file, files)]));
for (const [file, others] of imports) {
  const layer = layerOf(file), allowed = layers.get(layer);
  if (!allowed) problems.push(`${file}: ${layer} has no line in the layers of web/README.md`);
  else for (const other of others) {
    if (folderOf(file) && folderOf(other) === layer) continue;
    if (!allowed.has(layerOf(other))) problems.push(`${file} imports ${other}, which ${layer} may not`);
  }
}
checkCircles(imports);
for (const name of layers.keys()) if (!existsSync(join(source, name))) problems.push(`web/README.md lists ${name}, which does not exist`);
const count = [...imports.values()].flat().length;
if (!count) problems.push('no import found to check');
for (const problem of problems) console.error(problem);
console.log(`${count} imports checked in ${layers.size} folders and files, ${problems.length} problems`);
process.exit(problems.length ? 1 : 0);
