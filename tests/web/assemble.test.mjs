// SPDX-License-Identifier: Apache-2.0
// The assembled page offers a choice only where the module that it needs was built.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

let folder;
before(() => { folder = mkdtempSync(join(tmpdir(), 'fourdvt-assemble-')); });
after(() => rmSync(folder, { recursive: true, force: true }));

// The index page as it is served with these files in the built web package, and with characters from cameras or without.
function indexWith(modules, hasCameras = true) {
  const [out, dist, character, cameras] = ['out', 'dist', 'character', 'cameras'].map((name) => join(folder, name));
  for (const made of [out, dist, character, cameras]) {
    rmSync(made, { recursive: true, force: true });
    mkdirSync(made);
  }
  for (const name of ['fourdvt-viewer.js', ...modules]) writeFileSync(join(dist, name), '');
  writeFileSync(join(character, 'character.gltf'), '{}');
  execFileSync(process.execPath, [fileURLToPath(new URL('../../site/assemble.mjs', import.meta.url)), out, dist, character,
    ...(hasCameras ? [cameras] : [])]);
  return readFileSync(join(out, 'index.html'), 'utf8');
}

test('OpenCV\'s optical flow is offered where its module lies, and only there', () => {
  const source = readFileSync(new URL('../../site/index.html', import.meta.url), 'utf8');
  assert.equal(indexWith(['fourdvt-opencv.js']), source);
  const without = indexWith([]);
  assert.doesNotMatch(without, /flow-opencv/);
  assert.match(without, /value="flow-dis"/);
  assert.equal(without.split('\n').length, source.split('\n').length - 1, 'nothing else is left out');
});

test('the pages with characters from cameras are linked where there are any', () => {
  const withCameras = indexWith([]);
  for (const page of ['cameras.html', 'methods.html']) {
    assert.ok(withCameras.includes(`href="${page}"`), page);
    assert.ok(existsSync(join(folder, 'out', page)), page);
  }
  assert.doesNotMatch(indexWith([], false), /(cameras|methods)\.html/);
  assert.ok(!existsSync(join(folder, 'out', 'cameras.html')));
});

test('documents and examples are served', () => {
  indexWith([], false);
  for (const path of ['docs/index.html', 'docs/algorithms.html', 'docs/cameras.html', 'docs/docs.css', 'examples/embed.html'])
    assert.ok(existsSync(join(folder, 'out', path)), path);
});
