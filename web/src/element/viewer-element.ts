// SPDX-License-Identifier: Apache-2.0
// Public interface of the element <fourdvt-viewer>, implemented by the other files of this folder. Attributes and events
// follow <model-viewer> and HTMLMediaElement; web/README.md lists them.
import type { UploadChoice } from '../decode/upload-path.js';
import type { LiveState } from '../live/live.js';
import type { SignAddress } from '../net/transport.js';
import { methodOf } from '../player/method-attributes.js';
import type { ParameterInfo, Placement, RenderOptions, SceneMesh, SequenceInfo } from '../player/wasm-player.js';
import { PageElement, type MediaFault } from '../report/errors.js';
import { STRINGS, type Languages } from '../report/strings.js';
import type { Snapshot } from '../session/session-host.js';
import { FILES } from '../wasm/files.js';
import { Appearance } from './appearance.js';
import { SecondPart } from './extras.js';
import { Loading } from './loading.js';
import { Media, timeRanges, type PictureMetadata } from './media.js';
import { Motion } from './motion.js';
import { Playback } from './playback.js';
import { OBSERVED, reflect, valueOf, type Reflected } from './properties.js';
import { statsOf, type ViewerStats } from './stats.js';
import { View } from './view.js';
import { Viewer } from './viewer.js';

/** Orbit of the camera: angles in degrees, distance in metres. */
export interface Orbit {
  azimuth: number;
  elevation: number;
  distance: number;
}

export interface FourdvtViewer extends Reflected {
  /** Tracks of the viewer's <track> elements; undefined until the player's second part is loaded. */
  readonly textTracks?: TextTrackList;
}
export class FourdvtViewer extends PageElement {
  /** Address of the player's wasm file, with the others beside it. Default: beside the script. Set before the first load. */
  static wasmUrl = FILES.wasm;
  /** Address of the OpenCV module, which is fetched only for align="flow-opencv"; its wasm file lies beside it. */
  static opencvUrl = FILES.opencv;
  /** Texts by language. */
  static strings: Languages = STRINGS;
  static readonly observedAttributes = OBSERVED;

  readonly #viewer = new Viewer(this);
  readonly #loading = new Loading(this.#viewer);
  readonly #playback = new Playback(this.#viewer, this.#loading);
  readonly #media = new Media(this.#viewer, this.#loading, this);
  readonly #second = new SecondPart(this.#viewer, this);
  readonly #motion = new Motion(this.#viewer, this.#loading, this);
  readonly #appearance = new Appearance(this.#viewer);
  #defaultRate = 1;

