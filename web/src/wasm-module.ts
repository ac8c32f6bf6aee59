// SPDX-License-Identifier: Apache-2.0
// Loads the wasm file once a page; every viewer instantiates it for itself, so that removing a viewer frees all of it.
import createModule from 'fourdvt-wasm';

import type { WasmModule } from './wasm-abi.js';
import { ViewerError } from './errors.js';

const compiled = new Map<string, Promise<WebAssembly.Module>>();

async function compile(url: string): Promise<WebAssembly.Module> {
  const response = await fetch(url, { credentials: 'same-origin' }).catch(() => undefined);
  if (!response?.ok) {
    throw new ViewerError('fetch-failed', `${url}: ${response ? `HTTP ${response.status}` : 'network error'}; the player's wasm file must lie beside its script`);
  }
  return WebAssembly.compile(await response.arrayBuffer());
}

export async function instantiate(url: string): Promise<WasmModule> {
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
