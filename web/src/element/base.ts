// SPDX-License-Identifier: Apache-2.0
// Base of <fourdvt-viewer>: its shadow tree, its session's host, its life in the document. The features are mixins over it
// (loading.ts, playback.ts …), each with its attributes, properties and events; they meet in the methods that symbols name, which
// every one extends. Does not load or show anything by itself.
import { isOn, upgradeProperties } from '../page/attributes.js';
import { Commands, type Wishes } from '../player/commands.js';
import { JOIN_EVENT, type Companion } from '../session/companion.js';
import { dispatch, PageElement, type ErrorDetail } from '../report/errors.js';
import { OrbitCamera } from '../camera/orbit-camera.js';
import { Overlay } from './overlay.js';
import { PictureBox, type Size } from '../page/picture-box.js';
import type { Session } from '../session/session.js';
import type { SessionHost, SessionOptions } from '../session/session-host.js';
import { STRINGS, stringsOf, type Languages, type Strings } from '../report/strings.js';
import type { More } from '../player/wasm-module.js';
import type { SequenceInfo } from '../player/wasm-player.js';
import { stallOf } from '../report/watchdog.js';

/** State that the features share. */
export const parts: unique symbol = Symbol();
/** Dispatches an event of the element. */
export const emit: unique symbol = Symbol();
/** Dispatches an event of the session, after the features have heard of it. */
export const report: unique symbol = Symbol();
/** Lets the session run or rest. */
export const updateActive: unique symbol = Symbol();
/** The element has come into a document, and has read no attribute yet. */
export const onConnected: unique symbol = Symbol();
/** It shows another source than when it left a document, if it ever did. */
export const onArrival: unique symbol = Symbol();
/** It has left the document. */
export const onLeft: unique symbol = Symbol();
/** An attribute has changed while it is in a document. */
export const onAttribute: unique symbol = Symbol();
/** A session begins: what is known of the last one is over. */
export const onSession: unique symbol = Symbol();
/** True while nothing is to be loaded. */
export const holds: unique symbol = Symbol();
/** Its picture's size or pixel ratio has changed: CSS pixels. */
export const onResize: unique symbol = Symbol();
/** An event of the session, before it is dispatched. */
export const onEvent: unique symbol = Symbol();
/** A picture has been drawn. */
export const onPicture: unique symbol = Symbol();
/** The player's second part is there; once or more. */
export const onMore: unique symbol = Symbol();
/** The GL context of a session is lost; it has come back: true if another session takes its place. */
export const onLost: unique symbol = Symbol();
export const onRestored: unique symbol = Symbol();
/** A session has ended because the player has trapped in another viewer's call. */
export const onTrapped: unique symbol = Symbol();
/** The page lets it hold a character, or takes it away. */
export const onGranted: unique symbol = Symbol();
/** Puts its texts and labels on. */
export const applyTexts: unique symbol = Symbol();
/** The visitor has done something with it. */
export const touched: unique symbol = Symbol();
/** A turn of the page's loop. True if the view or the motion changes by itself. */
export const animate: unique symbol = Symbol();
/** Gives the wishes that another source begins with. */
export const firstWishes: unique symbol = Symbol();
/** Gives the options of a new session. */
export const sessionOptions: unique symbol = Symbol();
/** Nothing will come of the present wish; `error`: why, none if it is not wanted any more. */
export const onGivenUp: unique symbol = Symbol();

export interface Parts {
  readonly overlay: Overlay;
  readonly picture: PictureBox;
  readonly camera: OrbitCamera;
  readonly commands: Commands;
  readonly companions: Set<Companion>;
  readonly host: SessionHost;
  readonly reducedMotion: { readonly matches: boolean };
  session: Session | null;
  /** Of the canvas, pixels. */
  readonly size: Size;
  /** In a document. */
  connected: boolean;
  /** Time of the visitor's last input, ms. */
  touchedMs: number;
  /** The sequence that is shown. */
  readonly current: SequenceInfo | null;
}

/** Class that a feature extends; mixins must take any arguments. */
export type Constructor<T> = (new (...args: any[]) => T) & { readonly observedAttributes: readonly string[] };

export class ViewerBase extends PageElement {
  /** Texts by language. */
  static strings: Languages = STRINGS;
  static get observedAttributes(): readonly string[] { return ['alt', 'camera-controls', 'lang', 'motion-controls', 'touch-action']; }

  readonly [parts]: Parts;
  #watching = new AbortController(); // its picture's size

