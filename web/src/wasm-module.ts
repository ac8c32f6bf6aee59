// SPDX-License-Identifier: Apache-2.0
// Compiles a wasm file once per page. Every viewer makes its own instance of it, so that removing a viewer frees all of
// its memory. Two modules have the same functions: the player, and the player with optical flow, which is fetched only
// when it is asked for.
import createPlayer from 'fourdvt-wasm';

import type { ModuleOptions, WasmModule } from './wasm-abi.js';
import { ViewerError } from './errors.js';

type CreateModule = (options: ModuleOptions) => Promise<WasmModule>;

const compiled = new Map<string, Promise<WebAssembly.Module>>();

async function compile(url: string): Promise<WebAssembly.Module> {
  const response = await fetch(url, { credentials: 'same-origin' }).catch(() => undefined);
  if (!response?.ok) {
    throw new ViewerError('fetch-failed', `${url}: ${response ? `HTTP ${response.status}` : 'network error'}; the player's wasm file must lie beside its script`);
  }
  return WebAssembly.compile(await response.arrayBuffer());
}

async function create(createModule: CreateModule, url: string): Promise<WasmModule> {
  let module = compiled.get(url);
  if (!module) {
    module = compile(url);
    compiled.set(url, module);
    module.catch(() => compiled.delete(url));
  }
  const ready = await module;
  return createModule({
    instantiateWasm(imports, done) {
      void WebAssembly.instantiate(ready, imports).then(done);
      return {};
    },
    printErr: (line) => console.warn(`fourdvt-viewer: ${line}`),
  });
}

export const instantiate = (url: string): Promise<WasmModule> => create(createPlayer, url);

/** Loads fourdvt-flow.js and its .wasm from beside the player's wasm file. Errors: ViewerError 'fetch-failed'. */
export async function instantiateWithFlow(playerUrl: string): Promise<WasmModule> {
  const script = new URL('fourdvt-flow.js', playerUrl).href;
  try {
    const { default: createModule } = (await import(script)) as { default: CreateModule };
    return await create(createModule, new URL('fourdvt-flow.wasm', playerUrl).href);
  } catch (reason) {
    if (reason instanceof ViewerError) throw reason;
    throw new ViewerError('fetch-failed', `${script}: the optical-flow module does not load (${String(reason)}); put it and its .wasm beside the player's`);
  }
}
