// SPDX-License-Identifier: Apache-2.0
// <fourdvt-viewer>: composes session (loading and playing), commands, orbit camera, controls and overlay.
// Attributes and events follow <model-viewer> and the media element; web/README.md lists them.
import { Commands } from './commands.js';
import { JOIN_EVENT, type Companion } from './companion.js';
import { deferred, type Deferred } from './deferred.js';
import { asViewerError, characterAddress, dispatch, ViewerError, type ErrorDetail } from './errors.js';
import { FourdvtCharacter } from './fourdvt-character.js';
import { checkRenderOptions } from './input-checks.js';
import { methodOf } from './method-attributes.js';
import type { LiveState } from './live.js';
import type { MotionControls } from './motion-controls.js';
import type { More } from './wasm-module.js';
import { OrbitCamera, parseOrbit, parseTarget, type Follow } from './orbit-camera.js';
import { OrbitControls } from './orbit-controls.js';
import { Overlay } from './overlay.js';
import { qualityOf } from './quality-attribute.js';
import { Session } from './session.js';
import type { SessionHost, Snapshot } from './session-host.js';
import { statsOf, type ViewerStats } from './stats.js';
import type { UploadChoice as UploadPath } from './upload-path.js';
import {
  ALIGN_MODES, type Align, type ParameterInfo, type Placement, type RenderOptions, type SceneMesh,
  type SequenceInfo,
} from './wasm-player.js';

export { FourdvtCharacter };
export type { Align, ErrorDetail, LiveState, ParameterInfo, Placement, RenderOptions, SceneMesh, SequenceInfo, Snapshot, UploadPath, ViewerStats };

export interface Orbit {
  azimuth: number;
  elevation: number;
  distance: number;
}

const STEER_DEG = 60;            // a held key asks for a heading this far from the present one
const PARAMETER_RANGES_S = 0.7;  // share of the parameter's range that a held key crosses per second
const MAX_PIXEL_RATIO = 2;
// Until the stream's index has come the total is too small; this keeps the progress bar from being full too early.
const MIN_TOTAL_BYTES = 300_000;
const AUTO_ROTATE_DEG_S = 14;
const AUTO_ROTATE_RESUME_S = 4;
const CONTEXT_PATIENCE_MS = 5000; // browsers that give a GL context back do so within a second
const DEFAULT_RENDER: RenderOptions = {
  background: [0, 0, 0, 0], groundShadow: true, shadowStrength: 0.45, samples: 4, debug: 'none', debugLayer: 0,
};

export class FourdvtViewer extends HTMLElement {
  // A new one needs: an entry here, unless it is read only when needed, as autoplay and zoom are; a case in
  // attributeChangedCallback; reading when the element connects (#load, #applyCamera or #applyLabels); a property, if
  // scripts set it; and a row in web/README.md.
  static readonly observedAttributes = [
    'src', 'poster', 'alt', 'loop', 'auto-rotate', 'camera-controls', 'camera-orbit', 'camera-target', 'field-of-view',
    'sequence', 'touch-action', 'motion-controls', 'camera-follow', 'travel', 'align', 'method', 'cameras', 'visibility',
    'background', 'look', 'look-strength', 'light', 'light-turn', 'quality',
  ];
  /** Address of the player's wasm file: beside the script, unless it is set before the first element loads. */
  static wasmUrl = new URL(`fourdvt-viewer.wasm${FOURDVT_VERSION}`, import.meta.url).href;
  /** Address of the OpenCV module, which is fetched only for align="flow-opencv". */
  static opencvUrl = new URL(`fourdvt-opencv.js${FOURDVT_VERSION}`, import.meta.url).href;

