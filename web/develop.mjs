// SPDX-License-Identifier: Apache-2.0
// Serves the site to the one who works on it: what is saved is seen in open pages within seconds.
//   node web/develop.mjs [--port 8080] [--site build/site]
// SITE: an assembled site, which site/demo.sh makes; it stays as it is. What is built here goes into build/develop and is served
// in front of it. A save of
//   shaders/gles        reloads pages, which draw with the saved texts: only the browser compiles them
//   web/src             is bundled; types are checked afterwards
//   native, wasm        builds build/wasm-dev (CMake preset wasm-dev: quick to link, neither small nor split), then bundles
//   site, web/examples  is copied
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

const problems = new Map(); // by step
const pages = new Set();
let builds = 0, embedded = new Map(); // shaders of the player that is served
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

// The script of every page, with the shaders as they are now.
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

// Runs work one at a time. Calls that come while it waits for its turn are one.
function serially(work) {
  let last = Promise.resolve(), waiting = null;
  return () => (waiting ??= last = last.then(() => {
    waiting = null;
    return work();
  }));
}

// True if the work was done; else its error is shown as the step's problem. The work returns false where there was nothing to do.
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

// Errors: one with the command's output. onOutput: called with each part of it.
function run(command, args, onOutput = () => undefined) {
  return new Promise((done, failed) => {
    let output = '';
    const child = spawn(command, args, { cwd: kRoot, env: { NODE_PATH: '/usr/share/nodejs', ...process.env } }); // Debian's Emscripten
    for (const stream of [child.stdout, child.stderr]) stream.on('data', (part) => { output += part; onOutput(String(part)); });
    child.on('error', (reason) => failed(new Error(`${command} does not start: ${reason.message}`)));
    child.on('close', (code) => (code ? failed(new Error(output.trim())) : done(output)));
  });
}

// The wasm modules that are bundled: copies, because the next build may begin before they are read.
let modules = '';
function takeModules(buildFolder) {
  const from = join(buildFolder, 'wasm'), taken = join(kOut, modules.endsWith('0') ? 'modules1' : 'modules0');
  rmSync(taken, { recursive: true, force: true });
  mkdirSync(join(taken, 'worker'), { recursive: true });
  for (const name of kModules) copyFileSync(join(from, name), join(taken, name));
  const more = join(from, 'fourdvt-more.wasm'); // what wasm-dev builds is not split
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

// Prints now and then how far a long build is.
function progress() {
  let printed = performance.now();
  return (text) => {
    const [, done] = /\[(\d+\/\d+)\][^[]*$/.exec(text) ?? [];
    if (!done || performance.now() - printed < 10_000) return;
    printed = performance.now();
    console.log(`C++: ${done.replace('/', ' of ')} steps`);
  };
}

const kNoise = /^\[\d+\/\d+\]|^FAILED: |^ninja: |em\+\+/; // steps that were done, and commands

async function buildModules() {
  const before = stateOf(kBuild);
  if (!existsSync(join(kBuild, 'build.ninja'))) {
    console.log('C++: build/wasm-dev is built for the first time, which takes minutes; every later save takes seconds');
    const quick = { ...process.env, DRACO_WASM_FLAGS: '-O2 -msimd128' }; // without -flto, which each link would pay for
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
const kLeftOut = /(^|\/)(generated|sample|docs|lab)(\/|$)/; // made here, or of no page

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
if (built === kBuild) compile(); // what has been saved since it was built
