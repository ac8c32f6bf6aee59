#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Parts of the measurement, with the inputs of each: a part whose inputs are unchanged is not measured again.
//   parts.mjs --list                     state, date and minutes of every part
//   parts.mjs --stale                    names of the parts that are out of date or were never measured
//   parts.mjs --hash PART [--at COMMIT]  hash of the part's inputs: of the working tree, or of a commit
//   parts.mjs --record PART --seconds N --yardstick RUNS --out FILE   writes what a finished measurement is recorded with; RUNS: of
//                                        tests/bench/yardstick.mjs --keep
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, lstatSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { summaryOf } from './yardstick.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const native = (...folders) => folders.map((folder) => `native/${folder}`);

const kBuild = ['CMakeLists.txt', 'native/precompiled.cmake', 'native/quick_build.cmake', 'shaders'];
const kSample = ['site/sample/actor_a'];
// Folders from capture to drawn character. Lists former places of moved folders as well, for hashes of older commits;
// missing folders add nothing.
const kPlayed = native('base', 'gpu', 'package', 'motion', 'render', 'stream', 'player', 'platform', 'edge');
const kBaked = [...kPlayed, ...native('store', 'encode', 'capture', 'silhouette', 'mattes', 'refine', 'jobs', 'bake', 'report')];
const kJudged = [...kBaked, ...native('measure', 'lab/measure')];
const kSurfaces = native('reconstruct');
const kStudy = native('study', 'lab/study', 'lab/labels');
const kStudio = native('studio', 'lab/studio');
const kBenches = ['CMakeLists.txt', 'bake_memory.sh', 'blend_cost.h', 'blend_ratio.cpp', 'class_frame.cpp', 'draw_ratio.cpp', 'first_frame.h', 'or_stop.h', 'wasm']
  .map((name) => `tests/bench/${name}`).concat('tests/package');

// Folders of commands are not inputs: they only parse and call; defaults are in the modules.
// runs: those of catalogue.mjs. inputs: files and folders; Markdown in them is left out. targets: CMake targets whose
// folders must be among the inputs (tests/tree/figures.test.mjs).
export const parts = {
  study: {
    what: 'the papers’ tables on the sample capture', runs: ['study'],
    inputs: [...kBuild, ...kSample, ...kJudged, ...kStudy, 'site/measured/parts/study.sh'],
    targets: ['fourdvt_study'],
  },
  fvvr: {
    what: 'the papers’ reference renderer at the held-out cameras, their form and at its best', runs: ['fvvr'],
    inputs: [...kBuild, ...kSample, ...kJudged, ...kStudy, 'site/measured/parts/fvvr.sh'],
    targets: ['fourdvt_study'],
  },
  truth: {
    what: 'motions of the virtual studio, where the truth between two of them is known', runs: ['truth'],
    inputs: [...kBuild, ...kJudged, ...kStudy, ...kStudio, 'site/measured/parts/truth.sh'],
    targets: ['fourdvt_study', 'fourdvt_studio'],
  },
  cameras: {
    what: 'characters from cameras: surfaces, number of cameras, bitrate', runs: [],
    inputs: [...kBuild, ...kSample, ...kJudged, ...kSurfaces, 'tests/bench/cameras.mjs', 'tests/bench/kept.mjs', 'site/measured/parts/cameras.sh'],
    targets: ['fourdvt_bake', 'fourdvt_reconstruct_run', 'fourdvt_measure_character'],
  },
  hulls: {
    what: 'surfaces from silhouettes and stereo', runs: [],
    inputs: [...kBuild, ...kSample, ...kJudged, ...kSurfaces, 'tests/bench/hulls.mjs', 'tests/bench/kept.mjs', 'site/measured/parts/hulls.sh'],
    targets: ['fourdvt_reconstruct_run', 'fourdvt_measure_character'],
  },
  methods: {
    what: 'methods of texturing from cameras', runs: [],
    inputs: [...kBuild, ...kSample, ...kJudged, ...kSurfaces, ...kStudy, ...kStudio, 'tests/bench/methods.mjs', 'tests/bench/method_choice.mjs', 'tests/bench/kept.mjs', 'site/cameras.sh',
      'site/measured/parts/methods.sh'],
    targets: ['fourdvt_study_projective', 'fourdvt_bake', 'fourdvt_reconstruct_run'],
  },
  bench: {
    what: 'the sample character, its variants, times, memory', runs: ['character', 'high', 'crf31', 'draw_ratio', 'blend_ratio', 'class_frame', 'bake_memory', 'parity'],
    inputs: [...kBuild, ...kSample, ...kJudged, 'wasm', 'web', ...kBenches, 'tests/web/parity.test.mjs', 'site/measured/parts/bench.sh'],
    targets: ['fourdvt_bake', 'fourdvt_measure_character'],
  },
  player: {
    what: 'the player’s bytes', runs: ['player'],
    inputs: [...kBuild, ...kPlayed, 'wasm', 'web', 'site/measured/parts/player.sh'],
    targets: ['fourdvt_player'],
  },
};

export const partOfRun = Object.fromEntries(Object.entries(parts).flatMap(([name, { runs }]) => runs.map((run) => [run, name])));

export function isInput(part, path) {
  return !path.endsWith('.md') && parts[part].inputs.some((input) => path === input || path.startsWith(`${input}/`));
}