  readonly #overlay: Overlay;
  readonly #camera = new OrbitCamera();
  readonly #reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  readonly #commands = new Commands();
  readonly #companions = new Set<Companion>();
  readonly #host: SessionHost;
  #controls: OrbitControls | null = null;
  #motion: MotionControls | null = null;
  #session: Session | null = null;
  #canvas: HTMLCanvasElement | null = null;
  #observers: AbortController | null = null;
  #size = { width: 1, height: 1 };
  #visible = true;
  #sinceInteraction = Infinity;
  #turns = false; // by keys or joystick
  #error: ErrorDetail | null = null;
  #loading = false;
  #loaded: string | null = null; // src of what is shown, or was shown when the element left the page
  #stopped = false;              // somebody has paused it
  #sought: { time?: number; frame?: number } = {}; // before there was a source
  #played: Deferred | null = null;
  #contextTimer = 0;

  constructor() {
    super();
    this.#overlay = new Overlay(this.attachShadow({ mode: 'open' }), () => this.play(), () => this.#load(true, true));
    this.#host = {
      element: this,
      camera: this.#camera,
      commands: this.#commands,
      companions: this.#companions,
      animate: (dt) => this.#animate(dt),
      emit: (name, detail) => this.#onSessionEvent(name, detail),
      firstPicture: () => {
        this.#overlay.ready();
        this.#emit('loadeddata');
      },
      network: (waiting) => this.#onNetwork(waiting),
      more: (more) => this.#addMotion(more),
    };
    this.#commands.set('options', DEFAULT_RENDER);
    this.addEventListener(JOIN_EVENT, (e) => this.#onJoin(e as CustomEvent<Companion>));
  }

  // --- properties like the media element's ---

