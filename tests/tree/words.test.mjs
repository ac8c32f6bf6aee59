// SPDX-License-Identifier: Apache-2.0
// Words of comments and names in native/, web/src/, wasm/, shaders/ and the scripts of the site: counts what the section
// Style of .github/CONTRIBUTING.md rules out. A count above its ceiling fails; each run prints all counts.
// FOURDVT_WORDS=NAME lists a row's places.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { extname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

// Ceilings are today's counts: lower them with the counts, never raise them.
const kCeilings = {
  openings: 0, // comments that open with Of, What, Whether, As, Where, When, If, How, Which
  trailing: 16, // comments behind code that open with one of these words in lower case
  not: 0, // "Does NOT"
  limits: 0, // kMost…, kLeast…, kFewest…, by file: min and max are the words
  machines: 3, // tell, ask, know, want, say of anything but people and papers
  private: 0, // star, household, serves, claims
  households: 0, // Wishes, Seat, Claim, Grant, Performer, Ledger in names of web/src, by file
};

const kOpening = /^(Of|What|Whether|As|Where|When|If|How|Which)\b/;
const kSaying = /(?<before>(?:[\w’']+ ){0,2})\b(?<verb>tells?|told|tell|asks?|asked|knows?|knew|wants?|says?|said)\b/gi;
const kPeople = /\b(people|person|visitors?|users?|authors?|papers?|you|one|nobody|who|everyone|[A-Z]+\d{2}|4DVT|LVDT|FT|M4D)( \w+)? $/i;
const kPrivate = /\b(stars?|households?|serves|claims)\b/gi;
const kLimits = /\bk(?:Most|Least|Fewest)(?=[A-Z_\d])\w*/g;
const kHouseholds = /\b(?:\w*[a-z_#])?(?:Wish|Wishes|Seats?|Claims?|Claimed|Grants?|Granted|Performers?|Ledger)(?![a-z])\w*|\b(?:wish|wishes|seats?|claims?|claimed|grants?|granted|performers?|ledger)(?![a-z])\w*/g;

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kKinds = new Set(['.h', '.cpp', '.inc', '.ts', '.js', '.frag', '.vert', '.glsl']);

/** Paths of all sources below a folder. */
function sourcesOf(folder, deep = true) {
  return readdirSync(join(kRoot, folder), { withFileTypes: true }).flatMap((entry) => {
    const path = `${folder}/${entry.name}`;
    if (entry.isDirectory()) return deep && !/^(generated|node_modules|dist)$/.test(entry.name) ? sourcesOf(path) : [];
    return kKinds.has(extname(path)) ? [path] : [];
  });
}

/** A file's comments, each { text, line, trailing }, and its code without them and without strings. */
export function readSource(text) {
  const comments = [], code = [];
  let open = null, block = false;
  text.split('\n').forEach((line, i) => {
    const bare = line.replace(/"(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*'/g, (literal) => '_'.repeat(literal.length));
    const at = block ? 0 : bare.search(/\/\/|\/\*/);
    if (at < 0) {
      code.push(bare);
      open = null;
      return;
    }
    const before = bare.slice(0, at);
    const words = line.slice(at).replace(/^\s*(\/\/+|\/\*+|\*(?!\/))?\s?/, '').replace(/\s*\*\/.*$/, '').trim();
    block = block ? !line.includes('*/') : bare.startsWith('/*', at) && !line.includes('*/', at);
    code.push(before);
    if (open && !before.trim() && (!open.trailing || open.column === at)) {
      open.text += ` ${words}`;
      return;
    }
    comments.push((open = { text: words, line: i + 1, trailing: before.trim() !== '', column: at }));
  });
  return { comments: comments.filter((comment) => !comment.text.startsWith('SPDX')).concat(firstPages(comments)), code };
}

// Text after a licence line in the same comment.
function firstPages(comments) {
  const found = comments.find((comment) => comment.text.startsWith('SPDX'));
  const text = found?.text.replace(/^SPDX-License-Identifier: \S+\s*/, '');
  return text ? [{ ...found, text, line: found.line + 1 }] : [];
}

/** Places { name: ["path:line: words"] } of every row. */
export function placesOf(files) {
  const out = Object.fromEntries(Object.keys(kCeilings).map((name) => [name, []]));
  for (const [path, text] of files) {
    const { comments, code } = readSource(text);
    for (const comment of comments) {
      const add = (name, words) => out[name].push(`${path}:${comment.line}: ${words}`);
      if (kOpening.test(comment.text)) add('openings', comment.text.slice(0, 60));
      const first = comment.text.replace(/^\w/, (letter) => letter.toUpperCase());
      if (comment.trailing && first !== comment.text && kOpening.test(first)) add('trailing', comment.text.slice(0, 60));
      for (const match of comment.text.matchAll(/\b[Dd](?:oes|o) NOT\b/g)) add('not', match[0]);
      for (const { groups: { before, verb } } of comment.text.matchAll(kSaying)) if (!kPeople.test(before)) add('machines', before + verb);
      for (const [word] of comment.text.matchAll(kPrivate)) add('private', word);
    }
    const names = (pattern) => new Set(code.join('\n').match(pattern) ?? []);
    for (const name of names(kLimits)) out.limits.push(`${path}: ${name}`);
    if (path.startsWith('web/src/')) for (const name of names(kHouseholds)) out.households.push(`${path}: ${name}`);
  }
  return out;
}

test('comments are read as people read them', () => {
  const source = '// SPDX-License-Identifier: X\n// Of a file\nint a; // of it\nconst b = "// What"; /* Whether\n it tells */\nkMostOf(x);\n// The paper says so. Does NOT\n';
  const places = placesOf(new Map([['native/a.h', source]]));
  const counts = Object.fromEntries(Object.entries(places).map(([name, list]) => [name, list.length]));
  assert.deepEqual(counts, { openings: 2, trailing: 1, not: 1, limits: 1, machines: 1, private: 0, households: 0 });
  const household = placesOf(new Map([['web/src/a.ts', 'interface Wishes {}\nthis.#seat = grantsOf(performer); // a wish\n']]));
  assert.deepEqual(household.households.map((place) => place.split(': ')[1]), ['Wishes', 'seat', 'grantsOf', 'performer']);
});

test('no row of words is above its ceiling', () => {
  const paths = [...['native', 'web/src', 'wasm', 'shaders'].flatMap((folder) => sourcesOf(folder)), ...sourcesOf('site', false)];
  assert.ok(paths.length > 500, `${paths.length} sources`);
  const places = placesOf(new Map(paths.map((path) => [path, readFileSync(join(kRoot, path), 'utf8')])));
  for (const [name, list] of Object.entries(places)) console.log(`${name}: ${list.length} of ${kCeilings[name]}`);
  if (places[process.env.FOURDVT_WORDS]) console.log(places[process.env.FOURDVT_WORDS].join('\n'));
  const above = Object.entries(places).filter(([name, list]) => list.length > kCeilings[name]);
  assert.deepEqual(above.map(([name, list]) => `${name}: ${list.length}, at most ${kCeilings[name]}`), [], 'list the places: FOURDVT_WORDS=NAME node --test tests/tree/words.test.mjs');
});
