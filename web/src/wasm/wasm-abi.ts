// SPDX-License-Identifier: Apache-2.0
// Types of the wasm modules that Emscripten makes: the functions of wasm/abi.txt and those of Emscripten's runtime.
// Functions of the second part always exist, but throw until it is loaded (wasm-module.ts). Addresses and handles are
// numbers.
import type { OpencvExports, PlayerExports } from './generated/abi.js';

export interface WasmModule extends PlayerExports {
  HEAPU8: Uint8Array;
  /** Implements fdvt_flow_farneback of wasm/abi.txt in this module's memory, for align mode flow-opencv. */
  fourdvtFlow?(a: number, b: number, width: number, height: number, flow: number): number;
  GL: {
    registerContext(context: WebGL2RenderingContext, attributes: object): number;
    textures: (WebGLTexture | null)[];
  };
}

/** Callback that calls one function of wasm/abi.txt and returns its `ok`. */
export type PlayerCall = (module: WasmModule, handle: number) => number;

/** Callbacks before and after each tick of a player. */
export interface TurnHook {
  beforeTick(module: WasmModule, handle: number): void;
  afterTick(module: WasmModule, handle: number): void;
  /** Called when the player is disposed of or gets another hook. */
  leave(): void;
}

export interface OpencvModule extends OpencvExports {
  HEAPU8: Uint8Array;
}

export interface ModuleOptions {
  instantiateWasm(imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void): object;
  printErr(line: string): void;
}