const git = (root, words, input) => execFileSync('git', ['-C', root, ...words], { encoding: 'utf8', input, maxBuffer: 1 << 26 });
const names = (text) => text.split('\0').filter(Boolean);

// Returns "MODE BLOB" by path for a commit, from `git ls-tree`.
function entriesAt(root, commit) {
  return new Map(names(git(root, ['ls-tree', '-r', '-z', '--full-tree', commit])).map((line) => {
    const [facts, path] = line.split('\t'), [mode, , blob] = facts.split(' ');
    return [path, `${mode} ${blob}`];
  }));
}

// Returns "MODE BLOB" by path for the working tree, as if all files except ignored ones were committed.
function entriesNow(root) {
  const out = new Map(names(git(root, ['ls-files', '-s', '-z'])).map((line) => {
    const [facts, path] = line.split('\t'), [mode, blob] = facts.split(' ');
    return [path, `${mode} ${blob}`];
  }));
  const changed = [...new Set(names(git(root, ['ls-files', '-m', '-o', '-z', '--exclude-standard'])))];
  const present = changed.filter((path) => existsSync(join(root, path)) && lstatSync(join(root, path)).isFile());
  for (const path of changed) if (!present.includes(path)) out.delete(path);
  const blobs = present.length ? git(root, ['hash-object', '--stdin-paths'], `${present.join('\n')}\n`).trim().split('\n') : [];
  present.forEach((path, i) => out.set(path, `${lstatSync(join(root, path)).mode & 0o100 ? 100755 : 100644} ${blobs[i]}`));
  return out;
}

// Hashes a part's inputs: modes, paths and blobs. commit: the commit to hash; default: the working tree, with the same
// result once it is committed. entries: of that tree.
export function inputHash(part, { root = kRoot, commit, entries = commit ? entriesAt(root, commit) : entriesNow(root) } = {}) {
  const lines = [...entries].filter(([path]) => isInput(part, path)).map(([path, entry]) => `${entry}\t${path}\n`).sort();
  if (!lines.length) throw new Error(`${part}: no file of ${root} is an input of this part; mend site/measured/parts.mjs`);
  return createHash('sha256').update(lines.join('')).digest('hex').slice(0, 16);
}

// Path of the file with a part's record and figures.
export const fileOf = (part) => (parts[part].runs.length ? 'site/measured/figures.json' : `site/measured/${part}.json`);

// Reads a part's record { inputs, date, commit, minutes, yardstick }; null if the part was never measured.
export function recordOf(part, root = kRoot) {
  const path = join(root, fileOf(part));
  if (!existsSync(path)) return null;
  return JSON.parse(readFileSync(path, 'utf8')).parts?.[part] ?? null;
}

export function stateOf(record, hash) {
  if (!record) return 'never';
  return record.inputs === hash ? 'up to date' : 'out of date';
}

// Names of the parts that are out of date or were never measured.
export function staleParts(root = kRoot) {
  const entries = entriesNow(root);
  return Object.keys(parts).filter((part) => stateOf(recordOf(part, root), inputHash(part, { root, entries })) !== 'up to date');
}

function list(root) {
  const rows = Object.keys(parts).map((part) => {
    const record = recordOf(part, root), hash = inputHash(part, { root });
    return [part, stateOf(record, hash), record?.date ?? '', record?.minutes === undefined ? '' : `${record.minutes} min`, hash, parts[part].what];
  });
  const widths = rows[0].map((_, i) => Math.max(...rows.map((row) => row[i].length)));
  return rows.map((row) => row.map((cell, i) => cell.padEnd(widths[i])).join('  ').trimEnd()).join('\n');
}

function record(part, { seconds, yardstick, out }) {
  const today = new Date().toISOString().slice(0, 10);
  const commit = git(kRoot, ['rev-parse', '--short', 'HEAD']).trim();
  const runs = readFileSync(yardstick, 'utf8').trim().split('\n').map((line) => JSON.parse(line));
  const value = { inputs: inputHash(part), date: today, commit, minutes: Number((Number(seconds) / 60).toFixed(1)), yardstick: summaryOf(runs) };
  writeFileSync(`${out}.part`, `${JSON.stringify(value)}\n`);
  renameSync(`${out}.part`, out);
}

function main() {
  const text = { type: 'string' };
  const { values } = parseArgs({ options: { list: { type: 'boolean' }, stale: { type: 'boolean' }, hash: text, at: text, record: text, seconds: text, yardstick: text, out: text } });
  const asked = values.hash ?? values.record;
  if (asked !== undefined && !parts[asked]) throw new Error(`no part is named "${asked}"; the parts are ${Object.keys(parts).join(', ')}`);
  if (values.list) console.log(list(kRoot));
  else if (values.stale) console.log(staleParts().join('\n'));
  else if (values.hash) console.log(inputHash(values.hash, { commit: values.at }));
  else if (values.record && values.seconds && values.yardstick && values.out) record(values.record, values);
  else throw new Error('usage: parts.mjs --list | --stale | --hash PART [--at COMMIT] | --record PART --seconds N --yardstick RUNS --out FILE');
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  try {
    main();
  } catch (error) {
    console.error(`parts: ${error.message}`);
    process.exit(2);
  }
}
