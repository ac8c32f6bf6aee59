// SPDX-License-Identifier: Apache-2.0
// Feature: the remaining members of HTMLMediaElement's interface, for third-party controls: states, time ranges, volume,
// callbacks for pictures. Ranges are empty until the player's second part is loaded.
import type { MediaTimes } from '../more/media-times.js';
import type { More } from '../player/wasm-module.js';
import type { ErrorDetail } from '../report/errors.js';
import type { Loading } from './loading.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

type TimedViewer = ConstructorParameters<typeof MediaTimes>[0];
type PictureCallback = (nowMs: number, metadata: PictureMetadata) => void;

/** Metadata of a picture, named as HTMLVideoElement's callback names them; times in ms, mediaTime in seconds. */
export interface PictureMetadata {
  presentationTime: number;
  expectedDisplayTime: number;
  width: number;
  height: number;
  mediaTime: number;
  presentedFrames: number;
}

const HAVE: Record<string, number> = { loadedmetadata: 1, loadeddata: 2, waiting: 2, canplay: 3, playing: 3, canplaythrough: 4 };

/** Makes TimeRanges of [start, end] pairs in seconds, in ascending order. */
export function timeRanges(list: readonly (readonly [number, number])[]): TimeRanges {
  const at = (side: 0 | 1) => (i: number): number => {
    const range = list[i];
    if (!range) throw new DOMException(`there are ${list.length} ranges`, 'IndexSizeError');
    return range[side];
  };
  return { length: list.length, start: at(0), end: at(1) };
}

export class Media implements Feature {
  readonly #viewer: Viewer;
  readonly #loading: Loading;
  readonly #timed: TimedViewer;
  #ready = 0;
  #duration = NaN; // at the last durationchange
  #volume = 1;
  #muted: boolean | null = null; // null before the element is first in a document: the attribute applies
  #times: MediaTimes | null = null;
  #callbacks = new Map<number, PictureCallback>();
  #handles = 0;
  #presented = NaN;

  /** timed: the viewer's element. */
  constructor(viewer: Viewer, loading: Loading, timed: TimedViewer) {
    this.#viewer = viewer;
    this.#loading = loading;
    this.#timed = timed;
  }

  get networkState(): number {
    const { session, element } = this.#viewer;
    if (!valueOf(element, 'src')) return 0;
    if (!session || session.ended) return this.#loading.error ? 3 : 1;
    return !session.character || session.transport.busy ? 2 : 1;
  }
  get readyState(): number { return this.#viewer.character ? this.#ready : 0; }
  get buffered(): TimeRanges { return timeRanges(this.#times?.buffered() ?? []); }
  get played(): TimeRanges { return timeRanges(this.#times?.played ?? []); }
  get volume(): number { return this.#volume; }
  set volume(value: number) {
    if (!(value >= 0 && value <= 1)) throw new DOMException('volume must be 0 to 1', 'IndexSizeError');
    if (this.#volume === value) return;
    this.#volume = value;
    this.#viewer.emit('volumechange');
  }
  get muted(): boolean { return this.#muted ?? valueOf(this.#viewer.element, 'muted'); }
  set muted(on: boolean) {
    const before = this.muted;
    this.#muted = on;
    if (before !== on) this.#viewer.emit('volumechange');
  }
  requestCallback(callback: PictureCallback): number {
    this.#callbacks.set(++this.#handles, callback);
    return this.#handles;
  }
  cancelCallback(handle: number): void { this.#callbacks.delete(handle); }

  // Reports `loadeddata` before `canplay`, once: the player may be able to play before the first picture is drawn.
  accept(event: string): boolean {
    if (event === 'canplay' && this.#ready < 2) this.#viewer.report('loadeddata');
    return event !== 'loadeddata' || this.#ready < 2;
  }
  handle(event: string): void {
    if (event === 'sequencechange') this.#ready = Math.min(this.#ready, 3); // HAVE_FUTURE_DATA: the new motion may not be buffered yet
    if (event in HAVE) this.#ready = event === 'waiting' ? HAVE[event]! : Math.max(this.#ready, HAVE[event]!);
    const { duration } = this.#viewer;
    if ((event === 'loadedmetadata' || event === 'sequencechange') && !Object.is(this.#duration, duration)) {
      this.#duration = duration;
      this.#viewer.emit('durationchange');
    }
    if (event === 'seeked') this.#viewer.emit('timeupdate');
  }
  picture(): void {
    const { state, size, currentTime } = this.#viewer;
    if (!this.#callbacks.size || state?.framesShown === this.#presented) return;
    this.#presented = state!.framesShown;
    const due = this.#callbacks, now = performance.now();
    this.#callbacks = new Map();
    for (const callback of due.values()) {
      const metadata = { presentationTime: now, expectedDisplayTime: now, ...size, mediaTime: currentTime, presentedFrames: this.#presented };
      try {
        callback(now, metadata);
      } catch (reason) {
        setTimeout(() => { throw reason; }); // rethrown as the page's own error, after the other callbacks
      }
    }
  }
  more(more: More): void {
    const viewer = this.#viewer;
    this.#times ??= new more.MediaTimes(this.#timed, {
      player: () => viewer.session?.wholePlayer ?? null,
      bytes: () => viewer.state?.bytesFetched ?? 0,
    }, (name, detail) => viewer.report(name, detail));
  }
  frame(): void { this.#times?.turn(); }
  connect(): void { this.#muted ??= valueOf(this.#viewer.element, 'muted'); }
  disconnect(): void { this.#times?.dispose(); }
  giveUp(error?: ErrorDetail): void { if (!error) this.begin(); }
  begin(): void {
    this.#ready = 0;
    this.#duration = NaN;
  }
}
