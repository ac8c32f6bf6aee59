// SPDX-License-Identifier: Apache-2.0
// node site/measured/knobs.mjs [--table]: how far each disturbance of a capture hurts mattes and surfaces, measured with the
// virtual studio's knobs; writes site/measured/knobs.md. About 15 minutes; needs a release build with -DFOURDVT_LAB=ON.
//   Resume   run it again after a kill: finished rows are in build/measured/knobs/HASH, each written as a whole. HASH is
//            that of native/ and shaders/ without Markdown, as committed, and of the studio's options; a row whose options changed is measured anew
//   --table  writes the document from the finished rows alone
import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kTool = process.env.FOURDVT_BIN ?? 'build/release/native/tools/fourdvt';
const kLab = process.env.FOURDVT_LAB_BIN ?? 'build/release/native/lab/tools/fourdvt-lab';
const kStudio = '--room --cameras 6 --size 480x640 --sequences walk --frames 2 --noise 2.5 --seed 31 --no-truth --test-every 2';
const kTogether = '--exposure-drift 8 --white-balance-drift 8 --plate-move 2 --soft-shadows .1 --offset-frames .5 --lens -.25,.1,.5 --bystander --room-size 15';
// name, title, options of the studio. A second --frames replaces the first.
const kRows = [
  ['none', 'none', ''],
  ['exposure', 'exposure strays by 8 %', '--exposure-drift 8'],
  ['white', 'white balance strays by 8 %', '--white-balance-drift 8'],
  ['plate', 'plates 2 pixels off', '--plate-move 2'],
  ['soft', 'penumbra of 10 cm', '--soft-shadows .1'],
  ['offset', 'time offsets, deviation half a frame', '--offset-frames .5'],
  ['lens', 'lens −0.25, 0.1, 0.5', '--lens -.25,.1,.5'],
  ['bystander', 'a second person in the background', '--bystander'],
  ['room', 'room of 15 m', '--room-size 15'],
  ['scale', 'figurine: world divided by 20', '--scale .05'],
  ['large', 'world times 20', '--scale 20'],
  ['clips', 'no plates', '--no-plates'],
  ['longer', 'no plates, 20 frames of walking on the spot', '--no-plates --frames 20'],
  ['together', 'all of exposure to room together', kTogether],
];

const git = (...words) => execFileSync('git', words, { cwd: kRoot, encoding: 'utf8' }).trim();
const hash = createHash('sha256').update([...git('ls-tree', '-r', 'HEAD', 'native', 'shaders').split('\n').filter((line) => !line.endsWith('.md')), kStudio].join('\n')).digest('hex').slice(0, 16);
const folder = join('build/measured/knobs', hash);

/** Runs a program; returns its output, or null and the last line of its error output. */
function output(program, ...words) {
  const { status, stdout, stderr } = spawnSync(program, words, { cwd: kRoot, encoding: 'utf8', maxBuffer: 1 << 26 });
  return status === 0 ? { text: stdout + stderr } : { text: null, error: stderr.trim().split('\n').at(-1) ?? `status ${status}` };
}

const numbersOf = (text, first) => text?.split('\n').findLast((line) => line.startsWith(first))?.match(/-?\d+\.\d+|nan/g)?.map(Number) ?? [];

