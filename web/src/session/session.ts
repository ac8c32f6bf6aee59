// SPDX-License-Identifier: Apache-2.0
// Session: loads a character onto the page's stage, forwards its player's events, and reopens it where necessary. There is one
// session per src and stage; after dispose() none of its callbacks run. drawing.ts draws the character; later.ts holds the code
// that is loaded after the first picture.
import { choosePath, kindOf, rememberedPath, type UploadPath } from '../decode/upload-path.js';
import type { LiveStream } from '../live/live.js';
import type { ActorHost, Bake, SessionSide, SidePlayer } from '../more/session-side.js';
import { extensionOf, isFromCameras } from '../net/manifest.js';
import { partsReceived } from '../net/requests.js';
import { Transport } from '../net/transport.js';
import { viewOf } from '../page/documents.js';
import { FrameLoop } from '../page/frame-loop.js';
import type { Commands } from '../player/commands.js';
import { expectMore, type More } from '../player/wasm-module.js';
import type { Align, CharacterInfo } from '../player/wasm-player.js';
import { asViewerError, type ErrorDetail } from '../report/errors.js';
import { Watchdog, type Awaited, type Step } from '../report/watchdog.js';
import type { WasmModule } from '../wasm/wasm-abi.js';
import { Actor } from './actor.js';
import { Drawing } from './drawing.js';
import { Later, needsFlow } from './later.js';
import type { SessionHost, SessionOptions } from './session-host.js';
import { Stage, type StageSlot } from './stage.js';

type Source = ConstructorParameters<typeof Actor>[1];

const LATE_TURN_MS = 5000;

export class Session implements SessionSide, StageSlot {
  readonly options: SessionOptions;
  readonly host: SessionHost;
  readonly drawing: Drawing;
  readonly #files: Transport; // first transport of src
  readonly #abort = new AbortController();
  readonly #loop: FrameLoop;
  readonly #watchdog = new Watchdog(() => this.#awaited(), (step) => this.#onStall(step));
  readonly #steps = new Set<Step>(); // active steps of the start
  readonly later = new Later(this);
  transport: Source['transport'];
  main: Actor | null = null;
  manifest: unknown = null;
  path: UploadPath = 'i420';
  align: Align;
  room: boolean;
  fresh: boolean;
  #live: LiveStream | null = null; // equal to `transport` if src is a live stream
  #stage: Stage | null = null;
  #start: Uint8Array = new Uint8Array();
  #deciding = false; // the upload path is being measured
  #decodes = true;
  #watched = false; // a new picture would be visible
  #distrusted = false; // reading textures back has failed
  #waiting = 0; // number of requests that wait for the network, of character, companions and player

  constructor(options: SessionOptions, host: SessionHost) {
    this.options = options;
    this.host = host;
    this.#loop = new FrameLoop((clockS, stepS) => this.drawing.turn(clockS, stepS), viewOf(host.element));
    ({ align: this.align, room: this.room, fresh: this.fresh } = options);
    this.host.commands.set('align', needsFlow(options.align) ? 'baked' : options.align); // until flow is loaded
    this.transport = this.#files = this.openTransport(options.src, options.fresh ? 'reload' : 'default');
    this.drawing = new Drawing(host, {
      actors: () => this.#actors,
      stage: () => this.#stage!,
      slot: this,
      picture: () => { host.picture(); this.later.onPicture(); },
      firstPicture: () => { host.firstPicture(); this.later.firstPicture(); },
      drawFailed: (reason) => this.fatal(reason),
    });
  }

