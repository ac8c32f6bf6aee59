#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// methods.mjs FOURDVT CAPTURE OUT [SEQUENCES [FRAMES [CHARACTERS]]]: the methods of characters from cameras against each
// other, by `fourdvt evaluate --projective`; prints tables and writes OUT/methods.md beside the report
// OUT/methods/report.html. SEQUENCES: by default run,pickup; constants were chosen on the sample's walk, which has rows
// of its own in the cross-validation alone. FRAMES: test frames of each, by default 1; of the
// cross-validation three. CHARACTERS: a folder of characters from
// cameras that were baked from CAPTURE, as the demo's build/cameras: their scores after the codec. A run that was
// stopped goes on.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [tool, capture, out, sequences = 'run,pickup', frames = '1', characters] = process.argv.slice(2);
const TUNED_ON = 'walk';
if (!out) {
  console.error('usage: methods.mjs FOURDVT CAPTURE OUT [SEQUENCES [FRAMES [CHARACTERS]]]');
  process.exit(2);
}
mkdirSync(out, { recursive: true });
const { sequences: captured } = JSON.parse(readFileSync(join(capture, 'capture.json'), 'utf8'));
// Rows of the study of these sequences.
function study(name, of, more = []) {
  const report = join(out, name);
  execFileSync(tool, ['evaluate', capture, '--projective', '-o', report, '--sequences', of, '--frames', frames, ...more], { stdio: 'inherit' });
  return JSON.parse(readFileSync(join(report, 'projective.json'), 'utf8')).rows;
}
const rows = study('methods', sequences);
const isTunedOn = captured.some(({ name }) => name === TUNED_ON) && !sequences.split(',').includes(TUNED_ON);
const tunedOn = isTunedOn ? study(TUNED_ON, TUNED_ON, ['--methods', 'fvvr,holoportation,montage4d']) : [];

const setting = (row, key) => (key === 'text' || key === 'pass'
  ? new RegExp(`(?:^| )${key}=(.*)$`).exec(row.setting)?.[1]
  : new RegExp(`(?:^| )${key}=(\\S+)`).exec(row.setting)?.[1]);
const matching = (table, method, settings, quantity) => rows.filter((row) => row.table === table && row.method === method
  && row.quantity === quantity && Object.entries(settings).every(([key, value]) => setting(row, key) === value) && row.value !== null);
// Mean over the sequences; NaN where nothing was measured.
function value(table, method, settings, quantity) {
  const found = matching(table, method, settings, quantity);
  return found.reduce((sum, row) => sum + row.value, 0) / found.length;
}
const fixed = (number, digits) => (Number.isFinite(number) ? number.toFixed(digits) : '–');
const quality = (method, settings) => `${fixed(value('condition', method, settings, 'psnr_fg_db'), 2)} / ${fixed(value('condition', method, settings, 'ssim_fg'), 3)}`;
const distinct = (list) => [...new Set(list)];
const table = (head, body) => [head, head.map(() => '---'), ...body].map((row) => `| ${row.join(' | ')} |`).join('\n');

const conditions = rows.filter((row) => row.table === 'condition');
const methods = distinct(conditions.map((row) => row.method));
const places = (axis) => distinct(conditions.filter((row) => setting(row, 'axis') === axis).map((row) => setting(row, 'at')));
const onProxy = (at) => ({ axis: 'proxy', at });

const names = { given: 'tracked mesh', refined: 'refined hull', hull: 'hull' };
const choices = Object.keys(names).filter((at) => places('proxy').includes(at)).map((at) => {
  const remark = (method) => {
    if (matching('choice', method, { proxy: at }, 'taken').length) return '**take this**';
    const [refused] = matching('choice', method, { proxy: at }, 'refused');
    return refused ? setting(refused, 'text') : '';
  };
  return `On a ${names[at]}:\n\n${table(['method', 'dB / SSIM', 'flicker, levels', 'new frame against FVVR', 'new view against FVVR', 'bytes', ''], methods.map((method) => [
    method, quality(method, onProxy(at)), fixed(value('condition', method, onProxy(at), 'flicker_levels'), 2),
    `${fixed(value('condition', method, onProxy(at), 'ratio_to_fvvr'), 2)} ×`,
    `${fixed(value('condition', method, onProxy(at), 'view_s') / value('condition', 'fvvr', onProxy(at), 'view_s'), 2)} ×`, '0', remark(method)]))}`;
}).join('\n\n');

const surfaces = table(['method', ...places('proxy')], methods.map((method) => [method, ...places('proxy').map((at) => quality(method, onProxy(at)))]));
const sharpness = table(['method', ...places('proxy')], methods.map((method) => [method, ...places('proxy').map((at) => (
  `${fixed(value('condition', method, onProxy(at), 'gradient_ratio'), 2)} / ${fixed(value('condition', method, onProxy(at), 'shift_tolerant_db'), 2)}`))]));

