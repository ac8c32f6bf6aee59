// SPDX-License-Identifier: Apache-2.0
// Makes the text of site/measured/index.html, the page of all figures.
import { constants, sections } from './catalogue.mjs';
import { partOfRun, parts } from './parts.mjs';
import { fixed, kNotMeasured, kStale, kStaleNote } from './shown.mjs';
import { inYardsticks, machineText } from './yardstick.mjs';

const escaped = (text) => String(text).replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;').replaceAll('"', '&quot;').replaceAll('\u00a0', '&nbsp;');
const cells = (tag, list) => list.map((cell, i) => `<${i ? tag : 'th'}${i ? '' : tag === 'td' ? ' scope="row"' : ''}>${cell}</${i ? tag : 'th'}>`).join('');
const table = (title, columns, rows) => `<div class="scroll" tabindex="0" role="region" aria-label="Table: ${escaped(title)}"><table>
<thead><tr>${cells('th', columns.map(escaped)).replace('<th></th>', '<td></td>')}</tr></thead>
<tbody>
${rows.map((row) => `<tr>${row}</tr>`).join('\n')}
</tbody></table></div>`;

const slug = (title) => title.toLowerCase().replace(/[^a-z0-9]+/g, '-');

// Makes a table; leaves out columns without figures, and marks rows without figures.
function matrix(shown, { title, columns, matrix: rows }) {
  const filled = rows.map(([what, ...values]) => [what, ...values.map((value) => shown.fill(value))]);
  const used = columns.map((_, i) => i === 0 || filled.some((row) => row[i] !== null));
  const shownColumns = columns.filter((_, i) => used[i]);
  if (shownColumns.length === 1) return `<p>${kNotMeasured}</p>`;
  return table(title, shownColumns, filled.map((row) => {
    const values = row.filter((_, i) => used[i]);
    if (values.slice(1).every((value) => value === null)) return `${cells('td', [escaped(values[0])])}<td colspan="${values.length - 1}">${kNotMeasured}</td>`;
    return cells('td', values.map((value) => escaped(value ?? '–')));
  }));
}

function verdict(shown, { goal, run }) {
  const met = goal ? shown.met(goal) : null;
  return met === null ? '' : (met ? 'met' : '<strong>missed</strong>') + shown.scope(run);
}

function goalRows(shown, { title, rows }, runs) {
  return table(title, ['what', 'measured', 'goal', 'is it met', 'run'], rows.map((row) => {
    const measured = shown.fill(row.measured);
    const run = runs[row.run] ? `<a href="#run-${row.run}">${row.run}</a>` : '';
    return cells('td', [escaped(shown.fill(row.what) ?? row.what), escaped(measured ?? kNotMeasured), escaped(row.goal?.text ?? ''), verdict(shown, row), run]);
  }));
}

function section(shown, data, runs) {
  const absent = data.matrix?.flat().every((cell) => !cell.includes('{') || shown.fill(cell) === null);
  const text = data.text && !absent ? `<p>${escaped((shown.fill(data.text) ?? data.text).replace(/\s+/g, ' '))}</p>\n` : '';
  const run = data.run && runs[data.run] ? `<p class="run">Run: <a href="#run-${data.run}">${data.run}</a></p>\n` : '';
  const body = data.matrix ? matrix(shown, data) : goalRows(shown, data, runs);
  return `<section aria-labelledby="${slug(data.title)}">\n<h2 id="${slug(data.title)}">${escaped(data.title)}</h2>\n${text}${run}${body}\n</section>`;
}

