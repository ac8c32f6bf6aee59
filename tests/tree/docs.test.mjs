// SPDX-License-Identifier: Apache-2.0
// The documents: generated parts are current, every link resolves in the repository and on the rendered site, and claims
// about figures hold for site/measured/figures.json.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, posix } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { errorTables } from '../../site/docs/errors.mjs';
import { layeringPicture, parseLayering } from '../../site/docs/layering.mjs';
import { run } from '../../site/docs/make.mjs';
import { capturePictures, classPictures, pages, served } from '../../site/docs/pages.mjs';
import { renderDocs, renderPage, slug } from '../../site/docs/render.mjs';
import { Shown } from '../../site/measured/shown.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const read = (path) => readFileSync(join(kRoot, path), 'utf8');

let out;
before(() => {
  out = mkdtempSync(join(tmpdir(), 'fourdvt-docs-'));
  renderDocs(kRoot, out);
});
after(() => rmSync(out, { recursive: true, force: true }));

test('picture and tables are what the code says', () => {
  assert.deepEqual(run(kRoot, true), [], 'run: node site/docs/make.mjs');
});

test('every document of the list exists, and every Markdown file of the tree is in it', () => {
  for (const { source } of pages) assert.ok(existsSync(join(kRoot, source)), source);
  for (const [path] of served) assert.ok(existsSync(join(kRoot, path)), path);
  const found = (folder) => readdirSync(join(kRoot, folder), { withFileTypes: true }).flatMap((entry) => {
    const path = posix.join(folder, entry.name);
    if (entry.isDirectory()) return /^(node_modules|build.*|dist|\.git|shared)$/.test(entry.name) ? [] : found(path);
    return path.endsWith('.md') ? [path] : [];
  });
  const listed = new Set([...pages.map(({ source }) => source), ...served.keys()]);
  assert.deepEqual(found('.').filter((path) => !listed.has(path)), [], 'list it in site/docs/pages.mjs');
});

