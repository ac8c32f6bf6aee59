// SPDX-License-Identifier: Apache-2.0
// Declares Emscripten's module, whose name build.mjs resolves to the script in the folder of --wasm, and constants that
// build.mjs replaces by their values.

/** Content of the custom section `fourdvt` in the wasm files of this build. */
declare const FOURDVT_STAMP: string;
/** Stamp of fourdvt-worker.wasm, shared with the scripts that use it. */
declare const FOURDVT_WORKER: string;
/** Query for addresses of the files beside this script: a hash of their content, so that caches have no older files. */
declare const FOURDVT_VERSION: string;
/** True if OpenCV's flow was built. */
declare const FOURDVT_OPENCV: boolean;

declare module 'fourdvt-wasm' {
  const createModule: (options: import('../wasm/wasm-abi.js').ModuleOptions) => Promise<import('../wasm/wasm-abi.js').WasmModule>;
  export default createModule;
}
