// SPDX-License-Identifier: Apache-2.0
// node site/measured/calibration.mjs [--table]: what `fourdvt calibrate` finds of cameras that are off in time and place, in virtual
// studios and in the sample; writes site/measured/calibration.md. About 20 minutes; needs a release build with -DFOURDVT_LAB=ON.
//   Resume   run it again after a kill: finished rows are in build/measured/calibration/HASH (that of native/ without Markdown, as committed)
//   --table  writes the document from the finished rows alone
import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, lstatSync, mkdirSync, readFileSync, readdirSync, realpathSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kTool = process.env.FOURDVT_BIN ?? join(kRoot, 'build/release/native/tools/fourdvt');
const kLab = process.env.FOURDVT_LAB_BIN ?? join(kRoot, 'build/release/native/lab/tools/fourdvt-lab');
const kStudio = 'procedural --sequences walk --no-truth --frames 24 --noise 3';
const studio = (cameras, seed, more = '') => `--cameras ${cameras} --seed ${seed} ${more}`.trim();
// Rows: names, options of the studio (null: the sample), time offsets declared for the sample, rotation of cameras, degrees.
const kRows = [
  { name: 'right-4', title: 'studio, 4 cameras, as they are', options: studio(4, 84) },
  { name: 'right-6', title: 'studio, 6 cameras, as they are', options: studio(6, 86) },
  { name: 'right-12', title: 'studio, 12 cameras, as they are', options: studio(12, 92) },
  { name: 'right-sample', title: 'sample, as it is' },
  { name: 'time-8', title: 'studio, 8 cameras, times off', options: studio(8, 81, '--offset-frames 1.7') },
  { name: 'time-8b', title: 'the same, another seed', options: studio(8, 82, '--offset-frames 1.7') },
  { name: 'time-5', title: 'studio, 5 cameras, times off', options: studio(5, 83, '--offset-frames 1.7') },
  { name: 'time-room', title: 'studio\'s room, 8 cameras, keyed against plates, times off', options: studio(8, 85, '--room --offset-frames 1.7') },
  { name: 'time-sample', title: 'sample, five cameras shifted', shifts: { cam01: 3, cam02: -1, cam04: -2, cam06: 1, cam07: -3 }, sequences: 'walk,run' },
  { name: 'one-sample', title: 'sample, one camera turned', turned: ['cam02'] },
  { name: 'one-6', title: 'studio, 6 cameras, one turned', options: studio(6, 86), turned: ['cam01'] },
  { name: 'one-12', title: 'studio, 12 cameras, one turned', options: studio(12, 92), turned: ['cam04'] },
  { name: 'three-sample', title: 'sample, three cameras turned', turned: ['cam01', 'cam02', 'cam05'], sequences: 'walk' },
  { name: 'all-sample', title: 'sample, all cameras turned', turned: Array.from({ length: 8 }, (_, c) => `cam0${c}`), sequences: 'walk' },
  { name: 'both-8', title: 'studio, 8 cameras, times off, two turned', options: studio(8, 87, '--offset-frames 1.7'), turned: ['cam03', 'cam06'] },
];
const kTurn_deg = 0.5;

const git = (...words) => execFileSync('git', words, { cwd: kRoot, encoding: 'utf8' }).trim();
const hash = createHash('sha256').update([...git('ls-tree', '-r', 'HEAD', 'native').split('\n').filter((line) => !line.endsWith('.md')), kStudio].join('\n')).digest('hex').slice(0, 16);
const folder = join(kRoot, 'build/measured/calibration', hash);