// Addresses in href and src of a rendered page; below, its ids.
const linksOf = (html) => [...html.matchAll(/ (?:href|src)="([^"]*)"/g)].map((match) => match[1]);
const idsOf = (html) => new Set([...html.matchAll(/ id="([^"]*)"/g)].map((match) => match[1]));

test('every link of a rendered page leads to a file of the site, and to a place in it', () => {
  const html = new Map(pages.map(({ name }) => [`${name}.html`, readFileSync(join(out, `${name}.html`), 'utf8')]));
  const others = new Set([...served.values(), '../index.html', '../measured/index.html', 'docs.css']);
  let links = 0;
  for (const [page, text] of html) {
    for (const link of linksOf(text)) {
      if (/^(https?:|mailto:|data:)/.test(link)) continue;
      ++links;
      const [path, fragment] = link.split('#'), target = path || page;
      assert.ok(html.has(target) || others.has(target), `${page}: ${link}`);
      if (fragment) assert.ok(idsOf(html.get(target) ?? '').has(decodeURIComponent(fragment)), `${page}: no such place: ${link}`);
    }
    assert.doesNotMatch(text, /\.md["#]/, `${page} links to Markdown`);
    assert.doesNotMatch(text, / (src|href)="https?:[^"]*\.(js|css|png|woff2?)"/, `${page} loads something from elsewhere`);
    assert.doesNotMatch(text, /<script| style="| on\w+="/, `${page} has nothing inline`);
    assert.match(text, /<main[\s\S]*<h1 id=/, `${page} begins with a heading`);
  }
  assert.ok(links > 300, `${links} links`);
});

test('the guides show every picture that is made for them, the site has them, and together they stay small', () => {
  for (const [source, folder, pictures] of [['CAPTURE', 'capture', capturePictures], ['CLASSES', 'classes', classPictures]]) {
    const guide = read(`native/capture/${source}.md`), shown = [...guide.matchAll(/!\[[^\]]+\]\(\.\.\/\.\.\/site\/docs\/([^)]+)\)/g)].map((match) => match[1]);
    assert.deepEqual(shown.toSorted(), pictures.toSorted());
    assert.deepEqual(readdirSync(join(kRoot, 'site/docs', folder)).map((name) => `${folder}/${name}`).toSorted(), pictures.toSorted());
    for (const path of pictures) assert.ok(existsSync(join(out, path)), path);
  }
  const made = [...read('site/docs/class_pictures.sh').matchAll(/^row (\w+) /gm)].map(([, name]) => `classes/${name}.webp`);
  assert.deepEqual(made.toSorted(), classPictures.toSorted(), 'bash site/docs/class_pictures.sh makes them');
  const script = read('site/docs/capture_pictures.mjs').match(/const kPictures = \{ ([\w, ]+) \}/)[1].split(', ');
  assert.deepEqual(script.map((name) => `capture/${name}.webp`).toSorted(), capturePictures.toSorted(), 'node site/docs/capture_pictures.mjs makes them');
  assert.ok([...capturePictures, ...classPictures].reduce((sum, path) => sum + statSync(join(kRoot, 'site/docs', path)).size, 0) < 600_000, 'pictures of the guides');
});

test('anchors of links in the repository exist', () => {
  for (const { source } of [...pages, { source: 'README.md' }]) {
    for (const [, link] of read(source).replace(/```[\s\S]*?```/g, '').matchAll(/\]\(([^):\s]*#[^)\s]+)\)/g)) {
      const [path, fragment] = link.split('#');
      const target = path ? posix.normalize(posix.join(dirname(source), path)) : source;
      const titles = [...read(target).matchAll(/^#+ (.*)$/gm)].map((match) => slug(match[1].replace(/`/g, '')));
      assert.ok(titles.includes(fragment), `${source}: ${link}`);
    }
  }
});

test('links are rewritten, paths in backquotes become links, files that the site lacks become text', () => {
  const html = renderPage({ source: 'web/README.md', name: 'element', title: 'x' },
    '# T\n\n<!-- gone -->\n[a](../native/package/FORMAT.md#character-gltf) [b](../native/base/result.h) `native/algorithms/README.md` [c](https://x.org) ![d](../site/layers.jpg)\n');
  assert.match(html, /<a href="format\.html#character-gltf">a<\/a> b <a href="algorithms\.html"><code>native\/algorithms\/README\.md<\/code><\/a> <a href="https:\/\/x\.org">c<\/a> <img src="\.\.\/layers\.jpg"/);
  assert.doesNotMatch(html, /gone/);
});

test('the layering is read with its groups; the picture has a box for each top folder', () => {
  const text = '# a: comment\nflow: b a\na:\n@g: a\nb: @g\nb/c: a b\n';
  assert.deepEqual(parseLayering(text), { flow: ['b', 'a'], folders: [['a', []], ['b', ['a']], ['b/c', ['a', 'b']]] });
  assert.equal(layeringPicture(text).match(/<rect /g).length, 2);
  assert.throws(() => parseLayering('a: @none\n'), /@none/);
});

test('an error without meaning or remedy is refused', () => {
  const header = (comment) => `enum class ErrorId : int {\n  None = 0,\n  BadThing,${comment}\n};\n`;
  const source = 'case ErrorId::BadThing:\n      return "bad-thing";', page = '//   own-thing: it broke; mend it\n';
  const { tool, page: own } = errorTables(header('  // it is\n             // bad; mend it'), source, page);
  assert.match(tool, /\| `bad-thing` \| It is bad \| Mend it \|/);
  assert.match(own, /\| `own-thing` \| It broke \| Mend it \|/);
  for (const comment of ['', '  // it is bad']) assert.throws(() => errorTables(header(comment), source, page), /meaning; remedy/);
  assert.throws(() => errorTables(header('  // a; b'), '', page), /no name for BadThing/);
});

// README, site/docs/measured.md and site/index.html put these facts into words.
test('what the documents claim about figures holds', () => {
  const shown = new Shown(JSON.parse(read('site/measured/figures.json')));
  const values = (id) => shown.group(id).map((figure) => figure.value);
  for (const id of ['equal_psnr.joint', 'equal_ssim.joint'])
    assert.equal(values(id).filter((percent) => percent > 100).length, 2, `layers of 512² need more bytes than camera videos on two of three motions: ${id}`);
  assert.ok(values('truth.mean.gain')[0] > 0, 'baked is ahead of flow on the true mesh');
  const blended = values('truth.psnr.blend.baked').map((dB, i) => dB - values('truth.psnr.blend.flow-gpu')[i]);
  assert.ok(blended.every((gain) => gain < 0), 'flow is ahead on the blended mesh');
});
