// SPDX-License-Identifier: Apache-2.0
// node tests/tree/references.mjs ROOT: every reference in the tree's comments and documents must resolve.
// node tests/tree/references.mjs --self-test: a wrong reference of each kind must be refused, a right one accepted.
//
// Kinds: document (a Markdown file or its bare name in capitals), section (its number or its quoted heading), paper (a
// short key, an author with a year, a bare equation), part (a paper's equation, figure, table or section number), file
// (by path, or by a name that only one file has), identifier ("see someName"; in a table's row | what | `file` | `name` |
// a name that the file must contain).
// Papers are the entries of the lists "Sources" in native/algorithms/*.md: - **KEY** where it was published. Cited: parts.
// Code of C++, GLSL, TypeScript and JavaScript is looked at in comments only, except for papers, which messages of the
// study name as well. Does NOT check web addresses, files that a build makes (kMade) and itself: its fixtures are
// wrong.
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, extname, join, normalize } from 'node:path';

const kAlgorithms = 'native/algorithms/';
const kThis = 'tests/tree/references.mjs';
const kFolders = ['native', 'web', 'wasm', 'shaders', 'tests', 'site', '.github'];
const kSkipped = /(^|\/)(node_modules|dist|build|corpus|\.(?!github)[^/]+)(\/|$)/;
const kSlashed = new Set(['.h', '.cpp', '.ts', '.mjs', '.js', '.frag', '.vert', '.glsl', '.css']);
const kHashed = new Set(['.sh', '.cmake', '.txt']);
const kProse = new Set(['.md', '.html']);
const kKinds = ['document', 'section', 'paper', 'part', 'file', 'identifier'];

// Files that a build, a bake or a user makes, and headers of other projects.
const kMade = new RegExp([
  /(^|\/)(build|dist|character|report|OUT|REPORT|FOLDER|CHARACTER)\//, /fourdvt[-\w]*\.js$/, /bench_\w+\.js$/,
  /(^|\/)(report|reconstruct|mattes|calibrate|track)\.html$/, /^(\.\.\/)?docs\/\w+\.html$/, /(^|\/)abi\.(h|ts)$/, /^opencv2\//, /^three\.js$/, /(^|\/)(NAME|[a-z])(\.\w+)?$/,
].map((pattern) => pattern.source).join('|'));
const kMonths = /^(January|February|March|April|May|June|July|August|September|October|November|December|Since|In|Of)$/;
const kKeyShape = /^[A-Z][A-Za-z]*[A-Z][A-Za-z]*([6-9]\d|[01]\d|2[0-6])$/;  // authors' initials and a year: CTGH13
const kNoKey = /^(RG|RGB|UTF|CRC|YUV|NV)/;
const kNumber = String.raw`\d+(?:\.\d+)*`;
const kNumbers = String.raw`(${kNumber}[a-z]?(?:(?:\s*[-–,]\s*|\s+and\s+)${kNumber}[a-z]?(?![\w]))*)`;

// What a reference looks like. A document's name; a file's; a folder's; words in capitals that may be keys of papers;
// "see someName".
const raw = String.raw;
const kDocument = new RegExp(
  raw`((?:[\w.-]+/)*[\w-]+\.md)\b` +
  raw`|(?<![\w./-])(DESIGN|STYLE|TOOLCHAIN|FORMAT|CHANGELOG)(?![\w./-]*\w)`, 'g');
const kFile = new RegExp(
  raw`(?<![\w.*%<>{$/-])((?:\.{1,2}/)?(?:[\w.-]+/)*` +
  raw`(?:[\w-]+(?:\.test)?\.(?:h|cpp|ts|mjs|js|frag|vert|glsl|sh|cmake|html|css)|CMakeLists\.txt))(?![\w*%{}-])`, 'g');
