#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// hulls.mjs FOURDVT FOURDVT_LAB CAPTURE OUT [SEQUENCES]: surfaces from silhouettes by tolerance, and refined by stereo.
// Hulls on one thread, stereo on all: overlap with the silhouettes, triangles, milliseconds per frame by stage,
// fallbacks; at the test frames, distances to the capture's own meshes, and plain projective texturing at the held-out
// cameras. Writes OUT/rows.json, from which site/measured/documents.mjs makes site/measured/hulls.md. A killed run
// resumes after its finished results.
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { mean } from '../../site/measured/sources.mjs';
import { kept, rounded, run, writeRows } from './kept.mjs';

const [tool, lab, capture, out, sequences] = process.argv.slice(2);
if (!out) {
  console.error('usage: hulls.mjs FOURDVT FOURDVT_LAB CAPTURE OUT [SEQUENCES]');
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

// Means over the sequences' views of the columns that `fourdvt-lab surfaces` prints after the sequence's name.
function scores(folder) {
  const rows = run(lab, 'surfaces', folder, '--reference', capture, ...only).trim().split('\n').slice(1).map((line) => line.trim().split(/\s+/).slice(1).map(Number));
  const column = (k) => rows.reduce((sum, row) => sum + row[k] * row[0], 0) / rows.reduce((sum, row) => sum + row[0], 0);
  return {
    psnr_db: column(1), ssim: column(2), triangles: column(3), to_given_mean_mm: column(4), to_given_p95_mm: column(6),
    from_given_mean_mm: column(7), from_given_p95_mm: column(8), still_change_mm: column(9),
  };
}

function measure({ surface, setting, options }) {
  if (!options) return rounded(scores(capture));
  const folder = join(out, `${surface}-${setting}`.replace(/[^a-z0-9.]+/g, '-'));
  if (!existsSync(join(folder, 'reconstruct.json'))) run(tool, 'reconstruct', capture, '-o', folder, ...options, ...only);
  const report = JSON.parse(readFileSync(join(folder, 'reconstruct.json'), 'utf8'));
  const frames = Object.values(report.sequences).flat();
  return rounded({
    ...scores(folder), frames: frames.length, overlap_mean: report.mean_overlap, overlap_lowest: report.lowest_overlap,
    triangles: mean(frames.map((f) => f.triangles)), silhouettes_ms: mean(frames.map((f) => f.silhouettes_ms)),
    hull_ms: mean(frames.map((f) => f.hull_ms)), stereo_ms: mean(frames.map((f) => f.stereo_ms)),
    fallbacks: frames.filter((f) => f.fallback).length,
  });
}

const rows = cases.map((one) => ({ table: 'surfaces', surface: one.surface, setting: one.setting, ...kept(out, `${one.surface} ${one.setting}`, () => measure(one)) }));
writeRows(out, { sequences: sequences ?? 'all', frames: rows[0].frames }, rows);
