// SPDX-License-Identifier: Apache-2.0
// One character: transport + decoders + player in wasm, and the traffic between them. Draws nothing and owns no canvas;
// session.ts does. After dispose() nothing of it runs any more.
import { asViewerError, ViewerError, type ErrorDetail } from './errors.js';
import { FrameDecoder, type Picture } from './frame-decoder.js';
import { Transport } from './transport.js';
import { uploadVideoFrame } from './upload-path.js';
import type { WasmModule } from './wasm-abi.js';
import {
  WasmPlayer, type Align, type CharacterInfo, type PictureKind, type PlayerRequest, type PlayerState,
} from './wasm-player.js';

const PICTURE_SLOTS = 4;

export interface Placement {
  /** Metres on the ground. */
  x: number;
  z: number;
  /** Degrees, from +z towards +x. */
  heading: number;
}

/** What is wanted of a character; a new player starts from it. */
export interface ActorWishes {
  src: string;
  sequence: string | null;
  playing: boolean;
  loop: number;
  rate: number;
  frame: number;
  parameters: Map<string, number>;
  align: Align;
  travel: boolean;
  placement: Placement;
}

export interface ActorHost {
  emit(name: string, detail?: unknown): void;
  /** Something to draw or to tick may have come. */
  wake(): void;
  /** This path cannot show the video's pictures. */
  onNoPlanes(): void;
  /** Once: the first picture, for measuring; the callee closes it. */
  onFirstFrame?(frame: VideoFrame): void;
  /** A trap in wasm or another end of everything. */
  fatal(reason: unknown): void;
}

export class Actor {
  readonly #wishes: ActorWishes;
  readonly #host: ActorHost;
  readonly #transport: Transport;
  readonly #gl: WebGL2RenderingContext;
  readonly #path: PictureKind;
  #decoders: (FrameDecoder | undefined)[] = [];
  #player: WasmPlayer | null;
  #character: CharacterInfo | null = null;
  #measured = false; // the first picture went to the host
  #stuck = false; // after an error: do not wait for what will not come

