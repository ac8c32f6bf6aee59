// SPDX-License-Identifier: Apache-2.0
// Owns one player's handle and wraps its C functions with types. Does not fetch, decode or schedule anything. The data of
// a request is a view into wasm memory, valid until the next call.
import type { Planes } from '../decode/frame-decoder.js';
import type { Quality } from '../page/quality-attribute.js';
import { ViewerError } from '../report/errors.js';
import { flattenJson } from '../wasm/flat-json.js';
import {
  ALIGN_MODES, bytesOfOptions, bytesOfPlanes, bytesOfView, DECODER_FAULTS, PICTURE_KINDS, readCharacter, readError,
  readEvent, readParameter, readRequest, readSequence, readState, VISIBILITIES, type AlignMode, type DebugView, type DecoderFault,
  type EventRecord, type ParameterRecord, type PictureKind, type RequestRecord, type StateRecord, type Visibility,
} from '../wasm/generated/abi.js';
import { Reader } from '../wasm/records.js';
import type { PlayerCall, TurnHook, WasmModule } from '../wasm/wasm-abi.js';
import { hasMore } from './wasm-module.js';

export { ALIGN_MODES, VISIBILITIES };
export type { PictureKind, Quality, PlayerCall, Visibility };
/** Request of the player; only the fields of its kind are set, see wasm/abi.txt. */
export type PlayerRequest = RequestRecord;
export type PlayerEvent = EventRecord;
export type Align = AlignMode;
export type ParameterInfo = ParameterRecord;

export interface Placement {
  /** Position on the ground, metres. */
  x: number;
  z: number;
  /** Heading, degrees from +z towards +x. */
  heading: number;
}

export interface PlayerState extends StateRecord, Placement {
  /** Bytes allocated in the module's memory; 0 until the second part is loaded. */
  readonly heapBytes: number;
}

export interface SequenceInfo {
  name: string;
  frames: number;
  loop: boolean;
  fps: number;
  duration: number;
  /** Parameters: at least one for a class of motions, none for a plain motion. */
  parameters: ParameterInfo[];
  /** Names of a class's captured motions. */
  members: string[];
}

export interface SceneMesh {
  /** Triangles: 3 corners of 6 numbers each, position in metres and colour in 0..1. */
  corners: Float32Array;
  /** True: the mesh hides characters without being drawn itself. */
  occluderOnly?: boolean;
}

/** Drawing method of a character from cameras. */
export interface Method {
  /** Name; empty: the character's own method. */
  name: string;
  /** Number of cameras, those nearest to the view; 0: the maximum. */
  closest: number;
  visibility: Visibility;
}

export interface CharacterInfo {
  name: string;
  /** True if textured from the cameras' pictures instead of layers. */
  fromCameras: boolean;
  /** Default drawing method; empty for a character from layers. */
  method: string;
  /** True if the start file had the base mesh; false: it is fetched, and decoded by the second part. */
  hasMesh: boolean;
  posterUri: string;
  /** Address of the room's picture; empty without a room. */
  roomUri: string;
  roomBytes: number;
  min: [number, number, number];
  max: [number, number, number];
  groundY: number;
  sequences: SequenceInfo[];
}

export interface RenderOptions {
  /** Background: premultiplied sRGB and alpha in 0..1; the page shows through where alpha is below 1. */
  background: [number, number, number, number];
  groundShadow: boolean;
  shadowStrength: number;
  samples: number;
  debug: DebugView;
  debugLayer: number;
}

export interface OrbitPose {
  azimuth: number;
  elevation: number;
  distance: number;
  target: [number, number, number];
  fov: number;
}

/** Settings of a character that a page can change. */
export interface Settings {
  /** Loop mode: -1 as stored with the sequence, 0 never, 1 always. */
  loop: number;
  rate: number;
  placement: Placement;
  travel: boolean;
  align: Align;
  method: Method;
  quality: Quality | null;
  /** Render options; like `scene` a property of the canvas, set on its main character only. */
  options: RenderOptions | null;
  scene: SceneMesh[] | null;
  /** Null: the first sequence of the character. */
  sequence: string | null;
  frame: number;
  /** Position in the sequence, seconds; null: `frame` applies. */
  time: number | null;
  playing: boolean;
}