  /** Loads the character. Never rejects: errors are dispatched. */
  async start(): Promise<void> {
    try {
      const { src, uploadPath, files } = this.options;
      const live = /^wss?:/.test(src);
      const path = choosePath(uploadPath, live);
      const early = live || path !== 'i420' || needsFlow(this.align) || this.later.hasLook;
      if (early) expectMore(files, this.network);
      if (!live) this.#files.expectStart(); // before the manifest is read, which may not name the file
      const join = this.#during('player', Stage.join(files, this, this.network).then((stage) => {
        this.#stage = stage;
        if (this.ended) stage.leave(this);
      }));
      const [loaded] = await Promise.all([live || this.#during('manifest', this.#files.manifest()), join]);
      if (this.ended) return;
      if (live) this.transport = this.#live = await this.#during('more', this.later.connect());
      if (this.ended) return;
      const manifest = this.#live ? await this.#during('manifest', this.#live.manifest()) : loaded;
      const start = live ? undefined : extensionOf(manifest)?.start?.uri;
      if (start) this.#start = await this.#during('files', this.#files.start(start));
      if (this.ended) return;
      // Paths other than 'i420' need the second part, which reads barcodes back.
      if (isFromCameras(manifest) || path !== 'i420') await this.more();
      // Ignores a failure: the character begins with 'baked' and no look. Flow and look load later, and report errors.
      else if (early) await this.more().catch(() => undefined);
      if (this.ended) return;
      this.manifest = manifest;
      this.#open(path);
    } catch (reason) {
      if (!this.ended) this.fatal(reason);
    }
  }

  dispose(): void {
    this.#abort.abort();
    this.#watchdog.stop();
    this.#loop.stop();
    this.transport.dispose();
    this.#close();
    this.manifest = null;
    this.#stage?.leave(this);
  }

  /** True after dispose(), or after an error that has ended the session. */
  get ended(): boolean { return this.signal.aborted; }
  get signal(): AbortSignal { return this.#abort.signal; }
  get module(): WasmModule { return this.#stage!.module; }
  get gl(): WebGL2RenderingContext { return this.#stage!.gl; }
  /** Live stream of src, once the player is loaded; null for a baked character. */
  get live(): LiveStream | null { return this.#live; }
  get character(): CharacterInfo | null { return this.main?.character ?? null; }
  /** True if a start file has come: the first picture is imminent. */
  get started(): boolean { return this.#start.length > 0; }
  // True if textures can be read back: against fingerprinting some browsers return noise or nothing. Not tested for
  // planes, where #mistrustsPlanes detects it.
  get #readable(): boolean { return this.path === 'i420' || (!this.#distrusted && this.later.loaded!.canReadBack(this.gl)); }
  /** Number of layers of the loaded character; undefined before, and for a character from cameras. */
  get layers(): number | undefined { return this.main ? extensionOf(this.manifest)?.layerCount : undefined; }
  // All actors, the main character's first; empty without it.
  get #actors(): Actor[] { return this.main ? [this.main, ...(this.later.others as Actor[])] : []; }
  /** Player of the main character; null until the second part is loaded. */
  get wholePlayer(): SidePlayer | null { return this.later.loaded ? this.main?.player ?? null : null; }
  more(): Promise<More> { return this.#during('more', this.later.more()); }
  resize(width: number, height: number): void {
    this.drawing.resize(width, height);
    this.wake();
  }
  /** active: false stops clock and drawing. decodes: false releases the decoders. onScreen: the element is visible. */
  setActive(active: boolean, decodes: boolean, onScreen: boolean): void {
    this.#watched = decodes && onScreen;
    if (this.#watched && !this.ended) this.#watchdog.wake();
    else this.#watchdog.stop();
    if (decodes !== this.#decodes) {
      this.#decodes = decodes;
      for (const actor of this.#actors) actor.setInSight(decodes);
    }
    this.#loop.setActive(active);
    if (active) this.wake();
  }
  wake(): void {
    this.drawing.invalidate();
    if (this.#watched && !this.ended) this.#watchdog.wake();
    if (this.main) this.#loop.wake();
  }

  // --- steps that pictures wait for ---

  async #during<T>(step: Step, work: Promise<T>): Promise<T> {
    this.#steps.add(step);
    try {
      return await work;
    } finally {
      this.#steps.delete(step);
    }
  }
  #awaited(): Awaited | null {
    const step = this.#missing();
    const state = this.main?.state(), received = /manifest|player|more|files/.test(step ?? '') && partsReceived();
    return step && { step, progress: [received, state?.framesShown, state?.barcodeChecked, this.main?.decoded].join() };
  }
  // Returns the step that the next visible change waits for; null: none.
  #missing(): Step | null {
    const { main, drawing: { shown } } = this, state = main?.state(), [step = null] = this.#steps;
    if (!main || !state) return step;
    const holds = shown && !state.seeking && (this.#live || this.host.commands.settings.rate === 0);
    if (holds || (!main.awaits(state) && (shown || !state.hasFrame))) return null;
    if (performance.now() - this.#loop.turnedMs > LATE_TURN_MS) return 'display';
    return !state.hasFrame && this.#steps.has('more') ? 'more' : main.missing(state);
  }
  // Switches to a fallback for the stalled step, where there is one.
  #onStall(step: Step | null): void {
    this.host.stalled(step);
    if (this.ended) return;
    if (step === 'upload') {
      void this.reopenOn('rgba');
    } else if (step === 'decoder') {
      this.main?.replaceDecoders('it gives no picture');
    } else if (step === 'barcode') {
      this.#distrusted = true;
      this.reopen(this.path);
    }
  }

  // --- interface of StageSlot ---
  show(canvas: HTMLCanvasElement): void { if (!this.ended) this.host.overlay.showCanvas(canvas); }
  redraw(): void { this.drawing.redraw(); }
  bytes(): number { return this.main?.bytes() ?? 0; }
  lost(): void {
    this.dispose();
    this.host.lost(this);
  }
  restored(): boolean { return this.host.restored(this); }
  trapped(): void {
    this.dispose();
    this.host.trapped(this);
  }

  readonly network = (waiting: boolean): void => {
    this.#waiting += waiting ? 1 : -1;
    if (!this.ended && this.#waiting === (waiting ? 1 : 0)) this.host.network(waiting);
  };
  openTransport(src: string, cache: RequestCache): Transport {
    const { credentials, signer } = this.options;
    return new Transport(src, this.network, { cache, credentials, signer });
  }
  makeActor(source: Source, commands: Commands, host: ActorHost): Actor {
    const video = this.path === 'video' ? this.later.loaded! : undefined;
    const actor = new Actor({ stage: this.#stage!, path: this.path, readable: this.#readable, video, beside: this.main }, source, commands, host);
    if (!this.#decodes) actor.setInSight(false);
    return actor;
  }

  #open(path: UploadPath): void {
    this.path = path;
    this.drawing.programsMissing = true;
    this.#deciding = !this.#live && path !== 'video' && this.options.uploadPath === 'auto' && !rememberedPath();
    const load = this.#live?.load(kindOf(path), this.#readable);
    const main = this.makeActor({ transport: this.transport, manifest: this.manifest, start: this.#start, load }, this.host.commands, {
      emit: (name, detail) => this.onMainEvent(name, detail),
      wake: () => this.wake(),
      onNoPlanes: () => void this.reopenOn('rgba'),
      more: () => this.more(),
      fatal: (reason) => this.fatal(reason),
    });
    if (this.ended) return main.dispose(); // an error during the actor's creation has ended the session
    this.main = main;
    if (main.character && !this.#live?.keepsCamera(main.character)) this.host.camera.setCharacter(main.character);
    if (!this.drawing.shown) this.host.camera.jump();
    this.later.onOpen();
    this.wake();
  }

  #close(): void {
    this.later.onClose();
    this.main?.dispose();
    this.main = null;
  }

  /** Opens another bake of the character, or the same one again, and continues at the present state. */
  reopen(path: UploadPath, bake: Partial<Bake> = {}): void {
    if (!this.main) return;
    this.drawing.forget();
    if (bake.transport) this.transport.dispose();
    else this.transport.cancelAll();
    this.#close();
    ({ transport: this.transport = this.transport, manifest: this.manifest = this.manifest, start: this.#start = this.#start } = bake);
    try {
      this.#open(path);
    } catch (reason) {
      this.fatal(reason);
    }
  }
  /** Opens the same character on another upload path, and continues at the present state. */
  async reopenOn(path: UploadPath): Promise<void> {
    try {
      await this.more();
      if (!this.ended) this.reopen(path);
    } catch (reason) {
      this.fatal(reason);
    }
  }

  /** Continues on the upload path that was measured as the fastest. */
  async settle(path: UploadPath): Promise<void> {
    this.#deciding = false;
    if (path !== this.path) await this.reopenOn(path);
    else if (this.main?.state()?.hasFrame) this.transport.stopReplay();
    this.wake();
  }

  onMainEvent(name: string, detail?: unknown): void {
    if (name === 'error' && this.#live?.takes(detail as ErrorDetail)) return;
    if (name === 'error' && this.later.renews(detail as ErrorDetail)) return;
    if (name === 'sharper') {
      this.drawing.redraw();
      return this.host.overlay.cover();
    }
    if (name === 'error' && this.#mistrustsPlanes(detail as ErrorDetail)) return;
    if (name === 'canplay') {
      if (!this.#deciding) this.transport.stopReplay();
      this.later.onCanPlay(this.#deciding);
    } else if (name === 'playing' || name === 'pause') {
      this.later.setPlaying(name === 'playing');
    }
    // Dispatches events from within the actor's constructor later: listeners use `main`, which is not set yet.
    if (this.main) this.host.emit(name, detail);
    else queueMicrotask(() => { if (!this.ended) this.host.emit(name, detail); });
  }

  // Handles planes with wrong barcodes, from a damaged file or a browser that alters planes: changes to path 'rgba'.
  #mistrustsPlanes({ id }: ErrorDetail): boolean {
    if (id !== 'video-invalid' || this.path !== 'i420' || !this.main?.state()?.barcodeMismatches) return false;
    void this.reopenOn('rgba');
    return true;
  }

  errorOf(reason: unknown): ErrorDetail { return asViewerError(reason).detail; }

  fatal(reason: unknown): void {
    const stage = this.#stage;
    if (stage?.gl.isContextLost()) return; // lost() follows
    this.end(this.errorOf(reason));
    if (reason instanceof WebAssembly.RuntimeError) stage?.fail();
  }
  end(error: ErrorDetail): void {
    if (this.ended) return;
    this.dispose();
    this.host.emit('error', error);
  }
}