// Makes the table of the headline rows, which README has, too.
function overview(shown, runs) {
  const rows = sections.flatMap((part) => part.rows ?? []).filter(({ headline }) => headline);
  const lines = rows.map((row) => cells('td', [escaped(shown.fill(row.what) ?? row.what), escaped(shown.fill(row.measured) ?? kNotMeasured),
    runs[row.run] ? `<a href="#run-${row.run}">${row.run}</a>` : '']));
  const misses = missed(shown) ? ' <a href="#missed">Goals that are missed</a> stand after the comparisons.' : '';
  return `<section aria-labelledby="measured">\n<h2 id="measured">What was measured</h2>\n<p>The sample’s character as it streams: quality at cameras that no method uses, storage, speed, and motions between recordings. FVVR renders from all camera videos at once.${misses}</p>\n${table('What was measured', ['what', 'measured', 'run'], lines)}\n</section>`;
}

function missed(shown) {
  const rows = sections.flatMap((part) => part.rows ?? []).filter(({ goal }) => goal && shown.met(goal) === false);
  if (!rows.length) return '';
  const items = rows.map((row) => `<li>${escaped(shown.fill(row.what) ?? row.what)}: ${escaped(shown.fill(row.measured))}; the goal is ${escaped(row.goal.text)}</li>`);
  return `<section aria-labelledby="missed">\n<h2 id="missed">Goals that are missed</h2>\n<ul>\n${items.join('\n')}\n</ul>\n</section>`;
}

function worse(shown) {
  const list = shown.worse();
  if (!list.length) return '';
  const unit = (figure, value) => escaped(fixed(value, figure.digits) + (figure.unit ? `\u00a0${figure.unit}` : ''));
  const rows = list.map((figure) => cells('td', [escaped(figure.what + (figure.key ? `, ${figure.key}` : '')), unit(figure, figure.before), unit(figure, figure.value) + escaped(shown.ratio([figure]))]));
  return `<section aria-labelledby="worse">\n<h2 id="worse">What got worse since the version before</h2>\n<p>Times differ between two runs of one version, too.</p>\n${table('What got worse', ['what', 'before', 'now'], rows)}\n</section>`;
}

// Makes a study's table that no section shows: a row per sequence, method and setting, a column per quantity.
function otherTable(shown, name, list) {
  const quantities = [...new Set(list.map((figure) => figure.what))], rows = new Map();
  for (const figure of list) {
    const key = Object.values(figure.cells).join('|');
    if (!rows.has(key)) rows.set(key, { cells: figure.cells, values: {} });
    rows.get(key).values[figure.what] = `${figure.value}${figure.unit ? `\u00a0${figure.unit}` : ''}${shown.ratio([figure])}${shown.isStale([figure]) ? kStale : ''}`;
  }
  const lines = [...rows.values()].map((row) => cells('td', [...Object.values(row.cells), ...quantities.map((q) => row.values[q] ?? '–')].map(escaped)));
  return `<h3>${escaped(name)}</h3>\n${table(name, ['motion', 'method', 'setting', ...quantities], lines)}`;
}

function others(shown) {
  const list = shown.figures.filter((figure) => figure.cells);
  if (!list.length) return '';
  const names = [...new Set(list.map((figure) => `${figure.run}: ${figure.row}`))];
  const tables = names.map((name) => otherTable(shown, name, list.filter((figure) => `${figure.run}: ${figure.row}` === name)));
  return `<section aria-labelledby="rows">\n<h2 id="rows">Further tables of the studies</h2>\n${tables.join('\n')}\n</section>`;
}

function constantsTable() {
  const rows = constants.map((row) => cells('td', row.map(escaped)));
  return `<section aria-labelledby="constants">\n<h2 id="constants">What the constants were chosen on</h2>\n<p>The values of a motion that constants were chosen on flatter them; those of the other motions do not. All motions are of one performer under one rig: no figure here shows another performer or another rig.</p>\n${table('Constants', ['constants', 'file', 'chosen on', 'by'], rows)}\n</section>`;
}

const took = ({ minutes, yardstick }) => (minutes === undefined ? '–' : `${fixed(minutes, 1)}\u00a0min${inYardsticks([minutes], 'min', yardstick)}`);

