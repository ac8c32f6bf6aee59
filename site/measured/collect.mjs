// SPDX-License-Identifier: Apache-2.0
// node site/measured/collect.mjs --from DIR [options] PART…: takes the figures of these parts from what their runs wrote in
// DIR/PART, and keeps those of the other parts as they are, with the hash of their inputs and their date. Nothing is typed
// by hand; a figure that was never measured is left out, and the pages say "not measured in this run".
// Writes site/measured/figures.json, and PART.json of a part that has tables of its own (cameras, hulls, methods).
//   DIR/PART/part.json    { inputs, date, commit, minutes, yardstick } of the measurement
//   DIR/study/report      of fourdvt-lab study CAPTURE -o REPORT; DIR/fvvr/report: the same of FVVR alone; DIR/truth/report:
//                         of the virtual studio
//   DIR/bench             character/ (its report.json), {high,crf31}/{character,scores}, NAME.txt (what a bench printed)
//   DIR/player            sizes.json of the built web package
//   DIR/PART/rows.json    { facts, rows } that the part's script in tests/bench wrote
//   --before FILE         an earlier figures.json: the page lists what got worse since (default: the figures replaced)
//   --to FOLDER           where the files are written and kept figures are read (default: site/measured)
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { figures as catalogue, leftToTheReport, runs } from './catalogue.mjs';
import { partOfRun, parts } from './parts.mjs';
import { SourceError, mean, readRecord, readTables, standardError, readBench, readCharacter, readScores, readSizes, readStudy } from './sources.mjs';

const kStudies = ['study', 'fvvr', 'truth'];  // runs that write a study's rows

const kOver = {
  mean,
  sum: (values) => values.reduce((a, b) => a + b, 0),
  max: (values) => Math.max(...values),
  min: (values) => Math.min(...values),
  first: (values) => values[0],
};
const kDerived = {
  ratio: (a, b) => a / b,
  percent: (a, b) => 100 * a / b,
  difference: (a, b) => a - b,
  percent_less: (a, b) => 100 * (1 - a / b),
  percent_more: (a, b) => 100 * (a / b - 1),
};

function isNumeric(text) {
  return text !== '' && Number.isFinite(Number(text));
}

// Returns the distinct values, in order of appearance; numbers in ascending order.
function distinct(values) {
  const out = [...new Set(values)].filter((value) => value !== undefined && value !== '');
  return out.every(isNumeric) ? out.sort((a, b) => a - b) : out;
}

function combine(rows, over) {
  const whole = rows.filter((row) => row.sequence === '');
  return kOver[over ?? 'mean']((whole.length ? whole : rows).map((row) => row.value));
}

// Divides values by another quantity of the same row, or subtracts it.
function withPartner(study, rows, { against, less }) {
  if (!against && !less) return rows;
  return rows.flatMap((row) => {
    const partner = study.rows.find((other) => other.quantity === (against ?? less) && other.table === row.table &&
      other.sequence === row.sequence && other.method === row.method && other.setting === row.setting);
    return partner ? [{ ...row, value: against ? row.value / partner.value : row.value - partner.value }] : [];
  });
}

const keyOf = (row, each) => (each === 'sequence' ? row.sequence : row.keys.get(each));

function fromStudy(study, table, figure) {
  const { method, setting, quantity, over } = figure.from;
  const rows = withPartner(study, study.select({ table, method, setting, quantity }), figure.from);
  if (!figure.each) return rows.length ? combine(rows, over) : NaN;
  const keys = distinct(rows.map((row) => keyOf(row, figure.each))).filter((key) => !figure.only || figure.only.some((wanted) => Number(wanted) === Number(key)));
  const values = keys.map((key) => [key, combine(rows.filter((row) => keyOf(row, figure.each) === key), over)]);
  const order = distinct(study.rows.map((row) => row.sequence));
  const outside = beyondRange(study, table, figure);
  return Object.fromEntries(outside.length ? [...values, ...outside].sort(([a], [b]) => order.indexOf(a) - order.indexOf(b)) : values);
}