const RADIANS = Math.PI / 180;
const SMALLEST_SCRATCH_BYTES = 4096;
const encoder = new TextEncoder();

export class WasmPlayer {
  readonly #m: WasmModule;
  #h = 0;
  #scratch = 0;
  #scratchBytes = 0;
  #scene: SceneMesh[] | null = null; // to be set when the second part is loaded

  /** Functions that apply one setting each. Errors: ViewerError. */
  readonly set: { readonly [Name in keyof Settings]: (value: NonNullable<Settings[Name]>) => void } = {
    loop: (mode) => this.#m._fdvt_set_loop(this.#h, mode),
    rate: (rate) => this.#m._fdvt_set_rate(this.#h, rate),
    placement: ({ x, z, heading }) => this.#m._fdvt_place(this.#h, x, z, heading * RADIANS),
    travel: (on) => this.#m._fdvt_set_travel(this.#h, on ? 1 : 0),
    align: (align) => this.#check(this.#m._fdvt_set_align(this.#h, ALIGN_MODES.indexOf(align))),
    method: ({ name, closest, visibility }) => {
      if (!this.character()?.fromCameras) return; // layered characters have no method
      this.#check(this.#m._fdvt_set_method(this.#h, ...this.#text(name), closest, VISIBILITIES.indexOf(visibility)));
    },
    quality: ({ rendition, maxTexels }) => this.#m._fdvt_set_quality(this.#h, rendition, maxTexels),
    options: (options) => this.#m._fdvt_set_options(this.#h, this.#put(bytesOfOptions(options))),
    scene: (meshes) => this.#setScene(meshes),
    sequence: (name) => this.#check(this.#m._fdvt_select(this.#h, ...this.#text(name))),
    frame: (frame) => this.#m._fdvt_seek_frame(this.#h, frame),
    time: (timeS) => this.#m._fdvt_seek(this.#h, timeS),
    playing: (on) => (on ? this.#m._fdvt_play(this.#h) : this.#m._fdvt_pause(this.#h)),
  };

  /**
   * on: a context registered in the module, or another character whose canvas to share, which must outlive this one.
   * readable: textures can be read back; otherwise frames of pictures are identified by timestamp instead of barcode.
   */
  constructor(module: WasmModule, on: number | WasmPlayer, kind: PictureKind, readable: boolean, slots: number) {
    this.#m = module;
    const kindNumber = PICTURE_KINDS.indexOf(kind);
    if (on instanceof WasmPlayer) this.#h = module._fdvt_create_beside(on.#h, kindNumber, Number(readable), slots);
    else this.#h = module._fdvt_create(on, kindNumber, Number(readable), slots);
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
    this.#h = this.#scratch = this.#scratchBytes = 0;
  }

  /** Loads the manifest. start: content of the start file; empty without one. */
  loadManifest(json: unknown, start: Uint8Array, load?: PlayerCall): void {
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
    this.#check(load ? load(this.#m, this.#h) : this.#m._fdvt_load(this.#h, this.#put(start), start.length));
  }

  tick(nowS: number, hook: TurnHook | null): void {
    hook?.beforeTick(this.#m, this.#h);
    this.#m._fdvt_tick(this.#h, nowS);
    hook?.afterTick(this.#m, this.#h);
  }

  nextRequest(): PlayerRequest | null {
    const at = this.#m._fdvt_next_request(this.#h);
    return at ? readRequest(this.#m.HEAPU8, at) : null;
  }
  nextEvent(): PlayerEvent | null {
    const at = this.#m._fdvt_next_event(this.#h);
    return at ? readEvent(this.#m.HEAPU8, at) : null;
  }

  rangeReceived(id: number, bytes: Uint8Array): void {
    const at = this.#m._fdvt_alloc(bytes.length || 1);
    this.#m.HEAPU8.set(bytes, at);
    this.#m._fdvt_range_received(this.#h, id, at, bytes.length);
    this.#m._fdvt_free(at);
  }
  rangeFailed(id: number, reason: string): void { this.#m._fdvt_range_failed(this.#h, id, ...this.#text(reason)); }
  decoderFailed(decoder: number, fault: DecoderFault, reason: string): void {
    this.#m._fdvt_decoder_failed(this.#h, decoder, DECODER_FAULTS.indexOf(fault), ...this.#text(reason));
  }
  setInSight(inSight: boolean): void { this.#m._fdvt_set_in_sight(this.#h, inSight ? 1 : 0); }

  /** Returns a slot for the picture; -1 if none is free at present, -2 if the player does not need this picture. */
  acquireSlot(decoder: number, timestampUs: number): number {
    return this.#m._fdvt_acquire_slot(this.#h, decoder, timestampUs);
  }

  /** Commits a slot with planes in a block of the player's memory; the player takes ownership of the block. */
  upload(slot: number, block: number, { width, height, layout }: Planes): void {
    const [y, u, v] = layout;
    if (!y || !u) throw new ViewerError('video-invalid', 'a decoded picture has no planes');
    this.#m._fdvt_upload(this.#h, slot, block, this.#put(bytesOfPlanes({
      width, height, offsetY: y.offset, strideY: y.stride, offsetU: u.offset, strideU: u.stride,
      offsetV: v?.offset ?? 0, strideV: v?.stride ?? 0,
    })));
  }
  slotTexture(slot: number): WebGLTexture | null {
    return this.#m.GL.textures[this.#m._fdvt_slot_texture(this.#h, slot)] ?? null;
  }
  /** Commits a slot after the page has filled its texture with a picture of this size. */
  commitSlot(slot: number, width: number, height: number): void {
    this.#m._fdvt_commit_slot(this.#h, slot, width, height);
  }
  /** Pictures per second to be decoded by a decoder with its own clock; 0: only a sought one. Needs the second part. */
  pace(decoder: number): number { return this.#m._fdvt_pace(this.#h, decoder); }
  invalidateState(): void { this.#m._fdvt_invalidate_state(this.#h); }

  /** Draws this character and others of its canvas into one picture. */
  draw(pose: OrbitPose, width: number, height: number, others: WasmPlayer[] = []): void {
    const view = bytesOfView({ ...pose, width, height });
    const handles = Uint32Array.of(this.#h, ...others.map((other) => other.#h));
    const at = this.#put(view, new Uint8Array(handles.buffer));
    this.#check(this.#m._fdvt_draw(at + view.length, handles.length, at));
  }

  /** Compiles one shader program that later pictures will need; returns false when none is missing. */
  makeNextProgram(): boolean { return hasMore(this.#m) && this.#m._fdvt_make_next_program(this.#h) !== 0; }

  // --- motion ---

  setParameter(name: string, value: number, atOnce: boolean): void {
    this.#check(this.#m._fdvt_set_parameter(this.#h, ...this.#text(name), value, atOnce ? 1 : 0));
  }
  /** Present value of a parameter; NaN if no class has it. */
  parameter(name: string): number { return this.#m._fdvt_parameter(this.#h, ...this.#text(name)); }
  goTo(state: string): void { this.#check(this.#m._fdvt_goto(this.#h, ...this.#text(state))); }
  steer(headingDeg: number): void { this.#m._fdvt_steer(this.#h, headingDeg * RADIANS); }
  /** Sets the expected throughput; call before `loadManifest`. */
  expectThroughput(bitsPerSecond: number): void { this.#m._fdvt_expect_throughput(this.#h, bitsPerSecond); }
  judgeRendition(sequence: number, rendition: number, plays: boolean): void {
    this.#m._fdvt_judge_rendition(this.#h, sequence, rendition, plays ? 1 : 0);
  }
  lookAhead(atOnce: boolean): void { this.#m._fdvt_look_ahead(this.#h, atOnce ? 1 : 0); }
  /** Runs a call of the module's functions; the second part's require that it is loaded. */
  call(action: PlayerCall): void { this.#check(action(this.#m, this.#h)); }
  // Sets the scene now, or in moreCame() if the second part is not loaded.
  #setScene(meshes: SceneMesh[]): void {
    this.#scene = hasMore(this.#m) ? null : meshes;
    if (this.#scene) return;
    this.#m._fdvt_clear_scene(this.#h);
    for (const { corners, occluderOnly } of meshes) {
      const at = this.#put(new Uint8Array(corners.buffer, corners.byteOffset, corners.byteLength));
      this.#check(this.#m._fdvt_add_scene_mesh(this.#h, at, corners.length / 6, occluderOnly ? 1 : 0));
    }
  }

  moreCame(): void { if (this.#scene) this.#setScene(this.#scene); }

  /**
   * Draws the character's room from now on, in place of the last one. bytes: the picture's file. Returns the texture,
   * which the page must fill with the picture and its mipmaps. Needs the second part.
   */
  showRoom(bytes: Uint8Array): WebGLTexture {
    const name = this.#m._fdvt_show_room(this.#h, this.#put(bytes), bytes.length);
    this.#check(name);
    return this.#m.GL.textures[name]!;
  }
  hideRoom(): void { if (hasMore(this.#m)) this.#m._fdvt_show_room(this.#h, 0, 0); }

  state(): PlayerState {
    const state = readState(this.#m.HEAPU8, this.#m._fdvt_state(this.#h));
    const m = this.#m, h = this.#h;
    return {
      ...state, x: state.xM, z: state.zM, heading: state.headingRad / RADIANS,
      get heapBytes() { return hasMore(m) ? m._fdvt_heap_bytes(h) : 0; }, // a getter: the call walks all heap blocks
    };
  }

  /** Description of the character; null before the manifest is read. */
  character(): CharacterInfo | null {
    const at = this.#m._fdvt_character(this.#h);
    if (!at) return null;
    const { boundsMin, boundsMax, groundYM, sequences, ...rest } = readCharacter(this.#m.HEAPU8, at);
    return {
      ...rest, min: boundsMin, max: boundsMax, groundY: groundYM,
      sequences: Array.from({ length: sequences }, (_, i) => this.#sequence(i)),
    };
  }

  #sequence(index: number): SequenceInfo {
    const m = this.#m;
    const { durationS, parameters, members, ...rest } = readSequence(m.HEAPU8, m._fdvt_sequence(this.#h, index));
    return {
      ...rest, duration: durationS,
      parameters: Array.from({ length: parameters }, (_, i) =>
        readParameter(m.HEAPU8, m._fdvt_sequence_parameter(this.#h, index, i))),
      members: Array.from({ length: members }, (_, i) =>
        new Reader(m.HEAPU8, m._fdvt_sequence_member(this.#h, index, i)).text(0)),
    };
  }

  #lastError(): ViewerError {
    const { id, message } = readError(this.#m.HEAPU8, this.#m._fdvt_error(this.#h));
    return new ViewerError(id, message);
  }
  #check(ok: number): void {
    if (!ok) throw this.#lastError();
  }

  // Copies a text into scratch memory; returns address and length.
  #text(text: string): [number, number] {
    const bytes = encoder.encode(text);
    return [this.#put(bytes), bytes.length];
  }

  // Copies the parts, concatenated, into scratch memory; returns its address, valid until the next call.
  #put(...parts: Uint8Array[]): number {
    const size = parts.reduce((sum, part) => sum + part.length, 0);
    if (size > this.#scratchBytes) {
      this.#m._fdvt_free(this.#scratch);
      this.#scratchBytes = Math.max(size, SMALLEST_SCRATCH_BYTES);
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
