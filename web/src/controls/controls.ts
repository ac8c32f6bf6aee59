// SPDX-License-Identifier: Apache-2.0
// Buttons of a viewer: a pause button; with the attribute `controls`, a bar with play, time, sound and full screen
// instead. Part of fourdvt-more.js.
import { isOn } from '../page/attributes.js';
import { adopt } from '../page/documents.js';
import { fill } from '../report/strings-more.js';
import type { Chapter } from './chapters.js';

const CSS = `
.controls { position: absolute; left: 0; right: 0; bottom: 0; display: flex; align-items: center; gap: 2px; padding: 0 4px; color: #fff;
  font: 13px/1 system-ui, sans-serif; font-variant-numeric: tabular-nums; background: rgba(20,20,24,.75); }
.controls.small { left: auto; right: max(12px, env(safe-area-inset-right)); bottom: max(12px, env(safe-area-inset-bottom)); padding: 0; border-radius: 50%;
  background: rgba(20,20,24,.55); }
.controls button { flex: none; width: 44px; height: 44px; border: 0; background: none; color: inherit; padding: 10px; cursor: pointer; }
.controls.small button { padding: 14px; border-radius: 50%; }
.controls button:focus-visible, .controls input:focus-visible { outline: 3px solid var(--fourdvt-focus, #8ab4ff); outline-offset: -3px; }
.controls svg { display: block; width: 100%; height: 100%; fill: currentColor; pointer-events: none; }
.controls input { flex: 1; min-width: 40px; height: 24px; margin: 0 6px; accent-color: var(--fourdvt-progress-color, #8ab4ff); }
.controls span { flex: none; padding: 0 6px; }
.controls [part=chapter] { flex: 0 1 auto; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; max-width: 30%; line-height: 1.3; unicode-bidi: plaintext; }
.controls:not(.own) { direction: ltr; writing-mode: horizontal-tb; } /* time runs to the right in every script */
@media (forced-colors: active) {
  .controls { border: 1px solid; }
  .controls button:focus-visible, .controls input:focus-visible { outline-color: Highlight; }
}
`;
const ICONS = {
  play: 'M5 2v20l16-10z',
  pause: 'M4 2h6v20H4zm10 0h6v20h-6z',
  loud: 'M3 9v6h4l5 5V4L7 9zm13.5 3a4.5 4.5 0 0 0-2.5-4v8a4.5 4.5 0 0 0 2.5-4zM14 3.2v2.1a7 7 0 0 1 0 13.4v2.1a9 9 0 0 0 0-17.6z',
  mute: 'M3 9v6h4l5 5V4L7 9zm18.5.9-1.4-1.4-2.6 2.6-2.6-2.6-1.4 1.4 2.6 2.6-2.6 2.6 1.4 1.4 2.6-2.6 2.6 2.6 1.4-1.4-2.6-2.6z',
  full: 'M2 2h8v3H5v5H2zm12 0h8v8h-3V5h-5zM2 14h3v5h5v3H2zm17 0h3v8h-8v-3h5z',
};

export interface Controlled extends HTMLElement {
  readonly paused: boolean;
  readonly duration: number;
  readonly sequence: string;
  readonly sequences: readonly { name: string; frames: number }[];
  readonly readyState: number;
  currentTime: number;
  muted: boolean;
  play(): Promise<void>;
  pause(): void;
}

/** State of the shown motion's sound. */
export interface SoundState {
  readonly present: boolean;
  /** True while the browser blocks sound until the visitor's first input. */
  readonly blocked: boolean;
}

/** Formats seconds as minutes and seconds. */
export function clockTime(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds || 0));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

const SVG = 'http://www.w3.org/2000/svg';
function setIcon(button: HTMLButtonElement, icon: keyof typeof ICONS, label: string): void {
  if (button.ariaLabel === label && button.dataset['icon'] === icon) return;
  button.ariaLabel = button.title = label;
  button.dataset['icon'] = icon;
  const svg = document.createElementNS(SVG, 'svg'), path = document.createElementNS(SVG, 'path');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  path.setAttribute('d', ICONS[icon]);
  svg.append(path);
  button.replaceChildren(svg);
}

