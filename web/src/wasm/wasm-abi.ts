// SPDX-License-Identifier: Apache-2.0
// The wasm modules as Emscripten makes them: the functions of wasm/abi.txt and what its runtime adds. Those of the second
// part are there from the start and must not be called before it is (wasm-module.ts). Addresses and
// handles are numbers.
import type { OpencvExports, PlayerExports } from './generated/abi.js';

export interface WasmModule extends PlayerExports {
  HEAPU8: Uint8Array;
  /** Called for align mode flow-opencv: does what fdvt_flow_farneback of wasm/abi.txt does, in this module's memory. */
  fourdvtFlow?(a: number, b: number, width: number, height: number, flow: number): number;
  GL: {
    registerContext(context: WebGL2RenderingContext, attributes: object): number;
    textures: (WebGLTexture | null)[];
  };
}

/** Calls a function of wasm/abi.txt that returns `ok`. */
export type PlayerCall = (module: WasmModule, handle: number) => number;

/** Runs before and after each tick of a player. */
export interface TurnHook {
  beforeTick(module: WasmModule, handle: number): void;
  afterTick(module: WasmModule, handle: number): void;
  /** The player is gone. */
  leave(): void;
}

export interface OpencvModule extends OpencvExports {
  HEAPU8: Uint8Array;
}

export interface ModuleOptions {
  instantiateWasm(imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void): object;
  printErr(line: string): void;
}
