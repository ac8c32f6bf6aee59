#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// cameras.mjs FOURDVT FOURDVT_LAB CAPTURE OUT [SEQUENCE]: scores of characters from cameras at the held-out cameras:
// hull, refined hull and the capture's own mesh, textured from the raw videos and as baked, from M cameras; bytes of
// pictures and surfaces; layers against cameras over the bitrate, on the capture's own mesh; and the same on the walk
// round the layers' default rate. Writes OUT/rows.json,
// from which site/measured/documents.mjs makes site/measured/cameras.md. A killed run resumes after its finished
// results.
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { characterScores, kept, run, writeRows } from './kept.mjs';

const [tool, lab, capture, out, sequence = 'run'] = process.argv.slice(2);
if (!out) {
  console.error('usage: cameras.mjs FOURDVT FOURDVT_LAB CAPTURE OUT [SEQUENCE]');
  process.exit(2);
}
mkdirSync(out, { recursive: true });
const counts = [2, 3, 4, 6, 8];
const rates = [24, 29, 32, 36, 40];
const walkRates = [26, 29, 32];
const methods = ['fvvr', 'sweep'];  // the first draws the raw videos, the last is the characters' default
const only = ['--sequences', sequence], onlyWalk = ['--sequences', 'walk'];

function surfaceFolder(name, options) {
  const folder = join(out, name);
  if (!existsSync(join(folder, 'reconstruct.json'))) run(tool, 'reconstruct', capture, '-o', folder, ...only, ...options);
  return folder;
}

function bake(name, folder, options, chosen = only) {
  const character = join(out, name);
  if (!existsSync(join(character, 'character.gltf'))) run(tool, 'bake', folder, '-o', character, ...chosen, '--no-classes', ...options);
  // Row of the sequence: video, surfaces or positions, labels, offsets, alignment, index, total, Mbit/s (video + rest).
  const row = run(tool, 'inspect', character).split('\n').filter((line) => line.startsWith(chosen[1]) && line.includes('+')).at(-1);
  const [, all, pictures, surfaces] = /([\d.]+) \(([\d.]+) \+ ([\d.]+)\)/.exec(row).map(Number);
  return { character, all, pictures, surfaces };
}

// Means over the held-out views, from the printed table.
function rawScores(folder, closest) {
  const row = run(lab, 'surfaces', folder, ...only, '--closest', `${closest}`).trim().split('\n').at(-1).trim().split(/\s+/);
  return { views: Number(row[1]), psnr_db: Number(row[2]), ssim: Number(row[3]) };
}
const bakedScores = (character, more = [], chosen = only) => characterScores(lab, capture, character, join(out, 'scores'), [...chosen, ...more]);

const rows = [];
const surfaces = [
  ['hull', surfaceFolder('hull', ['--hull', 'polyhedral'])],
  ['refined hull', surfaceFolder('refined', [])],
  ['given mesh', capture],
];
for (const [surface, folder] of surfaces) {
  const baked = bake(`${surface.replace(' ', '-')}-baked`, folder, ['--appearance', 'cameras']);
  rows.push({ table: 'bytes', surface, pictures_mbit_s: baked.pictures, surfaces_mbit_s: baked.surfaces, all_mbit_s: baked.all });
  for (const closest of counts) {
    const name = `${surface}, ${closest} cameras`;
    rows.push({ table: 'quality', surface, from: 'raw', method: methods[0], closest, ...kept(out, `${name}, raw`, () => rawScores(folder, closest)) });
    for (const method of methods)
      rows.push({ table: 'quality', surface, from: 'baked', method, closest,
        ...kept(out, `${name}, ${method}`, () => bakedScores(baked.character, ['--closest', `${closest}`, '--method', method])) });
  }
}
for (const crf of rates) {
  for (const appearance of ['layers', 'cameras']) {
    const name = `${appearance}-crf${crf}`, baked = bake(name, capture, ['--appearance', appearance, '--crf', `${crf}`]);
    rows.push({ table: 'rate', crf, appearance, all_mbit_s: baked.all, ...kept(out, name, () => bakedScores(baked.character)) });
  }
}
for (const [appearance, crf] of [['layers'], ...walkRates.map((rate) => ['cameras', rate])]) {
  const name = `walk-${appearance}${crf ? `-crf${crf}` : ''}`;
  const baked = bake(name, capture, ['--appearance', appearance, ...(crf ? ['--crf', `${crf}`] : [])], onlyWalk);
  rows.push({ table: 'walk', appearance, ...(crf && { crf }), all_mbit_s: baked.all, ...kept(out, name, () => bakedScores(baked.character, [], onlyWalk)) });
}
const { options } = JSON.parse(readFileSync(join(out, 'given-mesh-baked.report', 'report.json'), 'utf8'));
writeRows(out, { sequence, crf: options.crf }, rows);