export class Controls {
  readonly #viewer: Controlled;
  readonly #box: HTMLDivElement;
  readonly #play: HTMLButtonElement;
  readonly #time: HTMLInputElement;
  readonly #clock: HTMLSpanElement;
  readonly #chapter: HTMLSpanElement;
  readonly #marks: HTMLDataListElement;
  readonly #chaptersOf: (motion: string) => Chapter[];
  readonly #mute: HTMLButtonElement;
  readonly #full: HTMLButtonElement;
  readonly #sound: SoundState;
  readonly #offer: HTMLElement | null; // the overlay's large play button
  readonly #abort = new AbortController();
  #strings: Record<string, string> = {};
  #chapters: Chapter[] = []; // of the shown motion
  #marked = ''; // chapters that the slider marks
  #shown = ''; // key of the state that the controls show

  /** content: element that fills the viewer's content box, and gets the controls. */
  constructor(viewer: Controlled, content: HTMLElement, sound: SoundState, chaptersOf: (motion: string) => Chapter[]) {
    this.#chaptersOf = chaptersOf;
    this.#viewer = viewer;
    this.#sound = sound;
    this.#offer = content.querySelector('.play');
    adopt(content, CSS);
    const make = <K extends 'button' | 'input' | 'span'>(tag: K, part: string, on?: () => void): HTMLElementTagNameMap[K] => {
      const made = document.createElement(tag);
      made.setAttribute('part', part);
      if (on) made.addEventListener(tag === 'input' ? 'input' : 'click', on, { signal: this.#abort.signal });
      if (tag === 'button') (made as HTMLButtonElement).type = 'button';
      return made;
    };
    this.#box = document.createElement('div');
    this.#box.className = 'controls';
    this.#box.setAttribute('part', 'controls');
    this.#play = make('button', 'play-toggle', () => (viewer.paused ? void viewer.play() : viewer.pause()));
    this.#time = make('input', 'time', () => (viewer.currentTime = Number(this.#time.value)));
    Object.assign(this.#time, { type: 'range', min: '0', value: '0' });
    this.#clock = make('span', 'clock');
    this.#clock.ariaHidden = 'true'; // the slider's value text is the same
    this.#chapter = make('span', 'chapter');
    this.#chapter.ariaHidden = 'true';
    this.#marks = document.createElement('datalist');
    this.#marks.id = 'chapters';
    this.#time.setAttribute('list', 'chapters');
    // A press of the mute button also unlocks sound that the browser blocks, before its click arrives: the state at the
    // beginning of the press selects what the click does.
    const isSilent = (): boolean => viewer.muted || sound.blocked;
    let silent: boolean | null = null; // at the beginning of the press; null: no press
    this.#mute = make('button', 'mute', () => {
      viewer.muted = !(silent ?? isSilent());
      silent = null;
    });
    for (const type of ['pointerdown', 'keydown']) this.#mute.addEventListener(type, () => (silent = isSilent()), { signal: this.#abort.signal });
    this.#full = make('button', 'fullscreen', () => {
      const change = viewer.matches(':fullscreen') ? viewer.ownerDocument.exitFullscreen() : viewer.requestFullscreen();
      change.catch((reason: unknown) => console.warn('fourdvt-viewer:', reason)); // full screen is refused
    });
    const slot = document.createElement('slot');
    slot.name = 'controls';
    slot.style.display = 'contents';
    slot.append(this.#play, this.#time, this.#marks, this.#clock, this.#chapter, this.#mute, this.#full);
    this.#box.append(slot);
    content.append(this.#box);
    const names = ['playing', 'play', 'pause', 'ended', 'seeked', 'timeupdate', 'durationchange', 'canplay', 'emptied', 'volumechange', 'sequencechange'];
    for (const name of names) viewer.addEventListener(name, () => this.#show(), { signal: this.#abort.signal });
    viewer.addEventListener('fullscreenchange', () => this.#show(), { signal: this.#abort.signal });
    slot.addEventListener('slotchange', () => this.#show(), { signal: this.#abort.signal });
  }

  /** Updates the controls to the viewer's state. */
  show(): void { this.#show(); }
  update(strings: Record<string, string>): void {
    this.#strings = strings;
    this.#show(true);
  }
  /** Called per turn of the page's loop: moves the slider with the picture. */
  turn(): void {
    if (!this.#time.hidden && !this.#viewer.paused) this.#showTime();
  }
  dispose(): void {
    this.#abort.abort();
    this.#box.remove();
  }

  #show(always = false): void {
    const viewer = this.#viewer, s = this.#strings, mode = viewer.getAttribute('controls');
    const own = viewer.querySelector(':scope > [slot=controls]') !== null;
    const whole = own || (isOn(viewer, 'controls') && mode !== 'none'), timed = viewer.duration > 0 && viewer.duration < Infinity;
    const full = viewer.ownerDocument.fullscreenEnabled === true, isFull = viewer.matches(':fullscreen');
    const offered = !whole && this.#offer?.hidden === false; // the large button replaces the small one
    const silent = viewer.muted || this.#sound.blocked;
    const state = [this.#sound.present, silent, viewer.paused, mode, own, timed, isFull, viewer.readyState > 0, offered].join();
    if (always || state !== this.#shown) {
      this.#shown = state;
      const focused = this.#play.matches(':focus');
      this.#box.hidden = mode === 'none' || viewer.readyState === 0 || offered;
      if (focused && offered) this.#offer!.focus();
      this.#box.classList.toggle('small', !whole);
      this.#box.classList.toggle('own', own);
      if (whole) this.#box.setAttribute('role', 'group');
      else this.#box.removeAttribute('role');
      this.#box.ariaLabel = whole ? s['controls']! : null;
      this.#clock.textContent = ''; // forces a new text: the language may have changed
      this.#time.hidden = this.#clock.hidden = !whole || !timed;
      this.#chapter.hidden = true; // until its time is shown
      this.#chapter.textContent = '';
      this.#full.hidden = !whole || !full;
      this.#mute.hidden = !whole || !this.#sound.present;
      setIcon(this.#mute, silent ? 'mute' : 'loud', s[silent ? 'unmute' : 'mute']!);
      this.#time.ariaLabel = s['time']!;
      setIcon(this.#play, viewer.paused ? 'play' : 'pause', s[viewer.paused ? 'play' : 'pause']!);
      setIcon(this.#full, 'full', s[isFull ? 'leaveFullscreen' : 'fullscreen']!);
    }
    if (this.#time.hidden) return;
    const { duration, sequence, sequences } = viewer, frames = sequences.find(({ name }) => name === sequence)?.frames ?? 1;
    this.#time.max = String(duration);
    this.#time.step = String(duration / frames);
    const chapters = this.#chaptersOf(sequence), marks = JSON.stringify(chapters);
    if (marks !== this.#marked) this.#marks.replaceChildren(...chapters.map(({ startS, title }) => new Option(title, String(startS))));
    this.#chapters = chapters;
    this.#marked = marks;
    this.#showTime();
  }
  #showTime(): void {
    const { currentTime, duration } = this.#viewer, now = clockTime(currentTime), end = clockTime(duration);
    this.#time.value = String(currentTime);
    const clock = `${now} / ${end}`, chapter = this.#chapters.filter(({ startS, endS }) => startS <= currentTime && currentTime < endS).at(-1)?.title ?? '';
    if (this.#clock.textContent === clock && this.#chapter.textContent === chapter) return;
    this.#clock.textContent = clock;
    this.#chapter.textContent = chapter;
    this.#chapter.hidden = !chapter;
    const text = fill(this.#strings['timeOf']!, { now, end });
    this.#time.setAttribute('aria-valuetext', chapter ? `${text}, ${chapter}` : text);
  }
}
