// SPDX-License-Identifier: Apache-2.0
// Shared by cameras.mjs, hulls.mjs and methods.mjs: keeps finished results in OUT/kept, written atomically, so that a
// killed run resumes after them; scores of a character; OUT/rows.json.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { mean, parseCsv, standardError } from '../../site/measured/sources.mjs';

export const run = (program, ...words) => execFileSync(program, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });

function writeWhole(path, value) {
  writeFileSync(`${path}.part`, value);
  renameSync(`${path}.part`, path);
}

// Returns the kept result of an earlier run under this name, or else measures and keeps it.
export function kept(out, name, measure) {
  const folder = join(out, 'kept'), path = join(folder, `${name.replace(/[^A-Za-z0-9.]+/g, '-')}.json`);
  if (existsSync(path)) return JSON.parse(readFileSync(path, 'utf8'));
  const value = measure();
  mkdirSync(folder, { recursive: true });
  writeWhole(path, JSON.stringify(value));
  console.log(`${name}: ${JSON.stringify(value)}`);
  return value;
}

const places = (value, digits) => (Number.isFinite(value) ? Number(value.toFixed(digits)) : undefined);

// Means over views of PSNR-FG and SSIM-FG with their standard errors.
export function meanScores(views) {
  const [psnr, ssim] = ['psnr_db', 'ssim'].map((key) => views.map((view) => Number(view[key])));
  return {
    views: views.length,
    psnr_db: places(mean(psnr), 3), psnr_se_db: places(standardError(psnr), 3),
    ssim: places(mean(ssim), 4), ssim_se: places(standardError(ssim), 4),
  };
}

// Means of a character at the capture's held-out cameras.
export function characterScores(lab, capture, character, folder, options) {
  run(lab, 'score', character, '--capture', capture, '-o', folder, '--input-every', '0', '--flicker', '0', ...options);
  return meanScores(parseCsv(readFileSync(join(folder, 'evaluate.csv'), 'utf8')).filter((row) => row.kind === 'held-out'));
}

// rows: { table, … }; a number without a unit in its name is a ratio or a count. facts: texts. Read by collect.mjs.
export function writeRows(out, facts, rows) {
  writeWhole(join(out, 'rows.json'), `${JSON.stringify({ facts, rows })}\n`);
}

// Row with its numbers rounded to six digits.
export const rounded = (row) => Object.fromEntries(Object.entries(row)
  .map(([key, value]) => [key, typeof value === 'number' ? places(Number(value.toPrecision(6)), 6) : value]));