// Returns words in place of a value outside of the measured range.
function beyondRange(study, table, figure) {
  const { method, setting, beyond } = figure.from;
  if (!beyond) return [];
  return study.select({ table, method, setting, quantity: beyond }).map((row) => [keyOf(row, figure.each), row.value > 0 ? 'above all rates' : 'below all rates']);
}

// Standard error of a mean of means.
const ofMeans = (errors) => Math.hypot(...errors) / errors.length;

// Values of two methods at the same views, as differences.
function pairedDifferences(study, [method, other], quantity) {
  return study.select({ table: 'held-out-views', method, quantity }).flatMap((row) => {
    const partner = study.rows.find((one) => one.table === row.table && one.quantity === quantity && one.method === other &&
      one.sequence === row.sequence && one.setting === row.setting);
    return partner ? [{ sequence: row.sequence, value: row.value - partner.value }] : [];
  });
}

// Standard errors of a figure over the views that it is a mean of: a number, or one per key; NaN where there are none.
function spreadOf(figure, sources) {
  const { spread } = figure, study = spread && sources[figure.from.fvvr ? 'fvvr' : 'study'];
  if (!study) return NaN;
  const rows = spread.paired ? pairedDifferences(study, spread.paired, spread.quantity)
    : study.select({ table: figure.from.study ?? figure.from.fvvr, method: figure.from.method, setting: figure.from.setting, quantity: spread.quantity });
  const bySequence = distinct(rows.map((row) => row.sequence)).map((name) => {
    const values = rows.filter((row) => row.sequence === name).map((row) => row.value);
    return [name, spread.paired ? standardError(values) : ofMeans(values)];
  });
  if (figure.each) return Object.fromEntries(bySequence);
  return bySequence.length ? ofMeans(bySequence.map(([, error]) => error)) : NaN;
}

function fromReport(report, take, figure) {
  const value = take(report);
  if (value === null) return NaN;
  const numbers = typeof value === 'object' ? Object.values(value) : [value];
  if (!numbers.every(Number.isFinite)) throw new SourceError(`report.json lacks what the figure ${figure.id} is made from; bake the character again, or mend site/measured/catalogue.mjs`);
  return value;
}

function fromBench(folder, { bench, match, over }) {
  const text = readBench(folder, bench);
  if (text === null) return NaN;
  const found = [...text.matchAll(new RegExp(match.source, 'g'))].map((m) => Number(m[1]));
  if (!found.length) throw new SourceError(`${join(folder, bench)}.txt: no line matches ${match}; the bench failed, or prints something else now: mend site/measured/catalogue.mjs`);
  return kOver[over ?? 'first'](found);
}

// A number of some parts of the player; where it is of each file, by name.
function fromPlayer(sizes, { from: { player, quantity = 'gzip_bytes' }, each }) {
  const found = player.map((part) => sizes[part]).filter(Boolean);
  if (each === 'file') return Object.fromEntries(found.flatMap(({ files }) => files.map((file) => [file.name, file[quantity]])));
  return found.length === player.length ? found.reduce((sum, part) => sum + part[quantity], 0) : NaN;
}

// Points [bit/s, quality] of a rate curve, by bitrate.
function curvePoints(study, method, setting, quantity) {
  return study.select({ table: 'rate', method, setting, quantity: 'video_bps' }).flatMap((row) => {
    const partner = study.rows.find((other) => other.table === 'rate' && other.quantity === quantity && other.method === method && other.setting === row.setting && other.sequence === row.sequence);
    return partner ? [[row.value, partner.value]] : [];
  }).sort(([a], [b]) => a - b);
}

// Interpolated in log bitrate; NaN beyond the range.
function onCurve(points, x) {
  const next = points.findIndex(([at]) => at >= x);
  if (next < 0) return NaN;
  const [b, after] = points[next];
  if (b === x) return after;
  if (next === 0) return NaN;
  const [a, before] = points[next - 1];
  return before + (after - before) * Math.log(x / a) / Math.log(b / a);
}