  /** `beside`: the character that the canvas was opened with. Throws what stops it from loading. */
  constructor(module: WasmModule, gl: WebGL2RenderingContext, beside: Actor | null, path: PictureKind,
      transport: Transport, manifest: unknown, wishes: ActorWishes, host: ActorHost) {
    this.#gl = gl;
    this.#path = path;
    this.#transport = transport;
    this.#wishes = wishes;
    this.#host = host;
    const player = new WasmPlayer(module, (beside && beside.#player) ?? gl, path, PICTURE_SLOTS);
    this.#player = player;
    player.setLoop(wishes.loop);
    player.setRate(wishes.rate);
    player.place(wishes.placement.x, wishes.placement.z, wishes.placement.heading);
    player.setTravel(wishes.travel);
    try {
      player.loadManifest(manifest);
    } catch (reason) {
      this.dispose();
      throw reason;
    }
    this.setAlign(wishes.align);
    for (const [name, value] of wishes.parameters) this.#try((p) => p.setParameter(name, value, true));
    if (wishes.sequence) this.select(wishes.sequence);
    if (wishes.frame > 0) player.seekFrame(wishes.frame);
    if (wishes.playing) player.play();
    this.#character = player.character();
    this.pump();
  }

  dispose(): void {
    for (const decoder of this.#decoders) decoder?.dispose();
    this.#decoders = [];
    const player = this.#player;
    this.#player = null;
    try {
      player?.dispose();
    } catch (reason) {
      console.warn('fourdvt-viewer:', reason); // the wasm instance has trapped; it goes away with the session
    }
  }

  get player(): WasmPlayer | null { return this.#player; }
  get character(): CharacterInfo | null { return this.#character; }
  state(): PlayerState | null { return this.#guard((p) => p.state()) ?? null; }
  /** Something is under way that needs the frame loop. */
  busy(state: PlayerState): boolean {
    return ((!state.paused || state.seeking) && !this.#stuck) || this.#decoders.some((d) => d?.busy);
  }

  play(): void {
    this.#wishes.playing = true;
    this.#command((p) => p.play());
  }
  pause(): void {
    this.#wishes.playing = false;
    this.#command((p) => p.pause());
  }
  seek(timeS: number): void { this.#command((p) => p.seek(timeS)); }
  seekFrame(frame: number): void {
    this.#wishes.frame = frame;
    this.#command((p) => p.seekFrame(frame));
  }
  setRate(rate: number): void {
    this.#wishes.rate = rate;
    this.#command((p) => p.setRate(rate));
  }
  setLoop(loop: number): void {
    this.#wishes.loop = loop;
    this.#command((p) => p.setLoop(loop));
  }
  // A name that the character does not have is an error event, and nothing else changes.
  select(name: string): void {
    this.#wishes.sequence = name;
    this.#try((p) => p.selectSequence(name));
  }
  goTo(state: string): void {
    this.#wishes.sequence = state;
    this.#try((p) => p.goTo(state));
  }
  setParameter(name: string, value: number, atOnce: boolean): void {
    this.#wishes.parameters.set(name, value);
    this.#try((p) => p.setParameter(name, value, atOnce || !this.#wishes.playing)); // a still picture does not glide
  }
  parameter(name: string): number { return this.#guard((p) => p.parameter(name)) ?? NaN; }
  setAlign(align: Align): void {
    if (this.#try((p) => p.setAlign(align))) this.#wishes.align = align;
  }
  setTravel(on: boolean): void {
    this.#wishes.travel = on;
    this.#command((p) => p.setTravel(on));
  }
  place(placement: Placement): void {
    this.#wishes.placement = placement;
    this.#command((p) => p.place(placement.x, placement.z, placement.heading));
  }
  steer(heading: number): void { this.#command((p) => p.steer(heading)); }

  tick(nowS: number): void {
    this.#guard((p) => p.tick(nowS));
    this.pump();
  }

  pump(): void {
    this.#guard((player) => {
      this.#offerPictures(player);
      for (let request = player.nextRequest(); request; request = player.nextRequest()) this.#serve(request);
      for (const decoder of this.#decoders) decoder?.feed();
      for (let event = player.nextEvent(); event; event = player.nextEvent()) {
        if (event.name === 'error') {
          this.#stuck = true;
          this.#host.emit('error', event.error);
        } else if (event.name === 'progress') {
          this.#host.emit('progress', { loaded: event.loadedBytes, total: event.totalBytes });
        } else {
          this.#host.emit(event.name);
        }
        if (this.#player !== player) return; // a listener removed us
      }
    });
  }

  #serve(request: PlayerRequest): void {
    switch (request.kind) {
      case 'fetch': void this.#fetch(request.id, request.uri, request.offset, request.bytes); break;
      case 'cancel': this.#transport.cancel(request.id); break;
      case 'configure': this.#decoder(request.decoder).configure(request.codec, request.description, request.width, request.height); break;
      case 'decode': this.#decoders[request.decoder]?.decode(request.bytes, request.timestampUs, request.key); break;
      case 'flush': this.#decoders[request.decoder]?.flush(); break;
      case 'reset': this.#decoders[request.decoder]?.reset(); break;
      case 'close':
        this.#decoders[request.decoder]?.dispose();
        this.#decoders[request.decoder] = undefined;
        break;
    }
  }

  #decoder(index: number): FrameDecoder {
    return (this.#decoders[index] ??= new FrameDecoder(this.#path, {
      onPicture: () => {
        this.#guard((player) => this.#offerPictures(player));
        this.#host.wake();
      },
      onNoPlanes: () => this.#host.onNoPlanes(),
      onError: (error) => this.#onDecoderError(index, error),
      ...this.#measuring(),
    }));
  }

  // Decoders come and go with transitions; only the first one's first picture is measured.
  #measuring(): { onFirstFrame?(frame: VideoFrame): void } {
    if (this.#measured || !this.#host.onFirstFrame) return {};
    this.#measured = true;
    return { onFirstFrame: (frame) => this.#host.onFirstFrame?.(frame) };
  }

  async #fetch(id: number, uri: string, offset: number, bytes: number): Promise<void> {
    const player = this.#player;
    let answer: (p: WasmPlayer) => void;
    try {
      const part = await this.#transport.range(id, uri, offset, bytes);
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
        decoder?.shift();
      }
    });
  }

  #upload(player: WasmPlayer, slot: number, picture: Picture): void {
    if (picture.kind === 'i420') {
      player.upload(slot, picture.pixels, picture.planes);
      return;
    }
    const texture = player.slotTexture(slot);
    if (texture) uploadVideoFrame(this.#gl, texture, picture.frame);
    player.commitSlot(slot);
  }

  #onDecoderError(index: number, error: ViewerError): void {
    const reason = error.id === 'decoder-unsupported' ? `unsupported: ${error.message}` : error.message;
    this.#guard((p) => p.decoderFailed(index, reason));
    this.pump();
  }

  #command(action: (player: WasmPlayer) => void): void {
    this.#stuck = false;
    this.#guard(action);
    this.pump();
    this.#host.wake();
  }

  // False, and an error event: the character cannot do that.
  #try(action: (player: WasmPlayer) => void): boolean {
    let problem: ErrorDetail | null = null;
    this.#command((player) => {
      try {
        action(player);
      } catch (reason) {
        if (!(reason instanceof ViewerError)) throw reason;
        problem = reason.detail;
      }
    });
    if (problem) this.#host.emit('error', problem);
    return !problem;
  }

  // Runs the action on the living player. A trap in wasm ends the session, not the page.
  #guard<T>(action: (player: WasmPlayer) => T): T | undefined {
    if (!this.#player) return undefined;
    try {
      return action(this.#player);
    } catch (reason) {
      if (!this.#gl.isContextLost()) this.#host.fatal(reason);
      return undefined;
    }
  }
}
