// SPDX-License-Identifier: Apache-2.0
// One canvas: its GL context, the main character, the companions beside it, and when they are drawn. The element makes
// a session for each src and GL context. After dispose() nothing of it runs any more.
import { Actor, type ActorContext, type ActorHost, type Files } from './actor.js';
import type { Commands } from './commands.js';
import type { Companion } from './companion.js';
import { asViewerError, ViewerError, type ErrorDetail } from './errors.js';
import { checkSnapshot, MAX_CANVAS_SIDE } from './input-checks.js';
import { DrawPace, FrameLoop } from './frame-loop.js';
import type { LiveStream } from './live.js';
import { Transport } from './transport.js';
import { choosePath, kindOf, rememberedPath, rememberPath, uploadPicture, type UploadPath } from './upload-path.js';
import type { WasmModule } from './wasm-abi.js';
import { expectMore, instantiate, loadMore, type More } from './wasm-module.js';
import type { Align, CharacterInfo, OrbitPose } from './wasm-player.js';
import { extensionOf, isFromCameras } from './manifest.js';
import type { SessionHost, SessionOptions, Snapshot } from './session-host.js';

// What the files of two bakes bring when a new one was put in place of the one that is playing.
const mayBeOfTwoBakes = ({ id }: ErrorDetail): boolean => id === 'files-differ' || id === 'fetch-failed';

const FOLLOW_S = 1; // after the last change; six times the settling time of montage4d (native/render/method.h)

const ROOM_FETCH = -1; // the player numbers its requests from 0

const needsFlow = (align: Align): boolean => align.startsWith('flow');

// Error of a file that the page's side of the second part could not load.
const fetchFailed = (reason: unknown): never => { throw new ViewerError('fetch-failed', (reason as Error).message); };

/** A companion that has been loaded. */
interface Other {
  actor: Actor;
  transport: Transport;
}

export class Session {
  readonly #canvas: HTMLCanvasElement;
  readonly #options: SessionOptions;
  readonly #host: SessionHost;
  readonly #files: Transport; // of src at first
  #transport: Files;
  #live: LiveStream | null = null; // the transport, if src is a live stream
  readonly #abort = new AbortController();
  readonly #loop = new FrameLoop((clockS, stepS) => this.#turn(clockS, stepS));
  readonly #pace = new DrawPace();
  #gl: WebGL2RenderingContext | null = null;
  #module: WasmModule | null = null; // with its second part once #more has resolved
  #align: Align; // as the page asked for it; the commands hold what the player does until flow is loaded
  #room: boolean; // whether the character's room is to be drawn
  #looked = false; // a look has been set
  #lookTurn = 0; // counts the attempts to set the look: only the last one counts
  #roomTurn = 0; // counts the attempts to show it: only the last one counts
  #manifest: unknown = null;
  #start: Uint8Array = new Uint8Array();
  #main: Actor | null = null;
  readonly #others = new Map<Companion, Other>();
  readonly #coming = new Set<Companion>();
  #fresh = false; // the character is loaded past the browser's cache
  #unproven = false; // it was loaded anew and could not play yet
  #held: ErrorDetail[] | null = null; // errors that wait for what #renew finds
  readonly #renewedOthers = new WeakSet<Companion>();
  #path: UploadPath = 'i420';
  #video: ActorContext['video']; // of path 'video'
  #shown = false;
  #deciding = false; // the upload path is being measured
  #redraw = true;
  #programsMissing = true; // shader programs that later pictures will need
  #hidden = false;
  #waiting = 0; // for the network: the character, its companions, the player itself
  #drawn = '';
  #changedS = 0; // by the loop's clock: when what is drawn changed last
  #size = { width: 1, height: 1 };

  constructor(canvas: HTMLCanvasElement, options: SessionOptions, host: SessionHost) {
    this.#canvas = canvas;
    this.#options = options;
    this.#host = host;
    this.#align = options.align;
    this.#room = options.room;
    this.#commands.set('align', needsFlow(options.align) ? 'baked' : options.align); // until flow is loaded
    this.#fresh = options.fresh;
    this.#transport = this.#files = new Transport(options.src, this.#network, options.fresh ? 'reload' : undefined);
  }

