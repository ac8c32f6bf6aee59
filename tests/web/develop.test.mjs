// SPDX-License-Identifier: Apache-2.0
// Parts of web/develop.mjs: shaders whose lines messages name by file, and files served in front of a site's.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';

import { embeddedShaders, nameLines, readShaders } from '../../web/develop/glsl.mjs';
import { serve } from './server.mjs';

const folder = mkdtempSync(join(tmpdir(), 'fourdvt-develop-'));
after(() => rmSync(folder, { recursive: true }));

function write(files) {
  for (const [name, text] of Object.entries(files)) {
    mkdirSync(join(folder, name, '..'), { recursive: true });
    writeFileSync(join(folder, name), text);
  }
}

// The line that a compiler counts for a line of a text: that of the last directive above it, and those since.
function countedLine(text, wanted) {
  let number = 0;
  for (const line of text.split('\n')) {
    const [, given] = /^#line (\d+)$/.exec(line) ?? [];
    if (given) number = Number(given);
    else if (line === wanted) return number;
    else number += 1;
  }
  return assert.fail(`no line ${wanted}`);
}

test('lines of shaders are named by file and number, in included files, too', () => {
  write({ 'gles/a.frag': 'first\n#include "part.glsl"\n#include "part.glsl"\nlast', 'gles/part.glsl': '\ninside', 'gles/b.vert': '#include "absent.glsl"' });
  const gles = join(folder, 'gles'), shaders = readShaders(gles), text = shaders.get('a.frag');
  assert.deepEqual([...shaders.keys()], ['a.frag', 'b.vert']);
  assert.equal(text.split('inside').length, 2, 'a file is included once');
  for (const [line, place] of [['first', 'a.frag:1'], ['inside', 'part.glsl:2'], ['last', 'a.frag:4']]) {
    const number = countedLine(text, line);
    assert.equal(nameLines(`ERROR: 0:${number}: 'x'`, gles), `ERROR: ${place}: 'x'`, 'ANGLE');
    assert.equal(nameLines(`0:${number}(7): error`, gles), `${place}(7): error`, 'Mesa');
  }
  assert.match(shaders.get('b.vert'), /^#error no file absent\.glsl/m);
});

test('embedded shaders are those that the build has written', () => {
  write({ 'build/native/gpu/shader_sources.cpp': 'f(name) {\n  if (name == "a.frag") return R"__glsl__(void main() {}\n)__glsl__";\n  return {};\n}' });
  assert.deepEqual([...embeddedShaders(join(folder, 'build'))], [['a.frag', 'void main() {}\n']]);
});

test('files in front of a site come first, pages are edited, and what is handled is not looked for', async () => {
  write({ 'site/index.html': '<head>old', 'site/both.js': 'old', 'site/only.js': 'site', 'site/deep/index.html': '<head>deep', 'over/both.js': 'new', 'over/deep/x.js': 'x' });
  const { url, close } = await serve(join(folder, 'site'), 0, {
    over: join(folder, 'over'), edit: (html) => `${html} edited`,
    handle: (request, response) => request.url === '/events' && Boolean(response.end('handled')),
  });
  const get = async (path) => (await fetch(url + path)).text();
  assert.deepEqual(await Promise.all(['', 'both.js', 'only.js', 'deep/', 'deep/x.js', 'events', 'none.js'].map(get)),
    ['<head>old edited', 'new', 'site', '<head>deep edited', 'x', 'handled', 'not found\n']);
  await close();
});
