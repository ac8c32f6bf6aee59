// SPDX-License-Identifier: Apache-2.0
// Bundles src/ and the wasm modules of a build into one folder of matching scripts and modules. Checks neither types nor
// sizes.
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build, transform } from 'esbuild';

import { stampOf, stampWasm, writeTypeScript } from '../wasm/abi.mjs';
import { withoutNames } from '../wasm/binary.mjs';

const here = dirname(fileURLToPath(import.meta.url));

function checkModules(wasmFolder, opencvFolder) {
  for (const name of ['abi.ts', 'fourdvt.js', 'fourdvt.wasm', 'fourdvt-more.wasm', 'worker/fourdvt-worker.wasm']) {
    if (existsSync(join(wasmFolder, name))) continue;
    throw new Error(`${join(wasmFolder, name)} is missing: build the CMake preset wasm first, or name its folder with --wasm`);
  }
  if (opencvFolder && !existsSync(join(opencvFolder, 'fourdvt-opencv.js'))) {
    throw new Error(`${join(opencvFolder, 'fourdvt-opencv.js')} is missing: build the CMake preset wasm with OPENCV_WASM_DIR`);
  }
  const abi = join(here, 'src/wasm/generated/abi.ts');
  writeTypeScript(abi);
  if (!readFileSync(abi).equals(readFileSync(join(wasmFolder, 'abi.ts')))) {
    throw new Error(`the modules in ${wasmFolder} have another ABI than wasm/abi.txt: build the CMake preset wasm again`);
  }
}

// Removes the stub function that Emscripten's script defines for every export under its long name; bundles call exports
// by the module's short names instead. Returns the script, and the short names by long name.
function shortenExports(script) {
  const stub = /var (\w+)=Module\["\1"\]=function\(\)\{return\(\1=Module\["\1"\]=Module\["asm"\]\["([\w$]+)"\]\)\.apply\(null,arguments\)\};/g;
  const isUsed = (name) => script.split(new RegExp(`\\b${name}\\b`)).length > 6; // its own definition has it five times
  const names = {};
  const rest = script.replace(stub, (definition, name, short) => {
    if (isUsed(name)) return definition;
    names[name] = short;
    return '';
  });
  const taken = Object.values(names).filter((short) => script.includes(`Module["${short}"]`));
  const kept = 'Module["asm"]=exports;', shortened = rest.replace(kept, `Object.assign(Module,${kept.slice(0, -1)});`);
  if (Object.keys(names).length < 50 || shortened === rest || taken.length) {
    throw new Error(`Emscripten's script defines its exports in another way than this program reads ${taken}`);
  }
  return [shortened, names];
}

// Removes the code by which Emscripten's script fetches the module: the page fetches it.
function leaveOutFetching(script) {
  const cuts = [['var read_,readAsync,', 'var out='], ['var dataURIPrefix=', 'function createWasm('],
    ['function receiveInstantiationResult(', 'if(Module["instantiateWasm"])'], ['instantiateAsync().catch(readyPromiseReject);', 'return{}}']];
  return cuts.reduce((text, [from, to]) => {
    const begin = text.indexOf(from), end = text.indexOf(to, begin);
    if (begin < 0 || end < 0) throw new Error(`Emscripten's script has no ${from} before ${to}`);
    return text.slice(0, begin) + text.slice(end);
  }, script);
}

const kTarget = ['es2022', 'chrome94', 'safari16.4', 'firefox130'];

