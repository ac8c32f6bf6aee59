// SPDX-License-Identifier: Apache-2.0
// Typed owner of one player handle in wasm memory. Does not fetch, decode or schedule anything.
// Byte views handed out (request data) are valid until the next call; copy what must last.
import { ViewerError, type ErrorDetail } from './errors.js';
import { flattenJson } from './flat-json.js';
import type { WasmModule } from './wasm-abi.js';

export type PictureKind = 'i420' | 'rgba';

export type PlayerRequest =
  | { kind: 'fetch'; id: number; uri: string; offset: number; bytes: number }
  | { kind: 'cancel'; id: number }
  | { kind: 'configure'; decoder: number; codec: string; description: Uint8Array; width: number; height: number }
  | { kind: 'decode'; decoder: number; bytes: Uint8Array; timestampUs: number; key: boolean }
  | { kind: 'flush' | 'reset' | 'close'; decoder: number };

export interface PlayerEvent {
  name: string;
  error: ErrorDetail;
  loadedBytes: number;
  totalBytes: number;
}

export interface PlayerState {
  hasFrame: boolean;
  paused: boolean;
  frame: number;
  sequence: number;
  /** What is wanted is not on screen yet. */
  seeking: boolean;
  currentTime: number;
  framesShown: number;
  framesLate: number;
  barcodeChecked: number;
  barcodeMismatches: number;
  bytesFetched: number;
  encodedBytesHeld: number;
  draws: number;
  liveTextures: number;
  liveTextureBytes: number;
  /** Where the character stands: metres, degrees from +z towards +x. */
  x: number;
  z: number;
  heading: number;
  inTransition: boolean;
  /** The state asked for last. */
  goal: string;
}

export interface ParameterInfo {
  name: string;
  min: number;
  max: number;
}

export interface SequenceInfo {
  name: string;
  frames: number;
  loop: boolean;
  fps: number;
  duration: number;
  /** None: a plain motion; else a class of motions. */
  parameters: ParameterInfo[];
  /** Captured motions of a class. */
  members: string[];
}

export type Align = 'none' | 'baked' | 'flow-gpu' | 'flow-dis' | 'flow-opencv';

export interface SceneMesh {
  /** 6 numbers a corner, 3 corners a triangle: position in metres, colour 0..1. */
  corners: Float32Array;
  /** Hides characters without being seen itself. */
  occluderOnly?: boolean;
}

export interface CharacterInfo {
  name: string;
  posterUri: string;
  min: [number, number, number];
  max: [number, number, number];
  groundY: number;
  layers: number;
  vertices: number;
  faces: number;
  sequences: SequenceInfo[];
}

export interface RenderOptions {
  /** Premultiplied sRGB, 0..1; alpha 0 lets the page show through. */
  background: [number, number, number, number];
  groundShadow: boolean;
  shadowStrength: number;
  samples: number;
  debug: 'none' | 'labels' | 'layer' | 'weights' | 'normals';
  debugLayer: number;
}

export interface OrbitPose {
  azimuth: number;
  elevation: number;
  distance: number;
  target: [number, number, number];
  fov: number;
}

export interface Planes {
  width: number;
  height: number;
  /** Offset and stride of each plane; an NV12 picture has two. */
  layout: { offset: number; stride: number }[];
}

const ALIGNS: Align[] = ['none', 'baked', 'flow-gpu', 'flow-dis', 'flow-opencv'];
const DEBUG_VIEWS = ['none', 'labels', 'layer', 'weights', 'normals'];
const RADIANS = Math.PI / 180;
const encoder = new TextEncoder();
const decoder = new TextDecoder();

export class WasmPlayer {
  readonly #m: WasmModule;
  #h = 0;
  #context = 0;
  #scratch = 0;
  #scratchBytes = 0;

