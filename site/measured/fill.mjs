// SPDX-License-Identifier: Apache-2.0
// node site/measured/fill.mjs [--check]: writes site/measured/index.html from figures.json, cameras.md, hulls.md and
// methods.md from the tables beside them, and the figures of README.md, site/docs/measured.md and site/index.html between
// their markers:
//   <!-- figure:ID -->22.32 dB<!-- /figure -->        one figure of catalogue.mjs, or one per motion
//   <!-- figures:headlines --> … <!-- /figures -->    the headline rows of the catalogue as a Markdown table
//   <!-- figures:summary --> … <!-- /figures -->      the rows of summary.mjs as a Markdown table
//   <!-- figures:stale --> … <!-- /figures -->        the meaning of the mark of stale figures, where there are any
// A figure of a part whose inputs have changed since it was measured (parts.mjs) is marked.
// --check writes nothing and exits with 1 if one of these files would change, or if one of kChecked holds a number with a
// unit outside of the markers.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { sections } from './catalogue.mjs';
import { documentParts, makeDocument } from './documents.mjs';
import { makePage } from './page.mjs';
import { staleParts } from './parts.mjs';
import { Shown, kNotMeasured, kStaleNote } from './shown.mjs';
import { summary } from './summary.mjs';

const kFilled = ['README.md', 'site/docs/measured.md', 'site/index.html'];
const kChecked = [...kFilled, 'site/docs/README.md', 'site/steer.html'];

// Numbers with a unit that are allowed outside of the markers: not measured, each with a reason.
export const allowedNumbers = [
  { file: 'site/index.html', text: '100 %', reason: 'the slider of a look where it begins' },
  { file: 'site/index.html', text: '0.00 s', reason: 'the clock of the player before it plays' },
];

const kFigure = /<!-- figure:(\S+) -->[\s\S]*?<!-- \/figure -->/g;
const kBlock = /<!-- figures:(\S+) -->[\s\S]*?<!-- \/figures -->/g;

function goalText(shown, { goal, run }) {
  if (!goal) return '';
  const met = shown.met(goal);
  return goal.text + (met === null ? '' : (met ? ': met' : ': **missed**') + shown.scope(run));
}

const staleNote = (shown) => (shown.stale.size ? ` ${kStaleNote}` : '');

// Makes the Markdown table of the headline rows; values keep plain spaces.
function headlines(shown) {
  const sample = shown.fill('{sample.cameras} cameras, {sample.frames} frames, {sample.faces} faces; {sample.layers} layers, the first of {sample.texture} a side, CRF {sample.crf}') ?? kNotMeasured;
  const caption = `Measured on ${shown.runs.study?.what ?? 'the sample capture'} (${sample}). Several values in one cell are those of its motions.${staleNote(shown)}`;
  const rows = sections.flatMap((section) => section.rows ?? []).filter((row) => row.headline);
  const lines = rows.map((row) => `| ${shown.fill(row.what) ?? row.what} | ${shown.fill(row.measured) ?? kNotMeasured} | ${goalText(shown, row)} |`);
  return [caption, '', '| what | measured | goal |', '|---|---|---|', ...lines].join('\n').replaceAll('\u00a0', ' ');
}

// Makes README's Markdown table from the rows of summary.mjs.
function summaryTable(shown) {
  const rows = summary.filter(({ ours }) => shown.fill(ours) !== null).map(({ what, ours, other }) => `| ${what} | ${shown.fill(ours)} | ${shown.fill(other) ?? kNotMeasured} |`);
  return ['| | fourdvt | compared with |', '|---|---|---|', ...rows, ...(shown.stale.size ? ['', kStaleNote] : [])].join('\n').replaceAll('\u00a0', ' ');
}

export function fillText(text, shown, path) {
  const html = path.endsWith('.html');
  const blocks = { headlines: () => headlines(shown), summary: () => summaryTable(shown), stale: () => staleNote(shown).trim() };
  return text.replace(kBlock, (_, name) => {
    if (!blocks[name]) throw new Error(`${path}: no block is named ${name}`);
    return `<!-- figures:${name} -->\n${blocks[name]()}\n<!-- /figures -->`;
  }).replace(kFigure, (_, id) => {
    const value = shown.text(id) ?? kNotMeasured;
    return `<!-- figure:${id} -->${html ? value.replaceAll('\u00a0', '&nbsp;') : value.replaceAll('\u00a0', ' ')}<!-- /figure -->`;
  });
}