function measureRow([name, title, options]) {
  const [studio, mattes, surfaces] = ['studio', 'mattes', 'surfaces'].map((step) => join(folder, name, step)), row = { name, title, options };
  rmSync(join(kRoot, folder, name), { recursive: true, force: true });
  mkdirSync(join(kRoot, folder, name), { recursive: true });
  const words = `${/--frames/.test(options) ? kStudio.replace(/ --frames \d+/, '') : kStudio} ${options}`.trim().split(' ');
  const made = output(kLab, 'studio', 'procedural', '-o', studio, ...words);
  if (made.text === null) throw new Error(`${name}: ${made.error}`);
  const alone = output(kLab, 'mattes', studio);
  [row.alone, row.aloneRefused] = [numbersOf(alone.text, 'all')[0], alone.error];
  const together = output(kTool, 'mattes', studio, '-o', mattes);
  row.togetherRefused = together.error;
  if (together.text === null) return row;
  row.together = numbersOf(output(kLab, 'mattes', mattes).text, 'all')[0];
  const carved = output(kTool, 'reconstruct', mattes, '-o', surfaces, '--refine', 'none');
  row.surfacesRefused = carved.error;
  if (carved.text === null) return row;
  const report = JSON.parse(readFileSync(join(kRoot, surfaces, 'reconstruct.json'), 'utf8'));
  [row.overlap, row.lowest] = [report.mean_overlap, report.lowest_overlap];
  [row.psnr, row.ssim] = numbersOf(output(kLab, 'surfaces', surfaces).text, 'walk');
  return row;
}

const fixed = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : '–');

function tableOf(rows) {
  const head = ['disturbance', 'options', 'each camera by itself', 'cameras together', 'overlap', 'lowest', 'held-out dB', 'SSIM'];
  const cells = (row) => [row.title, row.options && `\`${row.options}\``, row.aloneRefused ? 'refused' : fixed(row.alone, 3), row.togetherRefused ? 'refused' : fixed(row.together, 3), fixed(row.overlap, 3), fixed(row.lowest, 3),
    fixed(row.psnr, 2), fixed(row.ssim, 3)];
  return [head, head.map(() => '---'), ...rows.map(cells)].map((line) => `| ${line.join(' | ')} |`).join('\n');
}

const refusals = (rows) => rows.flatMap((row) => [['each camera by itself', row.aloneRefused], ['cameras together', row.togetherRefused], ['surface', row.surfacesRefused]]
  .filter(([, error]) => error).map(([where, error]) => `- ${row.title}, ${where}: \`${error.replaceAll(`${join(folder, row.name)}/`, '').replaceAll(`${kRoot}`, '')}\``)).join('\n');

const documentOf = (rows, date) => `# Disturbances of a capture

Measured on ${date}, commit ${git('log', '-1', '--format=%h', '--', 'native', 'shaders', ':!*.md')}. Command: \`node site/measured/knobs.mjs\`.

The virtual studio's room, filmed by
\`fourdvt-lab studio procedural ${kStudio}\`
and the options of the row. One seed and two frames a row: differences below .01 say little. Weights of the cameras'
help were chosen with this seed and seed 33; other seeds: native/algorithms/mattes.md.

- each camera by itself: intersection over union of mattes and true mattes, by \`fourdvt-lab mattes\` on the studio's capture
- cameras together: the same of the mattes that \`fourdvt mattes\` makes
- overlap: intersection over union of surface and these mattes, mean and lowest over cameras and frames, by
  \`fourdvt reconstruct --refine none\`
- held-out: the visual hull, textured from the videos, at cameras kept apart, by \`fourdvt-lab surfaces\`

${tableOf(rows)}
${refusals(rows) && `\nRefused:\n\n${refusals(rows)}\n`}`;

// A finished row, or null.
function keptRow(path, options) {
  const row = existsSync(path) ? JSON.parse(readFileSync(path, 'utf8')) : null;
  return row?.options === options ? row : null;
}

const rows = [];
for (const row of kRows) {
  const path = join(kRoot, folder, `${row[0]}.json`);
  if (!keptRow(path, row[2]) && process.argv[2] !== '--table') {
    console.log(`knobs: ${row[1]}`);
    const measured = measureRow(row);
    writeFileSync(`${path}.part`, `${JSON.stringify(measured)}\n`);
    renameSync(`${path}.part`, path);
  }
  const kept = keptRow(path, row[2]);
  if (kept) rows.push({ ...kept, title: row[1] });
}
writeFileSync(join(kRoot, 'site/measured/knobs.md'), documentOf(rows, new Date().toISOString().slice(0, 10)));
console.log('wrote site/measured/knobs.md');
