// SPDX-License-Identifier: Apache-2.0
// One canvas: the frame loop, the GL context, the main character and those beside it. Made by the element, dies with it,
// with its src, or with the GL context. After dispose() nothing of it runs any more.
import { Actor, type ActorHost, type ActorWishes, type Placement } from './actor.js';
import { asViewerError, ViewerError } from './errors.js';
import { loadOpenCvFlow } from './opencv-flow.js';
import type { OrbitCamera } from './orbit-camera.js';
import { fetchManifest, Transport } from './transport.js';
import { measurePath, rememberedPath, rememberPath, type UploadPath } from './upload-path.js';
import { instantiate, instantiateWithFlow } from './wasm-module.js';
import type { WasmModule } from './wasm-abi.js';
import type { Align, CharacterInfo, OrbitPose, PictureKind, PlayerState, RenderOptions, SceneMesh } from './wasm-player.js';

const MAX_STEP_S = 0.5;     // a longer pause of the page is not caught up
const IDLE_FRAMES = 12;     // frames without change after which the loop sleeps
const MAX_CANVAS_SIDE = 4096;

const needsFlow = (align: Align): boolean => align.startsWith('flow');

/** What the element wants; a new session starts from it. */
export interface Wishes extends ActorWishes {
  wasmUrl: string;
  opencvUrl: string;
  uploadPath: UploadPath;
  render: RenderOptions;
  scene: SceneMesh[];
}

export interface SessionHost {
  readonly camera: OrbitCamera;
  /** Called once a frame before drawing; true if the view or the motion changes on its own. */
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
  #flow: Promise<WasmModule> | null = null; // the module with optical flow, once asked for
  #wanted: Align;
  #applied: Align; // what the player does now
  #manifest: unknown = null;
  #main: Actor | null = null;
  #others: Actor[] = [];
  readonly #transports = new Map<Actor, Transport>(); // of the others
  #path: PictureKind = 'i420';
  #raf = 0;
  #last = 0;
  #clock = 0;
  #idle = 0;
  #active = true;
  #shown = false;
  #deciding = false; // the upload path is being measured
  #redraw = true;
  #drawn = '';
  #size = { width: 1, height: 1 };

  constructor(canvas: HTMLCanvasElement, wishes: Wishes, host: SessionHost) {
    this.#canvas = canvas;
    this.#wishes = wishes;
    this.#host = host;
    this.#wanted = wishes.align;
    if (needsFlow(wishes.align)) wishes.align = 'baked'; // until flow is here
    this.#applied = wishes.align;
    this.#transport = new Transport(wishes.src);
  }

