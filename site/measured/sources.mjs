// SPDX-License-Identifier: Apache-2.0
// Reads the sources of collect.mjs: a study's rows, a character's report, the scores of a character, a bench's output,
// the player's sizes. Figures are defined in catalogue.mjs.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

export class SourceError extends Error {}

function readText(path, remedy) {
  if (!existsSync(path)) throw new SourceError(`${path} is missing; ${remedy}`);
  return readFileSync(path, 'utf8');
}

function readJson(path, remedy) {
  const text = readText(path, remedy);
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new SourceError(`${path}: ${error.message}; ${remedy}`);
  }
}

// RFC 4180: quotes are doubled inside quotes. Returns an object per record, keyed by the header.
export function parseCsv(text) {
  const records = [[]];
  let field = '', quoted = false;
  for (let i = 0; i < text.length; ++i) {
    const c = text[i];
    if (quoted && c === '"' && text[i + 1] === '"') { field += c; ++i; }
    else if (c === '"') quoted = !quoted;
    else if (!quoted && c === ',') { records.at(-1).push(field); field = ''; }
    else if (!quoted && c === '\n') { records.at(-1).push(field); field = ''; records.push([]); }
    else if (c !== '\r') field += c;
  }
  if (field) records.at(-1).push(field);
  const [header, ...rows] = records.filter((record) => record.length > 1);
  return rows.map((row) => Object.fromEntries(header.map((name, i) => [name, row[i] ?? ''])));
}

// Rows of `fourdvt-lab study CAPTURE -o FOLDER`: { table, sequence, method, setting, quantity, value, unit }.
export function readStudy(folder) {
  const json = join(folder, 'evaluate.json'), csv = join(folder, 'evaluate.csv'), remedy = `run fourdvt-lab study CAPTURE -o ${folder}`;
  const study = existsSync(json) ? readJson(json, remedy) : { rows: parseCsv(readText(csv, remedy)) };
  const numbers = (study.rows ?? []).map((row) => ({ ...row, value: row.value === null ? NaN : Number(row.value) })).filter((row) => row.table && row.quantity);
  if (!numbers.length) throw new SourceError(`${folder}: holds no rows of a study; ${remedy}`);
  return new Study(numbers, study);
}

// "key=value key=value" → Map. "text", "pass" and "stage" come last and reach to the end.
export function settingOf(text) {
  const tail = /(?:^| )(text|pass|stage)=(.*)$/s.exec(text);
  const words = (tail ? text.slice(0, tail.index) : text).split(' ').filter(Boolean);
  const pairs = words.map((word) => [word.split('=')[0], word.slice(word.indexOf('=') + 1)]);
  return new Map(tail ? [...pairs, [tail[1], tail[2]]] : pairs);
}

const sameValue = (a, b) => a === b || (a !== '' && b !== '' && Number(a) === Number(b));

// A filter is "key=value !key": each pair must be in the setting (numbers compare as numbers), a key after "!" must not.
export function matchesFilter(setting, filter) {
  return filter.split(' ').filter(Boolean).every((word) => {
    if (word.startsWith('!')) return !setting.has(word.slice(1));
    const equals = word.indexOf('=');
    return sameValue(setting.get(word.slice(0, equals)) ?? '', word.slice(equals + 1));
  });
}

export class Study {
  // Second argument: fields of evaluate.json about the run.
  constructor(rows, { generator, quick } = {}) {
    this.generator = generator;
    this.quick = quick;
    this.rows = rows.filter((row) => Number.isFinite(row.value)).map((row) => ({ ...row, keys: settingOf(row.setting ?? '') }));
  }
  // where: { table, method, setting, quantity }; what is left out matches all.
  select({ table, method, setting = '', quantity }) {
    return this.rows.filter((row) => row.table === table && (method === undefined || row.method === method) &&
      (quantity === undefined || row.quantity === quantity) && matchesFilter(row.keys, setting));
  }
  get isQuick() {
    return this.quick ?? /--quick/.test(this.fact('command'));
  }
  fact(name) {
    return this.rows.find((row) => row.table === 'about' && row.quantity === name)?.keys.get('text') ?? '';
  }
}

export const readCharacter = (folder) => readJson(join(`${folder}.report`, 'report.json'), `bake the character again: fourdvt bake CAPTURE -o ${folder}`);

// Scores of `fourdvt-lab score CHARACTER --capture CAPTURE -o FOLDER` at the held-out cameras: per sequence the mean
// over its views, then the mean over the sequences, as the study's own mean.
export function readScores(folder) {
  const remedy = `run fourdvt-lab score CHARACTER --capture CAPTURE -o ${folder}`;
  const rows = parseCsv(readText(join(folder, 'evaluate.csv'), remedy)).filter((row) => row.kind === 'held-out');
  if (!rows.length) throw new SourceError(`${folder}: holds no scores of held-out cameras; ${remedy}`);
  const sequences = [...new Set(rows.map((row) => row.sequence))];
  return (quantity) => mean(sequences.map((name) => mean(rows.filter((row) => row.sequence === name).map((row) => Number(row[quantity])))));
}

// Record of a part's measurement, by parts.mjs.
export function readRecord(folder) {
  const record = readJson(join(folder, 'part.json'), 'run bash site/measured/measure.sh');
  if (!record.inputs || !record.date) throw new SourceError(`${folder}/part.json: lacks inputs or date; run bash site/measured/measure.sh`);
  return record;
}

// { facts, rows } of a part with tables of its own.
export function readTables(folder) {
  const { facts = {}, rows } = readJson(join(folder, 'rows.json'), 'run bash site/measured/measure.sh');
  if (!rows?.length) throw new SourceError(`${folder}/rows.json: holds no rows; run bash site/measured/measure.sh`);
  return { facts, rows };
}

// The text that a bench printed, or null where it did not run.
export function readBench(folder, name) {
  const path = join(folder, `${name}.txt`);
  return existsSync(path) ? readFileSync(path, 'utf8') : null;
}

// Parts of the player as web/build.mjs lists them, by name: { files: [{ name, bytes, gzip_bytes }], gzip_bytes,
// limit_gzip_bytes }.
export function readSizes(folder) {
  const sizes = readJson(join(folder, 'sizes.json'), 'build the web package first: node web/build.mjs');
  if (!sizes.first?.files?.length) throw new SourceError(`${folder}/sizes.json: holds no part "first"; build the web package again: node web/build.mjs`);
  return sizes;
}

// Standard error of the mean of these values; NaN below two.
export function standardError(values) {
  const middle = mean(values);
  return Math.sqrt(values.reduce((sum, value) => sum + (value - middle) ** 2, 0) / (values.length * (values.length - 1)));
}

export const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
