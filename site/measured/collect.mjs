// SPDX-License-Identifier: Apache-2.0
// node site/measured/collect.mjs --study REPORT --character CHARACTER [options]: writes site/measured/figures.json, the
// figures that README and the site show, from what the runs wrote. Nothing in it is typed by hand; a figure whose run is
// not given is left out, and the pages say "not measured in this run".
//   --study REPORT        of fourdvt evaluate CAPTURE -o REPORT
//   --truth REPORT        the same of the virtual studio's capture
//   --character FOLDER    a baked character: its report.json
//   --variant NAME=DIR    DIR/character and DIR/scores (fourdvt evaluate CAPTURE --character …), NAME: high or crf31
//   --player DIST         the built web package
//   --bench DIR           NAME.txt: what the bench of that name printed
//   --before FILE         an earlier figures.json, so that the page lists what got worse
//   --out FILE            default: site/measured/figures.json
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { figures as catalogue, leftToTheReport, runs } from './catalogue.mjs';
import { SourceError, mean, playerBytes, readBench, readCharacter, readScores, readStudy } from './sources.mjs';

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

// In order of appearance; numbers ascend.
function distinct(values) {
  const out = [...new Set(values)].filter((value) => value !== undefined && value !== '');
  return out.every(isNumeric) ? out.sort((a, b) => a - b) : out;
}

function combine(rows, over) {
  const whole = rows.filter((row) => row.sequence === '');
  return kOver[over ?? 'mean']((whole.length ? whole : rows).map((row) => row.value));
}

// Values with another quantity of the same row divided out or taken off.
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