// Minifies the style sheets of sources: const CSS = `…`.
const minifiedStyles = {
  name: 'minified-styles',
  setup({ onLoad }) {
    onLoad({ filter: /\/src\/.*\.ts$/ }, async ({ path }) => {
      const contents = readFileSync(path, 'utf8'), [css] = /(?<=^const CSS = `)[^`]+(?=`;$)/m.exec(contents) ?? [];
      if (!css) return undefined;
      const { code } = await transform(css, { loader: 'css', minify: true, target: kTarget.slice(1) });
      return { contents: contents.replace(css, () => code.trim()), loader: 'ts' };
    });
  },
};

/**
 * Empties `out` and writes the player into it. wasmFolder: the build of wasm/; opencvFolder: the build of OpenCV, left
 * out if undefined. develop: modules of the preset wasm-dev, names kept in scripts, source maps. Errors: an Error with
 * one message, or esbuild's with `errors`.
 */
export async function bundlePlayer({ wasmFolder, opencvFolder, out, develop = false, logLevel = 'warning' }) {
  checkModules(wasmFolder, opencvFolder);
  const bundle = (entry, outfile, more = {}) => build({
    entryPoints: [entry],
    outfile: join(out, outfile),
    bundle: true,
    minify: !develop,
    sourcemap: develop,
    format: 'esm',
    target: kTarget,
    plugins: develop ? [] : [minifiedStyles],
    banner: { js: `/*! ${outfile.replace('.js', '')}, Apache-2.0 */` },
    legalComments: 'none',
    logLevel,
    ...more,
  });
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out, { recursive: true });
  // The stamp includes Emscripten's script: it shares short names with the module, which differ from build to build.
  const stamp = stampOf(...['abi.ts', 'fourdvt.js'].map((name) => readFileSync(join(wasmFolder, name))));
  const copyWasm = (from, to) => writeFileSync(join(out, to), stampWasm(withoutNames(readFileSync(from)), stamp));
  copyWasm(join(wasmFolder, 'fourdvt.wasm'), 'fourdvt-viewer.wasm');
  copyWasm(join(wasmFolder, 'fourdvt-more.wasm'), 'fourdvt-more.wasm');
  const workerWasm = readFileSync(join(wasmFolder, 'worker/fourdvt-worker.wasm'));
  const workerStamp = stampOf(stamp, workerWasm);
  writeFileSync(join(out, 'fourdvt-worker.wasm'), stampWasm(workerWasm, workerStamp));
  const define = { FOURDVT_WORKER: `"${workerStamp}"` };
  const emscripten = readFileSync(join(wasmFolder, 'fourdvt.js'), 'utf8');
  const [wasmScript, exportNames] = develop ? [emscripten, {}] : shortenExports(emscripten);
  const shortNames = develop ? {} : { mangleProps: new RegExp(`^(${Object.keys(exportNames).join('|')})$`), mangleCache: exportNames };
  await bundle(join(here, 'src/more.ts'), 'fourdvt-more.js', { define, ...shortNames });
  await bundle(join(here, 'src/decode/geometry-worker.ts'), 'fourdvt-worker.js', { format: 'iife', define });
  if (opencvFolder) {
    await bundle(join(opencvFolder, 'fourdvt-opencv.js'), 'fourdvt-opencv.js');
    copyWasm(join(opencvFolder, 'fourdvt-opencv.wasm'), 'fourdvt-opencv.wasm');
  }
  const version = stampOf(...readdirSync(out).sort().map((name) => readFileSync(join(out, name))));
  const script = join(out, 'fourdvt-wasm.js');
  writeFileSync(script, develop ? wasmScript : leaveOutFetching(wasmScript));
  const { metafile } = await bundle(join(here, 'src/fourdvt-viewer.ts'), 'fourdvt-viewer.js', {
    metafile: true,
    ...shortNames,
    alias: { 'fourdvt-wasm': script },
    define: { FOURDVT_STAMP: `"${stamp}"`, FOURDVT_VERSION: `"?v=${version}"`, FOURDVT_OPENCV: String(Boolean(opencvFolder)) },
  });
  rmSync(script);
  // Keeps the page's bundler from bundling the second part's script; the minifier drops such comments from the source.
  const viewer = join(out, 'fourdvt-viewer.js'), parts = readFileSync(viewer, 'utf8').split(/(?<=\bimport\()(?=\w+\))/);
  if (parts.length !== 2) throw new Error(`${viewer} has ${parts.length - 1} dynamic imports, not one`);
  writeFileSync(viewer, parts.join('/* webpackIgnore: true *//* @vite-ignore */'));
  if (develop) return;
  // Lengths of the page's modules in the script, for wasm/sizes.mjs.
  const modules = Object.entries(Object.values(metafile.outputs)[0].inputs).map(([path, { bytesInOutput }]) => [path.replace(/^.*\/(src|dist)\//, ''), bytesInOutput]);
  writeFileSync(join(wasmFolder, 'modules.json'), JSON.stringify({ script: viewer, modules: Object.fromEntries(modules) }));
  // Links for the page's <head>, which begin the downloads before the script requests them.
  writeFileSync(join(out, 'preload.html'), `<link rel="modulepreload" href="fourdvt-viewer/fourdvt-viewer.js">
<link rel="preload" as="fetch" crossorigin href="fourdvt-viewer/fourdvt-viewer.wasm?v=${version}">
<link rel="preload" as="fetch" crossorigin href="character/character.gltf">
<link rel="preload" as="fetch" crossorigin href="character/character.start.bin">
`);
}
