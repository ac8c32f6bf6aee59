// SPDX-License-Identifier: Apache-2.0
// Emscripten's generated module; build.mjs resolves the name to the folder given with --wasm.
declare module 'fourdvt-wasm' {
  const createModule: (options: import('./wasm-abi.js').ModuleOptions) => Promise<import('./wasm-abi.js').WasmModule>;
  export default createModule;
}