// What lies outside of the range that was measured has words instead of a value.
function beyondRange(study, table, figure) {
  const { method, setting, beyond } = figure.from;
  if (!beyond) return [];
  return study.select({ table, method, setting, quantity: beyond }).map((row) => [keyOf(row, figure.each), row.value > 0 ? 'above all rates' : 'below all rates']);
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

// Of numbers, or of groups: per key that all of them have.
function derived(operation, parts) {
  if (parts.every((part) => typeof part === 'number')) return operation(...parts);
  if (parts.some((part) => typeof part === 'number')) return NaN;
  const keys = Object.keys(parts[0]).filter((key) => parts.every((part) => Number.isFinite(part[key])));
  return Object.fromEntries(keys.map((key) => [key, operation(...parts.map((part) => part[key]))]));
}

// What a figure is, or NaN where its run was not given.
function valueOf(figure, sources, known) {
  const { from } = figure;
  if (from.study) return sources.study ? fromStudy(sources.study, from.study, figure) : NaN;
  if (from.truth) return sources.truth ? fromStudy(sources.truth, from.truth, figure) : NaN;
  if (from.curve) return sources.study ? fromCurve(sources.study, from) : NaN;
  if (from.character) return sources.character ? fromReport(sources.character, from.character, figure) : NaN;
  if (from.variant) return sources.variants[from.variant] ? fromReport(sources.variants[from.variant].report, from.take, figure) : NaN;
  if (from.scores) return sources.variants[from.scores]?.score(from.quantity) ?? NaN;
  if (from.bench) return sources.bench ? fromBench(sources.bench, from) : NaN;
  if (from.player) return sources.player ? playerBytes(sources.player) : NaN;
  const [kind] = Object.keys(kDerived).filter((name) => from[name]);
  return derived(kDerived[kind], from[kind].map((id) => known.get(id) ?? NaN));
}

// Where a reader finds it again.
function origin({ from }) {
  const name = ['study', 'truth'].find((key) => from[key]);
  if (name) {
    const words = [from[name], from.method, from.setting, from.quantity, from.against && `/ ${from.against}`, from.less && `− ${from.less}`, from.over];
    return { run: name, row: words.filter(Boolean).join(', ') };
  }
  if (from.curve) return { run: 'study', row: ['rate', from.method, from.setting, from.curve, from.minus && `− ${from.minus}`].filter(Boolean).join(', ') };
  if (from.character) return { run: 'character', row: 'report.json' };
  if (from.variant) return { run: from.variant, row: 'character/report.json' };
  if (from.scores) return { run: from.scores, row: `scores/evaluate.csv, held-out, ${from.quantity}` };
  if (from.bench) return { run: from.bench, row: `${from.bench}.txt, ${from.match}` };
  if (from.player) return { run: 'player', row: 'fourdvt-viewer.js, fourdvt-viewer.wasm' };
  const [kind, ids] = Object.entries(from)[0];
  return { run: 'figures', row: `${kind} of ${ids.join(', ')}` };
}

// A hundredth of what is shown is kept.
function kept(value, digits) {
  return Number(value.toFixed(digits + 2));
}

function entries(figure, value) {
  const base = { unit: figure.unit, digits: figure.digits, what: figure.what, ...origin(figure), ...(figure.better && { better: figure.better }) };
  const make = (id, number, key) => ({ id, value: kept(number * (figure.scale ?? 1), figure.digits), ...(key !== undefined && { of: figure.id, key }), ...base });
  if (typeof value === 'number') return Number.isFinite(value) ? [make(figure.id, value)] : [];
  return Object.entries(value).map(([key, number]) => {
    const id = `${figure.id}.${key.replaceAll(' ', '_')}`;
    return typeof number === 'string' ? { ...make(id, 0, key), value: null, text: number } : make(id, number, key);
  });
}

// Whether a figure takes this table and quantity for this method, be it as a partner of another quantity.
function isTaken(row) {
  return catalogue.some(({ from }) => (from.study ?? from.truth) === row.table && (from.method === undefined || from.method === row.method) &&
    [from.quantity, from.against, from.less, from.beyond].includes(row.quantity));
}

function isLeft(row) {
  const left = leftToTheReport[row.table];
  return left === '*' || left?.includes(row.quantity);
}

// Rows that nothing in the catalogue shows: kept as they are.
function otherRows(study, run) {
  return study.rows.filter((row) => !isLeft(row) && !isTaken(row)).map((row) => ({
    id: [`${run}:${row.table}`, row.sequence, row.method, (row.setting ?? '').replaceAll(' ', '+'), row.quantity].join('/'),
    value: Number(row.value.toPrecision(6)), unit: row.unit ?? '', what: row.quantity, run, row: row.table,
    cells: { sequence: row.sequence, method: row.method, setting: row.setting ?? '' },
  }));
}

export function collect(sources) {
  const known = new Map(), out = [];
  for (const figure of catalogue) {
    const value = valueOf(figure, sources, known);
    const scaled = (number) => number * (figure.scale ?? 1);
    known.set(figure.id, typeof value === 'number' ? scaled(value) : Object.fromEntries(Object.entries(value).map(([key, number]) => [key, scaled(number)])));
    out.push(...entries(figure, value));
  }
  for (const run of ['study', 'truth']) if (sources[run]) out.push(...otherRows(sources[run], run));
  return out;
}

export function withBefore(figures, before) {
  const old = new Map(before.figures.map((figure) => [figure.id, figure.value]));
  return figures.map((figure) => (old.has(figure.id) ? { ...figure, before: old.get(figure.id) } : figure));
}

function describeRuns(sources, used) {
  const out = Object.fromEntries(Object.entries(runs).filter(([name]) => used.has(name)).map(([name, run]) => [name, { ...run }]));
  for (const name of ['study', 'truth']) {
    if (!out[name] || !sources[name]) continue;
    if (sources[name].isQuick) Object.assign(out[name], { what: `${out[name].what}; the study was a quick run of one motion`, quick: true, command: `${out[name].command} --quick` });
    out[name].device = sources[name].fact('device');
    if (sources[name].generator) out[name].generator = sources[name].generator;
  }
  return out;
}

// One figure a line, so that a change of one is a change of one line.
export function printed({ runs: used, figures }) {
  const lines = figures.map((figure) => `  ${JSON.stringify(figure)}`);
  return `{\n "made_by": "node site/measured/collect.mjs",\n "runs": ${JSON.stringify(used, null, 2).replaceAll('\n', '\n ')},\n "figures": [\n${lines.join(',\n')}\n ]\n}\n`;
}

function readSources(values) {
  const variants = Object.fromEntries((values.variant ?? []).map((text) => {
    const [name, folder] = text.split(/=(.*)/s);
    if (!runs[name] || !folder) throw new SourceError(`--variant ${text}: give NAME=FOLDER with a name of site/measured/catalogue.mjs, e.g. high=build/measured/high`);
    return [name, { report: readCharacter(join(folder, 'character')), score: readScores(join(folder, 'scores')) }];
  }));
  return {
    study: values.study && readStudy(values.study), truth: values.truth && readStudy(values.truth),
    character: values.character && readCharacter(values.character), bench: values.bench, player: values.player, variants,
  };
}

const text = { type: 'string' };
const kOptions = { study: text, truth: text, character: text, variant: { type: 'string', multiple: true }, player: text, bench: text, before: text, out: text };

function main() {
  const { values } = parseArgs({ options: kOptions });
  if (!values.study || !values.character) throw new SourceError('usage: node site/measured/collect.mjs --study REPORT --character CHARACTER [--truth REPORT] [--variant NAME=DIR] [--player DIST] [--bench DIR] [--before FILE] [--out FILE]');
  const sources = readSources(values);
  let figures = collect(sources);
  if (values.before) figures = withBefore(figures, JSON.parse(readFileSync(values.before, 'utf8')));
  const out = values.out ?? new URL('figures.json', import.meta.url).pathname;
  writeFileSync(out, printed({ runs: describeRuns(sources, new Set(figures.map((figure) => figure.run))), figures }));
  console.log(`${figures.length} figures in ${out}; now: node site/measured/fill.mjs`);
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
