// SPDX-License-Identifier: Apache-2.0
// One character: passes data between its transport, its decoders and its player in wasm. Does not own a canvas or
// schedule draws, as drawing.ts does. After dispose() none of its callbacks run.
import { FrameDecoder, type DecoderCallbacks, type Picture, type PictureDecoder } from '../decode/frame-decoder.js';
import { kindOf, uploadPicture, type UploadPath } from '../decode/upload-path.js';
import type { ActorHost } from '../more/session-side.js';
import { throughput } from '../net/throughput.js';
import type { Transport } from '../net/transport.js';
import type { Commands, Instance } from '../player/commands.js';
import {
  WasmPlayer, type CharacterInfo, type PlayerEvent, type PlayerRequest, type PlayerState, type PlayerCall,
} from '../player/wasm-player.js';
import { asViewerError, ViewerError, type ErrorDetail } from '../report/errors.js';
import type { Step } from '../report/watchdog.js';
import type { DecoderFault } from '../wasm/generated/abi.js';
import type { TurnHook, WasmModule } from '../wasm/wasm-abi.js';

// Slots per decoder: one picture on screen, the others ready or being filled. Fewer for planes, which take memory of the
// player's module.
const PICTURE_SLOTS = 4;
const PLANE_SLOTS = 3;

const DETAILS: Record<string, (event: PlayerEvent) => unknown> = {
  error: ({ error }) => error,
  progress: ({ loadedBytes, totalBytes }) => ({ loaded: loadedBytes, total: totalBytes }),
  methodfallback: ({ error, drawn }) => ({ wanted: error.id, drawn, message: error.message }),
};

/** Stage and canvas, shared by characters. */
export interface ActorContext {
  stage: { readonly module: WasmModule; readonly gl: WebGL2RenderingContext; readonly context: number };
  path: UploadPath;
  /** True if textures can be read back. */
  readable: boolean;
  /** Functions for upload path 'video'; undefined on the others. */
  video: {
    makeVideoDecoder(callbacks: DecoderCallbacks): PictureDecoder;
    isSubFaster(gl: WebGL2RenderingContext, video: HTMLVideoElement): boolean;
  } | undefined;
  /** Main character of the canvas; null if this actor is the main one. */
  beside: Actor | null;
}

/** Members of Transport, which LiveStream implements too. */
export type Files = Pick<Transport, 'manifest' | 'address' | 'range' | 'busy' | 'cancel' | 'cancelAll' | 'stopReplay' | 'dispose'>;

/** Source of one character. start: content of its start file, or empty; load: begins a live stream. */
export interface Source {
  transport: Files;
  manifest: unknown;
  start: Uint8Array;
  load?: PlayerCall | undefined;
}

export class Actor implements Instance {
  readonly #context: ActorContext;
  readonly #transport: Files;
  readonly #commands: Commands;
  readonly #host: ActorHost;
  #decoders: (PictureDecoder | undefined)[] = [];
  #player: WasmPlayer | null;
  #character: CharacterInfo | null = null;
  #ready: Promise<unknown> = Promise.resolve(); // resolves when the player can use the results of fetches
  #taken: ((frame: VideoFrame) => void) | null = null; // also gets the next decoded picture
  #subVideo: boolean | null = null; // <video> pictures are uploaded into existing storage; null: not measured yet
  #hook: TurnHook | null = null;
  #mustWait = false; // #ready is pending
  #checked = -1; // count of checked barcodes at the last upload
  #stuck = false; // an error has stopped the pictures, until the next command

  /** Loads the manifest, and applies commands until dispose(). Errors: ViewerError if the manifest cannot be used. */
  constructor(context: ActorContext, source: Source, commands: Commands, host: ActorHost) {
    this.#context = context;
    this.#transport = source.transport;
    this.#commands = commands;
    this.#host = host;
    const player = new WasmPlayer(context.stage.module, context.beside?.player ?? context.stage.context, kindOf(context.path), context.readable, context.path === 'i420' ? PLANE_SLOTS : PICTURE_SLOTS);
    this.#player = player;
    try {
      const bitsPerSecond = throughput();
      if (bitsPerSecond) player.expectThroughput(bitsPerSecond);
      commands.prepare(player);
      player.loadManifest(source.manifest, source.start, source.load);
    } catch (reason) {
      this.dispose();
      throw reason;
    }
    this.#character = player.character();
    if (!this.#character?.hasMesh) {
      this.#mustWait = true;
      this.#ready = host.more().then(() => (this.#mustWait = false));
    }
    commands.attach(this);
    this.pump();
  }

