// SPDX-License-Identifier: Apache-2.0
// node site/docs/capture_pictures.mjs [NAME…]: makes the pictures of native/capture/CAPTURE.md, site/docs/capture/NAME.webp, and
// prints the figures that the guide quotes beside them. The performers are those of the virtual studio: nothing is filmed.
// About 20 minutes; needs a release build with -DFOURDVT_LAB=ON, npm ci in web/ and Chromium. Captures and reports are kept in
// build/guide, and a run that was killed goes on after them; remove that folder to make everything anew.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, readdirSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { montage, paintStrokes } from './montage.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kTool = process.env.FOURDVT_BIN ?? join(kRoot, 'build/release/native/tools/fourdvt');
const kLab = process.env.FOURDVT_LAB_BIN ?? join(kRoot, 'build/release/native/lab/tools/fourdvt-lab');
const kWork = join(kRoot, 'build/guide'), kOut = join(kRoot, 'site/docs/capture');
const { chromium } = createRequire(join(kRoot, 'web/package.json'))('playwright-core');

const run = (program, ...words) => execFileSync(program, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 26 });
const at = (...names) => join(kWork, ...names);

/** Makes build/guide/NAME by `make(folder)` unless it is there. Returns its path. */
function kept(name, make) {
  if (existsSync(at(name))) return at(name);
  rmSync(at(`${name}.part`), { recursive: true, force: true });
  console.log(`making ${name}`);
  make(at(`${name}.part`));
  renameSync(at(`${name}.part`), at(name));
  return at(name);
}

const studio = (name, options) => kept(name, (folder) => run(kLab, 'studio', 'procedural', '-o', folder, '--no-truth', '--images', '--size', '480x640',
  ...options.split(' ')));

// Writes a capture's capture.json with the fields that readers need, for other frames.
function describe(folder, from, frames) {
  const { name, fps, units, up_axis, ground_y, background } = JSON.parse(readFileSync(join(from, 'capture.json'), 'utf8'));
  writeFileSync(join(folder, 'capture.json'), JSON.stringify({ name, fps, units, up_axis, ground_y, background, sequences: [{ name: 'take', frames, mesh: null }] }));
}

// Makes a capture of another one's pictures: frame i of camera c is picture frameOf(c, i), with its true matte if `truth`.
// poseOf(line, c) changes a line of images.txt.
function retime(folder, from, { sequence, frames, frameOf = (c, i) => i, poseOf = (line) => line, truth = true, plates = false }) {
  const digits = (i) => `${String(i).padStart(6, '0')}.png`;
  const count = readFileSync(join(from, 'cameras/images.txt'), 'utf8').match(/cam\d+$/gm).length;
  for (let c = 0; c < count; ++c) {
    const two = String(c).padStart(2, '0');
    const links = [[`take/cam${two}`, `${sequence}/cam${two}`], ...(truth ? [[`take/mask${two}`, `mattes_true/${sequence}/mask${two}`]] : [])];
    for (const [to, source] of links) {
      mkdirSync(join(folder, to), { recursive: true });
      for (let i = 0; i < frames; ++i) symlinkSync(join(from, source, digits(frameOf(c, i))), join(folder, to, digits(i)));
    }
  }
  mkdirSync(join(folder, 'cameras'));
  symlinkSync(join(from, 'cameras/cameras.txt'), join(folder, 'cameras/cameras.txt'));
  const poses = readFileSync(join(from, 'cameras/images.txt'), 'utf8').split('\n');
  writeFileSync(join(folder, 'cameras/images.txt'), poses.map((line) => (/cam\d+$/.test(line) ? poseOf(line, Number(/(\d+)$/.exec(line)[1])) : line)).join('\n'));
  if (plates) symlinkSync(join(from, 'background'), join(folder, 'background'));
  describe(folder, from, frames);
}

// Pans the camera of a line of images.txt by `degrees`.
function panned(line, degrees) {
  const [id, ...words] = line.split(' '), [w, x, y, z, tx, ty, tz] = words.slice(0, 7).map(Number), half = degrees * Math.PI / 360;
  const [c, s] = [Math.cos(half), Math.sin(half)], [c2, s2] = [Math.cos(2 * half), Math.sin(2 * half)];
  return [id, c * w - s * y, c * x + s * z, c * y + s * w, c * z - s * x, c2 * tx + s2 * tz, ty, c2 * tz - s2 * tx, ...words.slice(7)].join(' ');
}

