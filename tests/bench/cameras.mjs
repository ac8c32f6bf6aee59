#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// cameras.mjs FOURDVT CAPTURE OUT [SEQUENCE]: characters from cameras at the held-out cameras: hull, refined hull and the
// capture's own mesh, textured from the raw videos and as baked, from M cameras; bytes of pictures and surfaces; and
// layers against cameras over the bitrate, on the capture's own mesh. Prints tables, and writes OUT/cameras.json and
// OUT/cameras.md. Finished surfaces and characters are kept in OUT.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [tool, capture, out, sequence = 'run'] = process.argv.slice(2);
if (!out) {
  console.error('usage: cameras.mjs FOURDVT CAPTURE OUT [SEQUENCE]');
  process.exit(2);
}
mkdirSync(out, { recursive: true });
const counts = [2, 3, 4, 6, 8];
const rates = [24, 29, 32, 36, 40];
const methods = ['fvvr', 'sweep'];  // the raw videos are drawn by the first, characters by default by the last
const only = ['--sequences', sequence];
const run = (...words) => execFileSync(tool, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });

function surfaceFolder(name, options) {
  const folder = join(out, name);
  if (!existsSync(join(folder, 'reconstruct.json'))) run('reconstruct', capture, '-o', folder, ...only, ...options);
  return folder;
}

function bake(name, folder, options) {
  const character = join(out, name);
  if (!existsSync(join(character, 'character.gltf'))) run('bake', folder, '-o', character, ...only, '--no-classes', ...options);
  // The sequence's row: video, surfaces or positions, labels, offsets, alignment, index, total, Mbit/s (video + rest).
  const row = run('inspect', character).split('\n').filter((line) => line.startsWith(sequence) && line.includes('+')).at(-1);
  const [, all, video, rest] = /([\d.]+) \(([\d.]+) \+ ([\d.]+)\)/.exec(row).map(Number);
  return { character, all, video, rest };
}

// PSNR-FG and SSIM-FG, means over the held-out views.
function rawScore(folder, closest) {
  const row = run('evaluate', folder, '--surface', ...only, '--closest', `${closest}`).trim().split('\n').at(-1).trim().split(/\s+/);
  return { psnr: Number(row[2]), ssim: Number(row[3]) };
}
function bakedScore(character, more = []) {
  const text = run('evaluate', capture, '--character', character, ...only, '--input-every', '0', '--flicker', '0', ...more);
  const row = text.split('\n').find((line) => line.trim().startsWith('mean')).trim().split(/\s+/);
  return { psnr: Number(row[2]), ssim: Number(row[3]) };
}

const text = ({ psnr, ssim }) => `${psnr.toFixed(2)} / ${ssim.toFixed(3)}`;
const table = (head, rows) => [head, head.map(() => '---'), ...rows].map((row) => `| ${row.join(' | ')} |`).join('\n');

const surfaces = [
  ['hull', surfaceFolder('hull', ['--hull', 'polyhedral'])],
  ['refined hull', surfaceFolder('refined', [])],
  ['given mesh', capture],
];
const results = { sequence, surfaces: [], rates: [] };
for (const [name, folder] of surfaces) {
  const baked = bake(`${name.replace(' ', '-')}-baked`, folder, ['--appearance', 'cameras']);
  const row = { name, ...baked, raw: [], scores: Object.fromEntries(methods.map((method) => [method, []])) };
  for (const m of counts) {
    row.raw.push(rawScore(folder, m));
    for (const method of methods) row.scores[method].push(bakedScore(baked.character, ['--closest', `${m}`, '--method', method]));
    console.log(`${name}, ${m} cameras: raw ${text(row.raw.at(-1))}, baked ${methods.map((method) => `${method} ${text(row.scores[method].at(-1))}`).join(', ')}`);
  }
  results.surfaces.push(row);
}
for (const crf of rates) {
  const row = { crf };
  for (const appearance of ['layers', 'cameras']) {
    const baked = bake(`${appearance}-crf${crf}`, capture, ['--appearance', appearance, '--crf', `${crf}`]);
    row[appearance] = { ...baked, ...bakedScore(baked.character) };
    console.log(`${appearance}, CRF ${crf}: ${baked.all} Mbit/s, ${text(row[appearance])}`);
  }
  results.rates.push(row);
}
writeFileSync(join(out, 'cameras.json'), `${JSON.stringify(results, null, 1)}\n`);
const quality = table(['surface', 'textured from', ...counts.map((m) => `M = ${m}`)],
  results.surfaces.flatMap(({ name, raw, scores }) => [
    [name, `raw videos, ${methods[0]}`, ...raw.map(text)], ...methods.map((method) => [name, `baked, ${method}`, ...scores[method].map(text)])]));
const bytes = table(['surface', 'pictures, Mbit/s', 'surfaces, Mbit/s', 'all'],
  results.surfaces.map(({ name, video, rest, all }) => [name, video.toFixed(2), rest.toFixed(2), all.toFixed(2)]));
const against = table(['CRF', 'layers, Mbit/s', 'dB / SSIM', 'cameras, Mbit/s', 'dB / SSIM'],
  results.rates.map(({ crf, layers, cameras }) => [crf, layers.all.toFixed(2), text(layers), cameras.all.toFixed(2), text(cameras)]));
writeFileSync(join(out, 'cameras.md'), `# Characters from cameras

Made by \`node tests/bench/cameras.mjs\` from the sample's ${sequence}, at its held-out cameras (PSNR-FG in dB / SSIM-FG). M: cameras that a view is
blended from. Baked with the defaults (CRF 29, vertices on a grid of 1 mm, at most 10,000 triangles where every frame has its own).
The raw videos have mattes, which cut the surface's rim; the baked tiles go on with the performer's colours instead. The given
mesh is as given with the raw videos, and refined (outlines, cameras) where it is baked.

${quality}

${bytes}

Layers (3 of them) against cameras (M = 4, drawn by default, by ${methods.at(-1)}) on the given mesh, refined in both, over the rate factor (the layers' size and the tiles' scale are the defaults throughout):

${against}
`);
console.log(`${quality}\n\n${bytes}\n\n${against}`);