  dispose(): void {
    for (const decoder of this.#decoders) decoder?.dispose();
    this.#decoders = [];
    this.#commands.detach(this);
    this.#hook?.leave();
    this.#hook = null;
    const player = this.#player;
    this.#player = null;
    try {
      player?.dispose();
    } catch (reason) {
      console.warn('fourdvt-viewer:', reason); // the wasm instance has trapped, and is dropped anyway
    }
  }

  get player(): WasmPlayer | null { return this.#player; }
  get character(): CharacterInfo | null { return this.#character; }
  state(): PlayerState | null { return this.#guard((p) => p.state()) ?? null; }
  /** Bytes in use on the GPU and in the module's memory, by all players of the module. */
  bytes(): number {
    return this.#guard((p) => {
      const { liveTextureBytes, liveTargetBytes, heapBytes } = p.state();
      return liveTextureBytes + liveTargetBytes + heapBytes;
    }) ?? 0;
  }
  parameter(name: string): number { return this.#guard((p) => p.parameter(name)) ?? NaN; }
  /** True while a picture is due. */
  awaits(state: PlayerState): boolean { return (!state.paused || state.seeking) && !this.#stuck; }
  /** True while the frame loop is needed. */
  busy(state: PlayerState): boolean {
    return this.awaits(state) || this.#decoders.some((d) => d?.busy);
  }
  /** Returns the step that the next picture waits for. */
  missing(state: PlayerState): Step {
    if (this.#mustWait) return 'more';
    if (this.#transport.busy) return 'files';
    if (this.#checked === state.barcodeChecked) return 'barcode';
    return this.#decoders.find((decoder) => decoder?.missing)?.missing ?? 'geometry';
  }
  /** Number of pictures decoded so far. */
  get decoded(): number { return this.#decoders.reduce((sum, decoder) => sum + (decoder?.given ?? 0), 0); }
  /** Reopens the decoders from which a picture is due. */
  replaceDecoders(reason: string): void {
    this.#decoders.forEach((decoder, index) => { if (decoder?.missing) this.#onDecoderFault(index, 'taken-away', reason); });
  }

  run(action: (player: WasmPlayer) => void): boolean {
    let problem: ErrorDetail | null = null;
    this.#stuck = false;
    this.#guard((player) => {
      try {
        action(player);
      } catch (reason) {
        if (!(reason instanceof ViewerError)) throw reason;
        problem = reason.detail;
      }
    });
    this.pump();
    this.#host.wake();
    if (problem) this.#host.emit('error', problem);
    return !problem;
  }

  /** Passes the next picture that WebCodecs decodes to `action`, which must close it. */
  takeFrame(action: (frame: VideoFrame) => void): void { this.#taken = action; }

  tick(nowS: number): void {
    this.#guard((p) => p.tick(nowS, this.#hook));
    this.pump();
  }

  /** Calls `hook` around each tick from now on, in place of the last hook. */
  setHook(hook: TurnHook): void {
    this.#hook?.leave();
    if (this.#player) this.#hook = hook;
    else hook.leave();
  }
  wake(): void { this.#host.wake(); }

  /** Compiles one shader program that later pictures will need; returns false when none is missing. */
  makeNextProgram(): boolean { return this.#guard((p) => p.makeNextProgram()) ?? false; }

  /** inSight: false releases the decoders. */
  setInSight(inSight: boolean): void {
    this.#guard((p) => p.setInSight(inSight));
    this.pump();
  }

  pump(): void {
    this.#guard((player) => {
      this.#offerPictures(player);
      for (let request = player.nextRequest(); request; request = player.nextRequest()) this.#serve(request);
      this.#decoders.forEach((decoder, index) => decoder?.feed(this.#context.video ? player.pace(index) : 0));
      for (let event = player.nextEvent(); event; event = player.nextEvent()) {
        const { name, error } = event;
        if (name === 'error') this.#stuck = true;
        if (name === 'warning') console.warn(`fourdvt-viewer: ${error.id}: ${error.message}`);
        else this.#host.emit(name, DETAILS[name]?.(event));
        if (this.#player !== player) return; // a listener has removed this character
      }
    });
  }

  #serve(r: PlayerRequest): void {
    const decoder = this.#decoders[r.decoder];
    switch (r.kind) {
      case 'fetch': void this.#fetch(r.id, r.uri, r.offset, r.size); break;
      case 'cancel': this.#transport.cancel(r.id); break;
      case 'configure': this.#decoder(r.decoder).configure(r.codec, r.data, r.width, r.height); break;
      case 'decode': decoder?.decode(r.data, r.timestampUs, r.key, r.wanted); break;
      case 'flush': decoder?.flush(); break;
      case 'reset': decoder?.reset(); break;
      case 'close':
        decoder?.dispose();
        this.#decoders[r.decoder] = undefined;
        break;
    }
  }

  #decoder(index: number): PictureDecoder {
    return (this.#decoders[index] ??= this.#makeDecoder({
      onPicture: () => {
        this.#guard((player) => this.#offerPictures(player));
        this.#host.wake();
      },
      onNoPlanes: () => this.#host.onNoPlanes(),
      onFault: (fault, reason) => this.#onDecoderFault(index, fault, reason),
      onFrame: (frame) => {
        const taken = this.#taken;
        this.#taken = null;
        taken?.(frame.clone());
      },
    }));
  }
  #makeDecoder(callbacks: DecoderCallbacks): PictureDecoder {
    const { stage: { module }, path, video } = this.#context;
    return video?.makeVideoDecoder(callbacks) ?? new FrameDecoder(kindOf(path), {
      allocate: (bytes) => this.#catch(() => module._fdvt_alloc_planes(bytes)) ?? 0,
      free: (block) => this.#catch(() => module._fdvt_free_planes(block)),
      bytes: (block, length) => module.HEAPU8.subarray(block, block + length),
    }, callbacks);
  }

  async #fetch(id: number, uri: string, offset: number, bytes: number): Promise<void> {
    const player = this.#player;
    let answer: (p: WasmPlayer) => void;
    try {
      const [part] = await Promise.all([this.#transport.range(id, uri, offset, bytes), this.#ready]);
      if (!part) return;
      answer = (p) => p.rangeReceived(id, part);
    } catch (reason) {
      answer = (p) => p.rangeFailed(id, asViewerError(reason).message);
    }
    if (!player || this.#player !== player) return;
    this.#guard(answer);
    this.pump();
    this.#host.wake();
  }

  #offerPictures(player: WasmPlayer): void {
    this.#decoders.forEach((decoder, index) => {
      for (let picture = decoder?.peek(); picture; picture = decoder?.peek()) {
        const slot = player.acquireSlot(index, picture.timestampUs);
        if (slot === -1) return;
        if (slot >= 0) this.#upload(player, slot, picture);
        decoder?.shift(slot >= 0);
      }
    });
  }

  #upload(player: WasmPlayer, slot: number, picture: Picture): void {
    if (picture.kind === 'i420') {
      player.upload(slot, picture.block, picture.planes);
      return;
    }
    const texture = player.slotTexture(slot);
    if (this.#context.readable) this.#checked = player.state().barcodeChecked;
    const { stage: { gl }, path } = this.#context;
    if (picture.kind === 'video') {
      const { video } = picture;
      // A picture of another size than the texture is refused at the commit.
      this.#subVideo ??= this.#context.video!.isSubFaster(gl, video);
      if (texture) uploadPicture(gl, texture, video, this.#subVideo);
      player.commitSlot(slot, video.videoWidth, video.videoHeight);
      return;
    }
    if (texture) uploadPicture(gl, texture, picture.frame, path === 'rgba-sub');
    player.commitSlot(slot, picture.frame.displayWidth, picture.frame.displayHeight);
  }

  // Handles a decoder's fault asynchronously: the decoder may report it within one of the pump's requests.
  #onDecoderFault(index: number, fault: DecoderFault, reason: string): void {
    const decoder = this.#decoders[index];
    queueMicrotask(() => {
      if (!decoder || this.#decoders[index] !== decoder) return;
      this.#guard((p) => p.decoderFailed(index, fault, reason));
      this.pump();
      this.#host.wake();
    });
  }

  // Runs the action if the player is not disposed of.
  #guard<T>(action: (player: WasmPlayer) => T): T | undefined {
    const player = this.#player;
    return player ? this.#catch(() => action(player)) : undefined;
  }
  // Runs code that calls wasm. A trap ends the session, not the page.
  #catch<T>(action: () => T): T | undefined {
    try {
      return action();
    } catch (reason) {
      if (!this.#context.stage.gl.isContextLost()) this.#host.fatal(reason);
      return undefined;
    }
  }
}