const axisMethods = distinct(conditions.filter((row) => setting(row, 'axis') !== 'proxy').map((row) => row.method));
const units = { cameras: 'cameras', rotation: '° of rotation', translation: 'mm of position', focal: '% of focal length', gain: '% of gain', standoff: 'mm of surface', mixed: '' };
const axes = table(['error', ...axisMethods], [
  ['none, 4 cameras', ...axisMethods.map((method) => quality(method, onProxy('given')))],
  ...Object.keys(units).flatMap((axis) => places(axis).map((at) => [axis === 'mixed' ? 'mixed' : `${at} ${units[axis]}`.replace(' °', '°'),
    ...axisMethods.map((method) => quality(method, { axis, at }))]))]);

const crossRows = [...rows, ...tunedOn].filter((row) => row.table === 'cross');
const cross = table(['motion, surface', 'method', 'left out: RMSE, %', 'dB / SSIM', 'with its own picture: RMSE, %', 'dB / SSIM'],
  distinct(crossRows.map((row) => `${row.sequence} ${setting(row, 'proxy')} ${row.method}`)).map((key) => {
    const [sequence, proxy, method] = key.split(' ');
    const one = (own, quantity) => crossRows.find((row) => row.sequence === sequence && row.method === method
      && row.quantity === quantity && setting(row, 'proxy') === proxy && setting(row, 'own') === own)?.value;
    const cells = ['0', '1'].flatMap((own) => [fixed(100 * one(own, 'rmse'), 2), `${fixed(one(own, 'psnr_fg_db'), 2)} / ${fixed(one(own, 'ssim_fg'), 3)}`]);
    return [`${sequence}, ${proxy}`, method, ...cells];
  }));

const stageMethods = distinct(rows.filter((row) => row.table === 'stage').map((row) => row.method));
const passes = distinct(rows.filter((row) => row.table === 'stage').map((row) => setting(row, 'pass')));
const stages = table(['pass, ms', ...stageMethods], passes.map((pass) => [pass, ...stageMethods.map((method) => fixed(value('stage', method, { pass }, 'frame_ms'), 1))]));

// dB / SSIM over all held-out views of what was streamed, by character and method.
function streamedScore(character, method) {
  const text = execFileSync(tool, ['evaluate', capture, '--character', join(characters, character), '--method', method, '--input-every', '0', '--flicker', '0'], { encoding: 'utf8' });
  const words = text.split('\n').filter((line) => line.trim().startsWith('mean')).at(-1).trim().split(/\s+/);
  return `${fixed(Number(words[2]), 2)} / ${fixed(Number(words[3]), 3)}`;
}
const streamed = characters ? readdirSync(characters, { withFileTypes: true }).filter((entry) => entry.isDirectory()).map(({ name }) => name) : [];
const streamedSection = !streamed.length ? '' : `
## After the codec

The demo's characters from cameras (\`site/cameras.sh\`: H.264 with CRF 30, the refined hull coarser than by default), all held-out
views of the run, PSNR-FG in dB / SSIM-FG. \`tracked\` is the capture's mesh with its outlines refined, as the bake does by default, and
with cameras as given; above the mesh is as given, too.

${table(['method', ...streamed], methods.map((method) => [method, ...streamed.map((character) => streamedScore(character, method))]))}
`;

const promises = rows.filter((row) => row.table === 'promise').map((row) => `- ${row.quantity}: ${setting(row, 'text')}`).join('\n');
const about = rows.filter((row) => row.table === 'about').map((row) => `- ${row.quantity}: ${setting(row, 'text')}`).join('\n');

const tables = `## Which method to take

A method may not be below linear blending by more than .05 dB, not cost more than twice FVVR's frame, and not flicker by more than
a tenth more than FVVR. Of those left, the one with the best SSIM-FG; of those within .002 of it, the one that costs least. All
methods draw from the same files. Costs are of a new frame, in software rendering: only ratios count.

${choices}

## What the papers promise

${promises}

## Surfaces

PSNR-FG in dB / SSIM-FG:

${surfaces}

Gradient energy against the truth's (below 1: blurred) / shift-tolerant PSNR in dB (blocks of 16 × 16 pixels, ±3 pixels):

${sharpness}

${streamedSection}
## Cameras and calibration, on the given mesh

${axes}

## Montage4D Table 2

Every input camera's picture against what is drawn for it, at three test frames. Constants were chosen on the walk.

${cross}

## Montage4D Table 3

Passes of a new frame, the GPU drained after each.

${stages}
`;
writeFileSync(join(out, 'methods.md'), `# Methods of texturing from cameras

Made by \`node tests/bench/methods.mjs\` with \`fourdvt evaluate --projective\`, from the raw videos before any codec unless it says otherwise, at the sample's
held-out cameras, which are three for every test frame. What was measured:

${about}

${tables}`);
console.log(tables);
