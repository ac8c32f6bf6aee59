// SPDX-License-Identifier: Apache-2.0
// The element's shadow tree: canvas, poster, progress bar, play button and error panel, all in the element's content box.
// The element is a size container: its content box is 100cqw wide and 100cqh high, and begins where a block in flow does.
// The style is a constructable style sheet, so that the page can have a strict style-src policy.

import { adopt } from '../page/documents.js';
import type { ErrorDetail } from '../report/errors.js';
import type { Strings } from '../report/strings.js';
import type { Step } from '../report/watchdog.js';

const ON_DEVELOPERS_MACHINE = /^(file:|https?:\/\/(localhost|127\.0\.0\.1|\[::1])(:|$))/;

// Text of an error: with details on a developer's machine, else `short`. Tests `origin`, since a frame without an address
// of its own inherits it.
const textOf = ({ id, message }: ErrorDetail, short: string): string =>
  ON_DEVELOPERS_MACHINE.test(location.protocol === 'file:' ? 'file:' : origin) ? `${id}: ${message}` : short;

// plus-lighter: cross-fades cover and canvas linearly, also where they are translucent.
const CSS = `
:host { display: block; position: relative; overflow: hidden; contain: strict; container-type: size; width: 300px; aspect-ratio: 3/4; }
:host([hidden]) { display: none; }
.content { position: absolute; width: 100%; height: 100%; width: 100cqw; height: 100cqh; }
.stage { position: absolute; inset: 0; outline: none; user-select: none; -webkit-user-select: none; }
.stage.orbits { cursor: grab; touch-action: pan-y; }
:host([disable-zoom]:not([disable-zoom=false])) .stage.orbits { touch-action: pan-y pinch-zoom; }
.stage.orbits:active { cursor: grabbing; }
.stage.ring:focus::after { content: ''; position: absolute; inset: 0; box-shadow: inset 0 0 0 3px var(--fourdvt-focus, #5b8def); pointer-events: none; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; display: block; }
.poster, .picture { position: absolute; inset: 0; width: 100%; height: 100%; object-fit: contain; pointer-events: none;
  transition: opacity .3s, visibility .3s; }
.covered, .fading { isolation: isolate; }
.cover { mix-blend-mode: plus-lighter; }
.covered > canvas:not(.cover), .fading > .cover { opacity: 0; }
.fading > canvas { transition: opacity .3s; }
::slotted([slot=poster]) { pointer-events: auto; }
slot { display: block; }
.progress-bar { position: absolute; left: 0; right: 0; bottom: 0; }
:host([controls=none]) .play { display: none; }
.bar { position: absolute; left: 0; right: 0; bottom: 0; height: var(--fourdvt-progress-height, 3px);
  background: var(--fourdvt-progress-track, rgba(127,127,127,.25)); pointer-events: none; }
.bar > div { height: 100%; width: 100%; transform-origin: left; transform: scaleX(0);
  background: var(--fourdvt-progress-color, currentColor); transition: transform .15s; }
.play { position: absolute; left: 50%; top: 50%; width: 64px; height: 64px; margin: -32px; border: 0; border-radius: 50%;
  background: rgba(20,20,24,.6); color: #fff; font: 26px/64px system-ui, sans-serif; padding: 0 0 0 5px; cursor: pointer; }
.error { position: absolute; left: 0; right: 0; top: 50%; transform: translateY(-50%); text-align: center; margin: 0 auto;
  padding: 6px 12px; width: fit-content; max-width: 90%; border-radius: 6px; font: 14px/1.4 system-ui, sans-serif; color: #fff;
  background: rgba(20,20,24,.75); box-sizing: border-box; max-height: 100%; overflow: auto; overflow-wrap: anywhere; }
.error > button { margin-inline-start: 10px; padding: 2px 10px; border: 1px solid currentColor; border-radius: 4px; background: none;
  color: inherit; font: inherit; cursor: pointer; }
.note { position: absolute; left: 0; right: 0; top: 10px; width: fit-content; margin: 0 auto; padding: 3px 10px;
  border-radius: 6px; font: 12px/1.4 system-ui, sans-serif; color: #fff; background: rgba(20,20,24,.75); pointer-events: none; }
.gone { opacity: 0; visibility: hidden; }
[hidden] { display: none !important; }
@media (prefers-reduced-motion: reduce) { .poster, .bar > div, .fading > canvas { transition: none; } }
@media (forced-colors: active) {
  .bar { background: Canvas; outline: 1px solid CanvasText; }
  .bar > div { background: Highlight; }
  .play, .error, .note { border: 1px solid; }
  .stage.ring:focus::after { outline: 3px solid Highlight; outline-offset: -3px; }
}
`;
const COVERED_MS = 1000, FADING_MS = 300; // maximum time of a cover; duration of the style's transition
// True if the last input that may move the focus was Tab, not a pointer: only then the focus ring is drawn.
let tabs = false;
if (typeof document !== 'undefined') {
  document.addEventListener('keydown', (e) => { if (e.key === 'Tab') tabs = true; }, true);
  document.addEventListener('pointerdown', () => { tabs = false; }, true);
}
const KEPT_PIXELS = 320; // longer side of the copy that keepPicture makes