const add = (a, b, scale = 1) => a.map((v, i) => v + scale * b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const apply = (m, v) => m.map((row) => row.reduce((sum, x, i) => sum + x * v[i], 0));
const product = (a, b) => a.map((row) => b[0].map((_, j) => row.reduce((sum, x, i) => sum + x * b[i][j], 0)));

/** Rotation by a vector, radians (Rodrigues). */
function rotation(vector) {
  const angle = length(vector), k = angle > 0 ? vector.map((v) => v / angle) : [0, 0, 0], c = Math.cos(angle), s = Math.sin(angle);
  const unit = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  return unit.map((row, i) => row.map((one, j) => c * one + (1 - c) * k[i] * k[j] + s * cross(k, unit[j])[i]));
}

/** {name: {r, t, f}} of a COLMAP text model with one intrinsic per camera in order. */
function posesOf(capture) {
  const lines = (file) => readFileSync(join(capture, file), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(' '));
  const ring = JSON.parse(readFileSync(join(capture, 'capture.json'), 'utf8')).calibration?.ring ?? 'cameras';
  const focal = Object.fromEntries(lines(`${ring}/cameras.txt`).map((words) => [words[0], Number(words[4])]));
  return Object.fromEntries(lines(`${ring}/images.txt`).filter((words) => words.length >= 10).map(([, ...words]) => {
    const [w, x, y, z, ...t] = words.slice(0, 7).map(Number);
    const r = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
    return [words[8].replace(/\.\w+$/, ''), { r, t, f: focal[words[7]] }];
  }));
}

/** images.txt with cameras turned about axes of their own by kTurn_deg. */
function turnedImages(text, names) {
  return text.split('\n').map((line) => {
    const words = line.split(' '), at = names.indexOf(words[9]?.replace(/\.\w+$/, ''));
    if (words.length !== 10 || at < 0) return line;
    const axis = [Math.sin(3 * at + 1), Math.cos(5 * at + 2), Math.sin(7 * at + 3)], half = kTurn_deg * Math.PI / 360, [w, ...v] = words.slice(1, 5).map(Number);
    const a = axis.map((x) => x / length(axis)), s = a.map((x) => x * Math.sin(half)), c = Math.cos(half);
    const q = [c * w - s.reduce((sum, x, i) => sum + x * v[i], 0), ...add(add(v.map((x) => c * x), s, w), cross(s, v))];
    return [words[0], ...q, ...apply(rotation(a.map((x) => 2 * half * x)), words.slice(5, 8).map(Number)), ...words.slice(8)].join(' ');
  }).join('\n');
}

/** Solves a x = b by Gauss-Jordan elimination. */
function solved(a, b) {
  const m = a.map((row, i) => [...row, b[i]]);
  for (let i = 0; i < m.length; ++i)
    for (let k = 0; k < m.length; ++k) if (k !== i) m[k] = add(m[k], m[i], -m[k][i] / m[i][i]);
  return m.map((row, i) => row.at(-1) / row[i]);
}

const kBody = [];  // points within the performer's volume
for (let y = 0.1; y < 1.8; y += 0.3) for (let k = 0; k < 4; ++k) kBody.push([0.3 * Math.cos(1.57 * k + y), y, 0.3 * Math.sin(1.57 * k + y)]);
const kMiddle = [0, 0.9, 0];
const moved = (p, g) => add(add(kMiddle, apply(rotation(g.slice(0, 3)), add(p, kMiddle, -1))), g.slice(3));
const project = ({ r, t, f }, p) => { const q = add(apply(r, p), t); return [f * q[0] / q[2], f * q[1] / q[2]]; };

/** Angular error of each camera, degrees: RMS over kBody, after the rigid motion of the rig that best explains it. */
function degreesOff(truth, found, wholeRig) {
  let g = [0, 0, 0, 0, 0, 0];
  const names = Object.keys(truth), step = 1e-5;
  for (let round = 0; wholeRig && round < 6; ++round) {
    const a = g.map(() => g.map(() => 0)), b = g.map(() => 0);
    for (const name of names)
      for (const p of kBody) {
        const here = project(found[name], moved(p, g)), miss = add(project(truth[name], p), here, -1), weight = 1 / (1 + length(miss));
        const columns = g.map((_, k) => add(project(found[name], moved(p, g.map((v, i) => v + (i === k ? step : 0)))), here, -1).map((v) => v / step));
        columns.forEach((x, i) => { b[i] += weight * (x[0] * miss[0] + x[1] * miss[1]); columns.forEach((y, j) => { a[i][j] += weight * (x[0] * y[0] + x[1] * y[1]); }); });
      }
    g = add(g, solved(a, b));
  }
  return Object.fromEntries(names.map((name) => {
    const squares = kBody.map((p) => length(add(project(truth[name], p), project(found[name], moved(p, g)), -1)) ** 2);
    return [name, Math.sqrt(squares.reduce((x, y) => x + y) / squares.length) / truth[name].f * 180 / Math.PI];
  }));
}

function run(program, ...words) {
  const { status, stdout, stderr } = spawnSync(program, words, { cwd: kRoot, encoding: 'utf8', maxBuffer: 1 << 26 });
  if (status !== 0) throw new Error(`${words[0]}: ${stderr.trim().split('\n').at(-1)}`);
  return stdout + stderr;
}

/** A folder of links to a capture, with its own capture.json and cameras/. */
function variant(from, to, row) {
  mkdirSync(join(to, 'cameras'), { recursive: true });
  for (const entry of readdirSync(from))
    if (!['capture.json', 'cameras'].includes(entry) && !lstatSync(join(to, entry), { throwIfNoEntry: false })) symlinkSync(realpathSync(join(from, entry)), join(to, entry));
  const capture = JSON.parse(readFileSync(join(from, 'capture.json'), 'utf8'));
  if (row.shifts) capture.offset_frames = row.shifts;
  if (row.sequences) capture.sequences = capture.sequences.filter((s) => row.sequences.split(',').includes(s.name));
  if (row.sequences) delete capture.classes;
  writeFileSync(join(to, 'capture.json'), JSON.stringify(capture));
  writeFileSync(join(to, 'cameras/cameras.txt'), readFileSync(join(from, 'cameras/cameras.txt')));
  writeFileSync(join(to, 'cameras/images.txt'), turnedImages(readFileSync(join(from, 'cameras/images.txt'), 'utf8'), row.turned ?? []));
}

function measureRow(row) {
  const [filmed, given, found] = ['filmed', 'given', 'found'].map((step) => join(folder, row.name, step));
  rmSync(join(folder, row.name), { recursive: true, force: true });
  mkdirSync(join(folder, row.name), { recursive: true });
  if (row.options) run(kLab, 'studio', '-o', filmed, ...kStudio.split(' '), ...row.options.split(' '));
  const from = row.options ? filmed : join(kRoot, 'site/sample/actor_a');
  variant(from, given, row);
  const begun = process.hrtime.bigint();
  run(kTool, 'calibrate', given, '-o', found);
  const seconds = Number(process.hrtime.bigint() - begun) / 1e9;
  const report = JSON.parse(readFileSync(join(found, 'calibrate.json'), 'utf8')), filmedJson = JSON.parse(readFileSync(join(from, 'capture.json'), 'utf8'));
  const off = degreesOff(posesOf(from), posesOf(found), (row.turned?.length ?? 0) > 2), turned = row.turned ?? [];
  const most = (names) => (names.length ? Math.max(...names.map((name) => off[name])) : null);
  const sequences = JSON.parse(readFileSync(join(found, 'capture.json'), 'utf8')).sequences;
  // Delay of the camera's pictures against their nominal times, frames.
  const late = (name, c) => -(filmedJson.studio?.offset_frames_true?.[c] ?? 0);
  let timeError = 0, timeBefore = 0;
  for (const sequence of sequences) {
    const errors = report.cameras.map(({ name }, c) => (sequence.offset_frames?.[name] ?? row.shifts?.[name] ?? 0) - late(name, c)).sort((x, y) => x - y);
    const before = report.cameras.map(({ name }, c) => (row.shifts?.[name] ?? 0) - late(name, c));
    const middle = (values) => [...values].sort((x, y) => x - y)[values.length >> 1];
    timeError = Math.max(timeError, ...errors.map((e) => Math.abs(e - middle(errors))));
    timeBefore = Math.max(timeBefore, ...before.map((e) => Math.abs(e - middle(before))));
  }
  const mean = (key) => report.cameras.reduce((sum, camera) => sum + camera[key].mean_pixels, 0) / report.cameras.length;
  return { name: row.name, timeBefore, timeError, turnedError: most(turned), othersError: most(Object.keys(off).filter((name) => !turned.includes(name))),
    before: mean('outside_before'), after: mean('outside_after'), seconds };
}

const fixed = (value, digits) => (Number.isFinite(value) && value !== null ? value.toFixed(digits) : '–');
const tableOf = (rows) => [['capture', 'times off by at most, frames', 'after', 'turned by .5°: left, degrees', 'others: moved by, degrees', 'outside, pixels', 'after', 'seconds'], Array(8).fill('---'),
  ...rows.map((row) => [row.title, fixed(row.timeBefore, 2), fixed(row.timeError, 3), fixed(row.turnedError, 3), fixed(row.othersError, 3), fixed(row.before, 2), fixed(row.after, 2), fixed(row.seconds, 0)])]
  .map((cells) => `| ${cells.join(' | ')} |`).join('\n');

const documentOf = (rows, date) => `# Cameras in step and in place

Measured on ${date}, commit ${git('log', '-1', '--format=%h', '--', 'native', ':!*.md')}. Command: \`node site/measured/calibration.mjs\`.

\`fourdvt calibrate\` on captures whose times and poses are known: virtual studios (\`fourdvt-lab studio ${kStudio}\`, other seeds than
constants were chosen on), and the sample, on whose walk they were.

- times: largest distance of a camera's offset from the true one, less their median: which camera is on time cannot be known
- turned: largest error left of the cameras that were turned by ${kTurn_deg}° about some axis, as the shift of the body in the picture; where
  more than two were, less the motion of the whole rig that explains most of it, which cannot be known either
- others: the same of all other cameras
- outside: mean distance by which outlines stick out of the hull of the other cameras
- seconds: wall time on a machine with two cores that others used, too

${tableOf(rows)}
`;

const rows = [];
for (const row of kRows) {
  const path = join(folder, `${row.name}.json`);
  if (!existsSync(path) && process.argv[2] !== '--table') {
    console.log(`calibration: ${row.title}`);
    const measured = measureRow(row);
    writeFileSync(`${path}.part`, `${JSON.stringify(measured)}\n`);
    renameSync(`${path}.part`, path);
  }
  if (existsSync(path)) rows.push({ ...JSON.parse(readFileSync(path, 'utf8')), title: row.title });
}
writeFileSync(join(kRoot, 'site/measured/calibration.md'), documentOf(rows, new Date().toISOString().slice(0, 10)));
console.log('wrote site/measured/calibration.md');
