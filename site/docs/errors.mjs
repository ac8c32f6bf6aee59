// SPDX-License-Identifier: Apache-2.0
// Makes the documents' tables of errors by ID from comments "meaning; remedy" in the code:
//   enum class ErrorId of native/base/result.h:      FileMissing,  // meaning; remedy
//   the page's own IDs in web/src/report/errors.ts:         //   insecure-context: meaning; remedy

function row(name, comment, where) {
  const [meaning, ...remedy] = comment.trim().split('; ');
  if (!meaning || !remedy.length) throw new Error(`${where}: the comment of ${name} must read "meaning; remedy"`);
  const upper = (text) => (/^\S+\.\w/.test(text) ? text : text[0].toUpperCase() + text.slice(1));
  const sentence = (text) => upper(text).replaceAll('|', '\\|').replace(/(?<!\w)--[a-z]\S*/g, '`$&`');
  return `| \`${name}\` | ${sentence(meaning)} | ${sentence(remedy.join('; '))} |`;
}

const table = (rows) => ['| ID | meaning | remedy |', '|---|---|---|', ...rows].join('\n');

/** Returns { tool, page }, Markdown tables. Throws for an ID without a name, a meaning or a remedy. */
export function errorTables(header, source, page) {
  const [, list] = /enum class ErrorId : int \{([\s\S]*?)\n\};/.exec(header) ?? [];
  if (!list) throw new Error('native/base/result.h has no enum class ErrorId');
  const names = new Map([...source.matchAll(/case ErrorId::(\w+):\s*return "([^"]+)"/g)].map((m) => [m[1], m[2]]));
  const entries = [...list.matchAll(/^ {2}([A-Z]\w*)(?: = 0)?,(?:\s*\/\/ (.*(?:\n\s*\/\/ .*)*))?/gm)].filter(([, id]) => id !== 'None');
  const tool = entries.map(([, id, comment = '']) => {
    if (!names.has(id)) throw new Error(`native/base/result.cpp: errorName has no name for ${id}`);
    return row(names.get(id), comment.replace(/\s*\n\s*\/\/ /g, ' '), 'native/base/result.h');
  });
  const own = [...page.matchAll(/^\/\/ {3}([a-z][a-z-]+): (.*(?:\n\/\/ {5,}\S.*)*)/gm)]
    .map(([, name, comment]) => row(name, comment.replace(/\n\/\/\s+/g, ' '), 'web/src/report/errors.ts'));
  if (!tool.length || !own.length) throw new Error('no error found: the files look different from what site/docs/errors.mjs expects');
  return { tool: table(tool), page: table(own) };
}