const kFolder = /(?<![\w.\/*-])((?:native|wasm|shaders|site|tests|web)(?:\/[\w-]+)+)\/?(?![\w.*%{-])/g;
const kCapitals = new RegExp(
  raw`(?<![\w./'-])([A-Z][A-Za-z]*[A-Z][A-Za-z]*\d{2}|[A-Z0-9]*[A-Z][A-Z0-9]+)(?: 20\d\d| 19\d\d)?(?!\w)`, 'g');
const kSee = /\b[Ss]ee `?((?:\w+(?:::|\.))?[A-Za-z_]\w*)(?![\w.\/-]*\w)/g;

// ---- Reading -----------------------------------------------------------------------------------------------------

/** path → text of every file that may hold a reference; paths from the root, with slashes. */
function readTree(root) {
  const files = new Map();
  const visit = (folder) => {
    for (const entry of readdirSync(join(root, folder), { withFileTypes: true })) {
      const path = folder === '.' ? entry.name : `${folder}/${entry.name}`;
      if (kSkipped.test(path)) continue;
      if (entry.isDirectory()) {
        if (folder !== '.' || kFolders.includes(entry.name)) visit(path);
      } else {
        files.set(path, isText(path) ? readFileSync(join(root, path), 'utf8') : '');
      }
    }
  };
  visit('.');
  return files;
}

function isText(path) {
  const kind = extname(path);
  return kSlashed.has(kind) || kProse.has(kind) || (kHashed.has(kind) && (kind !== '.txt' || /CMakeLists/.test(path)));
}

/** A line of code, and the comment that it ends with or null. */
function partsOfLine(line, marker) {
  const found = new RegExp(`(?<=^|[\\s;{}(])${marker}(?:\\s|$)`).exec(line);
  return found ? [line.slice(0, found.index), line.slice(found.index + found[0].length)] : [line, null];
}

/**
 * Paragraphs { text, starts } of what people read in a file: prose whole, code its comments, comments of consecutive
 * lines joined. starts: [place in the text, line].
 */
function paragraphsOf(path, text) {
  const kind = extname(path);
  const prose = kProse.has(kind);
  const marker = kHashed.has(kind) ? '#' : '//';
  const out = [];
  let open = null, inBlock = false;
  text.split('\n').forEach((line, i) => {
    let words = null;
    if (prose) {
      words = line.trim() === '' ? null : line;
    } else if (!kHashed.has(kind) && (inBlock || /\/\*/.test(line))) {
      words = line.replace(/^.*?\/\*+/, '').replace(/\*\/.*$/, '').replace(/^\s*\*\s?/, '');
      inBlock = !/\*\//.test(line);
    } else {
      words = partsOfLine(line, marker)[1];
    }
    if (words === null) return (open = null);
    if (!open) return out.push((open = { text: words, starts: [[0, i + 1]] }));
    open.starts.push([open.text.length, i + 1]);
    open.text += ` ${words.trim()}`;
  });
  return out;
}

/** The line that the character `at` of a paragraph stands in. */
function lineAt(paragraph, at) {
  return paragraph.starts.reduce((line, [start, number]) => (start <= at ? number : line), 0);
}

/** Words of the code alone: what "see someName" may mean. */
function identifiersOf(files) {
  const words = new Set();
  for (const [path, text] of files) {
    if (kProse.has(extname(path))) continue;
    const marker = kHashed.has(extname(path)) ? '#' : '//';
    for (const line of text.split('\n')) {
      for (const word of partsOfLine(line, marker)[0].match(/[A-Za-z_]\w*/g) ?? []) words.add(word);
    }
  }
  return words;
}

/** Headings of a document: their text, and the numbers that they begin with. */
function headingsOf(text) {
  const titles = new Set(), numbers = new Set();
  for (const [, title] of text.matchAll(/^#+\s+(.*?)\s*$/gm)) {
    titles.add(title.toLowerCase());
    titles.add(title.replace(new RegExp(`^${kNumber}\\.?\\s+`), '').toLowerCase());
    const number = new RegExp(`^(${kNumber})\\.?\\s`).exec(title);
    if (number) numbers.add(number[1]);
  }
  return { titles, numbers };
}

/** { key, source, parts } of the entries of a document's list "Sources". */
function sourcesOf(text) {
  const start = text.search(/^#+\s+Sources\s*$/m);
  if (start < 0) return [];
  return [...text.slice(start).matchAll(/^- \*\*(\w+)\*\* (.*)$/gm)].map(([, key, entry]) => {
    const [source, parts = ''] = entry.split(' Cited: ');
    return { key, source, parts };
  });
}

/** "1, 3-5" → ["1", "3", "4", "5"]; letters of sub-figures are left out. */
function expanded(list) {
  const out = [];
  for (const piece of list.replace(/\band\b/g, ',').split(',')) {
    const [first, last] = piece.trim().split(/\s*[-–]\s*/).map((number) => number.replace(/[a-z]$/, ''));
    if (/^\d+$/.test(first) && /^\d+$/.test(last)) for (let n = Number(first); n <= Number(last); ++n) out.push(String(n));
    else out.push(first, last ?? '');
  }
  return out.filter((number) => number !== '');
}

/** "Eq. 1–7; sections 2, 4.4; Fig. 5" → has('Eq', '3') */
function partsOf(parts) {
  const known = new Map();
  for (const [, name, list] of parts.matchAll(new RegExp(`(Eq|Fig|Table|section|step)s?\\.?\\s+${kNumbers}`, 'g')))
    known.set(name.toLowerCase(), new Set([...(known.get(name.toLowerCase()) ?? []), ...expanded(list)]));
  return (name, number) => known.get(name)?.has(number) ?? false;
}

// ---- Checking ----------------------------------------------------------------------------------------------------

class Checker {
  constructor(files) {
    this.files = files;
    this.paths = [...files.keys()];
    this.identifiers = identifiersOf(files);
    this.sources = this.paths.filter((path) => path.startsWith(kAlgorithms)).flatMap((path) => sourcesOf(files.get(path)));
    this.byKey = new Map(this.sources.map((row) => [row.key, { ...row, has: partsOf(row.parts) }]));
    this.failures = [];
    this.counts = Object.fromEntries(kKinds.map((kind) => [kind, 0]));
    this.headings = new Map(this.paths.filter((path) => extname(path) === '.md').map((path) => [path, headingsOf(files.get(path))]));
  }

  run() {
    for (const [path, text] of this.files) {
      if (path === kThis) continue;
      for (const paragraph of paragraphsOf(path, text)) this.check(path, paragraph);
      if (kSlashed.has(extname(path))) this.checkMessages(path, text);
      if (extname(path) === '.md') this.checkRows(path, text);
    }
    return this;
  }

  missingKinds() { return kKinds.filter((kind) => this.counts[kind] === 0); }

  /** Prints what is wrong and how many references of each kind there are; true: nothing is wrong. */
  report() {
    const wrong = [...this.failures, ...this.missingKinds().map((kind) => `no reference of the kind "${kind}" was found`)];
    console.log([...wrong, kKinds.map((kind) => `${this.counts[kind]} ${kind}`).join(', ')].join('\n'));
    return wrong.length === 0;
  }

  expect(ok, kind, path, line, message) {
    ++this.counts[kind];
    if (!ok) this.failures.push(`${path}:${line}: ${kind}: ${message}`);
  }

  check(path, paragraph) {
    this.checkDocuments(path, paragraph);
    this.checkFiles(path, paragraph);
    this.checkIdentifiers(path, paragraph);
    if (path.startsWith(kAlgorithms) && /^- \*\*\w+\*\* /.test(paragraph.text)) return;  // the list of sources itself
    this.checkKeys(path, paragraph);
    this.checkAuthors(path, paragraph);
    this.checkBareEquations(path, paragraph);
  }

  // Papers in messages and titles of the study: string literals.
  checkMessages(path, text) {
    text.split('\n').forEach((line, i) => {
      const literals = partsOfLine(line, '//')[0].match(/"(?:[^"\\]|\\.)*"/g);
      if (literals) this.checkKeys(path, { text: literals.join(' ').replace(/"/g, ' '), starts: [[0, i + 1]] });
    });
  }

  // Rows of "Where do I change …?"
  checkRows(path, text) {
    text.split('\n').forEach((line, i) => {
      const row = /^\|[^|]*\| `([^`]+)` \|([^|]*)\|$/.exec(line);
      const code = row && this.files.get(row[1]);
      if (!code) return;
      for (const [, name] of row[2].matchAll(/`(?:\w+::)*(\w+)`/g))
        this.expect(new RegExp(`\\b${name}\\b`).test(code), 'identifier', path, i + 1, `${row[1]} has no ${name}`);
    });
  }

  /** Paths that a mention may mean: as it stands, beside the file, or any whose end it is. */
  resolve(mention, from) {
    const beside = normalize(join(dirname(from), mention)).replace(/\\/g, '/');
    for (const path of [mention, beside, `native/${mention}`])
      if (this.files.has(path)) return [path];
    return this.paths.filter((path) => path === mention || path.endsWith(`/${mention}`));
  }

  // FORMAT 4.1 · algorithms/labels.md, section 4 · FORMAT.md, "Labels"
  checkDocuments(path, paragraph) {
    for (const match of paragraph.text.matchAll(kDocument)) {
      const mention = match[1] ?? `${match[2]}.md`;
      if (kMade.test(mention)) continue;
      const found = this.resolve(mention, path), document = found.length === 1 && found[0];
      const line = lineAt(paragraph, match.index);
      this.expect(document, 'document', path, line, `there is no single document ${mention}`);
      if (document) this.checkSection(document, paragraph.text.slice(match.index + match[0].length), path, line);
    }
  }

  checkSection(document, rest, path, line) {
    const numbered = new RegExp(`^[)\`]?,?\\s+(?:sections?\\s+)?${kNumbers}(?![\\w])`).exec(rest);
    const quoted = /^[)`]?,\s+(?:sections?\s+)?"([^"]+)"/.exec(rest);
    const { titles, numbers } = this.headings.get(document);
    for (const number of numbered ? expanded(numbered[1]) : [])
      this.expect(numbers.has(number), 'section', path, line, `${document} has no section ${number}`);
    if (quoted) this.expect(titles.has(quoted[1].toLowerCase()), 'section', path, line, `${document} has no section "${quoted[1]}"`);
  }

  checkFiles(path, paragraph) {
    for (const { index, 1: mention } of paragraph.text.matchAll(kFile)) {
      if (kMade.test(mention)) continue;
      const found = this.resolve(mention, path);
      const message =
        found.length > 1 ? `${mention} may be any of ${found.slice(0, 3).join(', ')}` : `there is no file ${mention}`;
      this.expect(found.length === 1, 'file', path, lineAt(paragraph, index), message);
    }
    for (const { index, 1: mention } of paragraph.text.matchAll(kFolder)) {
      if (kMade.test(mention)) continue;
      const ends = [`/${mention}/`, `/${mention}.`];
      const ok = this.paths.some((other) => ends.some((end) => `/${other}`.includes(end)));
      this.expect(ok, 'file', path, lineAt(paragraph, index), `there is no ${mention}`);
    }
  }

  checkIdentifiers(path, paragraph) {
    for (const { index, 1: word } of paragraph.text.matchAll(kSee)) {
      const name = word.split(/::|\./).pop();
      const isName = /[a-z][A-Z]|_|^[A-Z][a-z]+[A-Z]/.test(name) || /::/.test(word);
      if (!isName) continue;
      this.expect(this.identifiers.has(name), 'identifier', path, lineAt(paragraph, index), `there is no ${word}`);
    }
  }

  // LVDT Eq. 3-4 · 4DVT 4.1 · 4DVT, section 5 · CTGH13
  checkKeys(path, paragraph) {
    const part = new RegExp(`^[,;]?\\s+(?:(Eq|Fig)\\.|(Table|sections?|step))?\\s*${kNumbers}(?![\\w%°²])`, 'i');
    for (const match of paragraph.text.matchAll(kCapitals)) {
      const key = match[1], known = this.byKey.get(key), rest = paragraph.text.slice(match.index + match[0].length);
      const cited = part.exec(rest);
      const looksLikeKey = kKeyShape.test(key) && !kNoKey.test(key);
      if (!known && !looksLikeKey && !(cited && (cited[1] || cited[2] === 'Table'))) continue;
      const line = lineAt(paragraph, match.index);
      this.expect(known, 'paper', path, line, `${key} is no source of ${kAlgorithms}`);
      if (known && cited) this.checkParts(known, rest, path, line);
    }
  }

  // ", Fig. 5-7, Table 1" and so on behind a key
  checkParts(paper, rest, path, line) {
    const one = new RegExp(`^(?:[,;]|\\s+and)?\\s+(?:(Eq|Fig)s?\\.\\s*|(Table|sections?|step)\\s+)?${kNumbers}(?![\\w%°²])`, 'i');
    let left = rest, first = true;
    for (let match; (match = one.exec(left)); left = left.slice(match[0].length), first = false) {
      const name = (match[1] ?? match[2] ?? 'section').toLowerCase().replace(/^sections$/, 'section');
      if (!first && !match[1] && !match[2]) return;
      for (const number of expanded(match[3])) {
        const message = `the entry of ${paper.key} in ${kAlgorithms} names no ${name} ${number}`;
        this.expect(paper.has(name, number), 'part', path, line, message);
      }
    }
  }

  // Wang et al. 2004 · Boykov and Kolmogorov, "An Experimental …" (2004) · Farnebäck 2003
  checkAuthors(path, paragraph) {
    const surname = String.raw`[A-Z][a-zà-ÿć]+(?:-[A-Z][a-z]+)?`;
    const others = `(?:, ${surname})*(?:,? and ${surname})?|(?: et al\\.)`;
    const title = String.raw`(?:,? (?:"[^"]*"|[A-Z][\w ]*,))?`;
    const year = String.raw`\(?((?:19[5-9]|20[0-2])\d)\b(?![-\d])`;
    const cited = new RegExp(`(?<![\\w.])(${surname})(${others})${title} ${year}`, 'g');
    for (const { index, 1: author, 3: when } of paragraph.text.matchAll(cited)) {
      if (kMonths.test(author)) continue;
      const ok = this.sources.some(({ source }) => source.includes(author) && source.includes(when));
      const message = `${author} ${when} is no source of ${kAlgorithms}`;
      this.expect(ok, 'paper', path, lineAt(paragraph, index), message);
    }
  }

  // An equation needs a paper before it in the same paragraph.
  checkBareEquations(path, paragraph) {
    for (const match of paragraph.text.matchAll(/\bEqs?\.\s*\d/g)) {
      const before = paragraph.text.slice(0, match.index);
      const ok = [...this.byKey.keys()].some((key) => before.includes(key));
      if (/[A-Z0-9]{3,},?\s*$/.test(before)) continue;  // an unknown key: said already
      this.expect(ok, 'paper', path, lineAt(paragraph, match.index), `"${match[0]}" does not say of which paper`);
    }
  }
}

// ---- Self-test ---------------------------------------------------------------------------------------------------

const kFixture = {
  [`${kAlgorithms}notes.md`]: [
    '# Notes', '## 1 First', '### 1.1 Inner', '## Sources', '',
    '- **ABCD** Jane Doe, Ann Roe: A Title. A Venue, 2014. Cited: Eq. 1–3; section 4.1; Fig. 2.',
    '- **XYZ13** Max Moe: B. C, 2013.', ''].join('\n'),
  'native/FORMAT.md': '# Bytes\n## 1 First\n### 1.1 Inner\n',
  'native/base/thing.h': '#pragma once\nint someThing();\n',
  'native/base/other.h': '#pragma once\n',
  'native/gpu/twice.h': '#pragma once\n',
  'native/base/twice.h': '#pragma once\n',
};
const kRight = [
  'See algorithms/notes.md for it.', 'FORMAT 1.1 says so', 'algorithms/notes.md, section 1', 'notes.md, "Inner"',
  'ABCD Eq. 1-3 and nothing else', 'ABCD 4.1', 'XYZ13', 'Doe et al. (2014)', 'ABCD: as Eq. 2 has it', 'base/thing.h',
  'other.h', 'see someThing', 'native/base/ has it', 'H.264 at CRF 23, BT.709, 1024² and 12 mm',
];
const kWrong = {
  document: ['see native/OTHER.md', 'DESIGN says so'],
  section: ['FORMAT 2', 'algorithms/notes.md, section 1.2', 'notes.md, "Outer"'],
  paper: ['CTGH13', 'EFGH Eq. 2', 'Poe et al. (2014)', 'Doe and Roe 2013', 'by Eq. 2 alone'],
  part: ['ABCD Eq. 4', 'ABCD 4.2', 'ABCD Fig. 2, Table 1'],
  file: ['nothing.h', 'gpu/thing.h', 'twice.h', 'native/none/ has it'],
  identifier: ['see someOther'],
};

function checked(code) {
  return new Checker(new Map(Object.entries({ ...kFixture, ...(code && { 'wasm/user.cpp': code }) }))).run();
}

function selfTest() {
  let passed = true;
  const expect = (condition, message) => {
    if (!condition) console.log(`self-test: ${message}`);
    passed &&= condition;
  };
  for (const comment of kRight) {
    const failures = checked(`// ${comment}\n`).failures;
    expect(failures.length === 0, `"${comment}" is right, and was refused: [${failures}]`);
  }
  for (const [kind, comments] of Object.entries(kWrong))
    for (const comment of comments) {
      const failures = checked(`// ${comment}\n`).failures;
      const ok = failures.length === 1 && failures[0].includes(`: ${kind}: `);
      expect(ok, `"${comment}" should fail once, as ${kind}: [${failures}]`);
    }
  expect(checked('int x;  // of FORMAT\n        // 7.7\n').failures.length === 1, 'a reference over two lines was not found');
  expect(checked('title = "ABCD Table 9";\n').failures.length === 1, 'a reference in a message was not found');
  const readme = '| x | `native/base/thing.h` | `none` |\n';
  const lacking = new Checker(new Map(Object.entries({ ...kFixture, 'README.md': readme }))).run();
  expect(lacking.failures.length === 1, 'a name that the file of a row lacks was not found');
  expect(checked(null).missingKinds().length === kKinds.length, 'a tree without references has some');
  console.log(passed ? 'self-test passed' : 'self-test FAILED');
  return passed;
}

const argument = process.argv[2];
if (!argument) {
  console.error('usage: node tests/tree/references.mjs ROOT | --self-test');
  process.exit(2);
}
process.exit((argument === '--self-test' ? selfTest() : new Checker(readTree(argument)).run().report()) ? 0 : 1);