  /** Loads the character. Never rejects: what goes wrong becomes an error event. */
  async start(): Promise<void> {
    try {
      const { wasmUrl } = this.#options;
      const live = /^wss?:/.test(this.#options.src);
      const path = choosePath(this.#options.uploadPath, live);
      const early = live || path !== 'i420' || needsFlow(this.#align) || this.#hasLook;
      if (early) expectMore(wasmUrl, this.#network);
      const start = live ? null : this.#files.start(); // beside the others, whether the manifest names it or not
      const [files, module] = await Promise.all([live || this.#files.manifest(), instantiate(wasmUrl, this.#network)]);
      if (this.#abort.signal.aborted) return;
      this.#module = module;
      const manifest = live ? await this.#connect() : files;
      if (start && extensionOf(manifest)?.start) this.#start = await start;
      if (this.#abort.signal.aborted) return;
      if (isFromCameras(manifest)) await this.#more();
      // If it does not load, the character begins with 'baked', as filmed and without a scene; #show and useLook try again and
      // report it.
      else if (early || this.#commands.wishes.scene?.length) await this.#more().catch(() => undefined);
      if (this.#abort.signal.aborted) return;
      this.#manifest = manifest;
      this.#gl = this.#canvas.getContext('webgl2', {
        alpha: true, premultipliedAlpha: true, antialias: false, depth: false, stencil: false,
        powerPreference: 'high-performance',
      });
      if (!this.#gl) throw new ViewerError('gpu-failure', 'no WebGL2 context: the browser or its GPU driver refuses one');
      await this.#openOn(path);
    } catch (reason) {
      if (!this.#abort.signal.aborted) this.#fatal(reason);
    }
  }

  // The manifest of the live stream.
  async #connect(): Promise<unknown> {
    const { LiveStream } = await this.#more();
    if (this.#abort.signal.aborted) return null;
    this.#transport = this.#live = new LiveStream(this.#options.src, {
      actor: () => this.#main,
      emit: (name, detail) => this.#host.emit(name, detail),
      network: this.#network,
      replace: (manifest) => {
        this.#manifest = manifest;
        this.#reopen(this.#path);
      },
      fail: (id, message) => this.#fatal(new ViewerError(id, message)),
    });
    return this.#live.manifest();
  }

  dispose(): void {
    this.#abort.abort();
    this.#loop.stop();
    this.#transport.dispose();
    this.#close();
    this.#module = null;
    this.#manifest = null;
  }

  /** After dispose: frees the GL context before the next garbage collection. The canvas cannot be used afterwards. */
  loseContext(): void {
    this.#gl?.getExtension('WEBGL_lose_context')?.loseContext();
    this.#gl = null;
  }

  /** It was disposed of, or an error has ended it. */
  get ended(): boolean { return this.#abort.signal.aborted; }
  /** If src is one, once the player is there. */
  get live(): LiveStream | null { return this.#live; }
  get character(): CharacterInfo | null { return this.#main?.character ?? null; }
  /** A start file has come: the first picture is near. */
  get started(): boolean { return this.#start.length > 0; }
  /** Of the loaded character; undefined before, and for one from cameras. */
  get layers(): number | undefined { return this.#main ? extensionOf(this.#manifest)?.layerCount : undefined; }
  get path(): UploadPath { return this.#path; }
  get #commands(): Commands { return this.#host.commands; }

  /** Optical flow takes effect when its module is loaded; if it does not load, an error event says why. */
  setAlign(align: Align): void {
    this.#align = align;
    this.#programsMissing = true;
    if (!needsFlow(align)) this.#commands.set('align', align);
    else if (this.#shown) void this.#useFlow(align); // else it is loaded after the first picture
  }

  /** The room takes effect when its picture is loaded; if it does not load, an error event says why. */
  setRoom(on: boolean): void {
    this.#room = on;
    this.#main?.player?.hideRoom();
    void this.#useRoom();
  }

  /** Loads another character into the same canvas, unless it is there. If it cannot be, its error event says why. */
  async add(companion: Companion): Promise<void> {
    if (!this.#main || this.#coming.has(companion) || this.#others.has(companion)) return;
    this.#coming.add(companion);
    const cache = this.#renewedOthers.has(companion) ? 'reload' : 'default';
    const transport = new Transport(companion.src ?? this.#options.src, this.#network, cache);
    transport.stopReplay();
    const leave = (): void => transport.dispose();
    for (const signal of [companion.left, this.#abort.signal]) signal.addEventListener('abort', leave);
    try {
      const manifest = await transport.manifest();
      if (isFromCameras(manifest)) await this.#more();
      if (this.#main && !companion.left.aborted) this.#addActor(companion, transport, manifest);
    } catch (reason) {
      if (!this.#abort.signal.aborted && !companion.left.aborted) companion.emit('error', asViewerError(reason).detail);
    }
    this.#coming.delete(companion);
    if (!this.#others.has(companion)) transport.dispose();
  }
  remove(companion: Companion): void {
    this.#drop(companion);
    this.wake();
  }

  resize(width: number, height: number): void {
    const scale = Math.min(1, MAX_CANVAS_SIDE / Math.max(width, height, 1));
    this.#size = { width: Math.max(1, Math.round(width * scale)), height: Math.max(1, Math.round(height * scale)) };
    this.wake();
  }

  /** Off-screen the clock stands still and nothing is drawn; in a hidden page no decoder is held either. */
  setActive(onScreen: boolean, pageHidden: boolean): void {
    if (pageHidden !== this.#hidden) {
      this.#hidden = pageHidden;
      for (const actor of this.#actors) actor.setInSight(!pageHidden);
    }
    const active = onScreen && !pageHidden;
    this.#loop.setActive(active);
    if (active) this.wake();
  }

  wake(): void {
    this.#redraw = true;
    if (this.#main) this.#loop.wake();
  }

  /**
   * A PNG of what is shown, at the size and pose of the snapshot if there is one. Null before the first picture. Rejects
   * with a TypeError, a RangeError or the player's error if there can be no such picture; the one that is shown stays.
   */
  async toBlob(snapshot?: Snapshot): Promise<Blob | null> {
    const { width, height } = snapshot ?? this.#size;
    const pose = { ...this.#host.camera.pose, ...snapshot?.pose };
    if (snapshot) checkSnapshot(width, height, pose);
    if (!this.#main?.state()?.hasFrame) return null;
    try {
      this.#fit(width, height);
      this.#paint(pose);
      return new Promise((resolve) => this.#canvas.toBlob(resolve, 'image/png')); // of what the canvas shows now
    } finally {
      this.#fit(this.#size.width, this.#size.height);
      this.#draw(this.#host.camera.pose);
    }
  }

  readonly #network = (waiting: boolean): void => {
    this.#waiting += waiting ? 1 : -1;
    if (!this.#abort.signal.aborted && this.#waiting === (waiting ? 1 : 0)) this.#host.network(waiting);
  };

  // --- the second part of the player ---

  async #more(): Promise<More> {
    const more = await loadMore(this.#module!, this.#options.wasmUrl, this.#network);
    this.#host.more(more);
    return more;
  }

  // Once it can play, so that the first pictures do not share the network with it. What fails is tried again when it is
  // needed.
  async #loadRest(): Promise<void> {
    const more = await this.#more().catch(() => null);
    if (!more) return;
    if (this.#deciding) this.#main?.takeFrame((frame) => void this.#choosePath(frame, more));
    if (this.#main) this.#advise(this.#main, this.#manifest);
    for (const actor of this.#actors) actor.run((player) => player.moreCame());
    this.#programsMissing = true;
  }

  // Tells the player what the browser expects of its renditions, then lets it look ahead. Without the second part it does
  // without.
  #advise(actor: Actor, manifest: unknown): void {
    this.#more().then(({ advise }) => advise(manifest, actor, actor === this.#main && this.#host.element), () => undefined);
  }

  get #hasLook(): boolean { return this.#host.element.matches('[look]:not([look=""],[look=none]),[method=montage4d]'); }

  /** The element's look takes effect when it is loaded; if it does not load, an error event says why. */
  async useLook(): Promise<void> {
    const turn = ++this.#lookTurn;
    if (!this.#main || !(this.#looked || this.#hasLook)) return; // as filmed
    try {
      const { readLook } = await this.#more();
      const tell = await readLook(this.#host.element).catch(fetchFailed);
      if (turn !== this.#lookTurn || !this.#main) return;
      this.#looked = true;
      this.#main.run((player) => player.tell(tell));
    } catch (reason) {
      if (turn === this.#lookTurn && !this.#abort.signal.aborted) this.#host.emit('error', asViewerError(reason).detail);
    }
  }

  async #useFlow(align: Align): Promise<void> {
    try {
      const { loadOpenCvFlow } = await this.#more();
      if (align === 'flow-opencv') await loadOpenCvFlow(this.#options.opencvUrl, this.#module!).catch(fetchFailed);
      if (!this.#main || this.#align !== align) return;
      if (!this.#commands.set('align', align)) this.#align = this.#commands.wishes.align;
    } catch (reason) {
      if (this.#abort.signal.aborted) return;
      if (this.#align === align) this.#align = this.#commands.wishes.align;
      if (reason instanceof ViewerError) this.#host.emit('error', reason.detail);
      else this.#fatal(reason);
    }
  }

  // --- the room ---

  async #useRoom(): Promise<void> {
    const turn = ++this.#roomTurn;
    const player = this.#main?.player;
    const info = this.#main?.character;
    if (!this.#room || !player || !info) return;
    if (!info.roomUri) return console.warn('fourdvt-viewer: this character has no room, so none is drawn');
    try {
      await this.#more();
      const bytes = await this.#transport.range(ROOM_FETCH, info.roomUri, 0, info.roomBytes);
      if (!bytes || turn !== this.#roomTurn) return;
      const texture = player.showRoom(bytes); // nothing is seen of it until it is filled
      const picture = await createImageBitmap(new Blob([bytes as BlobPart]), { colorSpaceConversion: 'none' });
      if (turn === this.#roomTurn) {
        uploadPicture(this.#gl!, texture, picture, true);
        this.#gl!.generateMipmap(this.#gl!.TEXTURE_2D);
        player.invalidateState();
        this.wake();
      }
      picture.close();
    } catch (reason) {
      if (turn === this.#roomTurn) this.#onMainEvent('error', asViewerError(reason).detail);
    }
  }

  // --- opening and closing characters ---

  #context(beside: Actor | null): ActorContext {
    return { module: this.#module!, gl: this.#gl!, path: this.#path, video: this.#video, beside };
  }

  // Paths other than 'i420' need the second part: it reads the pictures' numbers back.
  async #openOn(path: UploadPath): Promise<void> {
    if (path !== 'i420') {
      const more = await this.#more();
      this.#video = path === 'video' ? more : undefined;
    }
    if (!this.#abort.signal.aborted) this.#open(path);
  }

  #open(path: UploadPath): void {
    this.#path = path;
    this.#programsMissing = true;
    this.#deciding = !this.#live && path !== 'video' && this.#options.uploadPath === 'auto' && !rememberedPath();
    const source = { transport: this.#transport, manifest: this.#manifest, start: this.#start, load: this.#live?.load(kindOf(path)) };
    const main = new Actor(this.#context(null), source, this.#commands, {
      emit: (name, detail) => this.#onMainEvent(name, detail),
      wake: () => this.wake(),
      onNoPlanes: () => void this.#reopenOn('rgba'),
      more: () => this.#more(),
      fatal: (reason) => this.#fatal(reason),
    });
    if (this.#abort.signal.aborted) return main.dispose(); // an error during its creation has ended the session
    this.#main = main;
    if (this.#hidden) main.setInSight(false);
    if (main.character && !this.#live?.keepsCamera(main.character)) this.#host.camera.setCharacter(main.character);
    if (!this.#shown) this.#host.camera.jump();
    void this.#useRoom();
    void this.useLook();
    this.wake();
  }

  #addActor(companion: Companion, transport: Transport, manifest: unknown): void {
    const { commands } = companion;
    commands.set('playing', this.#commands.wishes.playing);
    commands.set('align', this.#align === 'none' ? 'none' : 'baked');
    const host: ActorHost = {
      emit: (name, detail) => {
        if (name !== 'error' || !this.#addAgain(companion, detail as ErrorDetail)) companion.emit(name, detail);
      },
      wake: () => this.wake(),
      fatal: (reason) => this.#fatal(reason),
      more: () => this.#more(),
      onNoPlanes: () => companion.emit('error',
        new ViewerError('video-invalid', 'the pictures of this video cannot be read here').detail),
    };
    const actor = new Actor(this.#context(this.#main), { transport, manifest, start: new Uint8Array() }, commands, host);
    this.#others.set(companion, { actor, transport });
    if (this.#hidden) actor.setInSight(false);
    this.#advise(actor, manifest);
    // A listener of its first events may have removed it.
    if (companion.left.aborted || this.#abort.signal.aborted) this.remove(companion);
    this.wake();
  }

  // True if the companion is being loaded anew, once, instead of reporting the error.
  #addAgain(companion: Companion, error: ErrorDetail): boolean {
    if (!mayBeOfTwoBakes(error) || this.#renewedOthers.has(companion)) return false;
    this.#renewedOthers.add(companion);
    queueMicrotask(() => {
      if (!this.#others.has(companion)) return;
      this.#drop(companion);
      void this.add(companion);
    });
    return true;
  }

  // Looks whether there is a new bake where the character was loaded from, and goes on with that. Files that differ
  // from their manifest without one may be leftovers in the browser's cache: they are loaded again, past it.
  async #renew(error: ErrorDetail): Promise<void> {
    this.#held = [error];
    const transport = new Transport(this.#options.src, this.#network, 'reload');
    const leave = (): void => transport.dispose();
    this.#abort.signal.addEventListener('abort', leave);
    const manifest = await transport.manifest().catch(() => null);
    const start = extensionOf(manifest)?.start ? await transport.start() : new Uint8Array();
    if (isFromCameras(manifest)) await this.#more().catch(() => undefined);
    const errors = this.#held;
    this.#held = null;
    if (this.#abort.signal.aborted || !this.#main) return leave();
    const isNew = manifest !== null && JSON.stringify(manifest) !== JSON.stringify(this.#manifest);
    const mayBeCached = manifest !== null && !this.#fresh && errors.some(({ id }) => id === 'files-differ');
    if (!isNew && !mayBeCached) {
      leave();
      for (const detail of errors) this.#host.emit('error', detail);
      return;
    }
    this.#fresh = this.#unproven = true;
    this.#transport.dispose();
    this.#transport = transport;
    this.#manifest = manifest;
    this.#start = start;
    this.#reopen(this.#path);
  }

  #onMainEvent(name: string, detail?: unknown): void {
    if (name === 'error' && this.#live?.takes(detail as ErrorDetail)) return;
    if (name === 'error' && this.#main && mayBeOfTwoBakes(detail as ErrorDetail)) {
      if (this.#held) return void this.#held.push(detail as ErrorDetail);
      if (!this.#unproven) return void this.#renew(detail as ErrorDetail);
    }
    if (name === 'canplay') {
      this.#unproven = false;
      if (!this.#deciding) this.#transport.stopReplay();
      void this.#loadRest();
      for (const companion of this.#host.companions) void this.add(companion);
    } else if (name === 'playing' || name === 'pause') {
      for (const { commands } of this.#others.keys()) commands.set('playing', name === 'playing');
    }
    // The first events come while the actor is being made, but the element's listeners ask for it: they get them later.
    if (this.#main) this.#host.emit(name, detail);
    else queueMicrotask(() => { if (!this.#abort.signal.aborted) this.#host.emit(name, detail); });
  }

  #drop(companion: Companion): void {
    const other = this.#others.get(companion);
    this.#others.delete(companion);
    other?.transport.dispose();
    other?.actor.dispose();
  }

  // The companions are loaded again when the next main character can play.
  #close(): void {
    for (const companion of [...this.#others.keys()]) this.#drop(companion);
    ++this.#roomTurn;
    this.#main?.dispose();
    this.#main = null;
  }

  // Opens the same character on another upload path; it goes on from where it is.
  async #reopenOn(path: UploadPath): Promise<void> {
    try {
      await this.#more();
      if (!this.#abort.signal.aborted) this.#reopen(path);
    } catch (reason) {
      this.#fatal(reason);
    }
  }

  #reopen(path: UploadPath): void {
    if (!this.#main) return;
    this.#drawn = '';
    this.#transport.cancelAll();
    this.#close();
    try {
      this.#open(path);
    } catch (reason) {
      this.#fatal(reason);
    }
  }

  async #choosePath(frame: VideoFrame, { measurePath }: More): Promise<void> {
    const gl = this.#gl;
    if (!gl) return frame.close();
    let path: UploadPath = this.#path;
    try {
      path = await measurePath(gl, frame, () => this.#main?.player?.invalidateState());
    } catch {
      // it cannot be measured here: stay on the path that works
    } finally {
      frame.close();
    }
    if (this.#abort.signal.aborted || gl.isContextLost()) return;
    rememberPath(path);
    this.#deciding = false;
    if (path !== this.#path) await this.#reopenOn(path);
    else if (this.#main?.state()?.hasFrame) this.#transport.stopReplay();
    this.wake();
  }

  // --- drawing ---

  // The main character first, if there is one.
  get #actors(): Actor[] {
    return this.#main ? [this.#main, ...Array.from(this.#others.values(), ({ actor }) => actor)] : [];
  }

  #turn(clockS: number, stepS: number): boolean {
    for (const actor of this.#actors) actor.tick(clockS);
    const moved = this.#host.animate(stepS);
    const actors = this.#actors;
    const states = actors.map((actor) => actor.state());
    const [state] = states; // the main character's
    if (!state) return false;
    this.#host.camera.follow(state);
    const serial = states.map((s) => s && [s.framesShown, s.frame, s.x, s.z, s.heading]).join();
    const changed = moved || this.#redraw || serial !== this.#drawn;
    if (changed) this.#changedS = clockS;
    // What follows with time takes the time since the last tick for that since the last picture: it is drawn every turn.
    const following = this.#host.element.matches('[method^=montage4d]') && clockS - this.#changedS < FOLLOW_S;
    // One a turn, after the first picture: neither that nor the first use of a slider has to wait for them.
    if (this.#shown && state.hasFrame && this.#programsMissing) this.#programsMissing = actors[0]!.makeNextProgram();
    if ((changed || following) && state.hasFrame) {
      const picture = this.#redraw || following || serial !== this.#drawn;
      this.#redraw = !this.#pace.takes(stepS, picture);
      if (!this.#redraw) this.#show(serial);
    }
    return moved || following || actors.some((actor, i) => states[i] && actor.busy(states[i]!));
  }

  #show(serial: string): void {
    this.#fit(this.#size.width, this.#size.height);
    if (!this.#draw(this.#host.camera.pose)) return;
    this.#drawn = serial;
    if (this.#shown) return;
    this.#shown = true;
    this.#host.firstPicture();
    if (needsFlow(this.#align)) void this.#useFlow(this.#align);
  }

  #fit(width: number, height: number): void {
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
  }

  // Once the main character has a frame.
  #paint(pose: OrbitPose): void {
    const [main, ...others] = this.#actors.filter((actor) => actor.state()?.hasFrame);
    main?.player?.draw(pose, this.#canvas.width, this.#canvas.height, others.map((actor) => actor.player!));
  }
  // False, after an error event, if the player cannot.
  #draw(pose: OrbitPose): boolean {
    try {
      this.#paint(pose);
      return !!this.#main;
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