  get src(): string { return this.getAttribute('src') ?? ''; }
  set src(value: string) { this.setAttribute('src', value); }
  get poster(): string { return this.getAttribute('poster') ?? ''; }
  set poster(value: string) { this.setAttribute('poster', value); }
  get autoplay(): boolean { return this.hasAttribute('autoplay'); }
  set autoplay(value: boolean) { this.toggleAttribute('autoplay', value); }
  get loop(): boolean { return this.hasAttribute('loop') && this.getAttribute('loop') !== 'false'; }
  set loop(value: boolean) { this.setAttribute('loop', value ? '' : 'false'); }
  get paused(): boolean { return !this.#commands.wishes.playing; }
  get error(): ErrorDetail | null { return this.#error; }
  get duration(): number { return this.#session?.live ? Infinity : this.#current()?.duration ?? NaN; }
  get currentTime(): number { return this.#commands.state()?.currentTimeS ?? this.#commands.wishes.time ?? 0; }
  set currentTime(value: number) {
    if (!Number.isFinite(Number(value))) throw new TypeError('currentTime must be a number of seconds');
    this.#emit('seeking');
    if (!this.#session) this.#sought = { time: Number(value) };
    this.#commands.seek(Number(value));
  }
  get playbackRate(): number { return this.#commands.wishes.rate; }
  set playbackRate(value: number) {
    if (!(value > 0 && value <= 4)) throw new RangeError('playbackRate must be above 0 and at most 4');
    this.#commands.set('rate', value);
    this.#emit('ratechange');
  }
  /** Resolves when it plays; rejects if it is paused, reloaded or removed before, or if an error comes instead. */
  play(): Promise<void> {
    this.#stopped = false;
    this.#overlay.offerPlay(false);
    const state = this.#commands.state();
    if (state?.hasFrame && !state.paused && !state.seeking) return Promise.resolve();
    const { promise } = (this.#played ??= deferred());
    if (this.#error && this.#standsStill) this.#settlePlay(new ViewerError(this.#error.id, this.#error.message));
    if (this.paused) {
      this.#commands.remember('playing', true);
      this.#emit('play');
      this.#commands.set('playing', true);
    }
    return promise;
  }
  pause(): void {
    this.#stopped = true;
    this.#settlePlay(new DOMException('paused before it played', 'AbortError'));
    if (this.paused) return;
    this.#commands.set('playing', false);
    if (!this.#session?.character) this.#emit('pause');
  }

  /** Loads the character again, from the start. Any error before is forgotten. */
  load(): void {
    if (this.#observers) this.#load();
  }

  // --- what a character has beyond a video ---

  get frame(): number { return this.#commands.state()?.frame ?? 0; }
  seekFrame(frame: number): void {
    this.#emit('seeking');
    if (!this.#session) this.#sought = { frame };
    this.#commands.seekFrame(frame);
  }
  get sequence(): string { return this.#current()?.name ?? this.getAttribute('sequence') ?? ''; }
  set sequence(name: string) { this.setAttribute('sequence', name); }
  get sequences(): SequenceInfo[] { return this.#session?.character?.sequences ?? []; }

  // --- motion ---

  /** Parameters of the motion shown, with their ranges; none for a plain motion. */
  get parameters(): ParameterInfo[] { return this.#current()?.parameters ?? []; }
  /** Lets the motion glide to the value, or jump if `immediate`. A value out of range counts as the range's end. */
  setParameter(name: string, value: number, immediate = false): void {
    if (!Number.isFinite(value)) throw new TypeError(`${name} must be a number`);
    this.#commands.setParameter(name, value, immediate);
    this.#emit('parameterchange', { name, value });
  }
  /** The value as shown now; NaN if the character has no such parameter. */
  getParameter(name: string): number { return this.#commands.parameter(name); }
  /** Goes over to another motion by the best transition. A motion without loop returns by itself. */
  goTo(state: string): void { this.#commands.goTo(state); }
  /** The motion that was asked for last, or the one that is shown. */
  get state(): string { return this.#commands.state()?.goal || this.sequence; }
  get inTransition(): boolean { return this.#commands.state()?.inTransition ?? false; }
  /** Degrees, from +z towards +x. Setting it makes the character turn to it while it moves. */
  get heading(): number { return this.#commands.placement.heading; }
  set heading(degrees: number) {
    if (!Number.isFinite(degrees)) throw new TypeError('heading must be a number of degrees');
    this.#commands.steer(degrees);
  }
  /** Where the character stands. Setting it puts the character there at once. */
  get placement(): Placement { return this.#commands.placement; }
  set placement(place: Partial<Placement>) {
    const at = { ...this.placement, ...place };
    if (![at.x, at.z, at.heading].every(Number.isFinite)) throw new TypeError('x, z and heading must be numbers');
    this.#commands.place(at);
  }
  /** Whether root motion moves the character over the ground. */
  get travel(): boolean { return this.hasAttribute('travel'); }
  set travel(on: boolean) { this.toggleAttribute('travel', on); }
  get align(): Align {
    const wish = this.getAttribute('align') as Align | null;
    return wish && ALIGN_MODES.includes(wish) ? wish : 'baked';
  }
  set align(value: Align) { this.setAttribute('align', value); }
  /** 'auto', 'highest', or a rendition's number, 0 for the lowest. */
  get quality(): string { return this.getAttribute('quality') || 'auto'; }
  set quality(value: string) { this.setAttribute('quality', value); }
  /** How a character from cameras is drawn, once it is loaded; web/README.md lists the methods. */
  get method(): string { return methodOf(this).name || this.#session?.character?.method || ''; }
  set method(name: string) { this.setAttribute('method', name); }
  /** Meshes that the characters stand among; web/README.md says what they consist of. */
  get scene(): SceneMesh[] { return this.#commands.wishes.scene ?? []; }
  set scene(meshes: SceneMesh[]) {
    const scene = meshes.map((mesh) => ({ ...mesh, corners: Float32Array.from(mesh.corners) }));
    const whole = scene.every(({ corners }) => corners.length % 18 === 0 && corners.every(Number.isFinite));
    if (!whole) throw new RangeError('a scene mesh needs 18 finite numbers per triangle');
    this.#commands.set('scene', scene.filter(({ corners }) => corners.length > 0));
  }

  /** State of a live stream; null for other characters. */
  get liveState(): LiveState | null { return this.#session?.live?.state ?? null; }
  /** Seconds from capture to now, of the live frame that is shown; NaN while that is not known. */
  get liveLatency(): number { return this.#session?.live?.latency ?? NaN; }

  getCameraOrbit(): Orbit {
    const { azimuth, elevation, distance } = this.#camera.pose;
    return { azimuth, elevation, distance };
  }
  /** Ends the camera's glide towards its goal. */
  jumpCameraToGoal(): void {
    this.#camera.jump();
    this.#session?.wake();
  }
  /** Background, ground shadow, multisampling, debug views. Assigning some of the options keeps the others. */
  get renderOptions(): RenderOptions { return { ...this.#commands.wishes.options! }; }
  set renderOptions(options: Partial<RenderOptions>) {
    const all = { ...this.renderOptions, ...options };
    checkRenderOptions(all, this.#session?.layers);
    this.#commands.set('options', all);
  }
  /** How decoded pictures reach the GPU; 'auto' measures what is faster. Takes effect at the next load. */
  get uploadPath(): UploadPath { return (this.getAttribute('upload-path') ?? 'auto') as UploadPath; }
  set uploadPath(value: UploadPath) { this.setAttribute('upload-path', value); }
  get stats(): ViewerStats | null {
    const state = this.#commands.state();
    return state && statsOf(state, this.#session!.path);
  }
  /** A PNG of the shown frame, at the size and pose of the snapshot if there is one. Null before the first picture. */
  toBlob(snapshot?: Snapshot): Promise<Blob | null> {
    return this.#session?.toBlob(snapshot) ?? Promise.resolve(null);
  }

  override focus(options?: FocusOptions): void { this.#overlay.stage.focus(options); }

  // --- life in the document ---

  connectedCallback(): void {
    if (this.#observers) return; // moved within the page: it goes on
    this.#observe();
    this.#controls = new OrbitControls(this.#overlay.stage, this.#camera, {
      orbits: () => this.hasAttribute('camera-controls'),
      wheelZooms: () => this.hasAttribute('zoom'),
      onInteract: () => this.#interacted(),
      togglePlay: () => (this.paused ? void this.play() : this.pause()),
    });
    const back = this.#loaded !== null && this.#loaded === this.src;
    if (!back) this.#applyCamera();
    this.#applyLabels();
    this.#load(back);
  }

  #addMotion(more: More): void {
    if (!this.#observers) return;
    this.#motion ??= new more.MotionControls(this.#overlay.stage, this.#overlay.joystick, {
      steers: () => this.hasAttribute('motion-controls'),
      act: () => this.#act(),
      onInteract: () => {
        this.#stopTurning(); // at once: a frame later the character has turned on by some degrees
        this.#session?.wake();
      },
    });
  }

  // A move within the page takes the element out and puts it back at once.
  disconnectedCallback(): void {
    queueMicrotask(() => { if (!this.isConnected) this.#leave(); });
  }
  #leave(): void {
    this.#observers?.abort();
    this.#observers = null;
    this.#controls?.dispose();
    this.#controls = null;
    this.#motion?.dispose();
    this.#motion = null;
    this.#unload();
    this.#overlay.idle();
  }

  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (!this.#observers) { // connectedCallback will read all attributes
      this.#loaded = null;
      return;
    }
    // The same motion or source again: another try, or back from where goTo has led.
    if (before === value && name !== 'sequence' && name !== 'src') return;
    switch (name) {
      case 'src': this.#load(); break;
      case 'poster': this.#overlay.setPoster(value); break;
      case 'loop': this.#commands.set('loop', this.#loopMode()); break;
      case 'sequence': if (value) this.#commands.select(value); break;
      case 'align': this.#session?.setAlign(this.align); break;
      case 'method': case 'cameras': case 'visibility':
        this.#commands.set('method', methodOf(this));
        void this.#session?.useLook();
        break;
      case 'quality': this.#applyQuality(); break;
      case 'look': case 'look-strength': case 'light': case 'light-turn': void this.#session?.useLook(); break;
      case 'background': this.#session?.setRoom(this.#room); break;
      case 'travel': this.#commands.set('travel', this.travel); break;
      case 'camera-orbit': case 'camera-target': case 'camera-follow': case 'field-of-view': this.#applyCamera(); break;
      default: this.#applyLabels();
    }
    this.#session?.wake();
  }

  get #room(): boolean { return this.getAttribute('background') === 'room'; }

  // `on`: goes on where it was.
  // fresh: past the browser's cache, which may hold what was not whole.
  #load(on = false, fresh = false): void {
    this.#unload();
    this.#error = null;
    this.#loaded = this.src || null;
    this.#overlay.idle();
    if (!this.src) return;
    this.#loading = true;
    this.#overlay.setPoster(this.poster || null);
    this.#overlay.loading();
    if (!on) {
      this.#commands.begin({ sequence: this.getAttribute('sequence'), loop: this.#loopMode(), travel: this.travel,
        method: methodOf(this), ...this.#sought });
      this.#sought = {};
      for (const { src, commands } of this.#companions) if (src === null) commands.begin();
      if (this.autoplay && !this.#stopped) this.#commands.remember('playing', !this.#reducedMotion.matches);
    }
    this.#overlay.offerPlay(this.paused);
    this.#emit('loadstart');
    const canvas = (this.#canvas = this.#overlay.newCanvas());
    canvas.addEventListener('webglcontextlost', this.#onContextLost);
    canvas.addEventListener('webglcontextrestored', this.#onContextRestored);
    this.#startSession(canvas, fresh);
  }

  #startSession(canvas: HTMLCanvasElement, fresh = false): void {
    let src: string;
    try {
      src = characterAddress(this.src, this.baseURI);
    } catch (reason) {
      // Not at once: whoever has just set it wants to listen first.
      return queueMicrotask(() => { if (canvas === this.#canvas) this.#onSessionEvent('error', asViewerError(reason).detail); });
    }
    const session = (this.#session = new Session(canvas, {
      src,
      wasmUrl: FourdvtViewer.wasmUrl,
      opencvUrl: FourdvtViewer.opencvUrl,
      uploadPath: this.uploadPath,
      align: this.align,
      room: this.#room,
      fresh,
    }, this.#host));
    session.resize(this.#size.width, this.#size.height);
    this.#updateActive();
    void session.start();
  }

  #unload(): void {
    this.#canvas?.removeEventListener('webglcontextlost', this.#onContextLost);
    this.#canvas?.removeEventListener('webglcontextrestored', this.#onContextRestored);
    clearTimeout(this.#contextTimer);
    const session = this.#session;
    this.#session = null;
    session?.dispose();
    session?.loseContext();
    this.#overlay.dropCanvas();
    this.#settlePlay(new DOMException('another character was loaded, or the viewer was removed', 'AbortError'));
    this.#canvas = null;
  }

  readonly #onContextLost = (e: Event): void => {
    e.preventDefault(); // asks the browser to restore it
    const session = this.#session;
    this.#session = null;
    session?.dispose();
    this.#emit('waiting');
    this.#awaitContext();
  };
  readonly #onContextRestored = (): void => {
    clearTimeout(this.#contextTimer);
    this.#forgetError();
    if (this.#canvas) this.#startSession(this.#canvas);
  };
  // A hidden page may get its context back when it is shown again.
  #awaitContext(): void {
    this.#contextTimer = setTimeout(() => {
      if (document.hidden) this.#awaitContext();
      else this.#onSessionEvent('error', { id: 'gpu-failure', message: 'the browser took the GPU away and did not give it back; try again, or reload the page' });
    }, CONTEXT_PATIENCE_MS);
  }

  #observe(): void {
    const stop = (this.#observers = new AbortController());
    const resize = new ResizeObserver((entries) => this.#onResize(entries[entries.length - 1]!));
    resize.observe(this);
    const intersection = new IntersectionObserver((entries) => {
      this.#visible = entries[entries.length - 1]!.isIntersecting;
      this.#updateActive();
    });
    intersection.observe(this);
    stop.signal.addEventListener('abort', () => {
      resize.disconnect();
      intersection.disconnect();
    });
    document.addEventListener('visibilitychange', () => this.#updateActive(), { signal: stop.signal });
  }
  #updateActive(): void {
    this.#session?.setActive(this.#visible, document.hidden);
  }

  #onResize(entry: ResizeObserverEntry): void {
    const ratio = Math.min(devicePixelRatio, MAX_PIXEL_RATIO);
    const { width, height } = entry.contentRect;
    this.#size = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
    this.#applyQuality();
    if (height > 0) this.#camera.setAspect(width / height);
    this.#session?.resize(this.#size.width, this.#size.height);
    if (!this.#interactedYet) this.#camera.jump();
  }
  get #interactedYet(): boolean { return this.#sinceInteraction !== Infinity; }

  // --- camera ---

  #applyCamera(): void {
    const fov = parseFloat(this.getAttribute('field-of-view') ?? '');
    this.#camera.fov = fov >= 5 && fov <= 120 ? fov : 35;
    this.#camera.setTarget(parseTarget(this.getAttribute('camera-target')));
    const follow = this.getAttribute('camera-follow');
    this.#camera.setFollow((['position', 'behind'] as (string | null)[]).includes(follow) ? follow as Follow : 'none');
    if (this.#session?.character) this.#camera.setCharacter(this.#session.character);
    this.#camera.setHome(parseOrbit(this.getAttribute('camera-orbit')));
    if (!this.#session?.character || this.#reducedMotion.matches) this.#camera.jump();
  }

  #animate(dtS: number): boolean {
    this.#sinceInteraction += dtS;
    const rotating = this.hasAttribute('auto-rotate') && !this.#reducedMotion.matches && !this.#controls?.dragging &&
      this.#sinceInteraction > AUTO_ROTATE_RESUME_S;
    if (rotating) this.#camera.rotate(AUTO_ROTATE_DEG_S * dtS, 0);
    if (this.#reducedMotion.matches) this.#camera.jump();
    const steering = this.#steer(dtS);
    return this.#camera.update(dtS) || rotating || steering;
  }

  // Held keys and the joystick change the wanted heading and the first parameter.
  #steer(dtS: number): boolean {
    const wish = this.#motion?.steering;
    if (!wish || this.paused) return false;
    if (wish.turn) {
      this.heading = this.heading - STEER_DEG * wish.turn;
      this.#turns = true;
    } else {
      this.#stopTurning();
    }
    const parameter = this.parameters[0];
    if (parameter && (wish.change || wish.level !== null)) {
      const { name, min, max } = parameter;
      const now = this.#commands.wishedParameter(name) ?? this.getParameter(name);
      const wanted = wish.level !== null ? min + (max - min) * wish.level : now + wish.change * (max - min) * PARAMETER_RANGES_S * dtS;
      const value = Math.min(max, Math.max(min, wanted));
      if (value !== now) {
        this.setParameter(name, value);
      }
    }
    return wish.turn !== 0 || wish.change !== 0 || wish.level !== null;
  }

  // The heading that was wanted lies ahead: once keys and joystick are let go, it is the present one.
  #stopTurning(): void {
    if (!this.#turns || this.#motion?.steering?.turn) return;
    this.#turns = false;
    const { heading } = this;
    this.heading = heading;
  }

  // Space plays the motion named by the attribute `action`, or else the first one that does not loop.
  #act(): void {
    if (this.paused) return void this.play();
    const action = this.getAttribute('action') ?? this.sequences.find((s) => !s.loop)?.name;
    if (action && this.state !== action) this.goTo(action);
  }

  #interacted(): void {
    this.#sinceInteraction = 0;
    this.#session?.wake();
    this.#emit('camera-change');
  }

  #applyQuality(): void {
    const wish = qualityOf(this, this.#size.height), { quality: before } = this.#commands.wishes;
    if (before?.rendition !== wish.rendition || before.mostTexels !== wish.mostTexels) this.#commands.set('quality', wish);
  }

  #applyLabels(): void {
    this.#overlay.setLabel(this.getAttribute('alt') ?? '', this.hasAttribute('camera-controls'), this.hasAttribute('motion-controls'));
    this.#overlay.setTouchAction(this.getAttribute('touch-action') ?? 'pan-y');
  }

  // --- events ---

  #onSessionEvent(name: string, detail?: unknown): void {
    if (name === 'progress') {
      const { loaded, total } = detail as { loaded: number; total: number };
      if (this.#loading) this.#overlay.progress(Math.min(1, loaded / Math.max(total, MIN_TOTAL_BYTES)));
    } else if (name === 'loadedmetadata') {
      this.#onMetadata();
    } else if (name === 'canplay') {
      this.#loading = false;
      this.#forgetError();
    } else if (name === 'playing') {
      this.#forgetError();
      this.#played?.resolve();
      this.#played = null;
    } else if (name === 'seeked' || name === 'sequencechange') {
      this.#forgetError();
    } else if (name === 'ended') {
      this.#commands.remember('playing', false);
    } else if (name === 'error') {
      this.#onError(detail as ErrorDetail);
    }
    this.#emit(name, detail);
  }

  // The panel is for errors that leave nothing to look at, or the wanted motion standing still; a command that was
  // refused changes nothing.
  #onError(error: ErrorDetail): void {
    this.#error = error;
    const over = this.#loading || (this.#session?.ended ?? true);
    this.#loading = false;
    if (!over && !this.#standsStill) return;
    this.#settlePlay(new ViewerError(error.id, error.message));
    this.#overlay.fail(error, over);
  }
  // Nothing will come of what is wanted.
  get #standsStill(): boolean { return (this.#session?.ended ?? true) || (this.#commands.state()?.failed ?? false); }
  #forgetError(): void {
    this.#error = null;
    this.#overlay.recover();
  }

  #onNetwork(waiting: boolean): void {
    this.#overlay.note(waiting ? 'Waiting for the network …' : null);
    if (waiting) this.#emit('stalled');
  }

  #settlePlay(reason: Error): void {
    this.#played?.reject(reason);
    this.#played = null;
  }

  #onMetadata(): void {
    const poster = this.#session?.character?.posterUri;
    if (poster && !this.#session?.started && !this.#overlay.hasPoster) this.#overlay.setPoster(new URL(poster, new URL(this.src, this.baseURI)).href);
  }

  #onJoin(event: CustomEvent<Companion>): void {
    event.stopPropagation();
    const companion = event.detail;
    this.#companions.add(companion);
    void this.#session?.add(companion);
    companion.left.addEventListener('abort', () => {
      this.#companions.delete(companion);
      this.#session?.remove(companion);
    });
  }

  #emit(name: string, detail?: unknown): void {
    dispatch(this, name, detail);
  }

  #current(): SequenceInfo | null {
    return this.#session?.character?.sequences[this.#commands.state()?.sequence ?? -1] ?? null;
  }
  /** -1 as the sequence says, 0 never, 1 always. */
  #loopMode(): number {
    if (!this.hasAttribute('loop')) return -1;
    return this.loop ? 1 : 0;
  }
}

if (!customElements.get('fourdvt-viewer')) customElements.define('fourdvt-viewer', FourdvtViewer);
if (!customElements.get('fourdvt-character')) customElements.define('fourdvt-character', FourdvtCharacter);

declare global {
  interface HTMLElementTagNameMap {
    'fourdvt-viewer': FourdvtViewer;
    'fourdvt-character': FourdvtCharacter;
  }
}