function fromCurve(study, { curve, method, setting, at, minus }) {
  const own = curvePoints(study, method, setting, curve), other = minus && curvePoints(study, method, minus, curve);
  if (!own.length || (other && !other.length)) return {};
  const bitrates = curvePoints(study, method, at, curve).map(([x]) => x);
  return Object.fromEntries(bitrates.map((x) => {
    const value = onCurve(own, x) - (other ? onCurve(other, x) : 0);
    return [(x * 1e-6).toFixed(2), Number.isFinite(value) ? value : '–'];
  }));
}

// Applies the operation to numbers, or to groups of values for each key that all of them have.
function derived(operation, parts) {
  if (parts.every((part) => typeof part === 'number')) return operation(...parts);
  if (parts.some((part) => typeof part === 'number')) return NaN;
  const keys = Object.keys(parts[0]).filter((key) => parts.every((part) => Number.isFinite(part[key])));
  return Object.fromEntries(keys.map((key) => [key, operation(...parts.map((part) => part[key]))]));
}

// Returns a figure's value, or NaN where its run was not given.
function valueOf(figure, sources, known) {
  const { from } = figure;
  const name = kStudies.find((key) => from[key]);
  if (name) return sources[name] ? fromStudy(sources[name], from[name], figure) : NaN;
  if (from.curve) return sources.study ? fromCurve(sources.study, from) : NaN;
  if (from.character) return sources.character ? fromReport(sources.character, from.character, figure) : NaN;
  if (from.variant) return sources.variants[from.variant] ? fromReport(sources.variants[from.variant].report, from.take, figure) : NaN;
  if (from.scores) return sources.variants[from.scores]?.score(from.quantity) ?? NaN;
  if (from.bench) return sources.bench ? fromBench(sources.bench, from) : NaN;
  if (from.player) return sources.player ? fromPlayer(sources.player, figure) : NaN;
  const [kind] = Object.keys(kDerived).filter((name) => from[name]);
  return derived(kDerived[kind], from[kind].map((id) => known.get(id) ?? NaN));
}

// Describes where the value is in the reports.
function origin({ from }) {
  const name = kStudies.find((key) => from[key]);
  if (name) {
    const words = [from[name], from.method, from.setting, from.quantity, from.against && `/ ${from.against}`, from.less && `− ${from.less}`, from.over];
    return { run: name, row: words.filter(Boolean).join(', ') };
  }
  if (from.curve) return { run: 'study', row: ['rate', from.method, from.setting, from.curve, from.minus && `− ${from.minus}`].filter(Boolean).join(', ') };
  if (from.character) return { run: 'character', row: 'report.json' };
  if (from.variant) return { run: from.variant, row: 'character/report.json' };
  if (from.scores) return { run: from.scores, row: `scores/evaluate.csv, held-out, ${from.quantity}` };
  if (from.bench) return { run: from.bench, row: `${from.bench}.txt, ${from.match}` };
  if (from.player) return { run: 'player', row: `sizes.json, ${from.player.join(', ')}` };
  const [kind, ids] = Object.entries(from)[0];
  return { run: 'figures', row: `${kind} of ${ids.join(', ')}` };
}

const byId = new Map(catalogue.map((figure) => [figure.id, figure]));
const derivedFrom = ({ from }) => Object.entries(from).find(([name]) => kDerived[name])?.[1] ?? [];

// Returns the parts in which a figure of the catalogue is measured.
export function partsOf(figure) {
  const own = partOfRun[origin(figure).run];
  return own ? [own] : [...new Set(derivedFrom(figure).flatMap((id) => partsOf(byId.get(id))))].sort();
}

// Rounds to two digits more than are shown.
function kept(value, digits) {
  return Number(value.toFixed(digits + 2));
}

