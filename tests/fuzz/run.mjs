// SPDX-License-Identifier: Apache-2.0
// node tests/fuzz/run.mjs PROGRAM CORPUS KEPT [SECONDS]: fuzzes by libFuzzer for so long, from the committed corpus and what earlier runs
// on this machine found, and keeps what is new. Prints the seed, another one every run, executions and coverage; after a
// finding, the input's file too. FOURDVT_FUZZ_SEED=N repeats a run. 0 seconds: the committed corpus alone, once.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';

const [program, corpus, kept, seconds = '5'] = process.argv.slice(2);
if (!kept) {
  console.error('usage: run.mjs PROGRAM CORPUS KEPT [SECONDS]');
  process.exit(2);
}
const name = basename(program), label = program.includes('fuzz32') ? `${name}, 32 bits` : name, findings = join(kept, 'findings'), own = join(kept, name);
for (const folder of [findings, own]) mkdirSync(folder, { recursive: true });
const seed = process.env.FOURDVT_FUZZ_SEED ?? String(1 + Math.floor(Math.random() * 0x7ffffffe));
// Inputs that only the 32-bit build handles quickly: its Draco has the same corrections as wasm's.
const small = program.includes('fuzz32') && existsSync(`${corpus}32`) ? [`${corpus}32`] : [];
const length = seconds === '0' ? [corpus, '-runs=0'] : [own, corpus, `-max_total_time=${seconds}`];
const { status, stderr } = spawnSync(program, [...length, ...small, `-seed=${seed}`, `-artifact_prefix=${join(findings, `${name}-`)}`,
  '-print_final_stats=1', '-timeout=60', '-rss_limit_mb=3072', '-max_len=65536'], { encoding: 'utf8', maxBuffer: 1 << 28, env: { ASAN_OPTIONS: 'detect_leaks=1', ...process.env } });
writeFileSync(join(kept, `${label.replace(/\W+/g, '-')}.log`), stderr ?? '');
const last = (pattern) => [...(stderr ?? '').matchAll(pattern)].at(-1)?.[1] ?? '?';
console.log(`${label}: seed ${seed}, ${last(/stat::number_of_executed_units:\s+(\d+)/g)} executions, ${last(/cov: (\d+)/g)} branches, ${readdirSync(own).length} inputs kept beside ${readdirSync(corpus).length}`);
if (status !== 0) {
  console.log((stderr ?? '').split('\n').slice(-60).join('\n'));
  console.log(`${label}: a finding with seed ${seed}; the input is in ${findings}: put it into ${corpus} once it is corrected`);
}
process.exit(status === 0 ? 0 : 1);