  /** `on`: the canvas's context, or another character that is drawn into the same canvas and outlives this one. */
  constructor(module: WasmModule, on: WebGL2RenderingContext | WasmPlayer, kind: PictureKind, slots: number) {
    this.#m = module;
    const rgba = kind === 'rgba' ? 1 : 0;
    if (on instanceof WasmPlayer) {
      this.#h = module._fdvt_create_beside(on.#h, rgba, slots);
    } else {
      this.#context = module.GL.registerContext(on, { majorVersion: 2, minorVersion: 0, enableExtensionsByDefault: true });
      this.#h = module._fdvt_create(this.#context, rgba, slots);
    }
    if (!module._fdvt_ready(this.#h)) {
      const error = this.#lastError();
      this.dispose();
      throw error;
    }
  }

  dispose(): void {
    if (!this.#h) return;
    this.#m._fdvt_destroy(this.#h);
    this.#m._fdvt_free(this.#scratch);
    if (this.#context) this.#m.GL.deleteContext(this.#context);
    this.#h = this.#scratch = this.#scratchBytes = 0;
  }

  loadManifest(json: unknown): void {
    flattenJson(json, (pointer, value) => {
      const key = encoder.encode(pointer);
      if (typeof value === 'string') {
        const text = encoder.encode(value);
        const at = this.#put(key, text);
        this.#m._fdvt_manifest_string(this.#h, at, key.length, at + key.length, text.length);
      } else if (typeof value === 'number') {
        this.#m._fdvt_manifest_number(this.#h, this.#put(key), key.length, value);
      } else {
        this.#m._fdvt_manifest_bool(this.#h, this.#put(key), key.length, value ? 1 : 0);
      }
    });
    if (!this.#m._fdvt_load(this.#h)) throw this.#lastError();
  }

  play(): void { this.#m._fdvt_play(this.#h); }
  pause(): void { this.#m._fdvt_pause(this.#h); }
  seekFrame(frame: number): void { this.#m._fdvt_seek_frame(this.#h, frame); }
  seek(timeS: number): void { this.#m._fdvt_seek(this.#h, timeS); }
  setRate(rate: number): void { this.#m._fdvt_set_rate(this.#h, rate); }
  /** -1 as the sequence says, 0 never, 1 always. */
  setLoop(loop: number): void { this.#m._fdvt_set_loop(this.#h, loop); }
  tick(nowS: number): void { this.#m._fdvt_tick(this.#h, nowS); }

  selectSequence(name: string): void {
    const text = encoder.encode(name);
    if (!this.#m._fdvt_select(this.#h, this.#put(text), text.length)) throw this.#lastError();
  }

  nextRequest(): PlayerRequest | null {
    const p = this.#m._fdvt_next_request(this.#h);
    if (!p) return null;
    const v = this.#view();
    const id = v.getUint32(p + 4, true);
    const decoder = v.getInt32(p + 36, true);
    switch (v.getInt32(p, true)) {
      case 1: return { kind: 'fetch', id, uri: this.#text(p + 8), offset: v.getFloat64(p + 40, true), bytes: v.getFloat64(p + 48, true) };
      case 2: return { kind: 'cancel', id };
      case 3: return { kind: 'configure', decoder, codec: this.#text(p + 8), description: this.#bytes(p + 16), width: v.getInt32(p + 24, true), height: v.getInt32(p + 28, true) };
      case 4: return { kind: 'decode', decoder, bytes: this.#bytes(p + 16), timestampUs: v.getFloat64(p + 56, true), key: v.getInt32(p + 32, true) !== 0 };
      case 5: return { kind: 'flush', decoder };
      case 6: return { kind: 'reset', decoder };
      default: return { kind: 'close', decoder };
    }
  }

  nextEvent(): PlayerEvent | null {
    const p = this.#m._fdvt_next_event(this.#h);
    if (!p) return null;
    const v = this.#view();
    return {
      name: this.#text(p),
      error: { id: this.#text(p + 12), message: this.#text(p + 20) },
      loadedBytes: v.getFloat64(p + 32, true),
      totalBytes: v.getFloat64(p + 40, true),
    };
  }

  rangeReceived(id: number, bytes: Uint8Array): void {
    const at = this.#m._fdvt_alloc(bytes.length || 1);
    this.#m.HEAPU8.set(bytes, at);
    this.#m._fdvt_range_received(this.#h, id, at, bytes.length);
    this.#m._fdvt_free(at);
  }
  rangeFailed(id: number, reason: string): void {
    const text = encoder.encode(reason);
    this.#m._fdvt_range_failed(this.#h, id, this.#put(text), text.length);
  }
  decoderFailed(decoder: number, reason: string): void {
    const text = encoder.encode(reason);
    this.#m._fdvt_decoder_failed(this.#h, decoder, this.#put(text), text.length);
  }

  /** A slot, or -1 (none free now) or -2 (nobody waits for it). */
  acquireSlot(decoder: number, timestampUs: number): number {
    return this.#m._fdvt_acquire_slot(this.#h, decoder, timestampUs);
  }

  /** Uploads the planes and commits the slot. */
  upload(slot: number, pixels: Uint8Array, planes: Planes): void {
    const at = this.#put(pixels);
    const [y, u, v] = planes.layout;
    if (!y || !u) throw new ViewerError('video-invalid', 'a decoded picture without planes');
    this.#m._fdvt_upload(this.#h, slot, at, planes.width, planes.height, y.offset, y.stride, u.offset, u.stride,
      v ? v.offset : 0, v ? v.stride : 0);
  }
  slotTexture(slot: number): WebGLTexture | null {
    return this.#m.GL.textures[this.#m._fdvt_slot_texture(this.#h, slot)] ?? null;
  }
  /** After the page filled the slot's texture itself. */
  commitSlot(slot: number): void { this.#m._fdvt_commit_slot(this.#h, slot); }
  invalidateState(): void { this.#m._fdvt_invalidate_state(this.#h); }

  setOptions(o: RenderOptions): void {
    this.#m._fdvt_set_options(this.#h, ...o.background, o.groundShadow ? 1 : 0, o.shadowStrength, o.samples,
      Math.max(0, DEBUG_VIEWS.indexOf(o.debug)), o.debugLayer);
  }
  /** `others`: characters created beside this one, drawn into the same picture. */
  draw(pose: OrbitPose, width: number, height: number, others: WasmPlayer[] = []): void {
    const { azimuth, elevation, distance, target, fov } = pose;
    let ok: number;
    if (others.length) {
      const handles = new Uint8Array(Uint32Array.of(this.#h, ...others.map((other) => other.#h)).buffer);
      ok = this.#m._fdvt_draw_group(this.#put(handles), others.length + 1, azimuth, elevation, distance, ...target, fov, width, height);
    } else {
      ok = this.#m._fdvt_draw(this.#h, azimuth, elevation, distance, ...target, fov, width, height);
    }
    if (!ok) throw this.#lastError();
  }

  // --- motion ---

  setParameter(name: string, value: number, atOnce: boolean): void {
    const text = encoder.encode(name);
    if (!this.#m._fdvt_set_parameter(this.#h, this.#put(text), text.length, value, atOnce ? 1 : 0)) throw this.#lastError();
  }
  /** As shown; NaN if no class has it. */
  parameter(name: string): number {
    const text = encoder.encode(name);
    return this.#m._fdvt_parameter(this.#h, this.#put(text), text.length);
  }
  goTo(state: string): void {
    const text = encoder.encode(state);
    if (!this.#m._fdvt_goto(this.#h, this.#put(text), text.length)) throw this.#lastError();
  }
  setTravel(on: boolean): void { this.#m._fdvt_set_travel(this.#h, on ? 1 : 0); }
  place(x: number, z: number, headingDeg: number): void { this.#m._fdvt_place(this.#h, x, z, headingDeg * RADIANS); }
  steer(headingDeg: number): void { this.#m._fdvt_steer(this.#h, headingDeg * RADIANS); }
  setAlign(align: Align): void {
    if (!this.#m._fdvt_set_align(this.#h, ALIGNS.indexOf(align))) throw this.#lastError();
  }
  setScene(meshes: SceneMesh[]): void {
    this.#m._fdvt_clear_scene(this.#h);
    for (const { corners, occluderOnly } of meshes) {
      const at = this.#put(new Uint8Array(corners.buffer, corners.byteOffset, corners.byteLength));
      if (!this.#m._fdvt_add_scene_mesh(this.#h, at, corners.length / 6, occluderOnly ? 1 : 0)) throw this.#lastError();
    }
  }

  state(): PlayerState {
    const p = this.#m._fdvt_state(this.#h);
    const v = this.#view();
    const real = (index: number): number => v.getFloat64(p + 24 + 8 * index, true);
    return {
      hasFrame: v.getInt32(p, true) !== 0,
      paused: v.getInt32(p + 4, true) !== 0,
      frame: v.getInt32(p + 8, true),
      sequence: v.getInt32(p + 12, true),
      seeking: v.getInt32(p + 16, true) !== 0,
      currentTime: real(0),
      framesShown: real(1),
      framesLate: real(2),
      barcodeChecked: real(3),
      barcodeMismatches: real(4),
      bytesFetched: real(5),
      encodedBytesHeld: real(6),
      draws: real(7),
      liveTextures: real(8),
      liveTextureBytes: real(9),
      x: real(10),
      z: real(11),
      heading: real(12) / RADIANS,
      inTransition: v.getInt32(p + 20, true) !== 0,
      goal: this.#text(p + 128),
    };
  }

  /** Null before the manifest is read. */
  character(): CharacterInfo | null {
    const p = this.#m._fdvt_character(this.#h);
    if (!p) return null;
    const v = this.#view();
    const real = (index: number): number => v.getFloat64(p + 8 * index, true);
    const info: CharacterInfo = {
      name: this.#text(p + 72),
      posterUri: this.#text(p + 80),
      min: [real(0), real(1), real(2)],
      max: [real(3), real(4), real(5)],
      groundY: real(6),
      layers: v.getInt32(p + 56, true),
      vertices: v.getInt32(p + 60, true),
      faces: v.getInt32(p + 64, true),
      sequences: [],
    };
    const count = v.getInt32(p + 68, true);
    for (let i = 0; i < count; ++i) info.sequences.push(this.#sequence(i));
    return info;
  }

  #sequence(index: number): SequenceInfo {
    const p = this.#m._fdvt_sequence(this.#h, index);  // the block stays until the next fdvt_sequence
    const v = this.#view();
    return {
      name: this.#text(p),
      frames: v.getInt32(p + 8, true),
      loop: v.getInt32(p + 12, true) !== 0,
      fps: v.getFloat64(p + 16, true),
      duration: v.getFloat64(p + 24, true),
      parameters: Array.from({ length: v.getInt32(p + 32, true) }, (_, i) => this.#parameter(index, i)),
      members: Array.from({ length: v.getInt32(p + 36, true) }, (_, i) =>
        this.#text(this.#m._fdvt_sequence_member(this.#h, index, i))),
    };
  }
  #parameter(sequence: number, index: number): ParameterInfo {
    const p = this.#m._fdvt_sequence_parameter(this.#h, sequence, index);
    const v = this.#view();
    return { name: this.#text(p), min: v.getFloat64(p + 8, true), max: v.getFloat64(p + 16, true) };
  }

  #lastError(): ViewerError {
    const p = this.#m._fdvt_error(this.#h);
    return new ViewerError(this.#text(p + 4), this.#text(p + 12));
  }
  #view(): DataView { return new DataView(this.#m.HEAPU8.buffer); }
  #bytes(at: number): Uint8Array {
    const v = this.#view();
    const start = v.getUint32(at, true);
    return this.#m.HEAPU8.subarray(start, start + v.getUint32(at + 4, true));
  }
  #text(at: number): string { return decoder.decode(this.#bytes(at)); }

  // Copies the parts one after the other into scratch memory that lasts until the next call.
  #put(...parts: Uint8Array[]): number {
    const size = parts.reduce((sum, part) => sum + part.length, 0);
    if (size > this.#scratchBytes) {
      this.#m._fdvt_free(this.#scratch);
      this.#scratchBytes = Math.max(size, 4096);
      this.#scratch = this.#m._fdvt_alloc(this.#scratchBytes);
    }
    let at = this.#scratch;
    for (const part of parts) {
      this.#m.HEAPU8.set(part, at);
      at += part.length;
    }
    return this.#scratch;
  }
}
