// SPDX-License-Identifier: Apache-2.0
// Serves the site during development: open pages show each saved change within seconds.
//   node web/develop.mjs [--port 8080] [--site build/site]
// SITE: a site assembled by site/demo.sh, not modified. This script builds into build/develop, whose files take
// precedence over SITE's. After a save in
//   shaders/gles        pages reload and draw with the saved texts: only the browser compiles them
//   web/src             it bundles; types are checked afterwards
//   native, wasm        it builds build/wasm-dev (CMake preset wasm-dev: quick to link, neither small nor split), then bundles
//   site, web/examples  it copies the files
// Mistakes are printed and shown on the pages until they have been corrected.
import { execFileSync, spawn } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, statSync, watch, writeFileSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { serveOnNextFreePort } from '../tests/web/server.mjs';
import { bundlePlayer } from './bundle.mjs';
import { embeddedShaders, nameLines, readShaders } from './develop/glsl.mjs';

const kRoot = resolve(dirname(fileURLToPath(import.meta.url)), '..');
const kBuild = join(kRoot, 'build/wasm-dev'), kOut = join(kRoot, 'build/develop'), kShaders = join(kRoot, 'shaders/gles');
const kModules = ['abi.ts', 'fourdvt.js', 'fourdvt.wasm', 'worker/fourdvt-worker.wasm'];
const kEmptyModule = Buffer.from('\0asm\x01\0\0\0', 'latin1');
const kQuietMs = 40; // editors save in several steps

function fail(message) {
  console.error(`develop.mjs: ${message}`);
  process.exit(2);
}

function readOptions() {
  try {
    return parseArgs({ options: { port: { type: 'string', default: '8080' }, site: { type: 'string', default: join(kRoot, 'build/site') } } }).values;
  } catch (reason) {
    fail(`${reason.message}; usage: node web/develop.mjs [--port N] [--site FOLDER]`);
  }
}
const options = readOptions(), site = resolve(options.site);
if (!(Number(options.port) >= 0)) fail(`--port must be a number, not "${options.port}"`);
if (!existsSync(join(site, 'character/character.gltf'))) fail(`${site} has no character/character.gltf: bash site/demo.sh --prepare makes the site`);

// --- messages to open pages ---

const problems = new Map(); // messages by step
const pages = new Set();
let builds = 0, embedded = new Map(); // shader texts in the served player
const version = () => `${process.pid}.${builds}`;

const send = (page) => page.write(`data: ${JSON.stringify({ version: version(), problems: [...problems.values()] })}\n\n`);
function reload() {
  problems.delete('GLSL');
  ++builds;
  pages.forEach(send);
}
function complain(step, text) {
  if (problems.get(step) === text) return;
  problems.set(step, text);
  console.error(text);
  pages.forEach(send);
}

// Script for every page, with the shaders' present texts.
function pageScript() {
  const texts = readShaders(kShaders);
  const shaders = [...embedded].filter(([name]) => texts.has(name)).map(([name, text]) => ({ name, embedded: text, text: texts.get(name) }));
  const script = readFileSync(join(kRoot, 'web/develop/page.js'), 'utf8');
  return `const develop = ${JSON.stringify({ version: version(), shaders })};\n${script}`;
}

function handle(request, response) {
  if (request.url === '/develop/page.js') {
    response.writeHead(200, { 'Content-Type': 'text/javascript; charset=utf-8', 'Cache-Control': 'no-store' }).end(pageScript());
  } else if (request.url === '/develop/events') {
    response.writeHead(200, { 'Content-Type': 'text/event-stream', 'Cache-Control': 'no-store' });
    pages.add(response);
    response.on('close', () => pages.delete(response));
    send(response);
  } else if (request.url === '/develop/problem' && request.method === 'POST') {
    let text = '';
    request.on('data', (part) => (text += part)).on('end', () => {
      response.writeHead(204).end();
      const [of, problem] = text.split(/\n(.*)/s); // the version on the first line
      if (of === version() && problem) complain('GLSL', nameLines(problem, kShaders));
    });
  } else {
    return false;
  }
  return true;
}

