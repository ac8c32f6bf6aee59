// SPDX-License-Identifier: Apache-2.0
// <fourdvt-viewer>: a thin composition of session (loading and playing), orbit camera and controls, and overlay.
// Attributes and events follow <model-viewer> and the media element; README.md lists them.
import type { ErrorDetail } from './errors.js';
import { OrbitCamera, parseOrbit, parseTarget } from './orbit-camera.js';
import { OrbitControls } from './orbit-controls.js';
import { Overlay } from './overlay.js';
import { Session, type SessionHost, type Snapshot, type Wishes } from './session.js';
import type { UploadPath } from './upload-path.js';
import type { PictureKind, RenderOptions, SequenceInfo } from './wasm-player.js';

export type { ErrorDetail, RenderOptions, SequenceInfo, Snapshot, UploadPath };

export interface ViewerStats {
  framesShown: number;
  framesLate: number;
  barcodeChecked: number;
  barcodeMismatches: number;
  bytesFetched: number;
  encodedBytesHeld: number;
  textureBytes: number;
  uploadPath: PictureKind;
}

export interface Orbit {
  azimuth: number;
  elevation: number;
  distance: number;
}

const MAX_PIXEL_RATIO = 2;
// The total is known only when the stream's index is here: the bar must not be full before that.
const LEAST_TOTAL_BYTES = 300_000;
const AUTO_ROTATE_DEG_S = 14;
const AUTO_ROTATE_RESUME_S = 4;
const DEFAULT_RENDER: RenderOptions = {
  background: [0, 0, 0, 0], groundShadow: true, shadowStrength: 0.45, samples: 4, debug: 'none', debugLayer: 0,
};

export class FourdvtViewer extends HTMLElement {
  static readonly observedAttributes = [
    'src', 'poster', 'alt', 'loop', 'auto-rotate', 'camera-controls', 'camera-orbit', 'camera-target', 'field-of-view',
    'sequence', 'touch-action',
  ];
  /** Where the player's wasm file lies; beside the script unless set before an element loads. */
  static wasmUrl = new URL('fourdvt-viewer.wasm', import.meta.url).href;

  readonly #overlay: Overlay;
  readonly #camera = new OrbitCamera();
  readonly #reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  readonly #host: SessionHost;
  #controls: OrbitControls | null = null;
  #session: Session | null = null;
  #canvas: HTMLCanvasElement | null = null;
  #observers: AbortController | null = null;
  #size = { width: 1, height: 1 };
  #visible = true;
  #paused = true;
  #rate = 1;
  #sinceInteraction = Infinity;
  #uploadPath: UploadPath = 'auto';
  #render: RenderOptions = { ...DEFAULT_RENDER };
  #resume: { frame: number; sequence: string | null } | null = null;
  #error: ErrorDetail | null = null;
  #loading = false;

