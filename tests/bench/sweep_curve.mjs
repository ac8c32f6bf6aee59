#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// sweep_curve.mjs FOURDVT_LAB OUT CAPTURE [CAPTURE2 …] [--sequences A,B] [--quick]: held-out PSNR-FG and SSIM-FG of the
// method "sweep" over its number of planes and its band, and of "fvvr", on the surfaces of each capture. Prints a table
// and writes OUT/sweep_curve.json and OUT/sweep_curve.md. The defaults of SweepOptions are chosen from it.
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';

const kPlanes = [4, 8, 12, 16, 24, 32], kBands_mm = [4, 8, 16, 32, 64];
const kPlanesOfBands = 12, kBandOfPlanes_mm = 32;  // fixed while the other one varies

const args = process.argv.slice(2), further = [];
if (args.includes('--quick')) further.push(...args.splice(args.indexOf('--quick'), 1));
if (args.includes('--sequences')) further.push(...args.splice(args.indexOf('--sequences'), 2));
const [lab, out, ...captures] = args;
if (!captures.length) {
  console.error('usage: sweep_curve.mjs FOURDVT_LAB OUT CAPTURE [CAPTURE2 …] [--sequences A,B] [--quick]');
  process.exit(2);
}
mkdirSync(out, { recursive: true });

// Means over the sequences' views of the columns that `fourdvt-lab methods` prints.
function scores(capture, method, options) {
  const text = execFileSync(lab, ['methods', capture, '--methods', method, ...options, ...further],
    { encoding: 'utf8' });
  const rows = text.trim().split('\n').slice(1).map((line) => line.trim().split(/\s+/).slice(2).map(Number));
  const views = rows.reduce((sum, row) => sum + row[0], 0);
  const column = (k) => rows.reduce((sum, row) => sum + row[k] * row[0], 0) / views;
  return { views, psnr_db: column(1), ssim: column(2) };
}

const cases = [
  { method: 'fvvr' },
  ...kPlanes.map((planes) => ({ method: 'sweep', planes, band_mm: kBandOfPlanes_mm })),
  ...kBands_mm.filter((band_mm) => band_mm !== kBandOfPlanes_mm)
    .map((band_mm) => ({ method: 'sweep', planes: kPlanesOfBands, band_mm })),
];
const lines = [
  `| method | planes | band, mm |${captures.map((c) => ` ${basename(resolve(c))}: dB | SSIM |`).join('')}`,
  `|---|---|---|${captures.map(() => '---|---|').join('')}`,
];
console.log(lines.join('\n'));
const results = [];
for (const one of cases) {
  const options = one.planes ? ['--sweep-planes', `${one.planes}`, '--sweep-band-mm', `${one.band_mm}`] : [];
  const cells = captures.map((capture) => {
    const result = { ...one, capture: basename(resolve(capture)), ...scores(capture, one.method, options) };
    results.push(result);
    return ` ${result.psnr_db.toFixed(2)} | ${result.ssim.toFixed(4)} |`;
  });
  lines.push(`| ${one.method} | ${one.planes ?? ''} | ${one.band_mm ?? ''} |${cells.join('')}`);
  console.log(lines.at(-1));
}
writeFileSync(join(out, 'sweep_curve.json'), `${JSON.stringify(results, null, 1)}\n`);
writeFileSync(join(out, 'sweep_curve.md'), `# Planes and band of the sweep

Made by \`node tests/bench/sweep_curve.mjs\`${further.length ? ` (${further.join(' ')})` : ''}: PSNR-FG and SSIM-FG at the held-out cameras, from
the raw pictures, on each capture's own surfaces.

${lines.join('\n')}
`);