const hull = (name, capture, ...options) => kept(name, (folder) => run(kTool, 'reconstruct', capture, '-o', folder, '--refine', 'none', ...options));
const preview = (name, capture, ...options) => kept(name, (folder) => run(kTool, 'mattes', capture, '-o', folder, ...options));
const reportOf = (folder) => JSON.parse(readFileSync(join(folder, 'reconstruct.json'), 'utf8'));
const sheets = (folder, stem) => readdirSync(folder).filter((name) => name.startsWith(`${stem}-`)).sort((a, b) => parseInt(a.split('-')[1]) - parseInt(b.split('-')[1]))
  .map((name) => join(folder, name));

// Returns each camera's overlap, mean over the frames.
const overlaps = (folder) => {
  const frames = Object.values(reportOf(folder).sequences).flat();
  return frames[0].overlap.map((_, c) => frames.reduce((sum, { overlap }) => sum + overlap[c], 0) / frames.length);
};
const scores = (folder) => run(kLab, 'surfaces', folder).trim().split('\n').at(-1).trim().split(/\s+/).slice(2, 4).map(Number);
const matteScore = (folder) => Number(run(kLab, 'mattes', folder).trim().split('\n').at(-1).trim().split(/\s+/)[2]);

// ---- The pictures: each returns { rows of { file, part or crop, label }, width of the picture, figures } -----------------

function cameras() {
  const figures = {}, shapes = [], looks = [];
  for (const count of [4, 5, 6, 7, 8, 12]) {
    const capture = studio(`ring${count}`, `--room --cameras ${count} --sequences walk --frames 2 --test-every 1 --seed 31`);
    const masked = kept(`ring${count}-masked`, (folder) => {
      retime(folder, capture, { sequence: 'walk', frames: 2 });
      symlinkSync(join(capture, 'cameras_test'), join(folder, 'cameras_test'));
      for (const name of readdirSync(join(capture, 'walk')).filter((entry) => entry.startsWith('test'))) symlinkSync(join(capture, 'walk', name), join(folder, 'take', name));
      const described = JSON.parse(readFileSync(join(folder, 'capture.json'), 'utf8'));
      described.sequences[0].test_frames = [0, 1];
      writeFileSync(join(folder, 'capture.json'), JSON.stringify(described));
    });
    const carved = hull(`ring${count}-hull`, masked);
    const refined = kept(`ring${count}-stereo`, (folder) => run(kTool, 'reconstruct', masked, '-o', folder));
    figures[count] = { hull: scores(carved), stereo: scores(refined) };
    if (count % 2) continue;
    const character = kept(`ring${count}-character`, (folder) => run(kTool, 'bake', refined, '-o', folder, '--renditions', 'highest'));
    const picture = kept(`ring${count}.png`, (path) => {
      run(kTool, 'render', character, '-o', `${path}.png`, '--frame', '0', '--azimuth', '20', '--size', '300x400', '--background', '191919', '--no-shadow');
      renameSync(`${path}.png`, path);
    });
    shapes.push({ file: sheets(carved, 'reconstruct')[0], cell: [0, 'shape'], label: `${count} cameras: silhouettes` });
    looks.push({ file: picture, crop: [40, 25, 220, 365], label: 'with stereo, textured' });
  }
  return { rows: [shapes, looks], height: 300, figures };
}

const kLate = 2;
const runners = () => studio('run50', '--room --cameras 8 --sequences run --fps 50 --frames 9 --test-every 9 --seed 31');

function offBy(name, label, options) {
  const masked = kept(`${name}-masked`, (folder) => {
    retime(folder, runners(), { sequence: 'run', frames: 2, frameOf: (c, i) => 4 * i, ...options });
  });
  const carved = hull(name, masked, '--any-silhouettes'), list = overlaps(carved);
  const others = list.filter((_, c) => c !== kLate);
  return {
    cells: ['picture', 'shape'].map((part) => ({ file: sheets(carved, 'reconstruct')[0], cell: [kLate, part], label: part === 'picture' ? label : '' })),
    figures: { this: list[kLate], others: others.reduce((a, b) => a + b) / others.length, lowest_of_others: Math.min(...others) },
  };
}

const inColumns = (cases) => ({ rows: [0, 1].map((row) => cases.map(({ cells }) => cells[row])), height: 330,
  figures: Object.fromEntries(cases.map(({ cells, figures }) => [cells[0].label, figures])) });

const late = (halves) => ({ frameOf: (c, i) => 4 * i + (c === kLate ? halves : 0) });
const turned = (degrees) => ({ poseOf: (line, c) => (c === kLate ? panned(line, degrees) : line) });