  constructor() {
    super();
    const commands = new Commands(), camera = new OrbitCamera(), companions = new Set<Companion>();
    const overlay = new Overlay(this.attachShadow({ mode: 'open' })), picture = new PictureBox(overlay.content);
    const all: Parts = (this[parts] = {
      overlay, picture, camera, commands, companions,
      host: {
        element: this, camera, commands, companions,
        animate: (dtS) => this[animate](dtS),
        emit: (name, detail) => this[report](name, detail),
        firstPicture: () => {
          overlay.ready(this.getAttribute('reveal') !== 'manual');
          this[updateActive](); // others may run now
          this[report]('loadeddata');
        },
        picture: () => {
          overlay.uncover();
          this[onPicture]();
        },
        sharper: () => overlay.cover(),
        network: (waiting) => {
          overlay.note(waiting);
          if (waiting) this[emit]('stalled');
        },
        stalled: (step) => {
          overlay.noteStep(step);
          if (step) this[emit]('stalled', stallOf(step));
        },
        more: (more) => {
          overlay.complete();
          this[onMore](more);
        },
        incomplete: (error) => overlay.incomplete(error),
        show: (canvas) => overlay.showCanvas(canvas),
        lost: (session) => this[onLost](session),
        restored: (session) => this[onRestored](session),
        trapped: (session) => this[onTrapped](session),
      },
      reducedMotion: matchMedia('(prefers-reduced-motion: reduce)'),
      session: null,
      get size() { return picture.canvas; },
      connected: false,
      touchedMs: -Infinity,
      get current() { return all.session?.character?.sequences[commands.state()?.sequence ?? -1] ?? null; },
    });
    this.addEventListener(JOIN_EVENT, (e) => this.#onJoin(e as CustomEvent<Companion>));
  }

  override focus(options?: FocusOptions): void { this[parts].overlay.stage.focus(options); }

  connectedCallback(): void {
    if (this[parts].connected) return; // moved within the page: it goes on
    upgradeProperties(this);
    this[parts].connected = true;
    this.#watching = new AbortController();
    this[parts].picture.watch(() => this.#resize(), this.#watching.signal);
    this[applyTexts]();
    this[onConnected]();
  }
  // A move within the page takes the element out and puts it back at once.
  disconnectedCallback(): void {
    queueMicrotask(() => { if (!this.isConnected && this[parts].connected) this.#leave(); });
  }
  // Observers and clocks belong to the old document, and are left there. Where the element is in the new one, connectedCallback follows.
  adoptedCallback(): void {
    this[parts].overlay.applyStyle();
    if (this[parts].connected) this.#leave();
  }
  #leave(): void {
    this.#watching.abort();
    this[parts].connected = false;
    this[onLeft]();
    this[parts].overlay.idle();
  }

  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    this[onAttribute](name, before, value);
    this[parts].session?.wake();
  }

  [emit](name: string, detail?: unknown): void { dispatch(this, name, detail); }
  [report](name: string, detail?: unknown): void {
    this[onEvent](name, detail);
    this[emit](name, detail);
  }
  [updateActive](): void { /* for the features */ }
  [onGranted](_load: boolean): void { /* likewise */ }
  [touched](): void { this[parts].touchedMs = performance.now(); }
  [onConnected](): void { /* likewise */ }
  [onArrival](): void { /* likewise */ }
  [onLeft](): void { /* likewise */ }
  [onAttribute](name: string, _before: string | null, _value: string | null): void {
    if (this[parts].connected && ViewerBase.observedAttributes.includes(name)) this[applyTexts]();
  }
  [onSession](): void { /* likewise */ }
  [holds](): boolean { return false; }
  [onResize](_width: number, _height: number): void { /* likewise */ }
  [onEvent](_name: string, _detail: unknown): void { /* likewise */ }
  [onPicture](): void { /* likewise */ }
  [onMore](_more: More): void { /* likewise */ }
  [onLost](_session: object): void { /* likewise */ }
  [onRestored](_session: object): boolean { return false; }
  [onTrapped](_session: object): void { /* likewise */ }
  [animate](_dtS: number): boolean {
    this[parts].picture.checkRatio();
    return false;
  }
  [firstWishes](): Partial<Wishes> { return {}; }
  [sessionOptions](): Partial<SessionOptions> { return {}; }
  [onGivenUp](_error?: ErrorDetail): void { /* likewise */ }

  #resize(): void {
    const { picture: { size, canvas }, session } = this[parts];
    this[onResize](size.width, size.height);
    session?.resize(canvas.width, canvas.height);
  }

  [applyTexts](): void {
    const { overlay } = this[parts];
    overlay.say(stringsOf(this, (this.constructor as typeof ViewerBase).strings) as unknown as Strings);
    overlay.setLabel(this.getAttribute('alt') ?? '', isOn(this, 'camera-controls'), isOn(this, 'motion-controls'));
    overlay.setTouchAction(this.getAttribute('touch-action') ?? '');
  }

  #onJoin(event: CustomEvent<Companion>): void {
    event.stopPropagation();
    const companion = event.detail, all = this[parts];
    all.companions.add(companion);
    all.session?.later.add(companion);
    companion.left.addEventListener('abort', () => {
      all.companions.delete(companion);
      all.session?.later.remove(companion);
    });
  }
}