  /** Never rejects: what goes wrong becomes an error event. */
  async start(): Promise<void> {
    try {
      if (typeof VideoDecoder === 'undefined') {
        throw new ViewerError('decoder-unsupported', 'this browser has no WebCodecs VideoDecoder: open the page in a newer one');
      }
      const [manifest, module] = await Promise.all([
        fetchManifest(this.#wishes.src, this.#abort.signal), this.#firstModule()]);
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

  /** The main character's commands. Null before it is there: what was wished until then holds (Wishes). */
  get main(): Actor | null { return this.#main; }
  get wishes(): Wishes { return this.#wishes; }
  get character(): CharacterInfo | null { return this.#main?.character ?? null; }
  get path(): PictureKind { return this.#path; }
  get bytesReceived(): number { return this.#transport.bytesReceived; }
  state(): PlayerState | null { return this.#main?.state() ?? null; }

  setRenderOptions(options: RenderOptions): void {
    this.#wishes.render = options;
    this.#main?.player?.setOptions(options);
    this.wake();
  }
  setScene(scene: SceneMesh[]): void {
    this.#wishes.scene = scene;
    try {
      this.#main?.player?.setScene(scene);
    } catch (reason) {
      if (!(reason instanceof ViewerError)) return this.#fatal(reason);
      this.#host.emit('error', reason.detail);
    }
    this.wake();
  }
  /** Flow takes effect when its module is here; if it cannot be, an error event says why and nothing changes. */
  setAlign(align: Align): void {
    this.#wanted = align;
    if (needsFlow(align)) {
      if (this.#shown) void this.#useFlow(align); // else the first picture asks for it
      return;
    }
    this.#wishes.align = this.#applied = align;
    this.#main?.setAlign(align);
  }

  /** Another character in the same canvas; null if this session cannot have it (an error event says why). */
  async add(wishes: ActorWishes, emit: (name: string, detail?: unknown) => void): Promise<Actor | null> {
    const transport = new Transport(wishes.src);
    transport.stopReplay();
    try {
      const manifest = await fetchManifest(wishes.src, this.#abort.signal);
      if (!this.#main || !this.#module || !this.#gl) {
        transport.dispose();
        return null;
      }
      const host: ActorHost = {
        emit, wake: () => this.wake(), fatal: (reason) => this.#fatal(reason),
        onNoPlanes: () => emit('error', new ViewerError('video-invalid', 'the pictures of this video cannot be read here').detail),
      };
      const actor = new Actor(this.#module, this.#gl, this.#main, this.#path, transport, manifest, wishes, host);
      this.#others.push(actor);
      this.#transports.set(actor, transport);
      this.wake();
      return actor;
    } catch (reason) {
      transport.dispose();
      if (!this.#abort.signal.aborted) emit('error', asViewerError(reason).detail);
      return null;
    }
  }
  remove(actor: Actor): void {
    this.#others = this.#others.filter((other) => other !== actor);
    this.#drop(actor);
    this.wake();
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
    if (!this.#raf && this.#active && this.#main) this.#raf = requestAnimationFrame((t) => this.#frame(t));
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

  // --- optical flow ---

  #flowModule(): Promise<WasmModule> {
    if (!this.#flow) {
      this.#flow = instantiateWithFlow(this.#wishes.wasmUrl);
      this.#flow.catch(() => { this.#flow = null; });
    }
    return this.#flow;
  }

  // Without the flow module a character begins as baked; #show asks again and tells.
  async #firstModule(): Promise<WasmModule> {
    const flow = needsFlow(this.#wanted) ? await this.#flowModule().catch(() => null) : null;
    return flow ?? instantiate(this.#wishes.wasmUrl);
  }

  async #useFlow(align: Align): Promise<void> {
    try {
      const module = await this.#flowModule();
      if (align === 'flow-opencv') await loadOpenCvFlow(this.#wishes.opencvUrl, module);
      if (!this.#main || this.#wanted !== align) return;
      if (this.#module !== module) {
        this.#module = module;
        this.#reopen(this.#path);
      }
      this.#main?.player?.setAlign(align);
      this.#applied = align;
      this.wake();
    } catch (reason) {
      if (this.#abort.signal.aborted) return;
      if (this.#wanted === align) this.#wanted = this.#applied;
      if (reason instanceof ViewerError) this.#host.emit('error', reason.detail);
      else this.#fatal(reason);
    }
  }

  // --- the main character's life ---

  #open(path: PictureKind): void {
    const wishes = this.#wishes;
    this.#path = path;
    const decide = (this.#deciding = wishes.uploadPath === 'auto' && !rememberedPath());
    const main = new Actor(this.#module!, this.#gl!, null, path, this.#transport, this.#manifest, wishes, {
      emit: (name, detail) => this.#onMainEvent(name, detail),
      wake: () => this.wake(),
      onNoPlanes: () => this.#reopen('rgba'),
      fatal: (reason) => this.#fatal(reason),
      ...(decide ? { onFirstFrame: (frame: VideoFrame) => void this.#choosePath(frame) } : {}),
    });
    this.#main = main;
    main.player?.setOptions(wishes.render);
    main.player?.setScene(wishes.scene);
    if (needsFlow(this.#applied)) main.player?.setAlign(this.#applied);
    if (main.character) this.#host.camera.setCharacter(main.character);
    if (!this.#shown) this.#host.camera.jump();
    this.wake();
  }

  #onMainEvent(name: string, detail?: unknown): void {
    if (name === 'canplay' && !this.#deciding) this.#transport.stopReplay();
    // The first events come while the actor is being made: the element asks for it in its listeners.
    if (this.#main) this.#host.emit(name, detail);
    else queueMicrotask(() => { if (!this.#abort.signal.aborted) this.#host.emit(name, detail); });
  }

  #drop(other: Actor): void {
    this.#transports.get(other)?.dispose();
    this.#transports.delete(other);
    other.dispose();
  }

  // The others come again when the next main character is there (fourdvt-character.ts).
  #close(): void {
    for (const other of this.#others) this.#drop(other);
    this.#others = [];
    this.#main?.dispose();
    this.#main = null;
  }

  // The same character on another upload path or in another module, from where it is.
  #reopen(path: PictureKind): void {
    if (!this.#main) return;
    this.#keepPlace();
    this.#transport.cancelAll();
    this.#close();
    try {
      this.#open(path);
    } catch (reason) {
      this.#fatal(reason);
    }
  }

  // A motion that is on its way to another one begins with that.
  #keepPlace(): void {
    const state = this.state();
    if (!state?.hasFrame || state.seeking) return; // then the wishes hold what is sought
    const shown = this.character?.sequences[state.sequence]?.name ?? null;
    const arrived = !state.goal || state.goal === shown;
    this.#wishes.sequence = arrived ? shown : state.goal;
    this.#wishes.frame = arrived ? state.frame : 0;
    this.#wishes.placement = { x: state.x, z: state.z, heading: state.heading };
    this.#drawn = '';
  }

  async #choosePath(frame: VideoFrame): Promise<void> {
    const gl = this.#gl;
    if (!gl) return frame.close();
    let path: PictureKind = this.#path;
    try {
      path = await measurePath(gl, frame, () => this.#main?.player?.invalidateState());
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

  // --- frame loop ---

  #frame(now: number): void {
    this.#raf = 0;
    const dt = this.#last ? Math.min((now - this.#last) / 1000, MAX_STEP_S) : 0;
    this.#last = now;
    this.#clock += dt;
    for (const actor of [this.#main, ...this.#others]) actor?.tick(this.#clock);
    const moved = this.#host.animate(dt);
    const main = this.#main;
    const state = main?.state();
    if (!main || !state) return;
    this.#host.camera.follow(state);
    const others = this.#others.map((actor) => actor.state());
    const serial = [state, ...others].map((s) => s && [s.framesShown, s.frame, s.x, s.z, s.heading]).join();
    const changed = moved || this.#redraw || serial !== this.#drawn;
    if (changed && state.hasFrame) this.#show(serial, this.#others.filter((_, i) => others[i]?.hasFrame));
    this.#redraw = false;
    const busy = moved || main.busy(state) || this.#others.some((actor, i) => others[i] && actor.busy(others[i]!));
    this.#idle = busy ? 0 : this.#idle + 1;
    // A command of this very frame may have asked for the next one already.
    if (this.#idle < IDLE_FRAMES && this.#main) this.#raf ||= requestAnimationFrame((t) => this.#frame(t));
    else this.#last = 0;
  }

  #show(serial: string, others: Actor[]): void {
    this.#fit(this.#size.width, this.#size.height);
    if (!this.#draw(this.#host.camera.pose, others)) return;
    this.#drawn = serial;
    if (this.#shown) return;
    this.#shown = true;
    this.#host.firstPicture();
    if (needsFlow(this.#wanted)) void this.#useFlow(this.#wanted);
  }

  #fit(width: number, height: number): void {
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
  }

  /** `others`: those with a frame. */
  #draw(pose: OrbitPose, others = this.#others.filter((actor) => actor.state()?.hasFrame)): boolean {
    try {
      this.#main?.player?.draw(pose, this.#canvas.width, this.#canvas.height, others.map((actor) => actor.player!));
      return this.#main !== null;
    } catch (reason) {
      if (!this.#gl?.isContextLost()) this.#fatal(reason);
      return false;
    }
  }

  #fatal(reason: unknown): void {
    if (this.#abort.signal.aborted) return;
    const error = asViewerError(reason);
    this.dispose();
    this.#host.emit('error', error.detail);
  }
}

export type { Placement };
