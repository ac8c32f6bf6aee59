#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Runs the yardstick, one fixed job (bench_yardstick: decodes two cameras of the sample's walk and encodes them by
// FFmpeg on one thread), before and after a bench: published seconds come with their ratio to its CPU seconds, because
// machines differ.
//   node yardstick.mjs PROGRAM …     runs a bench with the yardstick before and after, and prints it below what the bench prints
//   node yardstick.mjs --keep FILE   adds three runs to FILE, a line of JSON each
import { execFileSync, spawnSync } from 'node:child_process';
import { appendFileSync, existsSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { machineText, summaryOf } from '../../site/measured/yardstick.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kVideos = ['cam00', 'cam01'].map((name) => join(kRoot, 'site/sample/actor_a/walk', `${name}.mp4`));

/** Three runs, some seconds of CPU: { cpu_s, wall_s, others_s, job }. */
export function yardstickRuns() {
  const program = process.env.FOURDVT_YARDSTICK_BIN ?? join(kRoot, 'build/release/tests/bench/bench_yardstick');
  if (!existsSync(program)) throw new Error(`${program} is missing; build it: cmake --preset release -DFOURDVT_MORE_TOOLS=ON -DFOURDVT_LAB=ON -DFOURDVT_TESTS=ON && cmake --build build/release --target bench_yardstick`);
  return execFileSync(program, kVideos, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] }).trim().split('\n').map((line) => JSON.parse(line));
}

/** Result of `measure`, with the yardstick before and after it. runs: earlier runs; new ones are appended. */
export async function besideYardstick(measure, runs = []) {
  runs.push(...yardstickRuns());
  const value = await measure();
  runs.push(...yardstickRuns());
  return { value, yardstick: summaryOf(runs) };
}

async function main([first, ...rest]) {
  if (first === '--keep' && rest.length === 1) {
    const runs = yardstickRuns();
    appendFileSync(rest[0], runs.map((run) => `${JSON.stringify(run)}\n`).join(''));
    console.log(`yardstick: ${machineText(summaryOf(runs))}`);
  } else if (first && !first.startsWith('-')) {
    const { value, yardstick } = await besideYardstick(() => spawnSync(first, rest, { stdio: 'inherit' }));
    if (value.error) throw value.error;
    console.log(`yardstick: ${machineText(yardstick)}`);
    process.exitCode = value.status ?? 1;
  } else {
    throw new Error('usage: yardstick.mjs PROGRAM … | --keep FILE');
  }
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  main(process.argv.slice(2)).catch((error) => {
    console.error(`yardstick.mjs: ${error.message}`);
    process.exitCode = 1;
  });
}
