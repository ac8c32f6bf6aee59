// SPDX-License-Identifier: Apache-2.0
// The C functions of wasm/exports.cpp. Pointers and handles are numbers.

export interface WasmModule {
  HEAPU8: Uint8Array;
  /** Optical flow of align 4: two grey pictures in wasm memory → 2 floats a pixel at `out`; 0 if it cannot. */
  fourdvtFlow?(a: number, b: number, width: number, height: number, out: number): number;
  GL: {
    registerContext(context: WebGL2RenderingContext, attributes: object): number;
    deleteContext(handle: number): void;
    textures: (WebGLTexture | null)[];
  };
  _fdvt_alloc(bytes: number): number;
  _fdvt_free(pointer: number): void;
  _fdvt_create(context: number, pictureKind: number, slots: number): number;
  /** Another character on the first one's context, device and renderer; freed before it. */
  _fdvt_create_beside(first: number, pictureKind: number, slots: number): number;
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
  _fdvt_decoder_failed(h: number, decoder: number, reason: number, size: number): void;
  _fdvt_acquire_slot(h: number, decoder: number, timestampUs: number): number;
  _fdvt_upload(h: number, slot: number, pixels: number, width: number, height: number, offsetY: number,
    strideY: number, offsetU: number, strideU: number, offsetV: number, strideV: number): void;
  _fdvt_slot_texture(h: number, slot: number): number;
  _fdvt_commit_slot(h: number, slot: number): void;
  _fdvt_invalidate_state(h: number): void;
  _fdvt_set_options(h: number, r: number, g: number, b: number, a: number, shadow: number, strength: number,
    samples: number, debug: number, debugLayer: number): void;
  _fdvt_set_parameter(h: number, name: number, size: number, value: number, atOnce: number): number;
  _fdvt_parameter(h: number, name: number, size: number): number;
  _fdvt_goto(h: number, name: number, size: number): number;
  _fdvt_set_travel(h: number, on: number): void;
  _fdvt_place(h: number, x: number, z: number, headingRad: number): void;
  _fdvt_steer(h: number, headingRad: number): void;
  /** 0 none, 1 baked, 2 flow (Farneback), 3 flow (DIS), 4 flow by fourdvtFlow. */
  _fdvt_set_align(h: number, align: number): number;
  _fdvt_clear_scene(h: number): void;
  /** corners × 6 floats: position in metres, colour 0..1. */
  _fdvt_add_scene_mesh(h: number, corners: number, count: number, occluderOnly: number): number;
  /** Handles of characters on one device, drawn together; the first one's options and scene count. */
  _fdvt_draw_group(handles: number, count: number, azimuth: number, elevation: number, distance: number, x: number,
    y: number, z: number, fov: number, width: number, height: number): number;
  _fdvt_draw(h: number, azimuth: number, elevation: number, distance: number, x: number, y: number, z: number,
    fov: number, width: number, height: number): number;
  _fdvt_state(h: number): number;
  _fdvt_character(h: number): number;
  _fdvt_sequence(h: number, index: number): number;
  _fdvt_sequence_parameter(h: number, sequence: number, index: number): number;
  _fdvt_sequence_member(h: number, sequence: number, index: number): number;
}

export interface ModuleOptions {
  instantiateWasm(imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void): object;
  printErr(line: string): void;
}
