// SPDX-License-Identifier: Apache-2.0
// The assembled page offers a choice only where the module that it needs was built.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

let folder;
before(() => { folder = mkdtempSync(join(tmpdir(), 'fourdvt-assemble-')); });
after(() => rmSync(folder, { recursive: true, force: true }));

const assemble = fileURLToPath(new URL('../../site/assemble.mjs', import.meta.url));

// Makes the folders that a site is assembled from; the web package has these files.
function inputs(modules) {
  const [out, dist, character, cameras, report] = ['out', 'dist', 'character', 'cameras', 'character.report'].map((name) => join(folder, name));
  for (const made of [out, dist, character, cameras, report]) {
    rmSync(made, { recursive: true, force: true });
    mkdirSync(made);
  }
  for (const name of ['fourdvt-viewer.js', ...modules]) writeFileSync(join(dist, name), '');
  writeFileSync(join(character, 'character.gltf'), '{}');
  writeFileSync(join(report, 'report.html'), 'report');
  return [out, dist, character, cameras];
}

// Assembles the index page with these files in the built web package, with or without characters from cameras.
function indexWith(modules, hasCameras = true) {
  const [out, dist, character, cameras] = inputs(modules);
  execFileSync(process.execPath, [assemble, out, dist, character, ...(hasCameras ? [cameras] : [])]);
  return readFileSync(join(out, 'index.html'), 'utf8');
}

test('OpenCV\'s optical flow is offered where its module lies, and only there', () => {
  const source = readFileSync(new URL('../../site/index.html', import.meta.url), 'utf8').replace('    <!-- preload -->\n', '');
  assert.equal(indexWith(['fourdvt-opencv.js']), source);
  const without = indexWith([]);
  assert.doesNotMatch(without, /flow-opencv/);
  assert.match(without, /value="flow-dis"/);
  assert.equal(without.split('\n').length, source.split('\n').length - 1, 'nothing else is left out');
});

test('pages begin the downloads that the player\'s build lists', () => {
  const [out, dist, character, cameras] = inputs([]);
  writeFileSync(join(dist, 'preload.html'), '<link rel="a">\n<link rel="b">\n');
  execFileSync(process.execPath, [assemble, out, dist, character, cameras]);
  for (const page of ['index.html', 'steer.html']) {
    assert.ok(readFileSync(join(out, page), 'utf8').includes('    <link rel="a">\n    <link rel="b">\n    <script'), page);
  }
});

test('the pages with characters from cameras are linked where there are any', () => {
  const withCameras = indexWith([]);
  for (const page of ['cameras.html', 'methods.html', 'slider.html']) {
    assert.ok(withCameras.includes(`href="${page}"`), page);
    assert.ok(existsSync(join(folder, 'out', page)), page);
  }
  assert.doesNotMatch(indexWith([], false), /(cameras|methods|slider)\.html/);
  assert.ok(!existsSync(join(folder, 'out', 'cameras.html')));
});

test('the report is served beside the character, and linked where there is one', () => {
  assert.match(indexWith([]), /href="character\.report\/report\.html"/);
  assert.equal(readFileSync(join(folder, 'out', 'character.report', 'report.html'), 'utf8'), 'report');
  const [out, dist, character] = inputs([]);
  rmSync(`${character}.report`, { recursive: true });
  execFileSync(process.execPath, [assemble, out, dist, character]);
  assert.doesNotMatch(readFileSync(join(out, 'index.html'), 'utf8'), /report\.html/);
});

test('documents and examples are served', () => {
  indexWith([], false);
  for (const path of ['docs/index.html', 'docs/algorithms.html', 'docs/cameras.html', 'docs/docs.css', 'examples/embed.html'])
    assert.ok(existsSync(join(folder, 'out', path)), path);
});

test('links in a folder of characters are refused by name, so that no file from elsewhere is served', () => {
  for (const [inside, target] of [['character/poster.webp', join(folder, 'secret')], ['character/parts', folder],
    ['cameras/hull/mesh.bin', join(folder, 'secret')], ['character/lost.bin', 'nowhere']]) {
    const paths = inputs([]), link = join(folder, inside);
    writeFileSync(join(folder, 'secret'), 'secret');
    mkdirSync(join(folder, 'cameras', 'hull'));
    symlinkSync(target, link);
    const { status, stderr } = spawnSync(process.execPath, [assemble, ...paths], { encoding: 'utf8' });
    assert.equal(status, 1, inside);
    assert.ok(stderr.startsWith(`assemble: ${link} is a link`), stderr);
    assert.match(stderr, /cp -RL/);
    assert.ok(!existsSync(join(folder, 'out', 'index.html')), 'nothing is assembled');
  }
});

test('a folder of characters may be a link itself', () => {
  const [out, dist, character, cameras] = inputs([]), link = join(folder, 'linked');
  symlinkSync(character, link);
  execFileSync(process.execPath, [assemble, out, dist, link, cameras]);
  assert.ok(existsSync(join(out, 'character', 'character.gltf')));
});
