// SPDX-License-Identifier: Apache-2.0
// Time ranges of the motion that a viewer shows: those played, and those playable without the network; and the events of
// HTMLMediaElement that depend on them. Part of fourdvt-more.js.
import { readTimeRange } from '../wasm/generated/abi.js';
import type { SidePlayer } from './session-side.js';

const PROGRESS_MS = 350; // between two `progress` events, about as in browsers
const MEMORY_STEP = 2e6; // bytes; memory that grows by this causes a `progress` event: a new allocation
const ENOUGH_S = 4; // buffered ahead for `canplaythrough`: more is not needed, as renditions adapt to the network

export type Range = [number, number];

/** Members of the element that this file uses. */
export interface TimedViewer extends EventTarget {
  readonly paused: boolean;
  readonly currentTime: number;
  readonly duration: number;
  readonly readyState: number;
}
interface Measured {
  readonly stats?: { readonly textureBytes: number; readonly heapBytes: number } | null;
}

/** Access to the shown character. */
export interface TimedCharacter {
  /** Null until the second part is loaded. */
  player(): SidePlayer | null;
  /** Bytes fetched so far. */
  bytes(): number;
}

/** Returns the union of the ranges and one more, in order, with touching ranges merged. */
export function withRange(ranges: readonly Range[], [start, end]: Range): Range[] {
  const apart = ranges.filter(([a, b]) => b < start || a > end), joined = ranges.filter(([a, b]) => b >= start && a <= end);
  const whole: Range = [Math.min(start, ...joined.map(([a]) => a)), Math.max(end, ...joined.map(([, b]) => b))];
  return [...apart, whole].sort(([a], [b]) => a - b);
}

export class MediaTimes {
  readonly #viewer: TimedViewer;
  readonly #character: TimedCharacter;
  readonly #report: (name: string, detail?: unknown) => void;
  #since: number | null = null; // start of the present range of play; null: not playing
  #fetched = 0; // bytes, at the last event
  #held = 0; // memory of the page at the last event, steps
  #timer: ReturnType<typeof setTimeout> | undefined;
  played: Range[] = [];

  /** report: dispatches an event. */
  constructor(viewer: TimedViewer, character: TimedCharacter, report: (name: string, detail?: unknown) => void) {
    this.#viewer = viewer;
    this.#character = character;
    this.#report = report;
    const on = (names: string, run: () => void): void => { for (const name of names.split(' ')) viewer.addEventListener(name, run); };
    if (!viewer.paused) this.#since = viewer.currentTime;
    on('playing', () => (this.#since = viewer.currentTime));
    on('timeupdate', () => this.#note());
    on('pause seeking waiting', () => {
      this.#note();
      this.#since = null;
    });
    on('emptied suspend', () => this.dispose());
    on('sequencechange emptied', () => {
      this.played = [];
      if (this.#since !== null) this.#since = viewer.currentTime;
    });
    on('canplay playing sequencechange', () => this.#judge());
  }

  buffered(): Range[] {
    const list: Range[] = [];
    this.#character.player()?.call((module, handle) => {
      for (let at = 0; (at = module._fdvt_buffered(handle, list.length)); ) {
        const { startS, endS } = readTimeRange(module.HEAPU8, at);
        list.push([startS, endS]);
      }
      return 1;
    });
    return list;
  }

  /** Called per turn of the frame loop, which runs whenever bytes have come or memory has grown. */
  turn(): void {
    this.#timer ??= setTimeout(() => {
      this.#timer = undefined;
      const bytes = this.#character.bytes(), { textureBytes = 0, heapBytes = 0 } = (this.#viewer as Measured).stats ?? {};
      const held = Math.round((textureBytes + heapBytes) / MEMORY_STEP);
      if ((bytes === this.#fetched && held === this.#held) || this.#viewer.readyState < 2) return; // before the first picture the player has events of its own
      this.#fetched = bytes;
      this.#held = held;
      this.#report('progress', { loaded: bytes, total: bytes });
      this.#judge();
    }, PROGRESS_MS);
  }
  dispose(): void {
    clearTimeout(this.#timer);
    this.#timer = undefined;
  }

  // Adds the range played since #since; a loop may have wrapped within it.
  #note(): void {
    const { currentTime: now, duration } = this.#viewer, since = this.#since;
    if (since === null || now === since) return;
    const passed: Range[] = now > since ? [[since, now]] : [[since, duration], [0, now]];
    this.played = passed.filter(([start, end]) => start < end && end <= duration).reduce(withRange, this.played);
    this.#since = now;
  }

  #judge(): void {
    const { readyState, currentTime, duration } = this.#viewer;
    const [, end = 0] = this.buffered().find(([a, b]) => a <= currentTime && currentTime <= b) ?? [];
    if (readyState === 3 && end >= Math.min(duration, currentTime + ENOUGH_S) - 1e-3) this.#report('canplaythrough');
  }
}