function add<K extends keyof HTMLElementTagNameMap>(parent: Node, tag: K, name: string): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  element.className = name;
  element.setAttribute('part', name);
  parent.appendChild(element);
  return element;
}

export class Overlay {
  /** Parent of all parts; fills the element's content box. */
  readonly content = document.createElement('div');
  readonly stage: HTMLDivElement;
  readonly #poster: HTMLSlotElement;
  readonly #picture: HTMLImageElement;
  readonly #progress: HTMLSlotElement;
  readonly #bar: HTMLDivElement;
  readonly #fill: HTMLDivElement;
  readonly #play: HTMLButtonElement;
  readonly #error: HTMLParagraphElement;
  readonly #retry: HTMLButtonElement;
  readonly #message: HTMLSpanElement;
  readonly #note: HTMLParagraphElement;
  #strings = {} as Strings; // once it is in a document
  #network = false;
  #step: Step | null = null;
  #canvas: HTMLCanvasElement | null = null;
  #cover: HTMLCanvasElement | null = null; // copy of the last picture, until the canvas has the next
  #coverTimer = 0;
  #otherMode = true; // the poster's request has not been retried in the other mode, with or without CORS
  #kept: HTMLCanvasElement | null = null; // small copy of a removed canvas's last picture
  #lack = ''; // note while the player's second part is missing
  /** Called at a click on the play button, and on the retry button. */
  onPlay: () => void = () => undefined;
  onRetry: () => void = () => undefined;

  constructor(root: ShadowRoot) {
    const { content } = this;
    content.className = 'content';
    root.append(content);
    this.applyStyle();
    this.stage = add(content, 'div', 'stage');
    this.stage.addEventListener('focus', () => this.stage.classList.toggle('ring', tabs));
    this.#poster = add(content, 'slot', 'poster');
    this.#poster.name = 'poster';
    this.#picture = add(this.#poster, 'img', 'picture');
    this.#picture.alt = '';
    this.#picture.addEventListener('error', () => this.#onPosterError());
    this.setPoster(null);
    this.#progress = add(content, 'slot', 'progress-bar');
    this.#progress.name = 'progress-bar';
    this.#bar = add(this.#progress, 'div', 'bar');
    this.#bar.setAttribute('role', 'progressbar');
    this.#bar.setAttribute('aria-valuemin', '0');
    this.#bar.setAttribute('aria-valuemax', '100');
    this.#fill = add(this.#bar, 'div', 'fill');
    this.#play = add(content, 'button', 'play');
    this.#play.type = 'button';
    this.#play.textContent = '▶';
    this.#play.addEventListener('click', () => this.onPlay());
    this.#error = add(content, 'p', 'error');
    this.#error.setAttribute('role', 'alert');
    this.#message = add(this.#error, 'span', 'message');
    this.#retry = add(this.#error, 'button', 'retry');
    this.#retry.type = 'button';
    this.#retry.addEventListener('click', () => this.onRetry());
    this.#note = add(content, 'p', 'note');
    this.#note.setAttribute('role', 'status');
    this.idle();
  }

