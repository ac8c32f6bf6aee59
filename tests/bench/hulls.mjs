#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// hulls.mjs FOURDVT CAPTURE OUT [SEQUENCES]: surfaces from silhouettes against their tolerance, and refined by stereo. Hulls on
// one thread, stereo on all: overlap with the silhouettes, triangles, milliseconds a frame by stage, fallbacks; at the test
// frames distances to the capture's own meshes and plain projective texturing at the held-out cameras. Prints a table and
// writes OUT/hulls.json and OUT/hulls.md. Finished rows are kept in OUT.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [tool, capture, out, sequences] = process.argv.slice(2);
if (!out) {
  console.error('usage: hulls.mjs FOURDVT CAPTURE OUT [SEQUENCES]');
  process.exit(2);
}
mkdirSync(out, { recursive: true });

const oneThread = ['--refine', 'none', '--jobs', '1'];
const cases = [
  ...[0.25, 0.5, 1, 2, 4, 8].map((px) => ({
    surface: 'polyhedral', setting: `${px} px`, options: ['--hull', 'polyhedral', '--contour-tolerance', `${px}`, ...oneThread],
  })),
  ...[[3, 0.1], [5, 0], [5, 0.1], [8, 0.1], [12, 0.1]].map(([mm, adaptivity]) => ({
    surface: 'volumetric', setting: `${mm} mm, adaptivity ${adaptivity}`,
    options: ['--hull', 'volumetric', '--voxel-mm', `${mm}`, '--adaptivity', `${adaptivity}`, ...oneThread],
  })),
  { surface: 'stereo', setting: '5 mm', options: ['--hull', 'volumetric', '--refine', 'stereo'] },
  { surface: 'given', setting: '' },
];

const only = sequences ? ['--sequences', sequences] : [];
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

// Means over the sequences' views of the columns that `fourdvt evaluate --surface` prints after the name.
function scores(folder) {
  const text = execFileSync(tool, ['evaluate', folder, '--surface', '--reference', capture, ...only], { encoding: 'utf8' });
  const rows = text.trim().split('\n').slice(1).map((line) => line.trim().split(/\s+/).slice(1).map(Number));
  const column = (k) => rows.reduce((sum, row) => sum + row[k] * row[0], 0) / rows.reduce((sum, row) => sum + row[0], 0);
  return {
    psnr_db: column(1), ssim: column(2), triangles: column(3), to_given_mean_mm: column(4), to_given_p95_mm: column(6),
    from_given_mean_mm: column(7), from_given_p95_mm: column(8), still_change_mm: column(9),
  };
}

function measure({ surface, setting, options }) {
  if (!options) return { surface, setting, ...scores(capture) };
  const folder = join(out, `${surface}-${setting}`.replace(/[^a-z0-9.]+/g, '-'));
  if (!existsSync(join(folder, 'reconstruct.json')))
    execFileSync(tool, ['reconstruct', capture, '-o', folder, ...options, ...only], { stdio: ['ignore', 'ignore', 'inherit'] });
  const report = JSON.parse(readFileSync(join(folder, 'reconstruct.json'), 'utf8'));
  const frames = Object.values(report.sequences).flat();
  return {
    surface, setting, ...scores(folder), frames: frames.length,
    overlap_mean: report.mean_overlap, overlap_lowest: report.lowest_overlap,
    triangles: mean(frames.map((f) => f.triangles)),
    silhouettes_ms: mean(frames.map((f) => f.silhouettes_ms)),
    hull_ms: mean(frames.map((f) => f.hull_ms)), stereo_ms: mean(frames.map((f) => f.stereo_ms)),
    fallbacks: frames.filter((f) => f.fallback).length,
  };
}

const columns = [
  ['surface', 'surface'], ['setting', 'setting'], ['overlap', 'overlap_mean', 4], ['lowest', 'overlap_lowest', 4],
  ['triangles', 'triangles', 0], ['silhouettes, ms', 'silhouettes_ms', 0], ['hull, ms', 'hull_ms', 0],
  ['stereo, ms', 'stereo_ms', 0], ['fallbacks', 'fallbacks', 0], ['to given, mm', 'to_given_mean_mm', 2],
  ['95 %', 'to_given_p95_mm', 1], ['from given, mm', 'from_given_mean_mm', 2], ['95 %', 'from_given_p95_mm', 1],
  ['still change, mm', 'still_change_mm', 2], ['held-out dB', 'psnr_db', 2], ['SSIM', 'ssim', 3],
];
const cell = (value, digits) => (digits === undefined ? value : Number.isFinite(value) ? value.toFixed(digits) : '–');
const lines = [`| ${columns.map(([title]) => title).join(' | ')} |`, `|${columns.map(() => '---').join('|')}|`];
console.log(lines.join('\n'));
const results = [];
for (const one of cases) {
  const result = measure(one);
  results.push(result);
  lines.push(`| ${columns.map(([, key, digits]) => cell(result[key], digits)).join(' | ')} |`);
  console.log(lines.at(-1));
}
writeFileSync(join(out, 'hulls.json'), `${JSON.stringify(results, null, 1)}\n`);
const frames = results[0].frames;
writeFileSync(join(out, 'hulls.md'), `# Surfaces from cameras alone

Made by \`node tests/bench/hulls.mjs\` from ${frames} frames${sequences ? ` (${sequences})` : ''} of the sample capture, whose own meshes are not
looked at. Overlap: intersection over union of surface and silhouette, mean and lowest over all cameras and frames.
Milliseconds a frame: hulls on one core, stereo on all of them with software rendering; a polyhedral hull includes a coarse
carving for its bounds and the checks of the mesh. Distances, in the mean and at 95 %, are to and from the capture's meshes, which
stand about 2 mm outside the performer. Still change: how much the surface moves from a frame to the next where the
capture's mesh moves by less than half a millimetre. Held-out: plain projective texturing of the surface from the videos, at the
held-out cameras (PSNR-FG, SSIM-FG).

${lines.join('\n')}
`);