// Makes the table of parts. Commit: HEAD when the measurement began; hash: identifies the inputs in any history.
function partTable(records, stale) {
  const rows = Object.entries(parts).map(([name, { what }]) => {
    const record = records[name];
    const facts = record ? [record.date, `<code>${escaped(record.inputs)}</code>`, `<code>${escaped(record.commit ?? '–')}</code>`, escaped(took(record)), record.yardstick ? escaped(machineText(record.yardstick)) : 'not measured'] : [kNotMeasured, '–', '–', '–', '–'];
    return cells('td', [`<span id="part-${name}">${name}</span>`, escaped(what), record && stale.has(name) ? `${kStale} stale` : '', ...facts]);
  });
  return `<section aria-labelledby="parts">\n<h2 id="parts">When it was measured</h2>\n<p>Figures are measured in parts. A part is measured again when its inputs change: sources, capture, scripts. The hash names those that its figures are of; <code>node site/measured/parts.mjs --hash PART</code> prints today’s.</p>\n${table('Parts', ['part', 'what', 'state', 'date', 'hash of the inputs', 'commit', 'took', 'yardstick'], rows)}\n</section>`;
}

function runList(runs) {
  const items = Object.entries(runs).map(([name, run]) => `<dt id="run-${name}">${name} (part <a href="#part-${partOfRun[name]}">${partOfRun[name]}</a>)</dt>\n<dd>${escaped(run.what)}${[run.device, run.generator].filter(Boolean).map((fact) => `; ${escaped(fact)}`).join('')}<br><code>${escaped(run.command)}</code></dd>`);
  return `<section aria-labelledby="runs">\n<h2 id="runs">How to measure it again</h2>\n<p>What is out of date: <code>bash site/measured/measure.sh</code>; one part: <code>bash site/measured/measure.sh PART</code></p>\n<dl>\n${items.join('\n')}\n</dl>\n</section>`;
}

const meta = (name, content) => `<meta name="${name}" content="${content}">`;
const link = (rel, href) => `<link rel="${rel}" href="${href}">`;
const head = ['<meta charset="utf-8">', meta('viewport', 'width=device-width, initial-scale=1'),
  `<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'self'; img-src data:; base-uri 'none'; form-action 'none'">`,
  meta('color-scheme', 'light dark'),
  meta('description', 'Every figure of fourdvt, measured on the sample capture, with its goal and the command that measures it again.'),
  '<title>fourdvt · measured</title>', link('icon', 'data:,'), link('stylesheet', '../site.css'), link('stylesheet', 'measured.css')].join('\n');

const introduction = (shown) => `<header>
<p><a href="../index.html">fourdvt</a></p>
<h1>Measured</h1>
<p>Every figure of this page, of the README and of the front page comes from one file, <a href="figures.json">figures.json</a>, which is made from what the tool itself wrote. “FG” counts the silhouettes only; ± is the standard error over the views. Several values in one cell are those of the motions. Seconds whose machine was measured carry their ratio to a fixed job, in <a href="../docs/measured.html#yardsticks">yardsticks</a>.${shown.stale.size ? ` ${kStaleNote}` : ''}</p>
</header>`;

// Makes links to the sections, by the ids of their titles.
function contents(body) {
  const links = body.map((text) => text.match(/<h2 id="([^"]+)">(.*?)<\/h2>/)).map(([, id, title]) => `<a href="#${id}">${title}</a>`);
  return `<nav class="contents" aria-label="Sections">\n${links.join('\n')}\n</nav>`;
}

// Makes the page. records: of the parts, by name.
export function makePage(shown, records) {
  const { runs } = shown;
  const body = [overview(shown, runs), ...sections.map((data) => section(shown, data, runs)), missed(shown), worse(shown), constantsTable(), others(shown), partTable(records, shown.stale), runList(runs)].filter(Boolean);
  return `<!doctype html>
<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Made by site/measured/fill.mjs from figures.json: change site/measured/catalogue.mjs or measure again. -->
<html lang="en">
<head>
${head}
</head>
<body>
<main class="measured">
${introduction(shown)}
${contents(body)}
${body.join('\n')}
</main>
</body>
</html>
`;
}