  /** Applies the style again after another document has adopted the tree, which drops it. */
  applyStyle(): void { adopt(this.content, CSS); }

  setTexts(strings: Strings): void {
    this.#strings = strings;
    this.#bar.ariaLabel = strings.loading;
    this.#play.ariaLabel = strings.play;
    this.#retry.textContent = strings.retry;
  }

  /** Shows this canvas in place of the last one. */
  showCanvas(canvas: HTMLCanvasElement): void {
    this.dropCanvas();
    this.#canvas = canvas;
    canvas.setAttribute('part', 'canvas');
    this.stage.appendChild(canvas);
  }
  /** Replaces the canvas by a small copy of its picture until the next picture. */
  keepPicture(): void {
    const canvas = this.#canvas;
    if (canvas && !this.#kept) {
      const { width, height } = canvas, scale = Math.min(1, KEPT_PIXELS / Math.max(width, height));
      const kept = (this.#kept = Object.assign(document.createElement('canvas'), { width: Math.ceil(width * scale), height: Math.ceil(height * scale) }));
      kept.getContext('2d')?.drawImage(canvas, 0, 0, kept.width, kept.height);
      this.stage.prepend(kept);
    }
    this.dropCanvas();
    this.#progress.hidden = true;
    this.#forgetNote();
  }
  /** Covers the canvas with a copy of its picture until `uncover`, which fades to the canvas. */
  cover(): void {
    const canvas = this.#canvas;
    this.#dropCover();
    if (!canvas?.width || !canvas.height) return;
    const { width, height } = canvas, cover = (this.#cover = Object.assign(document.createElement('canvas'), { width, height, className: 'cover' }));
    cover.getContext('2d')?.drawImage(canvas, 0, 0);
    this.stage.append(cover);
    this.stage.classList.add('covered');
    this.#coverTimer = setTimeout(() => this.uncover(), COVERED_MS);
  }
  uncover(): void {
    if (!this.#cover || !this.stage.classList.replace('covered', 'fading')) return;
    clearTimeout(this.#coverTimer);
    this.#coverTimer = setTimeout(() => this.#dropCover(), FADING_MS);
  }
  #dropCover(): void {
    clearTimeout(this.#coverTimer);
    this.stage.classList.remove('covered', 'fading');
    this.#cover?.remove();
    this.#cover = null;
  }
  dropCanvas(): void {
    this.#dropCover();
    if (this.#canvas?.parentNode === this.stage) this.#canvas.remove(); // false if another viewer shows the canvas
    this.#canvas = null;
  }

  setLabel(alt: string, orbits: boolean, steers: boolean): void {
    const interactive = orbits || steers;
    if (interactive) this.stage.tabIndex = 0;
    else this.stage.removeAttribute('tabindex'); // a click does not take keys from the page
    this.stage.setAttribute('role', interactive ? 'application' : 'img');
    this.stage.ariaLabel = alt || this.#strings.label;
    if (steers) this.stage.setAttribute('aria-keyshortcuts', 'ArrowLeft ArrowRight ArrowUp ArrowDown W A S D Space');
    else if (orbits) this.stage.setAttribute('aria-keyshortcuts', 'ArrowLeft ArrowRight ArrowUp ArrowDown + - Home Space');
    else this.stage.removeAttribute('aria-keyshortcuts');
    this.stage.classList.toggle('orbits', orbits);
  }
  /** Sets the stage's CSS touch-action; empty: the style sheet's. */
  setTouchAction(value: string): void {
    this.stage.style.touchAction = value;
  }
  setPoster(url: string | null): void {
    this.#picture.crossOrigin = (this.content.getRootNode() as ShadowRoot).host.getAttribute('crossorigin');
    this.#otherMode = true;
    if (url) this.#picture.src = url;
    else this.#picture.removeAttribute('src');
    this.#picture.hidden = !url;
  }
  // Retries another origin's poster in the other request mode: a cross-origin isolated page may need CORS, or the server
  // may lack it. Leaves a broken picture out.
  #onPosterError(): void {
    const { src, crossOrigin } = this.#picture;
    if (!this.#otherMode || src.startsWith(`${globalThis.origin}/`)) return this.setPoster(null);
    this.#otherMode = false;
    this.#picture.crossOrigin = crossOrigin === null ? 'anonymous' : null;
    this.#picture.src = src;
  }
  get hasPoster(): boolean {
    return !this.#picture.hidden || this.#poster.assignedNodes().length > 0;
  }
  /** Hides the poster. */
  dismissPoster(): void { this.#poster.classList.add('gone'); }

  idle(): void {
    this.#forget();
    this.#progress.hidden = this.#play.hidden = this.#error.hidden = true;
    this.#forgetNote();
    this.#poster.classList.remove('gone');
  }
  #forget(): void {
    this.#kept?.remove();
    this.#kept = null;
  }
  loading(): void {
    if (!this.#kept) this.idle();
    this.#progress.hidden = false;
    this.progress(0);
  }
  progress(fraction: number): void {
    this.#fill.style.transform = `scaleX(${fraction})`;
    this.#bar.setAttribute('aria-valuenow', String(Math.round(100 * fraction)));
  }
  /** Ends the progress bar: the first picture is on the canvas. reveal: hides the poster. */
  ready(reveal: boolean): void {
    this.#forget();
    this.progress(1);
    this.#progress.hidden = true;
    if (reveal) this.dismissPoster();
  }
  offerPlay(offer: boolean): void {
    const focused = !offer && this.#play.matches(':focus');
    this.#play.hidden = !offer;
    if (focused) this.#focusStage();
  }
  // Focuses the stage; one without a tabindex is made focusable until it loses the focus.
  #focusStage(): void {
    const { stage } = this;
    if (!stage.hasAttribute('tabindex')) {
      stage.tabIndex = -1;
      stage.addEventListener('blur', () => { if (stage.tabIndex < 0) stage.removeAttribute('tabindex'); }, { once: true });
    }
    stage.focus();
  }
  /** Shows the error and a button to retry. over: there is no picture, so that the poster is shown again. */
  fail(error: ErrorDetail, over: boolean): void {
    this.#progress.hidden = this.#play.hidden = true;
    this.#message.textContent = textOf(error, this.#strings[error.id as keyof Strings] ?? this.#strings.failure);
    this.#error.hidden = false;
    if (over) this.#poster.classList.remove('gone');
  }
  recover(): void {
    this.#error.hidden = true;
  }
  /** Shows or hides the note that the viewer waits for the network. */
  note(waiting: boolean): void {
    this.#network = waiting;
    this.#showNote();
  }
  /** Shows a note that this step takes long; null: hides it. */
  noteStep(step: Step | null): void {
    this.#step = step;
    this.#showNote();
  }
  /** Shows a note until complete(): the player's second part cannot be loaded. */
  incomplete(error: ErrorDetail): void {
    this.#lack = textOf(error, this.#strings.incomplete);
    this.#showNote();
  }
  complete(): void {
    this.#lack = '';
    this.#showNote();
  }
  #forgetNote(): void {
    this.#network = false;
    this.#lack = '';
    this.noteStep(null);
  }
  #showNote(): void {
    const { waiting, network } = this.#strings, step = this.#step;
    const text = step ? `${waiting} ${this.#strings[`on-${step}`]} …` : this.#network ? network : this.#lack;
    this.#note.textContent = text;
    this.#note.hidden = !text;
  }
}