function entries(figure, value, spread) {
  const base = { unit: figure.unit, digits: figure.digits, what: figure.what, ...origin(figure), parts: partsOf(figure), ...(figure.better && { better: figure.better }) };
  const scaled = (number) => kept(number * (figure.scale ?? 1), figure.digits);
  const error = (key) => (key === undefined ? spread : spread?.[key]);
  const make = (id, number, key) => ({ id, value: scaled(number), ...(Number.isFinite(error(key)) && { se: scaled(error(key)) }), ...(key !== undefined && { of: figure.id, key }), ...base });
  if (typeof value === 'number') return Number.isFinite(value) ? [make(figure.id, value)] : [];
  return Object.entries(value).map(([key, number]) => {
    const id = `${figure.id}.${key.replaceAll(' ', '_')}`;
    return typeof number === 'string' ? { ...make(id, 0, key), value: null, text: number } : make(id, number, key);
  });
}

// True where a figure takes this table and quantity for this method, be it as a partner of another quantity.
function isTaken(row) {
  return catalogue.some(({ from, spread }) => kStudies.some((name) => from[name] === row.table) && (from.method === undefined || from.method === row.method) &&
    [from.quantity, from.against, from.less, from.beyond, spread?.quantity].includes(row.quantity));
}

function isLeft(row) {
  const left = leftToTheReport[row.table];
  return left === '*' || left?.includes(row.quantity);
}

// Rows that nothing in the catalogue shows: kept as they are.
function otherRows(study, run) {
  return study.rows.filter((row) => !isLeft(row) && !isTaken(row)).map((row) => ({
    id: [`${run}:${row.table}`, row.sequence, row.method, (row.setting ?? '').replaceAll(' ', '+'), row.quantity].join('/'),
    value: Number(row.value.toPrecision(6)), unit: row.unit ?? '', what: row.quantity, run, row: row.table, parts: [partOfRun[run]],
    cells: { sequence: row.sequence, method: row.method, setting: row.setting ?? '' },
  }));
}

// Value of a kept figure, for figures that are derived from it.
function valueOfEntries(list) {
  if (list.length === 1 && list[0].key === undefined) return list[0].value;
  return list.length ? Object.fromEntries(list.filter(({ value }) => value !== null).map(({ key, value }) => [key, value])) : NaN;
}

// Figures of the sources, and those of `old` that only parts which are not `measured` have a share in.
export function collect(sources, { old = [], measured = Object.keys(parts) } = {}) {
  const isMeasured = (list) => list.some((part) => measured.includes(part));
  const known = new Map(), out = [];
  for (const figure of catalogue) {
    const isNew = isMeasured(partsOf(figure));
    const kept = isNew ? [] : old.filter((one) => one.id === figure.id || one.of === figure.id);
    const value = isNew ? valueOf(figure, sources, known) : NaN;
    const scaled = (number) => number * (figure.scale ?? 1);
    known.set(figure.id, !isNew ? valueOfEntries(kept) : typeof value === 'number' ? scaled(value) : Object.fromEntries(Object.entries(value).map(([key, number]) => [key, scaled(number)])));
    out.push(...(isNew ? entries(figure, value, spreadOf(figure, sources)) : kept));
  }
  for (const run of kStudies) {
    if (sources[run]) out.push(...otherRows(sources[run], run));
    else if (!measured.includes(partOfRun[run])) out.push(...old.filter((figure) => figure.cells && figure.run === run));
  }
  return out;
}

export function withBefore(figures, before) {
  const old = new Map(before.figures.map((figure) => [figure.id, figure.value]));
  return figures.map((figure) => (old.has(figure.id) ? { ...figure, before: old.get(figure.id) } : figure));
}

// Describes the runs used; a run of a part that was not measured now keeps its old description.
function describeRuns(sources, used, old, measured) {
  const out = Object.fromEntries(Object.entries(runs).filter(([name]) => used.has(name))
    .map(([name, run]) => [name, measured.includes(partOfRun[name]) ? { ...run } : { ...(old[name] ?? run) }]));
  for (const name of kStudies) {
    if (!out[name] || !sources[name]) continue;
    if (sources[name].isQuick) Object.assign(out[name], { what: `${out[name].what}; the study was a quick run of one motion`, quick: true, command: `${out[name].command} --quick` });
    out[name].device = sources[name].fact('device');
    if (sources[name].generator) out[name].generator = sources[name].generator;
  }
  return out;
}