const sync = () => inColumns([offBy('late0', 'in step', {}), offBy('late1', 'half a frame late', late(1)), offBy('late4', 'two frames late', late(4))]);
const calibration = () => inColumns([offBy('late0', 'calibrated', {}), offBy('turned1', 'turned by 0.1°', turned(.1)), offBy('turned5', 'turned by 0.5°', turned(.5))]);

// A frame's two cells in a contact sheet of mattes: the picture with what was dropped, and the performer alone.
const sheetCells = (folder, camera, frame, label) => [0, 1].map((part) => ({
  file: sheets(folder, 'mattes')[camera], crop: [6 + 306 * frame, 60 + 400 * part, 300, 400], label: part ? '' : label,
}));

const disturbed = (name, options) => studio(name, `--room --cameras 6 --sequences walk --test-every 50 --seed 31 --noise 2.5 ${options}`);
const kMoment = 1;  // of those in the contact sheet

function mattes() {
  const cases = [['good', '--frames 2', 1, 'as it should be'], ['bystander', '--frames 2 --bystander', 1, 'red: somebody else'],
    ['moved', '--frames 2 --plate-move 2', 5, 'red: the camera was moved']];
  const figures = {}, columns = cases.map(([name, options, camera, label]) => {
    const capture = disturbed(`room-${name}`, options), keyed = preview(`mattes-${name}`, capture);
    figures[label] = { alone: matteScore(capture), together: matteScore(keyed), shift: JSON.parse(readFileSync(join(keyed, 'mattes.json'), 'utf8')).sequences.walk[0].cameras[camera].shift_pixels };
    return sheetCells(keyed, camera, 0, label);
  });
  return { rows: [0, 1].map((row) => columns.map((cells) => cells[row])), height: 330, figures };
}

// Captures of a performer who walks on the spot: without plates; below, with hints in the first frame of every camera.
const walker = () => disturbed('room-clips', '--frames 20 --no-plates');
const guessed = () => preview('mattes-clips', walker());

const clips = () => ({ rows: [0, 1].map((row) => [[0, 0], [2, 1], [4, 4]].map(([camera, frame]) => sheetCells(guessed(), camera, frame, `no plates: camera ${camera}`)[row])),
  height: 330, figures: { together: matteScore(guessed()) } });

async function hints() {
  const capture = walker(), hinted = at('room-hints');
  if (!existsSync(hinted)) {
    mkdirSync(at('room-hints.part'), { recursive: true });
    for (const name of readdirSync(capture)) if (!existsSync(at('room-hints.part', name))) symlinkSync(join(capture, name), at('room-hints.part', name));
    for (let c = 0; c < 6; ++c) {
      mkdirSync(at(`room-hints.part/hints/cam0${c}`), { recursive: true });
      await paintStrokes(browser, join(capture, `mattes_true/walk/mask0${c}/000000.png`), at(`room-hints.part/hints/cam0${c}/000000.png`));
    }
    renameSync(at('room-hints.part'), hinted);
  }
  const keyed = preview('mattes-hints', hinted), frame = (i) => join(capture, `walk/cam04/00000${i}.png`), matted = (folder) => sheetCells(folder, 4, kMoment, '')[1];
  return {
    rows: [[{ file: frame(0), over: join(hinted, 'hints/cam04/000000.png'), label: 'strokes on frame 0' },
      { ...matted(guessed()), label: 'a later frame, before' }, { ...matted(keyed), label: 'with the strokes' }]],
    height: 330, figures: { before: matteScore(guessed()), after: matteScore(keyed) },
  };
}

const kPictures = { cameras, sync, calibration, mattes, clips, hints };

mkdirSync(kWork, { recursive: true });
mkdirSync(kOut, { recursive: true });
const wanted = process.argv.slice(2), unknown = wanted.find((name) => !(name in kPictures));
if (unknown) {
  console.error(`capture_pictures: no picture called ${unknown}; there are ${Object.keys(kPictures).join(', ')}`);
  process.exit(2);
}
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });
try {
  for (const name of wanted.length ? wanted : Object.keys(kPictures)) {
    const picture = await kPictures[name]();
    await montage(browser, picture, join(kOut, `${name}.webp`), join(kWork, `${name}-look.png`));
    console.log(name, JSON.stringify(picture.figures, (key, value) => (typeof value === 'number' ? Number(value.toFixed(4)) : value)));
  }
} finally {
  await browser.close();
}