// --- steps ---

// Wraps `work` so that one run at a time is active; calls during a run share one further run.
function serially(work) {
  let last = Promise.resolve(), waiting = null;
  return () => (waiting ??= last = last.then(() => {
    waiting = null;
    return work();
  }));
}

// Runs a step's work; if it fails, shows the error as the step's problem and returns false. The work returns false if it
// had nothing to do.
async function step(name, work) {
  const began = performance.now();
  try {
    const idle = await work() === false;
    if (problems.delete(name)) pages.forEach(send);
    if (!idle) console.log(`${name}: ${((performance.now() - began) / 1000).toFixed(1)} s`);
    return !idle;
  } catch (reason) {
    complain(name, `${name}: ${reason.message}`);
    return false;
  }
}

// Runs a command; calls onOutput with each part of its output. Errors: an Error with the whole output.
function run(command, args, onOutput = () => undefined) {
  return new Promise((done, failed) => {
    let output = '';
    const child = spawn(command, args, { cwd: kRoot, env: { NODE_PATH: '/usr/share/nodejs', ...process.env } }); // for Debian's Emscripten
    for (const stream of [child.stdout, child.stderr]) stream.on('data', (part) => { output += part; onOutput(String(part)); });
    child.on('error', (reason) => failed(new Error(`${command} does not start: ${reason.message}`)));
    child.on('close', (code) => (code ? failed(new Error(output.trim())) : done(output)));
  });
}

// Folder of copies of the wasm modules to bundle: the next build may begin before the bundler has read them.
let modules = '';
function takeModules(buildFolder) {
  const from = join(buildFolder, 'wasm'), taken = join(kOut, modules.endsWith('0') ? 'modules1' : 'modules0');
  rmSync(taken, { recursive: true, force: true });
  mkdirSync(join(taken, 'worker'), { recursive: true });
  for (const name of kModules) copyFileSync(join(from, name), join(taken, name));
  const more = join(from, 'fourdvt-more.wasm'); // absent in wasm-dev, which is not split
  if (existsSync(more)) copyFileSync(more, join(taken, 'fourdvt-more.wasm'));
  else writeFileSync(join(taken, 'fourdvt-more.wasm'), kEmptyModule);
  writeFileSync(join(taken, 'shaders.json'), JSON.stringify([...embeddedShaders(buildFolder)]));
  modules = taken;
}

const bundle = serially(async () => {
  const done = await step('TypeScript', async () => {
    const from = modules, out = join(kOut, 'site/fourdvt-viewer'), opencv = join(kRoot, 'build/wasm/wasm/opencv');
    const opencvFolder = existsSync(join(opencv, 'fourdvt-opencv.js')) ? opencv : undefined;
    await bundlePlayer({ wasmFolder: from, opencvFolder, out: `${out}.part`, develop: true, logLevel: 'silent' });
    rmSync(out, { recursive: true, force: true });
    renameSync(`${out}.part`, out);
    embedded = new Map(JSON.parse(readFileSync(join(from, 'shaders.json'), 'utf8')));
  });
  if (done && !existsSync(join(kOut, 'site/index.html'))) await copyPages();
  else if (done) reload();
  return done;
});

const checkTypes = serially(() => run(process.execPath, [join(kRoot, 'web/node_modules/typescript/bin/tsc'), '-p', join(kRoot, 'web'), '--noEmit'])
  .catch((reason) => console.error(`types:\n${reason.message}`)));

const stateOf = (folder) => kModules.map((name) => statSync(join(folder, 'wasm', name), { throwIfNoEntry: false })?.mtimeMs).join();

