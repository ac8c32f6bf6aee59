// SPDX-License-Identifier: Apache-2.0
// node site/assemble.mjs OUT DIST CHARACTER [CAMERAS]: assembles the site in OUT.
// node site/assemble.mjs --add OUT DIST CHARACTER [CAMERAS]: updates an OUT that is being served: adds the character's
// files, its manifest last (an earlier character's files stay, for pages that play it), and the characters from cameras,
// then their pages; does not change the rest.
// node site/assemble.mjs --pages OUT DIST CHARACTER [CAMERAS]: copies only files of site/ and web/examples (web/develop.mjs).
// OUT/{index,steer}.html, their scripts, styles and pictures, OUT/live (the console of fourdvt live), OUT/measured (the page of
// figures), OUT/docs (the documents), OUT/examples, OUT/fourdvt-viewer (DIST, the built web package), OUT/character (a baked
// one), OUT/character.report (its report, if it lies beside it), OUT/{cameras,methods,slider}.html and OUT/cameras (characters
// from cameras: hull, refined, tracked, steered).
// An element of a page with data-needs="FILE", on a line of its own, is left out where DIST has no such file; with
// data-needs="cameras", where CAMERAS is not given, with data-needs="report", where there is none.
// Replaces only what it makes. Refuses links inside CHARACTER and CAMERAS, which may come from elsewhere.
import { copyFileSync, cpSync, existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

import { renderDocs } from './docs/render.mjs';

const kPageFiles = ['index.html', 'site.css', 'site.js', 'sound.js', 'steer.html', 'steer.js', 'place.js', 'layers.jpg', 'live/index.html', 'live/live.css', 'live/live.js',
  'measured/index.html', 'measured/measured.css', 'measured/figures.json'];

const kCameraFiles = ['cameras.html', 'cameras.js', 'methods.html', 'methods.js', 'slider.html', 'slider.js', 'together.js'];

function fail(message) {
  console.error(`assemble: ${message}`);
  process.exit(1);
}

const words = process.argv.slice(2), paths = words.filter((word) => !word.startsWith('--'));
const adds = words.includes('--add'), onlyPages = words.includes('--pages');
const [out, dist, character, cameras] = paths.map((path) => resolve(path));
if (!out || !dist || !character) fail('usage: node site/assemble.mjs [--add | --pages] OUT DIST CHARACTER [CAMERAS]');
const needed = [
  [join(dist, 'fourdvt-viewer.js'), 'build the web package first: npm run build in web/'],
  [join(character, 'character.gltf'), 'bake a character first: fourdvt bake CAPTURE -o CHARACTER'],
];
for (const [path, remedy] of needed) if (!existsSync(path)) fail(`${path} is missing; ${remedy}`);

function refuseLinks(folder) {
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isSymbolicLink()) fail(`${path} is a link, which would serve a file from elsewhere; if it is meant, assemble a copy of the folder made with cp -RL`);
    if (entry.isDirectory()) refuseLinks(path);
  }
}

const report = `${character}.report`;
for (const folder of [character, report, cameras]) if (folder && existsSync(folder)) refuseLinks(folder);

// Removes the lines with data-needs whose file or input is missing.
function onlyWhatWorks(html) {
  const works = (line) => {
    const needed = line.match(/ data-needs="([^"]+)"/);
    if (!needed) return true;
    if (needed[1] === 'cameras') return Boolean(cameras);
    return existsSync(needed[1] === 'report' ? report : join(dist, needed[1]));
  };
  return html.split('\n').filter(works).join('\n');
}

const here = dirname(fileURLToPath(import.meta.url));

// Replaces a folder by renaming, so that readers see the old one or the new one.
function replaceFolder(name, folder) {
  cpSync(folder, join(out, `${name}.part`), { recursive: true, dereference: true });
  rmSync(join(out, name), { recursive: true, force: true });
  renameSync(join(out, `${name}.part`), join(out, name));
}

// Adds the character's files before its manifest, so that every manifest that readers see has its files.
function addCharacter() {
  const isLast = (name) => /\.(gltf|start\.bin)$/.test(name);
  const names = readdirSync(character).sort((a, b) => isLast(a) - isLast(b) || b.localeCompare(a));
  for (const name of names) {
    cpSync(join(character, name), join(out, 'character', `${name}.part`), { recursive: true });
    renameSync(join(out, 'character', `${name}.part`), join(out, 'character', name));
  }
}

// Preload links from the player's build, which replace the mark in each page.
const preload = existsSync(join(dist, 'preload.html')) ? readFileSync(join(dist, 'preload.html'), 'utf8').replace(/^(?=.)/gm, '    ') : '';
const withPreload = (html) => html.replace('    <!-- preload -->\n', () => preload);

function writePages() {
  for (const name of [...kPageFiles, ...(cameras ? kCameraFiles : [])]) {
    const target = join(out, name);
    if (!name.endsWith('.html')) copyFileSync(join(here, name), `${target}.part`);
    else writeFileSync(`${target}.part`, withPreload(onlyWhatWorks(readFileSync(join(here, name), 'utf8'))));
    renameSync(`${target}.part`, target);
  }
}

for (const name of ['measured', 'live']) mkdirSync(join(out, name), { recursive: true });
const folders = { examples: join(here, '../web/examples'), 'fourdvt-viewer': dist, character };
if (onlyPages) {
  replaceFolder('examples', folders.examples);
  writePages();
  process.exit(0);
}
for (const [name, folder] of adds ? [] : Object.entries(folders)) replaceFolder(name, folder);
if (adds) addCharacter();
if (existsSync(report)) replaceFolder('character.report', report);
else rmSync(join(out, 'character.report'), { recursive: true, force: true });
if (cameras) replaceFolder('cameras', cameras);
if (!adds) renderDocs(join(here, '..'), join(out, 'docs'));
writePages();
console.log(`site assembled in ${out}`);
