#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// method_choice.mjs FOURDVT_LAB CAPTURE OUT [SEQUENCES [FRAMES [AXIS_FRAMES [METHODS_JSON]]]]: method that the bake
// would choose under every condition of methods.mjs, from the input cameras alone, against the scores at the held-out
// cameras in METHODS_JSON (default site/measured/methods.json). Prints a table; with METHODS_JSON given, replaces its
// rows "chosen", from which `node site/measured/fill.mjs` makes methods.md. A killed run resumes after its finished
// results.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { chosenAgainstTruth, regretSummary } from '../../site/measured/regret.mjs';
import { settingOf } from '../../site/measured/sources.mjs';
import { rounded, run } from './kept.mjs';

/** Rows "chosen" of the rows of `fourdvt-lab methods`. */
export function chosenRows(rows) {
  const tried = rows.filter((row) => row.table === 'tried').map((row) => ({ ...row, keys: settingOf(row.setting) }));
  const of = (keys, method, quantity) => tried.find((row) => row.keys.get('axis') === keys.get('axis') && row.keys.get('at') === keys.get('at') &&
    row.method === method && row.quantity === quantity)?.value;
  return tried.filter((row) => row.quantity === 'taken').map(({ keys, method }) => rounded({
    table: 'chosen', axis: keys.get('axis'), at: keys.get('at'), method, views: Number(keys.get('views')), shift_px: of(keys, '', 'shift_px'),
    blended_db: Object.fromEntries([...new Set(tried.map((row) => row.method))].filter(Boolean)
      .map((name) => [name, of(keys, name, 'blended_psnr_db')]).filter(([, value]) => value !== undefined)
      .map(([name, value]) => [name, Number(value.toFixed(2))])),
  }));
}

function main() {
  const [lab, capture, out, sequences = 'run,pickup', frames = '2', axisFrames = '1', json] = process.argv.slice(2);
  if (!out) {
    console.error('usage: method_choice.mjs FOURDVT_LAB CAPTURE OUT [SEQUENCES [FRAMES [AXIS_FRAMES [METHODS_JSON]]]]');
    process.exit(2);
  }
  mkdirSync(out, { recursive: true });
  const report = join(out, 'choice');
  run(lab, 'methods', capture, '-o', report, '--sequences', sequences, '--frames', frames, '--axis-frames', axisFrames, '--steps', 'choice');
  const chosen = chosenRows(JSON.parse(readFileSync(join(report, 'projective.json'), 'utf8')).rows);
  const path = json ?? fileURLToPath(new URL('../../site/measured/methods.json', import.meta.url));
  const text = readFileSync(path, 'utf8'), data = JSON.parse(text);
  const rows = [...data.rows.filter((row) => row.table !== 'chosen'), ...chosen];
  for (const row of chosenAgainstTruth(rows)) console.log(Object.values(row).join('  '));
  console.log(regretSummary(chosenAgainstTruth(rows)));
  data.facts['what the bake chooses'] = `measured on ${new Date().toISOString().slice(0, 10)}, test frames of each motion: ${frames}`;
  if (json) writeFileSync(json, text.replace(/"facts": .*/, `"facts": ${JSON.stringify(data.facts)},`).replace(/"rows": \[[\s\S]*\n ?\]/, `"rows": [\n${rows.map((row) => `  ${JSON.stringify(row)}`).join(',\n')}\n ]`));
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) main();
