// SPDX-License-Identifier: Apache-2.0
// Compiles each wasm file once per page, and makes instances. The module has two parts (wasm/more.txt): the first contains
// everything for the first picture of a layered character; the second, with optical flow, characters from cameras, scenes
// and looks, is linked to it later.
import createPlayer from 'fourdvt-wasm';

import { keep } from '../page/promises.js';
import type { PlayerFiles } from '../wasm/files.js';
import type { WasmModule } from '../wasm/wasm-abi.js';
import { asViewerError, ViewerError } from '../report/errors.js';
import { compileFile, fetchFile, type Report } from '../net/requests.js';

/** Exports of fourdvt-more.js. */
export type More = typeof import('../more.js');

type SecondPart = Pick<PlayerFiles, 'more' | 'moreWasm'>;

const BESIDE = "the player's files must lie beside its script";

const scripts = new Map<string, Promise<More>>(); // imports of fourdvt-more.js, done or pending, by address
let attempts = 0; // of importing a script; makes the address of a retry differ
const compiled = new Map<string, Promise<WebAssembly.Module>>();
const firstParts = new WeakMap<WasmModule, WebAssembly.Exports>();
const secondParts = new WeakMap<WasmModule, Promise<More>>();
const complete = new WeakSet<WasmModule>();

// Makes the error of a module that the browser does not compile: the page's policy, memory, or a file that is not wasm.
function refusal(url: string, reason: unknown): ViewerError {
  const text = String(reason);
  return reason instanceof RangeError || /memory/i.test(text)
    ? new ViewerError('out-of-memory', `${url}: the browser has no memory for the player (${text}); close other tabs`)
    : new ViewerError('wasm-refused', `${url}: the browser refuses the player's wasm (${text}); allow 'wasm-unsafe-eval' in the page's policy, and serve the file as it was built`);
}

// Compiles a file of this build. Fetches it again, past the cache, once, if it is of another build.
async function compileNew(url: string, report: Report, cache: RequestCache = 'default'): Promise<WebAssembly.Module> {
  const module = await compileFile(url, report, cache).catch((reason: unknown) => {
    if (!(reason instanceof ViewerError)) throw refusal(url, reason);
    throw new ViewerError('fetch-failed', `${asViewerError(reason).message}; ${BESIDE}`);
  });
  if (new TextDecoder().decode(WebAssembly.Module.customSections(module, 'fourdvt')[0]) === FOURDVT_STAMP) return module;
  if (cache === 'default') return compileNew(url, report, 'reload');
  throw new ViewerError('wasm-refused', `${url}: is of another build than the player's script; reload the page, or upload all files of the player again`);
}

// Compiles a file once for all callers; calls only the first caller's `report`.
const compile = (url: string, report: Report): Promise<WebAssembly.Module> => keep(compiled, url, () => compileNew(url, report));

// Placeholder of the second part's functions until that is loaded.
const absent = (): never => { throw new Error("the player's second part is not there yet"); };
const ABSENT = new Proxy({}, { get: () => absent });

// Returns the second part's imports from the first: exports by name, functions by index in the table (wasm/pack.mjs).
const importsOfSecond = (exports: WebAssembly.Exports): WebAssembly.ModuleImports => {
  const table = Object.values(exports).find((value) => value instanceof WebAssembly.Table);
  return new Proxy({}, { get: (_, name) => exports[name as string] ?? table?.get(Number(name)) });
};

/**
 * Instantiates the first part. report: called when waiting for the network begins and ends. Errors: ViewerError
 * 'fetch-failed', 'out-of-memory', 'wasm-refused'.
 */
export async function instantiate({ wasm: url }: Pick<PlayerFiles, 'wasm'>, report: Report): Promise<WasmModule> {
  const first = await compile(url, report);
  let exports: WebAssembly.Exports;
  try {
    const module = await new Promise<WasmModule>((resolve, reject) => {
      createPlayer({
        instantiateWasm(imports, done) {
          const all = { ...imports, placeholder: ABSENT };
          WebAssembly.instantiate(first, all).then((instance) => {
            exports = instance.exports;
            done(instance);
          }, reject);
          return {};
        },
        printErr: (line) => console.warn(`fourdvt-viewer: ${line}`),
      }).then(resolve, reject);
    });
    firstParts.set(module, exports!);
    return module;
  } catch (reason) {
    throw refusal(url, reason);
  }
}

/** Begins to download the second part. */
export const expectMore = ({ moreWasm }: SecondPart, report: Report): void => void compile(moreWasm, report).catch(() => undefined);

/** Returns true if the second part has been linked to this instance. */
export const hasMore = (module: WasmModule): boolean => complete.has(module);

/**
 * Links the second part, fourdvt-more.wasm, to an instance of the first, and imports fourdvt-more.js. Errors: those of
 * `instantiate`; the next call tries again.
 */
export function loadMore(module: WasmModule, files: SecondPart, report: Report): Promise<More> {
  return keep(secondParts, module, () => addSecond(module, files, report));
}

// Imports a script. Browsers do not report why an import has failed, and may not retry its address: then fetches the file,
// which waits for the network or fails with the cause, and imports it from another address.
async function importScript(script: string, report: Report): Promise<More> {
  const load = (address: string): Promise<More> => import(address) as Promise<More>;
  return load(script).catch(async () => {
    await fetchFile(script, report, undefined, { cache: 'reload' }).catch((reason: unknown) => {
      throw new ViewerError('fetch-failed', `${asViewerError(reason).message}; ${BESIDE}`);
    });
    const again = new URL(script);
    again.searchParams.set('try', String(++attempts));
    return load(again.href).catch((reason: unknown) => {
      throw new ViewerError('fetch-failed', `${script}: the browser does not run the player's second part (${String(reason)}); serve the file as it was built, as text/javascript, and let script-src of the page's policy allow it`);
    });
  });
}

async function addSecond(module: WasmModule, { more: script, moreWasm }: SecondPart, report: Report): Promise<More> {
  const [more, second] = await Promise.all([keep(scripts, script, () => importScript(script, report)), compile(moreWasm, report)]);
  if (!complete.has(module)) {
    await WebAssembly.instantiate(second, { first: importsOfSecond(firstParts.get(module)!) }).catch((reason: unknown) => {
      throw refusal(moreWasm, reason);
    });
    complete.add(module);
  }
  return more;
}
