// SPDX-License-Identifier: Apache-2.0
// Compiles a wasm file once per page. Every viewer makes its own instance of it, so that removing a viewer frees all of
// its memory. Two modules have the same functions: the player, and the full player, which also has optical flow and
// characters from cameras and looks, and is fetched only when these are needed.
import createPlayer from 'fourdvt-wasm';

import type { FullModule, ModuleOptions, WasmModule } from './wasm-abi.js';
import { asViewerError, ViewerError } from './errors.js';
import { fetchFile, type Report } from './transport.js';

type CreateModule = (options: ModuleOptions) => Promise<WasmModule>;
type FullScript = typeof import('./full.js');

/** The full player, and the page's side of what only that has. */
export interface Full extends Omit<FullScript, 'default'> {
  module: FullModule;
}

const compiled = new Map<string, Promise<WebAssembly.Module>>();

// Whoever asks first hears of waiting for the network; all wait for the same download.
async function compile(url: string, report: Report): Promise<WebAssembly.Module> {
  const bytes = await fetchFile(url, report).catch((reason: unknown) => {
    throw new ViewerError('fetch-failed', `${asViewerError(reason).message}; the player's wasm file must lie beside its script`);
  });
  return WebAssembly.compile(bytes);
}

// A browser's refusal: by the page's policy, for want of memory, or of a file that is no wasm.
function refusal(url: string, reason: unknown): ViewerError {
  const text = String(reason);
  return reason instanceof RangeError || /memory/i.test(text)
    ? new ViewerError('out-of-memory', `${url}: the browser has no memory for the player (${text}); close other tabs`)
    : new ViewerError('wasm-refused', `${url}: the browser refuses the player's wasm (${text}); allow 'wasm-unsafe-eval' in the page's policy, and serve the file as it was built`);
}

async function create(createModule: CreateModule, url: string, report: Report): Promise<WasmModule> {
  let module = compiled.get(url);
  if (!module) {
    module = compile(url, report);
    compiled.set(url, module);
    module.catch(() => compiled.delete(url));
  }
  try {
    const ready = await module;
    return await new Promise((resolve, reject) => {
      createModule({
        instantiateWasm(imports, done) {
          WebAssembly.instantiate(ready, imports).then(done).catch(reject);
          return {};
        },
        printErr: (line) => console.warn(`fourdvt-viewer: ${line}`),
      }).then(resolve, reject);
    });
  } catch (reason) {
    throw reason instanceof ViewerError ? reason : refusal(url, reason);
  }
}

/**
 * `report` hears of waiting for the network. Errors: ViewerError 'fetch-failed', 'out-of-memory', 'wasm-refused'.
 */
export const instantiate = (url: string, report: Report): Promise<WasmModule> => create(createPlayer, url, report);

/** Loads fourdvt-full.js and its .wasm from beside the player's wasm file. Errors: as of `instantiate`. */
export async function instantiateFull(playerUrl: string, report: Report): Promise<Full> {
  const script = new URL('fourdvt-full.js', playerUrl).href;
  try {
    const { default: createModule, ...page } = (await import(script)) as FullScript;
    const module = await create(createModule, new URL('fourdvt-full.wasm', playerUrl).href, report);
    return { ...page, module: module as FullModule };
  } catch (reason) {
    if (reason instanceof ViewerError) throw reason;
    throw new ViewerError('fetch-failed', `${script}: the full player does not load (${String(reason)}); put it and its .wasm beside the player's`);
  }
}