// Returns a function that prints a long build's progress now and then.
function progress() {
  let printed = performance.now();
  return (text) => {
    const [, done] = /\[(\d+\/\d+)\][^[]*$/.exec(text) ?? [];
    if (!done || performance.now() - printed < 10_000) return;
    printed = performance.now();
    console.log(`C++: ${done.replace('/', ' of ')} steps`);
  };
}

const kNoise = /^\[\d+\/\d+\]|^FAILED: |^ninja: |em\+\+/; // lines of finished build steps and of commands

async function buildModules() {
  const before = stateOf(kBuild);
  if (!existsSync(join(kBuild, 'build.ninja'))) {
    console.log('C++: build/wasm-dev is built for the first time, which takes minutes; every later save takes seconds');
    const quick = { ...process.env, DRACO_WASM_FLAGS: '-O2 -msimd128' }; // without -flto, which slows each link down
    const draco = execFileSync('bash', [join(kRoot, 'wasm/build_draco.sh')], { env: quick, encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] }).trim();
    await run('cmake', ['--preset', 'wasm-dev', `-DDRACO_WASM_DIR=${draco}`]);
  }
  await run('cmake', ['--build', kBuild, '--target', 'fourdvt_wasm', 'fourdvt_worker'], progress()).catch((reason) => {
    throw new Error(reason.message.split('\n').filter((line) => !kNoise.test(line)).join('\n'));
  });
  if (stateOf(kBuild) === before) return false;
  takeModules(kBuild);
}
const compile = serially(async () => {
  if (await step('C++', buildModules)) await bundle();
});

const copyPages = serially(async () => {
  const cameras = join(site, 'cameras');
  const done = await step('site', () => run(process.execPath, [join(kRoot, 'site/assemble.mjs'), '--pages', join(kOut, 'site'), join(kOut, 'site/fourdvt-viewer'),
    join(site, 'character'), ...(existsSync(cameras) ? [cameras] : [])]));
  if (done) reload();
});

function readAgain() {
  console.log('shaders: read again');
  reload();
}

// --- saves ---

const kSteps = [
  { folder: 'shaders/gles', files: /\.(vert|frag|glsl)$/, build: readAgain },
  { folder: 'web/src', files: /\.ts$/, build: () => bundle().then((done) => { if (done) checkTypes(); }) },
  { folder: 'native', files: /\.(cpp|h|inc|cmake|txt)$/, build: compile },
  { folder: 'wasm', files: /\.(cpp|h|cmake|txt)$/, build: compile },
  { folder: 'site', files: /\.(html|css|js|jpg|webp|json)$/, build: copyPages },
  { folder: 'web/examples', files: /\.html$/, build: copyPages },
];
const kLeftOut = /(^|\/)(generated|sample|docs|lab)(\/|$)/; // generated by this script, or not part of a page

function watchAll() {
  const touched = new Set();
  let timer = 0;
  const buildTouched = () => {
    const builds = new Set([...touched]);
    touched.clear();
    builds.forEach((build) => build());
  };
  for (const { folder, files, build } of kSteps) {
    const below = readdirSync(join(kRoot, folder), { recursive: true, withFileTypes: true }).filter((entry) => entry.isDirectory())
      .map((entry) => join(entry.parentPath ?? entry.path, entry.name));
    for (const path of [join(kRoot, folder), ...below]) {
      if (kLeftOut.test(relative(kRoot, path))) continue;
      watch(path, (_, name) => {
        if (!files.test(name ?? '')) return;
        touched.add(build);
        clearTimeout(timer);
        timer = setTimeout(buildTouched, kQuietMs);
      });
    }
  }
}

rmSync(join(kOut, 'site'), { recursive: true, force: true });
mkdirSync(join(kOut, 'site'), { recursive: true });
const built = [kBuild, join(kRoot, 'build/wasm')].find((folder) => kModules.every((name) => existsSync(join(folder, 'wasm', name))));
if (built) {
  takeModules(built);
  await bundle();
} else {
  await compile();
}
watchAll();
const { url } = await serveOnNextFreePort(site, Number(options.port), {
  over: join(kOut, 'site'), handle,
  edit: (html) => html.replace([/<head>/i, /<html[^>]*>/i, /^/].find((mark) => mark.test(html)), '$&<script src="/develop/page.js"></script>'),
});
console.log(url);
if (built === kBuild) compile(); // bundles changes saved after that build
