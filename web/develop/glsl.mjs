// SPDX-License-Identifier: Apache-2.0
// Shaders of a folder for web/develop.mjs: texts whose lines a compiler's messages name by file, and the texts that a build of
// the player has embedded (native/gpu/embed_shaders.cmake).
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const kShader = /\.(vert|frag|glsl)$/;
const kLinesPerFile = 100_000; // GLSL names no files: line 12 of the third file is line 300012

const shaderFiles = (folder) => readdirSync(folder).filter((name) => kShader.test(name)).sort();

/** Texts of a folder's shaders by name, `#include`s expanded; one that cannot be read does not compile, and its message says why. */
export function readShaders(folder) {
  const files = shaderFiles(folder);
  const numbered = (name, line) => `#line ${kLinesPerFile * (files.indexOf(name) + 1) + line}`;
  const expand = (name, seen) => readFileSync(join(folder, name), 'utf8').split('\n').map((line, i) => {
    const [, part] = /^\s*#include "(\w+\.glsl)"/.exec(line) ?? [];
    if (!part) return line;
    if (!files.includes(part)) return `#error no file ${part}: add it or correct the include`;
    if (seen.has(part)) return '';
    seen.add(part);
    return `${numbered(part, 1)}\n${expand(part, seen)}\n${numbered(name, i + 2)}`;
  }).join('\n');
  return new Map(files.filter((name) => !name.endsWith('.glsl')).map((name) => [name, `${numbered(name, 1)}\n${expand(name, new Set())}`]));
}

/** A GLSL compiler's log with the files of `folder` in place of the line numbers that readShaders has given. */
export function nameLines(log, folder) {
  const files = shaderFiles(folder);
  return log.replace(/(?:\b0([:(]))?\b(\d{6,})\b/g, (whole, _, number) => {
    const file = files[Math.floor(number / kLinesPerFile) - 1];
    return file ? `${file}:${number % kLinesPerFile}` : whole;
  });
}

/** Texts by name in what embed_shaders.cmake has written in the build folder. */
export function embeddedShaders(buildFolder) {
  const sources = readdirSync(join(buildFolder, 'native'), { recursive: true }).filter((path) => path.endsWith('shader_sources.cpp'));
  return new Map(sources.flatMap((path) => {
    const text = readFileSync(join(buildFolder, 'native', path), 'utf8');
    return [...text.matchAll(/name == "([\w.]+)"\) return R"__glsl__\(([^]*?)\)__glsl__";/g)].map(([, name, embedded]) => [name, embedded]);
  }));
}
