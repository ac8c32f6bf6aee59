// SPDX-License-Identifier: Apache-2.0
// The module that Emscripten makes. build.mjs replaces its name by the file in the folder given with --wasm.
declare module 'fourdvt-wasm' {
  const createModule: (options: import('./wasm-abi.js').ModuleOptions) => Promise<import('./wasm-abi.js').WasmModule>;
  export default createModule;
}
