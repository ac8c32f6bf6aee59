// SPDX-License-Identifier: Apache-2.0
// node site/measured/live.mjs [--table] [ROW…]: what a live system of six cameras does on this machine, end to end; writes
// site/measured/live.md. Needs a release build with -DFOURDVT_LAB=ON and -DFOURDVT_TESTS=ON, the site (bash site/demo.sh --prepare)
// and Chromium. About 35 minutes, ten of them for the memory's slope. Keep the machine quiet meanwhile.
//   Resume   run it again after a kill: finished rows are in build/measured/live/HASH (that of native/ without Markdown, as committed)
//   --table  writes the document from the finished rows alone
//   ROW      only these rows, in this order (names: rows of tests/bench/live/rows.mjs)
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { rows as kRows } from '../../tests/bench/live/rows.mjs';
import { besideYardstick } from '../../tests/bench/yardstick.mjs';
import { documentOf } from './live_document.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const git = (...words) => execFileSync('git', words, { cwd: kRoot, encoding: 'utf8' }).trim();
const hash = createHash('sha256').update(git('ls-tree', '-r', 'HEAD', 'native').split('\n').filter((line) => !line.endsWith('.md')).join('\n')).digest('hex').slice(0, 16);
const folder = join(kRoot, 'build/measured/live', hash);
const wanted = process.argv.slice(2).filter((word) => word !== '--table');
const unknown = wanted.filter((name) => !kRows.some((row) => row.name === name));
if (unknown.length) {
  console.error(`site/measured/live.mjs: no row ${unknown.join(', ')}; there are ${kRows.map(({ name }) => name).join(', ')}`);
  process.exit(2);
}

mkdirSync(folder, { recursive: true });
const pathOf = (name) => join(folder, `${name}.json`);
for (const row of process.argv.includes('--table') ? [] : kRows) {
  if (existsSync(pathOf(row.name)) || (wanted.length && !wanted.includes(row.name))) continue;
  console.log(`live: ${row.name}`);
  const { value, yardstick } = await besideYardstick(() => row.measure(join(kRoot, 'build/measured/live')));
  writeFileSync(`${pathOf(row.name)}.part`, `${JSON.stringify({ yardstick, ...value })}\n`);
  renameSync(`${pathOf(row.name)}.part`, pathOf(row.name));
}
const measured = Object.fromEntries(kRows.filter(({ name }) => existsSync(pathOf(name))).map(({ name }) => [name, JSON.parse(readFileSync(pathOf(name), 'utf8'))]));
const commit = git('log', '-1', '--format=%h', '--', 'native', ':!*.md');
writeFileSync(join(kRoot, 'site/measured/live.md'), documentOf(measured, kRows, { date: new Date().toISOString().slice(0, 10), commit }));
console.log('wrote site/measured/live.md');
process.exit(0); // browsers may hold connections
