// SPDX-License-Identifier: Apache-2.0
// Ranges of time of the motion that a viewer shows: what has been played, and what can be played without the network; and the
// events that follow from them. Part of fourdvt-more.js.
import { readTimeRange } from '../wasm/generated/abi.js';
import type { SidePlayer } from './session-side.js';

const PROGRESS_MS = 350; // between two events, about that of browsers
const MEMORY_STEP = 2e6; // bytes; a page's memory is shared out anew at such events
const ENOUGH_S = 4; // ahead: the player's renditions follow the network from there on

export type Range = [number, number];

/** The element: the members that are used here. */
export interface TimedViewer extends EventTarget {
  readonly paused: boolean;
  readonly currentTime: number;
  readonly duration: number;
  readonly readyState: number;
}
interface Measured {
  readonly stats?: { readonly textureBytes: number; readonly heapBytes: number } | null;
}

/** The character that it shows. */
export interface TimedCharacter {
  /** Null until its second part is there. */
  player(): SidePlayer | null;
  /** Bytes that were fetched so far. */
  bytes(): number;
}

/** The ranges with one more, in order, none touching another. */
export function withRange(ranges: readonly Range[], [start, end]: Range): Range[] {
  const apart = ranges.filter(([a, b]) => b < start || a > end), joined = ranges.filter(([a, b]) => b >= start && a <= end);
  const whole: Range = [Math.min(start, ...joined.map(([a]) => a)), Math.max(end, ...joined.map(([, b]) => b))];
  return [...apart, whole].sort(([a], [b]) => a - b);
}

export class MediaTimes {
  readonly #viewer: TimedViewer;
  readonly #character: TimedCharacter;
  readonly #report: (name: string, detail?: unknown) => void;
  #since: number | null = null; // it has played from there to now
  #fetched = 0; // bytes, at the last event
  #held = 0; // memory of the page at the last event, steps
  #timer: ReturnType<typeof setTimeout> | undefined;
  played: Range[] = [];

  /** report: dispatches an event of the player. */
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

  /** A turn of the page's loop: it is there wherever bytes have come, or memory has grown. */
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

  // A motion that loops may have begun again since.
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
