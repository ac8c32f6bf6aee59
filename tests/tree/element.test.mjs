// SPDX-License-Identifier: Apache-2.0
// Every attribute, property, method, event, slot and part of <fourdvt-viewer> is named in web/README.md and in a browser or unit test.
//   node tests/tree/element.test.mjs --table    prints which tests name each
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../../', import.meta.url));
const read = (path) => readFileSync(join(root, path), 'utf8');
const features = readdirSync(join(root, 'web/src/element')).map((name) => [name, read(`web/src/element/${name}`)]);
const tests = readdirSync(join(root, 'tests/web')).filter((name) => /\.(test|scenes)?\.?mjs$/.test(name)).map((name) => [name, read(`tests/web/${name}`)]);
const readme = read('web/README.md');

// Rows of the table of attributes.
const table = [...read('web/src/element/properties.ts').matchAll(/^ {2}'?([a-z-]+)'?: \{(.*)\},$/gm)].map(([, name, row]) => ({ name, property: /property: '(\w+)'/.exec(row)?.[1] }));
const attributes = () => table.map(({ name }) => name).sort();
// Members of the element's class, and the properties that reflect attributes.
function members() {
  const text = read('web/src/element/viewer-element.ts');
  const own = [...text.matchAll(/^ {2}(?:readonly |get |set |async )?([a-z]\w*)[(?]/gm)].map(([, name]) => name).filter((name) => !/^constructor$|Callback$/.test(name) || /VideoFrameCallback$/.test(name));
  return [...new Set([...own, ...table.flatMap(({ property }) => property ?? [])])].sort();
}
// Names of attributes that the code reads, as they stand in quotes.
function readAttributes() {
  const elsewhere = ['more/look', 'player/method-attributes', 'page/quality-attribute', 'controls/motion-controls', 'controls/steering', 'controls/controls', 'controls/extras', 'more/advice'];
  const sources = [...features.map(([, text]) => text), ...elsewhere.map((name) => read(`web/src/${name}.ts`))];
  const names = sources.flatMap((text) => [...text.matchAll(/(?:(?:hasAttribute|getAttribute|toggleAttribute|setAttribute)\(|(?:isOn|valueOf)\([\w.#]+, )'([a-z-]+)'/g)].map(([, name]) => name));
  return [...new Set(names)].filter((name) => !/^(part|viewBox|d|tabindex|aria-.*|style|role|position|heading|list|draggable)$/.test(name)).sort();
}
function events() {
  const sources = [...features.map(([, text]) => text), read('web/src/more/media-times.ts'), read('web/src/live/live.ts'), read('web/src/session/actor.ts')];
  const native = [...read('native/player/parts/messages.cpp').matchAll(/return "([a-z]+)"/g)].map(([, name]) => name);
  const own = sources.flatMap((text) => [...text.matchAll(/(?:\.emit|\.report|#report)\('([a-z-]+)'/g)].map(([, name]) => name));
  return [...new Set([...native, ...own])].filter((name) => name !== 'warning').sort();
}
const slots = () => ['poster', 'progress-bar', 'controls', 'prompt', 'hotspot-1'];

// A word that stands by itself, not as a part of a longer name.
const names = (text, word) => new RegExp(`(?<![\\w-])${word}(?![\\w-])`).test(text);
const covered = { attribute: attributes(), 'property or method': members(), event: events(), slot: slots() };
const rows = Object.entries(covered).flatMap(([kind, list]) => list.map((name) => ({ kind, name, by: tests.filter(([, text]) => names(text, name)).map(([file]) => file.replace('.mjs', '')) })));

if (process.argv.includes('--table')) {
  console.log('| kind | name | tests |\n|---|---|---|');
  for (const { kind, name, by } of rows) console.log(`| ${kind} | \`${name}\` | ${by.join(', ')} |`);
} else {
  test('the lists are read from the sources', () => {
    assert.ok(covered.attribute.includes('camera-controls') && covered.attribute.length > 30, covered.attribute.join());
    assert.ok(covered['property or method'].includes('requestVideoFrameCallback') && covered['property or method'].length > 50, covered['property or method'].join());
    assert.ok(covered.event.includes('durationchange') && covered.event.includes('sequencechange') && covered.event.length > 20, covered.event.join());
  });
  test('the table has every attribute that the code reads, and is the one of web/README.md', () => {
    assert.deepEqual(readAttributes().filter((name) => !attributes().includes(name)), []);
    const [, rows] = /^## Attributes\n([^]*?)\n\n[^|\n]/m.exec(readme);
    const documented = [...rows.matchAll(/^\| ((?:`[a-z-]+`(?:, )?)+) \|/gm)].flatMap(([, cell]) => [...cell.matchAll(/`([a-z-]+)`/g)].map(([, name]) => name));
    assert.deepEqual(documented.filter((name) => !attributes().includes(name)), []);
    assert.deepEqual(documented.filter((name, i) => documented.indexOf(name) !== i), []);
  });
  for (const kind of Object.keys(covered)) {
    test(`a test names every ${kind}`, () => { assert.deepEqual(rows.filter((row) => row.kind === kind && !row.by.length).map(({ name }) => name), []); });
    test(`web/README.md names every ${kind}`, () => { assert.deepEqual(covered[kind].filter((name) => !names(readme, name)), []); });
  }
}
