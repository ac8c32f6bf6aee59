// SPDX-License-Identifier: Apache-2.0
// The module that Emscripten makes. build.mjs replaces its name by the file in the folder given with --wasm, and the
// constants by texts.

/** The section `fourdvt` of the wasm files that were built with this script. */
declare const FOURDVT_STAMP: string;
/** Stamp of fourdvt-worker.wasm, shared with the scripts that use it. */
declare const FOURDVT_WORKER: string;
/** A query that names the content of the files beside this script, so that no cache has earlier ones under it. */
declare const FOURDVT_VERSION: string;
/** OpenCV's flow was built. */
declare const FOURDVT_OPENCV: boolean;

declare module 'fourdvt-wasm' {
  const createModule: (options: import('../wasm/wasm-abi.js').ModuleOptions) => Promise<import('../wasm/wasm-abi.js').WasmModule>;
  export default createModule;
}
