// SPDX-License-Identifier: Apache-2.0
// site/bake_stamp.mjs: what changes a bake changes its stamp, and nothing else does.
import assert from 'node:assert/strict';
import { appendFileSync, cpSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { bakeStamp, foldersBelow, sourcesOf } from '../../site/bake_stamp.mjs';

const kRoot = join(dirname(fileURLToPath(import.meta.url)), '../..');
const root = mkdtempSync(join(tmpdir(), 'fourdvt-stamp-'));
for (const name of ['native', 'shaders']) cpSync(join(kRoot, name), join(root, name), { recursive: true });
after(() => rmSync(root, { recursive: true }));

function changes(path, folders) {
  const before = bakeStamp(root, folders);
  appendFileSync(join(root, path), '// edited\n');
  return bakeStamp(root, folders) !== before;
}

test('folders below are those that the layering allows, through others too', () => {
  const layering = 'a:\nb: a\nc: a\nd: b\n';
  assert.deepEqual(foldersBelow(layering, ['d']), ['a', 'b', 'd']);
  assert.throws(() => foldersBelow(layering, ['e']), /no folder e/);
});

test('sources and shaders of the bake change its stamp', () => {
  for (const path of ['native/bake/bake.cpp', 'native/bake/texels/fill.cpp', 'native/capture/pictures.cpp', 'native/package/manifest.cpp', 'native/render/flow/gpu_flow.cpp',
    'native/tools/bake_command.cpp', 'shaders/gles/bake_resample.frag', 'shaders/gles/bake_camera.glsl']) assert.ok(changes(path), path);
});

test('the player, other commands and their shaders do not', () => {
  for (const path of ['native/player/player.cpp', 'native/player/parts/gop_cache.cpp', 'native/tools/render_command.cpp', 'native/live/service.cpp', 'native/edge/character_player.cpp',
    'native/reconstruct/stereo/plane_sweep.cpp', 'native/capture/CAPTURE.md', 'shaders/gles/style_sketch.frag', 'shaders/gles/barcode_cells.frag']) assert.ok(!changes(path), path);
});

test('other folders have stamps of their own', () => {
  assert.ok(changes('native/reconstruct/surface_cleaning.cpp', ['reconstruct/run']));
  assert.ok(!changes('native/bake/bake.cpp', ['reconstruct/run']));
  assert.ok(sourcesOf(root, ['reconstruct/run']).includes('shaders/gles/stereo_costs.frag'));
});
