// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: the rest of the media element's contract, by which ready-made controls drive it: states, ranges
// of time, volume, callbacks for pictures. Ranges are empty until the
// player's second part is there.
import { isOn } from '../page/attributes.js';
import type { MediaTimes } from '../more/media-times.js';
import type { More } from '../player/wasm-module.js';
import { animate, emit, onConnected, onEvent, onGivenUp, onLeft, onMore, onPicture, onSession, parts, report, type Constructor, type ViewerBase } from './base.js';
import type { Loading } from './loading.js';
import type { Playback } from './playback.js';

/** Metadata of a picture, by the names of HTMLVideoElement's; times in ms, mediaTime in seconds. */
export interface PictureMetadata {
  presentationTime: number;
  expectedDisplayTime: number;
  width: number;
  height: number;
  mediaTime: number;
  presentedFrames: number;
}

export interface Media {
  /** 'none': loads at the first play() or touch; else `loading` decides. */
  preload: string;
  /** 'use-credentials': cookies go to other origins, too. */
  crossOrigin: string | null;
  readonly networkState: number;
  readonly readyState: number;
  /** Ranges of the motion shown that can be played without the network. */
  readonly buffered: TimeRanges;
  readonly seekable: TimeRanges;
  /** Ranges of it that have been played since it was chosen. */
  readonly played: TimeRanges;
  volume: number;
  muted: boolean;
  defaultMuted: boolean;
  requestVideoFrameCallback(callback: (nowMs: number, metadata: PictureMetadata) => void): number;
  cancelVideoFrameCallback(handle: number): void;
}

const HAVE: Record<string, number> = { loadedmetadata: 1, loadeddata: 2, waiting: 2, canplay: 3, playing: 3, canplaythrough: 4 };

/** [start, end] in seconds, in their order. */
export function timeRanges(list: readonly (readonly [number, number])[]): TimeRanges {
  const at = (side: 0 | 1) => (i: number): number => {
    const range = list[i];
    if (!range) throw new DOMException(`there are ${list.length} ranges`, 'IndexSizeError');
    return range[side];
  };
  return { length: list.length, start: at(0), end: at(1) };
}

export function withMedia<T extends Constructor<ViewerBase & Loading & Playback>>(Base: T): T & Constructor<Media> {
  return class extends Base implements Media {
    #ready = 0;
    #duration = NaN; // at the last durationchange
    #volume = 1;
    #muted: boolean | null = null; // null before it is in a document: the attribute counts
    #times: MediaTimes | null = null;
    #callbacks = new Map<number, (nowMs: number, metadata: PictureMetadata) => void>();
    #handles = 0;
    #presented = NaN;

    get preload(): string { return this.getAttribute('preload') ?? 'auto'; }
    set preload(value: string) { this.setAttribute('preload', value); }
    get crossOrigin(): string | null { return this.getAttribute('crossorigin'); }
    set crossOrigin(value: string | null) {
      if (value === null) this.removeAttribute('crossorigin');
      else this.setAttribute('crossorigin', value);
    }
    get networkState(): number {
      const { session } = this[parts];
      if (!this.src) return 0;
      if (!session || session.ended) return this.error ? 3 : 1;
      return !session.character || session.transport.busy ? 2 : 1;
    }
    get readyState(): number { return this[parts].session?.character ? this.#ready : 0; }
    get buffered(): TimeRanges { return timeRanges(this.#times?.buffered() ?? []); }
    get seekable(): TimeRanges { return timeRanges(this.duration < Infinity ? [[0, this.duration]] : []); }
    get played(): TimeRanges { return timeRanges(this.#times?.played ?? []); }
    get volume(): number { return this.#volume; }
    set volume(value: number) {
      if (!(value >= 0 && value <= 1)) throw new DOMException('volume must be 0 to 1', 'IndexSizeError');
      if (this.#volume === value) return;
      this.#volume = value;
      this[emit]('volumechange');
    }
    get muted(): boolean { return this.#muted ?? this.defaultMuted; }
    set muted(on: boolean) {
      const before = this.muted;
      this.#muted = on;
      if (before !== on) this[emit]('volumechange');
    }
    get defaultMuted(): boolean { return isOn(this, 'muted'); }
    set defaultMuted(on: boolean) { this.toggleAttribute('muted', on); }

    requestVideoFrameCallback(callback: (nowMs: number, metadata: PictureMetadata) => void): number {
      this.#callbacks.set(++this.#handles, callback);
      return this.#handles;
    }
    cancelVideoFrameCallback(handle: number): void { this.#callbacks.delete(handle); }

    // The first picture may be drawn after the player can go on from it.
    override [report](name: string, detail?: unknown): void {
      if (name === 'canplay' && this.#ready < 2) super[report]('loadeddata');
      if (name !== 'loadeddata' || this.#ready < 2) super[report](name, detail);
    }
    override [onEvent](name: string, detail: unknown): void {
      super[onEvent](name, detail);
      if (name === 'sequencechange') this.#ready = Math.min(this.#ready, 3); // that one may not be buffered yet
      if (name in HAVE) this.#ready = name === 'waiting' ? HAVE[name]! : Math.max(this.#ready, HAVE[name]!);
      if ((name === 'loadedmetadata' || name === 'sequencechange') && !Object.is(this.#duration, this.duration)) {
        this.#duration = this.duration;
        this[emit]('durationchange');
      }
      if (name === 'seeked') this[emit]('timeupdate');
    }
    override [onPicture](): void {
      super[onPicture]();
      const state = this[parts].commands.state();
      if (!this.#callbacks.size || state?.framesShown === this.#presented) return;
      this.#presented = state!.framesShown;
      const due = this.#callbacks, now = performance.now();
      this.#callbacks = new Map();
      for (const callback of due.values()) {
        const metadata = { presentationTime: now, expectedDisplayTime: now, ...this[parts].size, mediaTime: this.currentTime, presentedFrames: this.#presented };
        try {
          callback(now, metadata);
        } catch (reason) {
          setTimeout(() => { throw reason; }); // the others, and the next picture, do not wait for it
        }
      }
    }
    override [onMore](more: More): void {
      super[onMore](more);
      this.#times ??= new more.MediaTimes(this, {
        player: () => this[parts].session?.wholePlayer ?? null,
        bytes: () => this[parts].commands.state()?.bytesFetched ?? 0,
      }, (name, detail) => this[report](name, detail));
    }
    override [animate](dtS: number): boolean {
      this.#times?.turn();
      return super[animate](dtS);
    }
    override [onConnected](): void {
      super[onConnected]();
      this.#muted ??= this.defaultMuted;
    }
    override [onLeft](): void {
      super[onLeft]();
      this.#times?.dispose();
    }
    override [onGivenUp](error?: Parameters<ViewerBase[typeof onGivenUp]>[0]): void {
      super[onGivenUp](error);
      if (!error) this.#forget();
    }
    override [onSession](): void {
      super[onSession]();
      this.#forget();
    }
    #forget(): void {
      this.#ready = 0;
      this.#duration = NaN;
    }
  };
}
