// SPDX-License-Identifier: Apache-2.0
// Runs the commands of native/capture/CLASSES.md, in order, on the sample laid out as a studio would deliver it; with
// smaller pictures and textures and fewer cameras than in the text.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const kRoot = fileURLToPath(new URL('../..', import.meta.url)), kSample = join(kRoot, 'site/sample/actor_a');
const kTool = process.env.FOURDVT_BIN ?? join(kRoot, 'build/release/native/tools/fourdvt');
const kCameras = 4;
// Options that make a command fast without changing what it does.
const kQuick = {
  bake: ['--texture', '128', '--layers', '1', '--renditions', 'highest', '--refine', 'none', '--refine-cameras', 'off', '--align', 'none'],
  render: ['--size', '96x128'],
};
const chapter = readFileSync(join(kRoot, 'native/capture/CLASSES.md'), 'utf8');
const kUntracked = /^## Without a tracker\n[\s\S]*?(?=^## )/m;
const commandsOf = (text) => [...text.matchAll(/^ {4}fourdvt (.+)$/gm)].map(([, words]) => words.split(/ +/));
const commands = commandsOf(chapter.replace(kUntracked, ''));

let folder;
before(() => { folder = mkdtempSync(join(tmpdir(), 'fourdvt-guide-')); });
after(() => rmSync(folder, { recursive: true, force: true }));

// The first kCameras cameras of a COLMAP text model.
const fewCameras = (name) => readFileSync(join(kSample, 'cameras', name), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).slice(0, kCameras)
  .map((line) => `${line}\n\n`).join('');

// One OBJ for each frame of packed positions, numbered from 1.
function writeMeshes({ name, frames, mesh }) {
  const faces = readFileSync(join(kSample, mesh.topology), 'utf8').split('\n').filter((line) => !line.startsWith('v ')).join('\n');
  const bytes = readFileSync(join(kSample, mesh.positions)), values = new Int16Array(bytes.buffer, bytes.byteOffset, bytes.length / 2);
  mkdirSync(join(folder, 'shoot', name, 'mesh'), { recursive: true });
  for (let f = 0; f < frames; ++f) {
    const own = values.subarray(f * values.length / frames, (f + 1) * values.length / frames);
    const lines = Array.from({ length: own.length / 3 }, (_, v) => `v ${[...own.subarray(3 * v, 3 * v + 3)].map((value) => value / mesh.units_per_metre).join(' ')}\n`);
    writeFileSync(join(folder, 'shoot', name, 'mesh', `${name}_${String(f + 1).padStart(4, '0')}.obj`), lines.join('') + faces);
  }
}

// Creates the folder described in the chapter.
function writeShoot() {
  const { sequences } = JSON.parse(readFileSync(join(kSample, 'capture.json'), 'utf8'));
  for (const sequence of sequences.filter(({ name }) => name === 'walk' || name === 'run')) {
    writeMeshes(sequence);
    mkdirSync(join(folder, 'shoot', sequence.name, 'masks'));
    for (const c of Array.from({ length: kCameras }, (_, i) => `0${i}`)) {
      cpSync(join(kSample, sequence.name, `cam${c}.mp4`), join(folder, 'shoot', sequence.name, `cam${c}.mp4`));
      cpSync(join(kSample, sequence.name, `mask${c}.mkv`), join(folder, 'shoot', sequence.name, `masks/cam${c}.mkv`));
    }
  }
  for (const name of ['cameras.txt', 'images.txt']) writeFileSync(join(folder, 'shoot', name), fewCameras(name));
}

const run = (words) => execFileSync(kTool, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });

test('every command of the chapter does what it says', () => {
  assert.deepEqual(commands.map(([name]) => name), ['import', 'bake', 'inspect', 'render', 'render']);
  writeShoot();
  const printed = commands.map(([name, ...words]) => {
    const movie = words.some((word) => word.endsWith('.mp4')) ? ['--seconds', '0.2'] : [];
    return run([name, ...words, ...(kQuick[name] ?? []), ...movie]);
  });
  // Expects that lines which import prints for all cameras occur in the chapter.
  for (const line of printed[0].trim().split('\n').filter((text) => /^(sequence|meshes|class) /.test(text)))
    assert.ok(chapter.includes(`    ${line.replace(`${kCameras} cameras`, '8 cameras')}\n`), line);
  const { classes, sequences } = JSON.parse(readFileSync(join(folder, 'performer/capture.json'), 'utf8'));
  const declared = JSON.parse(`{${/^ {4}"sequences": [\s\S]*?^ {4}\]\n/m.exec(chapter)[0]}${/^ {4}"classes": [\s\S]*?^ {4}\]\n/m.exec(chapter)[0]}}`
    .replace(/\]\n\s*"classes"/, '], "classes"'));
  assert.deepEqual({ sequences, classes }, declared);
  // Range of the slider: from the walk's to the run's speed, as measured by the bake; true values: 1.23 and 2.72 m/s.
  const [, low, high] = /class locomotion: speed_mps ([\d.]+) to ([\d.]+)/.exec(printed[2]);
  assert.ok(Math.abs(low - 1.23) < 0.1 && Math.abs(high - 2.72) < 0.15, `${low} to ${high}`);
  for (const made of ['between.png', 'faster.mp4']) assert.ok(existsSync(join(folder, made)), made);
});

// cli_track runs these commands; their surfaces take too long to be made here.
test('commands without a tracker are those of the tool', () => {
  const untracked = commandsOf(kUntracked.exec(chapter)[0]);
  assert.deepEqual(untracked.map(([name]) => name), ['import', 'reconstruct', 'track', 'bake']);
  for (const [name, ...words] of untracked) {
    const help = run([name, '--help']);
    for (const option of words.filter((word) => word.startsWith('-'))) assert.match(help, new RegExp(`(^|\\s)${option}[ ,<]`, 'm'), `${name} ${option}`);
  }
});

test('messages of the chapter that need no bake', () => {
  const shown = [...chapter.matchAll(/^\| `(--class[^`]*)` \|/gm)].map(([, text]) => text);
  const sequences = ['--sequences', 'walk=walk,run=run'];
  const given = [[...sequences, '--class', 'locomotion:speed_mps=walk,jog'], [...sequences, '--class', 'locomotion:speed_mps=walk:1.2,run'],
    ['--class', 'locomotion:speed_mps=walk,run']];
  assert.equal(shown.length, given.length);
  given.forEach((words, i) => assert.throws(() => run(['import', 'shoot', '-o', 'refused', ...words]), ({ stderr }) => stderr.includes(shown[i]), shown[i]));
});
