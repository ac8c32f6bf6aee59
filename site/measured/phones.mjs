// SPDX-License-Identifier: Apache-2.0
// node site/measured/phones.mjs [--before SITE --before-commit NAME] [--table] [ROW…]: measures the cost of playing in a
// page, per upload path and without WebCodecs; writes site/measured/phones.json and phones.md. Needs the site (bash
// site/demo.sh --prepare), bench_yardstick of a release build with -DFOURDVT_TESTS=ON, Chromium and Firefox. About 27
// minutes.
//   Resume     rows are measured again only if they are named, or missing; each keeps the commit that it was measured at, and the
//              yardstick beside it
//   --before   the site of an earlier version (its build/site): the rows that are compared with it
//   --table    writes the document from the finished rows alone
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { rows } from '../../tests/bench/phones/rows.mjs';
import { besideYardstick } from '../../tests/bench/yardstick.mjs';
import { documentOf } from './phones_document.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const { values: options, positionals: wanted } = parseArgs({ allowPositionals: true,
  options: { before: { type: 'string' }, 'before-commit': { type: 'string', default: '' }, table: { type: 'boolean' } } });
const unknown = wanted.filter((name) => !rows.some((row) => row.name === name));
if (unknown.length) {
  console.error(`site/measured/phones.mjs: no row ${unknown.join(', ')}; there are ${rows.map(({ name }) => name).join(', ')}`);
  process.exit(2);
}
const file = join(root, 'site/measured/phones.json');
const measured = existsSync(file) ? JSON.parse(readFileSync(file, 'utf8')) : {};
const commit = execFileSync('git', ['log', '-1', '--format=%h', '--', 'native', 'web', 'wasm', 'shaders'], { cwd: root, encoding: 'utf8' }).trim();
for (const row of options.table ? [] : rows) {
  if (wanted.length ? !wanted.includes(row.name) : measured[row.name]) continue;
  if (row.before && !options.before) continue;
  console.log(`phones: ${row.name}`);
  const { value: figures, yardstick } = await besideYardstick(() => row.measure({ root, site: join(root, 'build/site'), before: options.before }));
  measured[row.name] = { date: new Date().toISOString().slice(0, 10), commit: row.before ? options['before-commit'] : commit, yardstick, ...figures };
  writeFileSync(`${file}.part`, `{\n${Object.entries(measured).map(([name, value]) => ` ${JSON.stringify(name)}: ${JSON.stringify(value)}`).join(',\n')}\n}\n`);
  renameSync(`${file}.part`, file);
}
writeFileSync(join(root, 'site/measured/phones.md'), documentOf(measured, rows));
console.log('wrote site/measured/phones.md');
process.exit(0); // browsers may hold connections