  constructor() {
    super();
    this.#overlay = new Overlay(this.attachShadow({ mode: 'open' }), () => this.play());
    this.#host = {
      camera: this.#camera,
      animate: (dt) => this.#animate(dt),
      emit: (name, detail) => this.#onSessionEvent(name, detail),
      firstPicture: () => this.#overlay.ready(),
    };
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
  get paused(): boolean { return this.#paused; }
  get error(): ErrorDetail | null { return this.#error; }
  get duration(): number { return this.#current()?.duration ?? NaN; }
  get currentTime(): number { return this.#session?.state()?.currentTime ?? 0; }
  set currentTime(value: number) {
    this.#emit('seeking');
    this.#session?.seek(Number(value));
  }
  get playbackRate(): number { return this.#rate; }
  set playbackRate(value: number) {
    if (!(value > 0 && value <= 4)) throw new RangeError('playbackRate must be above 0 and at most 4');
    this.#rate = value;
    this.#session?.setRate(value);
    this.#emit('ratechange');
  }
  play(): Promise<void> {
    this.#overlay.offerPlay(false);
    if (this.#paused) {
      this.#paused = false;
      this.#emit('play');
      this.#session?.play();
    }
    return Promise.resolve();
  }
  pause(): void {
    if (this.#paused) return;
    this.#paused = true;
    this.#session?.pause();
    if (!this.#session?.character) this.#emit('pause');
  }

  // --- what a character has beyond a video ---

  get frame(): number { return this.#session?.state()?.frame ?? 0; }
  seekFrame(frame: number): void {
    this.#emit('seeking');
    this.#session?.seekFrame(frame);
  }
  get sequence(): string { return this.#current()?.name ?? this.getAttribute('sequence') ?? ''; }
  set sequence(name: string) { this.setAttribute('sequence', name); }
  get sequences(): SequenceInfo[] { return this.#session?.character?.sequences ?? []; }
  getCameraOrbit(): Orbit {
    const { azimuth, elevation, distance } = this.#camera.pose;
    return { azimuth, elevation, distance };
  }
  /** Ends the camera's glide towards its goal. */
  jumpCameraToGoal(): void {
    this.#camera.jump();
    this.#session?.wake();
  }
  /** Background, ground shadow, multisampling, debug views. Assigning a part keeps the rest. */
  get renderOptions(): RenderOptions { return { ...this.#render }; }
  set renderOptions(options: Partial<RenderOptions>) {
    this.#render = { ...this.#render, ...options };
    this.#session?.setRenderOptions(this.#render);
  }
  /** How decoded pictures reach the GPU; set before src. 'auto' measures. */
  get uploadPath(): UploadPath { return this.#uploadPath; }
  set uploadPath(value: UploadPath) { this.#uploadPath = value; }
  get stats(): ViewerStats | null {
    const state = this.#session?.state();
    if (!state) return null;
    const { framesShown, framesLate, barcodeChecked, barcodeMismatches, bytesFetched, encodedBytesHeld } = state;
    return {
      framesShown, framesLate, barcodeChecked, barcodeMismatches, bytesFetched, encodedBytesHeld,
      textureBytes: state.liveTextureBytes, uploadPath: this.#session!.path,
    };
  }
  /** PNG of the shown frame; another size or pose for this picture only if wanted. Null before the first picture. */
  toBlob(snapshot?: Snapshot): Promise<Blob | null> {
    return this.#session?.toBlob(snapshot) ?? Promise.resolve(null);
  }

  // --- life in the document ---

  connectedCallback(): void {
    this.#observe();
    this.#controls = new OrbitControls(this.#overlay.stage, this.#camera, {
      orbits: () => this.hasAttribute('camera-controls'),
      wheelZooms: () => this.hasAttribute('zoom') || this.matches(':focus-within'),
      onInteract: () => this.#interacted(),
      togglePlay: () => (this.#paused ? void this.play() : this.pause()),
    });
    this.#applyCamera();
    this.#applyLabels();
    this.#load();
  }

  disconnectedCallback(): void {
    this.#observers?.abort();
    this.#observers = null;
    this.#controls?.dispose();
    this.#controls = null;
    this.#unload();
    this.#overlay.idle();
  }

  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (!this.#observers || before === value) return; // before connectedCallback, which reads them all
    switch (name) {
      case 'src': this.#load(); break;
      case 'poster': this.#overlay.setPoster(value); break;
      case 'loop': this.#session?.setLoop(this.#loopMode()); break;
      case 'sequence': if (value) this.#session?.select(value); break;
      case 'camera-orbit': case 'camera-target': case 'field-of-view': this.#applyCamera(); break;
      default: this.#applyLabels();
    }
    this.#session?.wake();
  }

  #load(): void {
    this.#unload();
    this.#error = null;
    if (!this.src) return;
    this.#loading = true;
    this.#overlay.setPoster(this.poster || null);
    this.#overlay.loading();
    if (this.autoplay && !this.#resume) {
      this.#paused = this.#reducedMotion.matches;
      this.#overlay.offerPlay(this.#paused);
    }
    this.#emit('loadstart');
    const canvas = (this.#canvas = this.#overlay.newCanvas());
    canvas.addEventListener('webglcontextlost', this.#onContextLost);
    canvas.addEventListener('webglcontextrestored', this.#onContextRestored);
    this.#startSession(canvas);
  }

  #startSession(canvas: HTMLCanvasElement): void {
    const wishes: Wishes = {
      src: new URL(this.src, this.ownerDocument.baseURI).href,
      wasmUrl: FourdvtViewer.wasmUrl,
      uploadPath: this.#uploadPath,
      sequence: this.#resume?.sequence ?? this.getAttribute('sequence'),
      playing: !this.#paused,
      loop: this.#loopMode(),
      rate: this.#rate,
      frame: this.#resume?.frame ?? 0,
      render: this.#render,
    };
    this.#resume = null;
    const session = (this.#session = new Session(canvas, wishes, this.#host));
    session.resize(this.#size.width, this.#size.height);
    session.setActive(this.#visible);
    void session.start();
  }

  #unload(): void {
    this.#canvas?.removeEventListener('webglcontextlost', this.#onContextLost);
    this.#canvas?.removeEventListener('webglcontextrestored', this.#onContextRestored);
    const session = this.#session;
    this.#session = null;
    session?.dispose();
    session?.loseContext();
    this.#overlay.dropCanvas();
    this.#canvas = null;
  }

  readonly #onContextLost = (e: Event): void => {
    e.preventDefault(); // asks the browser to restore it
    this.#resume = { frame: this.frame, sequence: this.sequence || null };
    const session = this.#session;
    this.#session = null;
    session?.dispose();
    this.#emit('waiting');
  };
  readonly #onContextRestored = (): void => {
    if (this.#canvas) this.#startSession(this.#canvas);
  };

  #observe(): void {
    const stop = (this.#observers = new AbortController());
    const resize = new ResizeObserver((entries) => this.#onResize(entries[entries.length - 1]!));
    resize.observe(this);
    const intersection = new IntersectionObserver((entries) => {
      this.#visible = entries[entries.length - 1]!.isIntersecting;
      this.#session?.setActive(this.#visible);
    });
    intersection.observe(this);
    stop.signal.addEventListener('abort', () => {
      resize.disconnect();
      intersection.disconnect();
    });
    document.addEventListener('visibilitychange', () => {
      this.#session?.setActive(this.#visible && !document.hidden);
    }, { signal: stop.signal });
  }

  #onResize(entry: ResizeObserverEntry): void {
    const ratio = Math.min(devicePixelRatio, MAX_PIXEL_RATIO);
    const { width, height } = entry.contentRect;
    this.#size = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
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
    return this.#camera.update(dtS) || rotating;
  }

  #interacted(): void {
    this.#sinceInteraction = 0;
    this.#session?.wake();
    this.#emit('camera-change');
  }

  #applyLabels(): void {
    this.#overlay.setLabel(this.getAttribute('alt') ?? '', this.hasAttribute('camera-controls'));
    this.#overlay.setTouchAction(this.getAttribute('touch-action') ?? 'pan-y');
  }

  // --- events ---

  #onSessionEvent(name: string, detail?: unknown): void {
    if (name === 'progress') {
      const { loaded, total } = detail as { loaded: number; total: number };
      if (this.#loading) this.#overlay.progress(Math.min(1, loaded / Math.max(total, LEAST_TOTAL_BYTES)));
    } else if (name === 'loadedmetadata') {
      this.#onMetadata();
    } else if (name === 'canplay') {
      this.#loading = false;
    } else if (name === 'ended') {
      this.#paused = true;
    } else if (name === 'error') {
      this.#error = detail as ErrorDetail;
      if (this.#loading) this.#overlay.fail('This character cannot be shown.');
      this.#loading = false;
    }
    this.#emit(name, detail);
  }

  #onMetadata(): void {
    const poster = this.#session?.character?.posterUri;
    if (poster && !this.#overlay.hasPoster) this.#overlay.setPoster(new URL(poster, new URL(this.src, this.baseURI)).href);
  }

  #emit(name: string, detail?: unknown): void {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  #current(): SequenceInfo | null {
    const session = this.#session;
    const index = session?.state()?.sequence ?? -1;
    return session?.character?.sequences[index] ?? null;
  }
  /** -1 as the sequence says, 0 never, 1 always. */
  #loopMode(): number {
    if (!this.hasAttribute('loop')) return -1;
    return this.loop ? 1 : 0;
  }
}

if (!customElements.get('fourdvt-viewer')) customElements.define('fourdvt-viewer', FourdvtViewer);

declare global {
  interface HTMLElementTagNameMap {
    'fourdvt-viewer': FourdvtViewer;
  }
}
