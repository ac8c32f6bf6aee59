// SPDX-License-Identifier: Apache-2.0
// Makes the pages of docs/ from the Markdown files that pages.mjs lists.
//   renderDocs(root, OUT): writes OUT/*.html, their style and pictures; Markdown of the repository in, pages out
//   renderPage(page, text): the HTML of one page
// A link to a listed file, or its path in backquotes, becomes a link to its page; a link to another file of the
// repository becomes plain text. Comments are left out.
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, posix } from 'node:path';
import { fileURLToPath } from 'node:url';

import { capturePictures, classPictures, groups, pages, served } from './pages.mjs';

const MarkdownIt = createRequire(new URL('../../web/package.json', import.meta.url))('markdown-it');
const kCopied = ['docs.css', 'layering.svg', ...capturePictures, ...classPictures];
const pageOf = new Map(pages.map((page) => [page.source, `${page.name}.html`]));

/** Makes a heading's anchor as code hosts do: "1.2 Penalties, and X" → "12-penalties-and-x". */
export function slug(title) {
  return title.toLowerCase().replace(/[^\p{L}\p{N}\s_-]/gu, '').trim().replace(/\s/g, '-');
}

/** Returns the address, relative to docs/, of a file of the repository; null if the site does not have it. */
export function addressOf(path) {
  return pageOf.get(path) ?? served.get(path) ?? null;
}

// Returns the address for a link in `source`: unchanged if it is external; null if the site does not have its target.
function rewritten(href, source) {
  if (/^([a-z]+:|#)/.test(href)) return href;
  const [path, fragment] = href.split('#');
  const address = addressOf(posix.normalize(posix.join(posix.dirname(source), decodeURI(path))));
  return address && address + (fragment ? `#${fragment}` : '');
}

const textOf = (token) => token.children.map((child) => child.content).join('');

// Gives headings an id and collects those of the second level.
function addAnchors(markdown) {
  markdown.core.ruler.push('anchors', ({ tokens, env }) => {
    const seen = new Map();
    env.contents = [];
    tokens.forEach((token, i) => {
      if (token.type !== 'heading_open') return;
      const title = textOf(tokens[i + 1]), name = slug(title), count = seen.get(name) ?? 0;
      seen.set(name, count + 1);
      const id = count ? `${name}-${count}` : name;
      token.attrSet('id', id);
      if (token.tag === 'h1') env.title ??= title;
      if (token.tag === 'h2') env.contents.push({ id, title });
    });
  });
}

// Rewrites links; one whose file the site does not have becomes plain text.
function rewriteLinks(children, source) {
  const open = [];
  for (const token of children) {
    if (token.type === 'link_open') {
      const href = rewritten(token.attrGet('href'), source);
      open.push(href);
      if (href === null) Object.assign(token, { type: 'text', content: '', hidden: true });
      else token.attrSet('href', href);
    } else if (token.type === 'link_close') {
      if (open.pop() === null) Object.assign(token, { type: 'text', content: '', hidden: true });
    } else if (token.type === 'image') {
      token.attrSet('src', rewritten(token.attrGet('src'), source) ?? '');
      if (!token.attrGet('src').endsWith('.svg')) token.attrSet('loading', 'lazy');
    } else if (token.type === 'code_inline' && !open.length) {
      token.meta = { href: pageOf.get(token.content) ?? null };
    }
  }
}

function makeMarkdown() {
  const markdown = new MarkdownIt({ html: false, typographer: false });
  addAnchors(markdown);
  markdown.core.ruler.push('links', ({ tokens, env }) => {
    for (const token of tokens) if (token.type === 'inline') rewriteLinks(token.children, env.source);
  });
  const { rules } = markdown.renderer, code = rules.code_inline;
  // Makes wide tables scrollable by keyboard, with numbers by which screen readers list them.
  rules.table_open = (tokens, i, options, env) => `<div class="scroll" tabindex="0" role="region" aria-label="Table ${(env.tables = (env.tables ?? 0) + 1)}">\n<table>\n`;
  for (const name of ['fence', 'code_block']) {
    const code = rules[name];
    rules[name] = (...all) => code(...all).replace('<pre>', '<pre tabindex="0">');
  }
  const header = (end) => (tokens, i, ...rest) => {
    const text = tokens[end ? i - 1 : i + 1].content, cell = rest.at(-1).renderToken(tokens, i, rest[0]);
    return text ? cell : cell.replace('th', 'td'); // an empty header is a plain cell
  };
  rules.th_open = header(false);
  rules.th_close = header(true);
  rules.table_close = () => '</table>\n</div>\n';
  rules.code_inline = (tokens, i, ...rest) => {
    const html = code(tokens, i, ...rest), href = tokens[i].meta?.href;
    return href ? `<a href="${href}">${html}</a>` : html;
  };
  return markdown;
}

const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;').replaceAll('"', '&quot;');

function navigation(current) {
  return groups.map(({ title, pages: list }) => `<p>${escaped(title)}</p>\n<ul>\n${list.map(({ name, title: text }) =>
    `<li><a href="${name}.html"${name === current ? ' aria-current="page"' : ''}>${escaped(text)}</a></li>`).join('\n')}\n</ul>`).join('\n');
}

// Makes the table of contents of a page with at least four headings.
function contentsOf(list) {
  if (list.length < 4) return '';
  const items = list.map(({ id, title }) => `<li><a href="#${escaped(id)}">${escaped(title)}</a></li>`);
  return `<details class="contents">\n<summary>On this page</summary>\n<ul>\n${items.join('\n')}\n</ul>\n</details>\n`;
}

export function renderPage(page, text) {
  const env = { source: page.source };
  const body = makeMarkdown().render(text.replace(/<!--[\s\S]*?-->\n?/g, ''), env);
  const [heading, ...rest] = body.split(/(?<=<\/h1>\n)/);
  return `<!doctype html>
<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Made by site/docs/render.mjs from ${page.source}. -->
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'">
<meta name="color-scheme" content="light dark">
<title>fourdvt · ${escaped(env.title ?? page.title)}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="docs.css">
</head>
<body>
<a class="skip" href="#text">Skip to the text</a>
<header class="mast">
<a class="wordmark" href="../index.html">fourdvt</a>
<a href="index.html">Documents</a>
<a href="../measured/index.html">All figures</a>
</header>
<details class="menu">
<summary>All documents</summary>
<nav aria-label="Documents">
${navigation(page.name)}
</nav>
</details>
<div class="columns">
<nav class="side" aria-label="Documents">
${navigation(page.name)}
</nav>
<main id="text" tabindex="-1">
${rest.length ? `${heading}${contentsOf(env.contents)}${rest.join('')}` : heading}</main>
</div>
</body>
</html>
`;
}

export function renderDocs(root, out) {
  rmSync(out, { recursive: true, force: true });
  for (const folder of ['capture', 'classes']) mkdirSync(join(out, folder), { recursive: true });
  for (const name of kCopied) copyFileSync(join(dirname(fileURLToPath(import.meta.url)), name), join(out, name));
  for (const page of pages) {
    writeFileSync(join(out, `${page.name}.html`), renderPage(page, readFileSync(join(root, page.source), 'utf8')));
  }
}
