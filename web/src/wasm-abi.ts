// SPDX-License-Identifier: Apache-2.0
// The wasm modules as Emscripten makes them: the functions of wasm/abi.txt and what its runtime adds. Addresses and
// handles are numbers.
import type { FullExports, OpencvExports, PlayerExports } from './generated/abi.js';

export interface WasmModule extends PlayerExports {
  HEAPU8: Uint8Array;
  /** Called for align mode flow-opencv: does what fdvt_flow_farneback of wasm/abi.txt does, in this module's memory. */
  fourdvtFlow?(a: number, b: number, width: number, height: number, flow: number): number;
  GL: {
    registerContext(context: WebGL2RenderingContext, attributes: object): number;
    deleteContext(handle: number): void;
    textures: (WebGLTexture | null)[];
  };
}

export interface FullModule extends WasmModule, FullExports {}

export interface OpencvModule extends OpencvExports {
  HEAPU8: Uint8Array;
}

export interface ModuleOptions {
  instantiateWasm(imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void): object;
  printErr(line: string): void;
}
