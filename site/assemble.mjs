// SPDX-License-Identifier: Apache-2.0
// node site/assemble.mjs OUT DIST CHARACTER: the folder that is served.
// OUT/{index,steer}.html, their scripts, styles and pictures, OUT/fourdvt-viewer (DIST, the built web package), OUT/character (a baked one).
// Replaces only what it makes.
import { copyFileSync, cpSync, existsSync, mkdirSync, rmSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const kPageFiles = ['index.html', 'site.css', 'site.js', 'steer.html', 'steer.js', 'layers.jpg'];

function fail(message) {
  console.error(`assemble: ${message}`);
  process.exit(1);
}

const [out, dist, character] = process.argv.slice(2).map((path) => resolve(path));
if (!out || !dist || !character) fail('usage: node site/assemble.mjs OUT DIST CHARACTER');
const needed = [
  [join(dist, 'fourdvt-viewer.js'), 'build the web package first: npm run build in web/'],
  [join(character, 'character.gltf'), 'bake a character first: fourdvt bake CAPTURE -o CHARACTER'],
];
for (const [path, remedy] of needed) if (!existsSync(path)) fail(`${path} is missing; ${remedy}`);

const here = dirname(fileURLToPath(import.meta.url));
mkdirSync(out, { recursive: true });
for (const name of kPageFiles) copyFileSync(join(here, name), join(out, name));
for (const [name, folder] of [['fourdvt-viewer', dist], ['character', character]]) {
  rmSync(join(out, name), { recursive: true, force: true });
  cpSync(folder, join(out, name), { recursive: true, dereference: true });
}
console.log(`site assembled in ${out}`);