  constructor() {
    super();
    this.#viewer.features = [this.#loading, this.#loading.presence, this.#playback, this.#media, this.#second, this.#motion,
      new View(this.#viewer, this.#playback), this.#appearance];
  }

  connectedCallback(): void { this.#viewer.connect(); }
  disconnectedCallback(): void { this.#viewer.disconnect(); }
  adoptedCallback(): void { this.#viewer.adopt(); }
  attributeChangedCallback(name: string, before: string | null, value: string | null): void { this.#viewer.update(name, before !== value); }
  override focus(options?: FocusOptions): void { this.#viewer.overlay.stage.focus(options); }

  // --- loading ---

  /** Absolute address of the loaded character. */
  get currentSrc(): string { return this.#loading.currentSrc; }
  get error(): MediaFault | null { return this.#loading.error; }
  /** Callback: returns the address to fetch a file from; called again if the server refuses one. Null: the file's own. */
  get sign(): SignAddress | null { return this.#loading.sign; }
  set sign(sign: SignAddress | null) { this.#loading.sign = sign; }
  /** Upload path of decoded pictures; 'auto' measures the fastest. Takes effect at the next load. */
  get uploadPath(): UploadChoice { return valueOf(this, 'upload-path') as UploadChoice; }
  set uploadPath(value: UploadChoice) { this.setAttribute('upload-path', value); }
  /** Loads the character again, from the start, and clears an earlier error. */
  load(): void { this.#loading.load(); }
  get networkState(): number { return this.#media.networkState; }
  get readyState(): number { return this.#media.readyState; }
  /** Hides the poster; with reveal="manual" the only way to do so. */
  dismissPoster(): void { this.#viewer.overlay.dismissPoster(); }

  // --- playback ---

  get loop(): boolean { return valueOf(this, 'loop'); }
  set loop(value: boolean) { this.setAttribute('loop', value ? '' : 'false'); }
  /** True until `play` is dispatched; with autoplay that is when the character begins to play. */
  get paused(): boolean { return this.#playback.paused; }
  get ended(): boolean { return this.#playback.ended; }
  get seeking(): boolean { return this.#playback.seeking; }
  /** Resolves when the character plays; rejects after an error, or if paused, reloaded or removed before. */
  play(): Promise<void> { return this.#playback.play(); }
  pause(): void { this.#playback.pause(); }
  /** Seconds; Infinity for a live stream. */
  get duration(): number { return this.#viewer.duration; }
  get currentTime(): number { return this.#viewer.currentTime; }
  set currentTime(value: number) {
    if (!Number.isFinite(Number(value))) throw new TypeError('currentTime must be a number of seconds');
    this.#playback.seek(Number(value));
  }
  get frame(): number { return this.#viewer.state?.frame ?? 0; }
  seekFrame(frame: number): void { this.#playback.seekFrame(frame); }
  /** Factor of the speed, 0…4; 0: the state is playing, but the frame stays. */
  get playbackRate(): number { return this.#viewer.commands.settings.rate; }
  set playbackRate(value: number) {
    if (!(value >= 0 && value <= 4)) throw new RangeError('playbackRate must be 0 to 4');
    this.#viewer.commands.set('rate', value);
    this.#viewer.emit('ratechange');
  }
  get defaultPlaybackRate(): number { return this.#defaultRate; }
  set defaultPlaybackRate(value: number) { this.#defaultRate = value; }
  /** Time ranges of the shown motion that can be played without the network. */
  get buffered(): TimeRanges { return this.#media.buffered; }
  get seekable(): TimeRanges { return timeRanges(this.duration < Infinity ? [[0, this.duration]] : []); }
  /** Time ranges of the shown motion that have been played since it was selected. */
  get played(): TimeRanges { return this.#media.played; }
  get volume(): number { return this.#media.volume; }
  set volume(value: number) { this.#media.volume = value; }
  get muted(): boolean { return this.#media.muted; }
  set muted(on: boolean) { this.#media.muted = on; }
  /** True if the shown motion has sound; false until the player's second part is loaded. */
  get hasSound(): boolean { return this.#second.extras?.hasSound ?? false; }
  requestVideoFrameCallback(callback: (nowMs: number, metadata: PictureMetadata) => void): number { return this.#media.requestCallback(callback); }
  cancelVideoFrameCallback(handle: number): void { this.#media.cancelCallback(handle); }
  /** State of a live stream; null for other characters. */
  get liveState(): LiveState | null { return this.#viewer.session?.live?.state ?? null; }
  /** Age of the shown live frame since its capture, seconds; NaN while unknown. */
  get liveLatency(): number { return this.#viewer.session?.live?.latency ?? NaN; }

  // --- motion ---

  get sequence(): string { return this.#motion.sequence; }
  set sequence(name: string) { this.setAttribute('sequence', name); }
  get sequences(): SequenceInfo[] { return this.#viewer.character?.sequences ?? []; }
  /** Goes to another motion by the best transition. A motion without loop returns to the last one at its end. */
  goTo(state: string): void { this.#motion.goTo(state); }
  /** The goal of the last goTo(), or the motion that is shown. */
  get state(): string { return this.#motion.state; }
  get inTransition(): boolean { return this.#viewer.state?.inTransition ?? false; }
  /** Parameters of the shown motion, with their ranges; empty for a plain motion. */
  get parameters(): ParameterInfo[] { return this.#viewer.current?.parameters ?? []; }
  /** Sets a parameter's goal, which the motion approaches smoothly, or at once if `immediate`. Clamps to the range. */
  setParameter(name: string, value: number, immediate = false): void {
    if (!Number.isFinite(value)) throw new TypeError(`${name} must be a number`);
    this.#viewer.commands.setParameter(name, value, immediate);
    this.#viewer.emit('parameterchange', { name, value });
  }
  /** Present value of a parameter; NaN if the character has no such parameter. */
  getParameter(name: string): number { return this.#viewer.commands.parameter(name); }
  /** Heading, degrees from +z towards +x. When set, the character turns to it while it moves. */
  get heading(): number { return this.placement.heading; }
  set heading(degrees: number) {
    if (!Number.isFinite(degrees)) throw new TypeError('heading must be a number of degrees');
    this.#viewer.commands.steer(degrees);
  }
  /** Place, metres, and heading, degrees. When set, the character is there at once. */
  get placement(): Placement { return this.#viewer.commands.placement; }
  set placement(place: Partial<Placement>) {
    const at = { ...this.placement, ...place };
    if (![at.x, at.z, at.heading].every(Number.isFinite)) throw new TypeError('x, z and heading must be numbers');
    this.#viewer.commands.place(at);
  }

  // --- camera and picture ---

  getCameraOrbit(): Orbit {
    const { azimuth, elevation, distance } = this.#viewer.camera.pose;
    return { azimuth, elevation, distance };
  }
  /** Ends the camera's glide towards its goal. */
  jumpCameraToGoal(): void {
    this.#viewer.camera.jump();
    this.#viewer.session?.wake();
  }
  /** Drawing method of a character from cameras, once it is loaded; web/README.md lists the methods. */
  get method(): string { return methodOf(this).name || this.#viewer.character?.method || ''; }
  set method(name: string) { this.setAttribute('method', name); }
  /** Meshes drawn with the characters; web/README.md has the format. */
  get scene(): SceneMesh[] { return this.#viewer.commands.settings.scene ?? []; }
  set scene(meshes: SceneMesh[]) { this.#appearance.setScene(meshes); }
  /** Background, ground shadow, multisampling, debug views. Options left out of an assignment keep their values. */
  get renderOptions(): RenderOptions { return this.#appearance.options; }
  set renderOptions(options: Partial<RenderOptions>) { this.#appearance.setOptions(options); }
  get stats(): ViewerStats | null {
    const { session, state } = this.#viewer;
    return state && statsOf(state, session!.path);
  }
  /** Size of the bounding box of all motions, metres; null before the character is loaded. */
  getDimensions(): { x: number; y: number; z: number } | null {
    const { min, max } = this.#viewer.character ?? {};
    return min && max ? { x: max[0] - min[0], y: max[1] - min[1], z: max[2] - min[2] } : null;
  }
  /** Vertex at a point of the window, CSS pixels, for a hotspot's `data-vertex`; null off a layered character's surface. */
  vertexFromPoint(clientX: number, clientY: number): number | null { return this.#second.extras?.vertexAt(clientX, clientY) ?? null; }
  /** PNG of the shown frame, at the snapshot's size and pose if given; null before the first picture. */
  toBlob(snapshot?: Snapshot): Promise<Blob | null> { return this.#viewer.session?.drawing.toBlob(snapshot) ?? Promise.resolve(null); }
  /** toBlob's PNG as a data: address; empty before the first picture. */
  async toDataURL(snapshot?: Snapshot): Promise<string> {
    const blob = await this.toBlob(snapshot);
    return blob ? new Promise((done) => {
      const reader = new FileReader();
      reader.onload = () => done(reader.result as string);
      reader.readAsDataURL(blob);
    }) : '';
  }
}
reflect(FourdvtViewer.prototype);
