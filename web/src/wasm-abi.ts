// SPDX-License-Identifier: Apache-2.0
// The C functions of wasm/exports.cpp. Pointers and handles are numbers.

export interface WasmModule {
  HEAPU8: Uint8Array;
  GL: {
    registerContext(context: WebGL2RenderingContext, attributes: object): number;
    deleteContext(handle: number): void;
    textures: (WebGLTexture | null)[];
  };
  _fdvt_alloc(bytes: number): number;
  _fdvt_free(pointer: number): void;
  _fdvt_create(context: number, pictureKind: number, slots: number): number;
  _fdvt_ready(h: number): number;
  _fdvt_destroy(h: number): void;
  _fdvt_error(h: number): number;
  _fdvt_manifest_number(h: number, pointer: number, size: number, value: number): void;
  _fdvt_manifest_string(h: number, pointer: number, size: number, value: number, valueSize: number): void;
  _fdvt_manifest_bool(h: number, pointer: number, size: number, value: number): void;
  _fdvt_load(h: number): number;
  _fdvt_play(h: number): void;
  _fdvt_pause(h: number): void;
  _fdvt_seek_frame(h: number, frame: number): void;
  _fdvt_seek(h: number, timeS: number): void;
  _fdvt_set_rate(h: number, rate: number): void;
  _fdvt_set_loop(h: number, loop: number): void;
  _fdvt_select(h: number, name: number, size: number): number;
  _fdvt_tick(h: number, nowS: number): void;
  _fdvt_next_request(h: number): number;
  _fdvt_next_event(h: number): number;
  _fdvt_range_received(h: number, id: number, bytes: number, size: number): void;
  _fdvt_range_failed(h: number, id: number, reason: number, size: number): void;
  _fdvt_decoder_failed(h: number, reason: number, size: number): void;
  _fdvt_acquire_slot(h: number, timestampUs: number): number;
  _fdvt_upload(h: number, slot: number, pixels: number, width: number, height: number, offsetY: number,
    strideY: number, offsetU: number, strideU: number, offsetV: number, strideV: number): void;
  _fdvt_slot_texture(h: number, slot: number): number;
  _fdvt_commit_slot(h: number, slot: number): void;
  _fdvt_invalidate_state(h: number): void;
  _fdvt_set_options(h: number, r: number, g: number, b: number, a: number, shadow: number, strength: number,
    samples: number, debug: number, debugLayer: number): void;
  _fdvt_draw(h: number, azimuth: number, elevation: number, distance: number, x: number, y: number, z: number,
    fov: number, width: number, height: number): number;
  _fdvt_state(h: number): number;
  _fdvt_character(h: number): number;
  _fdvt_sequence(h: number, index: number): number;
}

export interface ModuleOptions {
  instantiateWasm(imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void): object;
  printErr(line: string): void;
}
