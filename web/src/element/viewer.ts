// SPDX-License-Identifier: Apache-2.0
// Core of one <fourdvt-viewer>: state shared by its features, connection to the document, dispatch of events. Does not
// show or load anything itself.
import { OrbitCamera } from '../camera/orbit-camera.js';
import { isOn, upgradeProperties } from '../page/attributes.js';
import { PictureBox, type Size } from '../page/picture-box.js';
import { Commands } from '../player/commands.js';
import type { More } from '../player/wasm-module.js';
import type { CharacterInfo, PlayerState, SequenceInfo, Settings } from '../player/wasm-player.js';
import { dispatch, type ErrorDetail } from '../report/errors.js';
import { stringsOf, type Languages, type Strings } from '../report/strings.js';
import { JOIN_EVENT, type Companion } from '../session/companion.js';
import type { Session } from '../session/session.js';
import { Overlay } from './overlay.js';

/** One concern of a viewer: an object that implements some of these callbacks. */
export interface Feature {
  /** Called when the element has entered a document. */
  connect?(): void;
  /** Called when the element has left the document. */
  disconnect?(): void;
  /** Called when an observed attribute was set while the element is in a document; changed: the value differs. */
  update?(name: string, changed: boolean): void;
  /** Called when the viewer's texts have changed. */
  updateTexts?(): void;
  /** Called when the picture's size, in CSS pixels, or its pixel ratio has changed. */
  resize?(width: number, height: number): void;
  /** Called per turn of the frame loop; returns true if the view or the motion changes by itself. */
  frame?(stepS: number): boolean | void;
  /** Called when the visitor, or a script on the visitor's behalf, has used the viewer. */
  touch?(): void;
  /** Returns false to suppress an event of the session, for example a repeated one. */
  accept?(event: string): boolean;
  /** Handles an event of the session before it is dispatched. */
  handle?(event: string, detail: unknown): void;
  /** Called when a picture has been drawn. */
  picture?(): void;
  /** Called, possibly more than once, when the player's second part is loaded. */
  more?(more: More): void;
  /** Called if the element returns to a document with another source than it left with. */
  reset?(): void;
  /** Returns initial settings for a new source. */
  settings?(): Partial<Settings>;
  /** Called when a session begins: resets the state of the last one. */
  begin?(): void;
  /** Called when a load or play() has failed. error: the reason; undefined if a new source has replaced it. */
  giveUp?(error?: ErrorDetail): void;
}

/** Static properties of the element's class. */
export interface Statics {
  strings: Languages;
  wasmUrl: string;
  opencvUrl: string;
}

export class Viewer {
  readonly element: HTMLElement;
  readonly overlay: Overlay;
  readonly picture: PictureBox;
  readonly camera = new OrbitCamera();
  readonly commands = new Commands();
  readonly companions = new Set<Companion>();
  readonly reducedMotion: { readonly matches: boolean } = matchMedia('(prefers-reduced-motion: reduce)');
  features: readonly Feature[] = [];
  session: Session | null = null;
  /** True while the element is in a document. */
  connected = false;
  /** True if an attribute was set since the element left its document. */
  changedOutside = false;
  /** Time of the visitor's last input, ms. */
  touchedMs = -Infinity;
  #watching = new AbortController(); // ends the observation of the picture's size

  constructor(element: HTMLElement) {
    this.element = element;
    this.overlay = new Overlay(element.attachShadow({ mode: 'open' }));
    this.picture = new PictureBox(this.overlay.content);
    element.addEventListener(JOIN_EVENT, (e) => this.#join(e as CustomEvent<Companion>));
  }

  get statics(): Statics { return this.element.constructor as unknown as Statics; }
  /** Size of the canvas, pixels. */
  get size(): Size { return this.picture.canvas; }
  get character(): CharacterInfo | null { return this.session?.character ?? null; }
  get state(): PlayerState | null { return this.commands.state(); }
  /** The sequence that is shown. */
  get current(): SequenceInfo | null { return this.character?.sequences[this.state?.sequence ?? -1] ?? null; }
  /** Duration of the shown sequence, seconds; NaN before it is loaded, Infinity for a live stream. */
  get duration(): number { return this.session?.live ? Infinity : this.current?.duration ?? NaN; }
  get currentTime(): number { return this.state?.currentTimeS ?? this.commands.settings.time ?? 0; }

  /** Calls a method of every feature that implements it, in the order of the features' list. */
  call<Name extends keyof Feature>(name: Name, ...values: Parameters<Required<Feature>[Name]>): ReturnType<Required<Feature>[Name]>[] {
    type Method = (...values: unknown[]) => ReturnType<Required<Feature>[Name]>;
    return this.features.filter((feature) => feature[name]).map((feature) => (feature[name] as Method).apply(feature, values));
  }

  connect(): void {
    if (this.connected) return; // moved within the page: goes on
    upgradeProperties(this.element);
    this.connected = true;
    this.#watching = new AbortController();
    this.picture.watch(() => this.#resize(), this.#watching.signal);
    this.updateTexts();
    this.call('connect');
  }
  // Defers leaving: a move within the page disconnects and reconnects the element at once.
  disconnect(): void {
    queueMicrotask(() => { if (!this.element.isConnected && this.connected) this.#leave(); });
  }
  /** Ends the observers and clocks of the old document. If the element is in the new one, connect() follows. */
  adopt(): void {
    this.overlay.applyStyle();
    if (this.connected) this.#leave();
  }
  #leave(): void {
    this.#watching.abort();
    this.connected = this.changedOutside = false;
    this.call('disconnect');
    this.overlay.idle();
  }

  update(name: string, changed: boolean): void {
    if (!this.connected) this.changedOutside = true;
    else if (/^(alt|lang|camera-controls|motion-controls|touch-action)$/.test(name)) this.updateTexts();
    if (this.connected) this.call('update', name, changed);
    this.session?.wake();
  }
  updateTexts(): void {
    const { element, overlay } = this;
    overlay.setTexts(stringsOf(element, this.statics.strings) as unknown as Strings);
    overlay.setLabel(element.getAttribute('alt') ?? '', isOn(element, 'camera-controls'), isOn(element, 'motion-controls'));
    overlay.setTouchAction(element.getAttribute('touch-action') ?? '');
    this.call('updateTexts');
  }
  frame(stepS: number): boolean {
    this.picture.checkRatio();
    return this.call('frame', stepS).includes(true);
  }
  touch(): void {
    this.touchedMs = performance.now();
    this.call('touch');
  }

  /** Dispatches an event of the element. */
  emit(name: string, detail?: unknown): void { dispatch(this.element, name, detail); }
  /** Dispatches an event of the session once the features have handled it. */
  report(name: string, detail?: unknown): void {
    if (this.call('accept', name).includes(false)) return;
    this.call('handle', name, detail);
    this.emit(name, detail);
  }

  #resize(): void {
    const { picture: { size, canvas }, session } = this;
    this.call('resize', size.width, size.height);
    session?.resize(canvas.width, canvas.height);
  }

  #join(event: CustomEvent<Companion>): void {
    event.stopPropagation();
    const companion = event.detail;
    this.companions.add(companion);
    this.session?.later.add(companion);
    companion.left.addEventListener('abort', () => {
      this.companions.delete(companion);
      this.session?.later.remove(companion);
    });
  }
}
