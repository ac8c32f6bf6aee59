#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// methods.mjs FOURDVT_LAB CAPTURE OUT [SEQUENCES [FRAMES [AXIS_FRAMES [CHARACTERS]]]]: compares the methods of
// characters from cameras by `fourdvt-lab methods`. Writes OUT/rows.json, from which site/measured/documents.mjs makes
// methods.md, and the report OUT/methods/report.html.
//   SEQUENCES    default run,pickup; constants were chosen on the sample's walk, which has rows of its own in the
//                cross-validation alone
//   FRAMES       test frames per sequence (default 2); AXIS_FRAMES: the same for conditions without a choice (default
// 1)
//   CHARACTERS   a folder of characters from cameras baked from CAPTURE, such as the demo's build/cameras: adds their
//                scores after the codec
// A killed run resumes after its finished results.
import { mkdirSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

import { mean, settingOf, standardError } from '../../site/measured/sources.mjs';
import { characterScores, kept, rounded, run, writeRows } from './kept.mjs';
import { chosenRows } from './method_choice.mjs';

const [lab, capture, out, sequences = 'run,pickup', frames = '2', axisFrames = '1', characters] = process.argv.slice(2);
const kTunedOn = 'walk', kBaseline = 'linear';
const kSteps = 'about,proxies,cameras,calibration,cross-validation,choice,stages';  // without the report's pictures
if (!out) {
  console.error('usage: methods.mjs FOURDVT_LAB CAPTURE OUT [SEQUENCES [FRAMES [AXIS_FRAMES [CHARACTERS]]]]');
  process.exit(2);
}
mkdirSync(out, { recursive: true });

// Rows of the study of these sequences, with their settings as maps.
function study(name, of, steps, more = []) {
  const report = join(out, name);
  run(lab, 'methods', capture, '-o', report, '--sequences', of, '--frames', frames, '--axis-frames', axisFrames, '--steps', steps, ...more);
  return JSON.parse(readFileSync(join(report, 'projective.json'), 'utf8')).rows.map((row) => ({ ...row, keys: settingOf(row.setting) }));
}
const { sequences: captured } = JSON.parse(readFileSync(join(capture, 'capture.json'), 'utf8'));
const all = study('methods', sequences, kSteps);
const isTunedOn = captured.some(({ name }) => name === kTunedOn) && !sequences.split(',').includes(kTunedOn);
const tunedOn = isTunedOn ? study(kTunedOn, kTunedOn, 'cross-validation', ['--methods', 'fvvr,holoportation,montage4d']) : [];

const distinct = (list) => [...new Set(list)];
const ofTable = (table, rows = all) => rows.filter((row) => row.table === table && row.value !== null);
const isAt = (row, { axis, at, method }) => row.method === method && row.keys.get('axis') === axis && row.keys.get('at') === at;
const conditions = ofTable('condition'), views = ofTable('view');

// Mean over the sequences; undefined where nothing was measured.
function meanOf(place, quantity) {
  const found = conditions.filter((row) => isAt(row, place) && row.quantity === quantity).map((row) => row.value);
  return found.length ? mean(found) : undefined;
}

// Mean over the views with its standard error; and both for the difference to linear blending, view by view.
function overViews(place, quantity) {
  const of = (method) => new Map(views.filter((row) => isAt(row, { ...place, method }) && row.quantity === quantity)
    .map((row) => [`${row.sequence} ${row.keys.get('view')} ${row.keys.get('frame')}`, row.value]));
  const own = of(place.method), base = of(kBaseline);
  const differences = [...own].filter(([view]) => base.has(view)).map(([view, value]) => value - base.get(view));
  return { count: own.size, mean: mean([...own.values()]), se: standardError([...own.values()]), gain: mean(differences), gainSe: standardError(differences) };
}

function conditionRow(place) {
  const psnr = overViews(place, 'psnr_fg_db'), ssim = overViews(place, 'ssim_fg');
  const fvvr_s = meanOf({ ...place, method: 'fvvr' }, 'view_s'), view_s = meanOf(place, 'view_s');
  return rounded({
    table: 'condition', ...place, views: psnr.count, psnr_db: psnr.mean, psnr_se_db: psnr.se, ssim: ssim.mean, ssim_se: ssim.se,
    gain_db: psnr.gain, gain_se_db: psnr.gainSe, gain_ssim: ssim.gain, gain_se_ssim: ssim.gainSe,
    flicker_levels: meanOf(place, 'flicker_levels'), frame_ratio: meanOf(place, 'ratio_to_fvvr'), view_ratio: view_s / fvvr_s,
    gradient_ratio: meanOf(place, 'gradient_ratio'), shift_tolerant_db: meanOf(place, 'shift_tolerant_db'),
  });
}
const places = distinct(conditions.map((row) => JSON.stringify({ axis: row.keys.get('axis'), at: row.keys.get('at'), method: row.method }))).map((text) => JSON.parse(text));

const choices = all.filter((row) => row.table === 'choice' && ['taken', 'refused'].includes(row.quantity)).map((row) => ({
  table: 'choice', proxy: row.keys.get('proxy'), method: row.method,
  ...(row.quantity === 'taken' ? { taken: 1 } : { refused: row.keys.get('text') }),
}));
const promises = all.filter((row) => row.table === 'promise').map((row) => ({ table: 'promise', verdict: row.quantity, text: row.keys.get('text') }));

const cross = [...ofTable('cross'), ...ofTable('cross', tunedOn)];
const crossKeys = distinct(cross.map((row) => JSON.stringify({ sequence: row.sequence, proxy: row.keys.get('proxy'), method: row.method, own: Number(row.keys.get('own')) })));
const crossRows = crossKeys.map((text) => {
  const key = JSON.parse(text);
  const value = (quantity) => cross.find((row) => row.quantity === quantity && row.sequence === key.sequence && row.method === key.method &&
    row.keys.get('proxy') === key.proxy && Number(row.keys.get('own')) === key.own)?.value;
  return rounded({ table: 'cross', ...key, rmse_percent: 100 * value('rmse'), psnr_db: value('psnr_fg_db'), ssim: value('ssim_fg') });
});
const passes = ofTable('stage').map((row) => rounded({ table: 'pass', pass: row.keys.get('pass'), method: row.method, frame_ms: row.value }));

// Means over all held-out views of the streamed characters from cameras, by character and method.
const names = characters ? readdirSync(characters, { withFileTypes: true }).filter((entry) => entry.isDirectory()).map(({ name }) => name).filter(isFromCameras) : [];
const methods = distinct(places.map(({ method }) => method));
const streamed = methods.flatMap((method) => names.map((character) => ({
  table: 'streamed', character, method,
  ...kept(out, `streamed ${character} ${method}`, () => characterScores(lab, capture, join(characters, character), join(out, 'scores'), ['--method', method])),
})));

function isFromCameras(character) {
  const { extensions } = JSON.parse(readFileSync(join(characters, character, 'character.gltf'), 'utf8'));
  return extensions.FOURDVT_layered_video_texture.appearance === 'cameras';
}

const facts = Object.fromEntries(all.filter((row) => row.table === 'about').map((row) => [row.quantity, row.keys.get('text')]));
writeRows(out, facts, [...places.map(conditionRow), ...chosenRows(all), ...choices, ...promises, ...crossRows, ...passes, ...streamed]);