const kUnit = String.raw`(?:dB|[kMG]i?B|[kMG]?bit\/s|ms|s|fps|mm|px|%|percent|×|seconds?|minutes?|hours?|times)`;
const kNumber = String.raw`(?:\d[\d,]*(?:\.\d+)?|\.\d+|two|three|four|five|six|seven|eight|nine|ten|twelve|twenty)`;
const kPatterns = [
  new RegExp(String.raw`(?<![\w.])${kNumber}(?:\s|&nbsp;)*${kUnit}(?![\w²/])`, 'g'),  // 22.3 dB, eight times
  /×(?:\s|&nbsp;)*\d[\d.]*/g,                                                         // × 7.9
  /(?<![\w.])[01]?\.\d{2,4}(?![\w.])/g,                                               // SSIM: .749
];

// Returns the visible text: without code, drawings and tags, with the texts of alt, title, content and aria-label.
function visible(text, path) {
  const marked = text.replace(kBlock, ' ').replace(kFigure, ' ');
  if (!path.endsWith('.html')) return marked.replace(/```[\s\S]*?```/g, ' ');
  return marked.replace(/<(script|style|svg|pre)\b[\s\S]*?<\/\1>/g, ' ').replace(/<!--[\s\S]*?-->/g, ' ')
    .replace(/<meta name="viewport"[^>]*>/g, ' ')
    .replace(/<[^>]*>/g, (tag) => [...tag.matchAll(/\b(?:alt|title|content|aria-label)="([^"]*)"/g)].map((m) => m[1]).join(' ') || ' ');
}

// Returns one message per number with a unit outside of the markers.
export function unmarked(text, path, allowed = allowedNumbers) {
  let seen = visible(text, path);
  for (const { file, text: constant } of allowed) if (file === path) seen = seen.replaceAll(constant, ' ');
  const found = new Set(kPatterns.flatMap((pattern) => [...seen.matchAll(pattern)].map((m) => m[0].replace(/\s+/g, ' '))));
  return [...found].map((number) => `${path}: "${number}" is typed by hand; mark it as a figure of site/measured/catalogue.mjs, or list it in fill.mjs with a reason`);
}

function outputs(root, data, stale) {
  const shown = new Shown({ ...data, stale });
  const tables = documentParts.map((part) => [part, JSON.parse(readFileSync(join(root, `site/measured/${part}.json`), 'utf8'))]);
  const documents = tables.map(([part, own]) => [`site/measured/${part}.md`, makeDocument(part, own, stale.includes(part))]);
  const records = { ...data.parts, ...Object.assign({}, ...tables.map(([, own]) => own.parts)) };
  const filled = kFilled.map((path) => [path, fillText(readFileSync(join(root, path), 'utf8'), shown, path)]);
  return [...filled, ...documents, ['site/measured/index.html', makePage(shown, records)]];
}

// Returns problems of the tree, as messages; writes outdated files unless `check`. stale: names of the parts whose inputs
// have changed.
export function run(root, check, stale = staleParts(root)) {
  const problems = [];
  const data = JSON.parse(readFileSync(join(root, 'site/measured/figures.json'), 'utf8'));
  for (const [path, text] of outputs(root, data, stale)) {
    let old = '';
    try { old = readFileSync(join(root, path), 'utf8'); } catch { /* made for the first time */ }
    if (old === text) continue;
    if (check) problems.push(`${path} is not what the figures of site/measured say; run: node site/measured/fill.mjs`);
    else writeFileSync(join(root, path), text);
  }
  for (const path of kChecked) problems.push(...unmarked(readFileSync(join(root, path), 'utf8'), path));
  return problems;
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [option, ...rest] = process.argv.slice(2);
  if (rest.length || (option && option !== '--check')) {
    console.error('usage: node site/measured/fill.mjs [--check]');
    process.exit(2);
  }
  const problems = run(fileURLToPath(new URL('../..', import.meta.url)), option === '--check');
  for (const problem of problems) console.error(problem);
  if (!problems.length) console.log(option ? 'every figure is the one of site/measured' : `filled ${kFilled.join(', ')}, site/measured/index.html and the documents beside it`);
  process.exit(problems.length ? 1 : 0);
}
