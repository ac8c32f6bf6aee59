// SPDX-License-Identifier: Apache-2.0
// One loaded character on one canvas: transport + decoder + player in wasm + the frame loop. Made by the element, dies
// with it, with its src, or with the GL context. After dispose() nothing of it runs any more.
import { asViewerError, ViewerError } from './errors.js';
import { FrameDecoder, type Picture } from './frame-decoder.js';
import type { OrbitCamera } from './orbit-camera.js';
import { fetchManifest, Transport } from './transport.js';
import { measurePath, rememberedPath, rememberPath, uploadVideoFrame, type UploadPath } from './upload-path.js';
import { instantiate } from './wasm-module.js';
import type { WasmModule } from './wasm-abi.js';
import {
  WasmPlayer, type CharacterInfo, type OrbitPose, type PictureKind, type PlayerRequest, type PlayerState,
  type RenderOptions,
} from './wasm-player.js';

const PICTURE_SLOTS = 4;
const MAX_STEP_S = 0.5;     // a longer pause of the page is not caught up
const IDLE_FRAMES = 12;     // frames without change after which the loop sleeps
const MAX_CANVAS_SIDE = 4096;

/** What the element wants; a new session starts from it. */
export interface Wishes {
  src: string;
  wasmUrl: string;
  uploadPath: UploadPath;
  sequence: string | null;
  playing: boolean;
  loop: number;
  rate: number;
  frame: number;
  render: RenderOptions;
}

export interface SessionHost {
  readonly camera: OrbitCamera;
  /** Called once a frame before drawing; true if the view changes on its own (auto-rotation, drag). */
  animate(dtS: number): boolean;
  emit(name: string, detail?: unknown): void;
  firstPicture(): void;
}

export interface Snapshot {
  width: number;
  height: number;
  pose?: Partial<OrbitPose>;
}

export class Session {
  readonly #canvas: HTMLCanvasElement;
  readonly #wishes: Wishes;
  readonly #host: SessionHost;
  readonly #transport: Transport;
  readonly #abort = new AbortController();
  #gl: WebGL2RenderingContext | null = null;
  #module: WasmModule | null = null;
  #manifest: unknown = null;
  #player: WasmPlayer | null = null;
  #decoder: FrameDecoder | null = null;
  #path: PictureKind = 'i420';
  #character: CharacterInfo | null = null;
  #raf = 0;
  #last = 0;
  #clock = 0;
  #idle = 0;
  #active = true;
  #shown = false;
  #deciding = false; // the upload path is being measured
  #stuck = false; // after an error: do not wait for what will not come
  #redraw = true;
  #drawn = -1;
  #size = { width: 1, height: 1 };

  constructor(canvas: HTMLCanvasElement, wishes: Wishes, host: SessionHost) {
    this.#canvas = canvas;
    this.#wishes = wishes;
    this.#host = host;
    this.#transport = new Transport(wishes.src);
  }