// Prints one figure per line, so that diffs have one line per changed figure.
export function printed({ parts: records, runs: used, figures }) {
  const lines = figures.map((figure) => `  ${JSON.stringify(figure)}`);
  const block = (value) => JSON.stringify(value, null, 2).replaceAll('\n', '\n ');
  return `{\n "made_by": "node site/measured/collect.mjs",\n "parts": ${block(records)},\n "runs": ${block(used)},\n "figures": [\n${lines.join(',\n')}\n ]\n}\n`;
}

// Prints a part with tables of its own in the same way.
export function printedTables(part, { record, facts, rows }) {
  const lines = rows.map((row) => `  ${JSON.stringify(row)}`);
  return `{\n "made_by": "node site/measured/collect.mjs",\n "parts": ${JSON.stringify({ [part]: record })},\n "facts": ${JSON.stringify(facts)},\n "rows": [\n${lines.join(',\n')}\n ]\n}\n`;
}

function readSources(folder, measured) {
  const of = (part, read) => (measured.includes(part) ? read(join(folder, part)) : undefined);
  const variant = (name) => ({ report: readCharacter(join(folder, 'bench', name, 'character')), score: readScores(join(folder, 'bench', name, 'scores')) });
  return {
    ...Object.fromEntries(kStudies.map((name) => [name, of(name, (path) => readStudy(join(path, 'report')))])),
    character: of('bench', (path) => readCharacter(join(path, 'character'))), bench: of('bench', (path) => path),
    player: of('player', readSizes), variants: of('bench', () => ({ high: variant('high'), crf31: variant('crf31') })) ?? {},
  };
}

const readFigures = (path) => (existsSync(path) ? JSON.parse(readFileSync(path, 'utf8')) : { parts: {}, runs: {}, figures: [] });

function writeFigures(folder, to, measured, { before }) {
  const path = join(to, 'figures.json'), old = readFigures(path), sources = readSources(folder, measured);
  const collected = collect(sources, { old: old.figures, measured });
  const isNew = ({ parts: list }) => list.some((part) => measured.includes(part));
  const compared = withBefore(collected, before ? readFigures(before) : old);
  const list = compared.map((figure, i) => (before || isNew(figure) ? figure : collected[i]));
  const records = { ...old.parts, ...Object.fromEntries(measured.map((part) => [part, readRecord(join(folder, part))])) };
  writeFileSync(path, printed({ parts: records, runs: describeRuns(sources, new Set(list.map((figure) => figure.run)), old.runs, measured), figures: list }));
  console.log(`${list.length} figures in ${path}, new ones of ${measured.join(', ')}`);
}

const text = { type: 'string' };
const kOptions = { from: text, before: text, to: text };
const kUsage = 'usage: node site/measured/collect.mjs --from DIR [--before FILE] [--to FOLDER] PART…';

function main() {
  const { values, positionals } = parseArgs({ options: kOptions, allowPositionals: true });
  if (!values.from || !positionals.length) throw new SourceError(kUsage);
  const unknown = positionals.find((part) => !parts[part]);
  if (unknown) throw new SourceError(`no part is named "${unknown}"; the parts are ${Object.keys(parts).join(', ')}`);
  const to = values.to ?? fileURLToPath(new URL('.', import.meta.url));
  const ofFigures = positionals.filter((part) => parts[part].runs.length);
  if (ofFigures.length) writeFigures(values.from, to, ofFigures, { before: values.before });
  for (const part of positionals.filter((one) => !parts[one].runs.length)) {
    const path = join(to, `${part}.json`), folder = join(values.from, part);
    writeFileSync(path, printedTables(part, { record: readRecord(folder), ...readTables(folder) }));
    console.log(`tables of ${part} in ${path}`);
  }
  console.log('now: node site/measured/fill.mjs');
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  try {
    main();
  } catch (error) {
    if (!(error instanceof SourceError) && !String(error.code).startsWith('ERR_PARSE_ARGS')) throw error;
    console.error(`collect: ${error.message}`);
    process.exit(1);
  }
}