  /** Never rejects: what goes wrong becomes an error event. */
  async start(): Promise<void> {
    try {
      if (typeof VideoDecoder === 'undefined') {
        throw new ViewerError('decoder-unsupported', 'this browser has no WebCodecs VideoDecoder: open the page in a newer one');
      }
      const [manifest, module] = await Promise.all([
        fetchManifest(this.#wishes.src, this.#abort.signal), instantiate(this.#wishes.wasmUrl)]);
      if (this.#abort.signal.aborted) return;
      this.#manifest = manifest;
      this.#module = module;
      this.#gl = this.#canvas.getContext('webgl2', {
        alpha: true, premultipliedAlpha: true, antialias: false, depth: false, stencil: false,
        powerPreference: 'high-performance',
      });
      if (!this.#gl) throw new ViewerError('gpu-failure', 'no WebGL2 context: the browser or its GPU driver refuses one');
      const wish = this.#wishes.uploadPath;
      this.#open(wish === 'auto' ? rememberedPath() ?? 'i420' : wish);
    } catch (reason) {
      if (!this.#abort.signal.aborted) this.#fatal(reason);
    }
  }

  dispose(): void {
    this.#abort.abort();
    cancelAnimationFrame(this.#raf);
    this.#raf = 0;
    this.#transport.dispose();
    this.#close();
    this.#module = null;
    this.#manifest = null;
  }

  /** After dispose: frees the context now, not at the next garbage collection. The canvas is of no use afterwards. */
  loseContext(): void {
    this.#gl?.getExtension('WEBGL_lose_context')?.loseContext();
    this.#gl = null;
  }

  get character(): CharacterInfo | null { return this.#character; }
  get path(): PictureKind { return this.#path; }
  get bytesReceived(): number { return this.#transport.bytesReceived; }
  state(): PlayerState | null { return this.#player ? this.#guard((p) => p.state()) ?? null : null; }

  // A command before the player is there becomes a wish.
  play(): void {
    this.#wishes.playing = true;
    this.#command((p) => p.play());
  }
  pause(): void {
    this.#wishes.playing = false;
    this.#command((p) => p.pause());
  }
  seek(timeS: number): void {
    this.#command((p) => p.seek(timeS));
  }
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
  setRenderOptions(options: RenderOptions): void {
    this.#wishes.render = options;
    this.#command((p) => p.setOptions(options));
  }
  /** A name that the character does not have is an error event, and nothing else changes. */
  select(name: string): void {
    this.#wishes.sequence = name;
    this.#command((p) => {
      try {
        p.selectSequence(name);
      } catch (reason) {
        if (!(reason instanceof ViewerError)) throw reason;
        this.#host.emit('error', reason.detail);
      }
    });
  }

  resize(width: number, height: number): void {
    const scale = Math.min(1, MAX_CANVAS_SIDE / Math.max(width, height, 1));
    this.#size = { width: Math.max(1, Math.round(width * scale)), height: Math.max(1, Math.round(height * scale)) };
    this.wake();
  }

  /** False: off-screen. The clock stands still and nothing is drawn or decoded. */
  setActive(active: boolean): void {
    this.#active = active;
    if (active) this.wake();
    else {
      cancelAnimationFrame(this.#raf);
      this.#raf = 0;
      this.#last = 0;
    }
  }

  wake(): void {
    this.#idle = 0;
    this.#redraw = true;
    if (!this.#raf && this.#active && this.#player) this.#raf = requestAnimationFrame((t) => this.#frame(t));
  }

  /** A PNG of what is shown, at another size and pose if wanted. Null before the first picture. */
  async toBlob(snapshot?: Snapshot): Promise<Blob | null> {
    if (!this.state()?.hasFrame) return null;
    const { width, height } = snapshot ?? this.#size;
    this.#fit(width, height);
    this.#draw({ ...this.#host.camera.pose, ...snapshot?.pose });
    const blob = new Promise<Blob | null>((resolve) => this.#canvas.toBlob(resolve, 'image/png'));
    this.#fit(this.#size.width, this.#size.height);
    this.#draw(this.#host.camera.pose);
    return blob;
  }

  // --- the player's life ---

  #open(path: PictureKind): void {
    const wishes = this.#wishes;
    this.#path = path;
    const decide = (this.#deciding = wishes.uploadPath === 'auto' && !rememberedPath());
    this.#decoder = new FrameDecoder(path, {
      onPicture: () => this.#onPicture(),
      onNoPlanes: () => this.#reopen('rgba'),
      onError: (error) => this.#onDecoderError(error),
      ...(decide ? { onFirstFrame: (frame: VideoFrame) => void this.#choosePath(frame) } : {}),
    });
    const player = new WasmPlayer(this.#module!, this.#gl!, path, PICTURE_SLOTS);
    this.#player = player;
    player.setOptions(wishes.render);
    player.setLoop(wishes.loop);
    player.setRate(wishes.rate);
    player.loadManifest(this.#manifest);
    if (wishes.sequence) this.select(wishes.sequence);
    if (wishes.frame > 0) player.seekFrame(wishes.frame);
    if (wishes.playing) player.play();
    this.#character = player.character();
    if (this.#character) this.#host.camera.setCharacter(this.#character);
    if (!this.#shown) this.#host.camera.jump();
    this.#pump();
    this.wake();
  }

  #close(): void {
    this.#decoder?.dispose();
    this.#decoder = null;
    const player = this.#player;
    this.#player = null;
    try {
      player?.dispose();
    } catch (reason) {
      console.warn('fourdvt-viewer:', reason); // the wasm instance has trapped; it goes away with the session
    }
  }

  // The same character on the other upload path, from where it is.
  #reopen(path: PictureKind): void {
    if (!this.#player) return;
    const state = this.state();
    if (state) this.#wishes.frame = state.frame;
    this.#transport.cancelAll();
    this.#close();
    try {
      this.#open(path);
    } catch (reason) {
      this.#fatal(reason);
    }
  }

  async #choosePath(frame: VideoFrame): Promise<void> {
    const gl = this.#gl;
    if (!gl) return frame.close();
    let path: PictureKind = this.#path;
    try {
      path = await measurePath(gl, frame, () => this.#guard((p) => p.invalidateState()));
    } catch {
      // not measurable here: stay on the path that works
    } finally {
      frame.close();
    }
    if (this.#abort.signal.aborted || gl.isContextLost()) return;
    rememberPath(path);
    this.#deciding = false;
    if (path !== this.#path) this.#reopen(path);
    else if (this.state()?.hasFrame) this.#transport.stopReplay();
    this.wake();
  }

  // --- requests and answers ---

  #pump(): void {
    this.#guard((player) => {
      this.#offerPictures(player);
      for (let request = player.nextRequest(); request; request = player.nextRequest()) this.#serve(request);
      this.#decoder?.feed();
      for (let event = player.nextEvent(); event; event = player.nextEvent()) {
        if (event.name === 'canplay' && !this.#deciding) this.#transport.stopReplay();
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
      case 'configure': this.#decoder?.configure(request.codec, request.description, request.width, request.height); break;
      case 'decode': this.#decoder?.decode(request.bytes, request.timestampUs, request.key); break;
      case 'flush': this.#decoder?.flush(); break;
      case 'reset': this.#decoder?.reset(); break;
    }
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
    if (this.#player !== player) return;
    this.#guard(answer);
    this.#pump();
    this.wake();
  }

  #onPicture(): void {
    this.#guard((player) => this.#offerPictures(player));
    this.wake();
  }

  #offerPictures(player: WasmPlayer): void {
    for (let picture = this.#decoder?.peek(); picture; picture = this.#decoder?.peek()) {
      const slot = player.acquireSlot(picture.timestampUs);
      if (slot === -1) return;
      if (slot >= 0) this.#upload(player, slot, picture);
      this.#decoder?.shift();
    }
  }

  #upload(player: WasmPlayer, slot: number, picture: Picture): void {
    if (picture.kind === 'i420') {
      player.upload(slot, picture.pixels, picture.planes);
      return;
    }
    const texture = player.slotTexture(slot);
    if (texture && this.#gl) uploadVideoFrame(this.#gl, texture, picture.frame);
    player.commitSlot(slot);
  }

  #onDecoderError(error: ViewerError): void {
    const reason = error.id === 'decoder-unsupported' ? `unsupported: ${error.message}` : error.message;
    this.#guard((p) => p.decoderFailed(reason));
    this.#pump();
  }

  // --- frame loop ---

  #frame(now: number): void {
    this.#raf = 0;
    const dt = this.#last ? Math.min((now - this.#last) / 1000, MAX_STEP_S) : 0;
    this.#last = now;
    this.#clock += dt;
    this.#guard((p) => p.tick(this.#clock));
    this.#pump();
    const moved = this.#host.animate(dt);
    const state = this.state();
    if (!state) return;
    const serial = state.framesShown * 65536 + state.frame;
    const changed = moved || this.#redraw || serial !== this.#drawn;
    if (changed && state.hasFrame) this.#show(serial);
    this.#redraw = false;
    this.#idle = moved || ((!state.paused || state.seeking) && !this.#stuck) || this.#decoder?.busy ? 0 : this.#idle + 1;
    if (this.#idle < IDLE_FRAMES && this.#player) this.#raf = requestAnimationFrame((t) => this.#frame(t));
    else this.#last = 0;
  }

  #show(serial: number): void {
    this.#fit(this.#size.width, this.#size.height);
    if (!this.#draw(this.#host.camera.pose)) return;
    this.#drawn = serial;
    if (this.#shown) return;
    this.#shown = true;
    this.#host.firstPicture();
  }

  #fit(width: number, height: number): void {
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
  }

  #draw(pose: OrbitPose): boolean {
    return this.#guard((p) => (p.draw(pose, this.#canvas.width, this.#canvas.height), true)) ?? false;
  }

  #command(action: (player: WasmPlayer) => void): void {
    this.#stuck = false;
    this.#guard(action);
    this.#pump();
    this.wake();
  }

  // Runs the action on the living player. A trap in wasm ends the session, not the page.
  #guard<T>(action: (player: WasmPlayer) => T): T | undefined {
    if (!this.#player) return undefined;
    try {
      return action(this.#player);
    } catch (reason) {
      if (this.#gl?.isContextLost()) return undefined;
      this.#fatal(reason);
      return undefined;
    }
  }

  #fatal(reason: unknown): void {
    if (this.#abort.signal.aborted) return;
    const error = asViewerError(reason);
    this.dispose();
    this.#host.emit('error', error.detail);
  }
}
