// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: playing, pausing and seeking, like the media element; frames; the state of live streams.
import { isOn } from '../page/attributes.js';
import type { Wishes } from '../player/commands.js';
import { deferred, type Deferred } from '../page/deferred.js';
import { ViewerError, type ErrorDetail } from '../report/errors.js';
import type { LiveState } from '../live/live.js';
import { emit, firstWishes, onAttribute, onEvent, onGivenUp, onSession, parts, report, touched, type Constructor, type ViewerBase } from './base.js';
import { standsStill, type Loading } from './loading.js';

/** It was paused, by the visitor or by the page. */
export const stopped: unique symbol = Symbol();

export interface Playback {
  autoplay: boolean;
  loop: boolean;
  /** True until `play` is dispatched: for autoplay, when it begins to play. */
  readonly paused: boolean;
  readonly ended: boolean;
  readonly seeking: boolean;
  readonly duration: number;
  currentTime: number;
  /** 0…4; 0: plays, but the frame stays. */
  playbackRate: number;
  defaultPlaybackRate: number;
  /** Resolves when it plays; rejects if it is paused, reloaded or removed before, or if an error comes instead. */
  play(): Promise<void>;
  pause(): void;
  readonly frame: number;
  seekFrame(frame: number): void;
  /** State of a live stream; null for other characters. */
  readonly liveState: LiveState | null;
  /** Seconds from capture to now, of the live frame that is shown; NaN while that is not known. */
  readonly liveLatency: number;
  readonly [stopped]: boolean;
}

export function withPlayback<T extends Constructor<ViewerBase & Loading>>(Base: T): T & Constructor<Playback> {
  return class extends Base implements Playback {
    static override get observedAttributes(): readonly string[] { return [...super.observedAttributes, 'loop']; }

    #defaultRate = 1;
    #playing = false; // as dispatched
    #ended = false;
    #seeking = false;
    #stopped = false; // somebody has paused it
    #sought: { time?: number; frame?: number } = {}; // before there was a source
    #played: Deferred | null = null;

    constructor(...args: any[]) {
      super(...args);
      this[parts].overlay.onPlay = () => this.play();
    }

    get autoplay(): boolean { return isOn(this, 'autoplay'); }
    set autoplay(value: boolean) { this.toggleAttribute('autoplay', value); }
    get loop(): boolean { return isOn(this, 'loop'); }
    set loop(value: boolean) { this.setAttribute('loop', value ? '' : 'false'); }
    get [stopped](): boolean { return this.#stopped; }
    get paused(): boolean { return !this.#playing; }
    get ended(): boolean { return this.#ended; }
    get seeking(): boolean { return this.#seeking; }
    get duration(): number { return this[parts].session?.live ? Infinity : this[parts].current?.duration ?? NaN; }
    get currentTime(): number {
      const { commands } = this[parts];
      return commands.state()?.currentTimeS ?? commands.wishes.time ?? 0;
    }
    set currentTime(value: number) {
      if (!Number.isFinite(Number(value))) throw new TypeError('currentTime must be a number of seconds');
      this.#seek({ time: Number(value) });
      this[parts].commands.seek(Number(value));
    }
    get defaultPlaybackRate(): number { return this.#defaultRate; }
    set defaultPlaybackRate(value: number) { this.#defaultRate = value; }
    get playbackRate(): number { return this[parts].commands.wishes.rate; }
    set playbackRate(value: number) {
      if (!(value >= 0 && value <= 4)) throw new RangeError('playbackRate must be 0 to 4');
      this[parts].commands.set('rate', value);
      this[emit]('ratechange');
    }

    play(): Promise<void> {
      const { commands, overlay } = this[parts], { error } = this;
      this[touched]();
      this.#stopped = false;
      overlay.offerPlay(false);
      const state = commands.state();
      if (state?.hasFrame && !state.paused && !state.seeking) return Promise.resolve();
      const { promise } = (this.#played ??= deferred());
      if (error && this[standsStill]) this.#settle(new ViewerError(error.id, error.message));
      commands.remember('playing', true);
      this.#begin();
      commands.set('playing', true);
      return promise;
    }
    pause(): void {
      this.#stopped = true;
      this.#settle(new DOMException('paused before it played', 'AbortError'));
      this[parts].commands.set('playing', false);
      this[report]('pause'); // where no character has done it
    }

    get frame(): number { return this[parts].commands.state()?.frame ?? 0; }
    seekFrame(frame: number): void {
      this.#seek({ frame });
      this[parts].commands.seekFrame(frame);
    }

    get liveState(): LiveState | null { return this[parts].session?.live?.state ?? null; }
    get liveLatency(): number { return this[parts].session?.live?.latency ?? NaN; }

    override [firstWishes](): Partial<Wishes> {
      const sought = this.#sought;
      this.#sought = {};
      const playing = this.autoplay && !this.#stopped ? !this[parts].reducedMotion.matches : this.#playing;
      if (!playing) this[report]('pause');
      return { ...super[firstWishes](), loop: this.#loopMode(), ...sought, playing };
    }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      if (name === 'loop' && before !== value && this[parts].connected) this[parts].commands.set('loop', this.#loopMode());
    }
    override [report](name: string, detail?: unknown): void {
      if (name === 'pause' && !this.#playing) return; // it was dispatched
      if (name === 'playing') this.#begin();
      super[report](name, detail);
    }
    override [onEvent](name: string, detail: unknown): void {
      const { commands, overlay } = this[parts];
      super[onEvent](name, detail);
      if (name === 'pause') {
        this.#playing = false;
        commands.remember('playing', false);
      } else if (name === 'ended') {
        this.#ended = true;
        overlay.offerPlay(true);
      } else if (name === 'seeked' || (name === 'error' && this[standsStill])) {
        this.#seeking = false;
      } else if (name === 'canplay') {
        this.#seeking &&= commands.state()?.seeking ?? false;
      } else if (name === 'playing' || name === 'sequencechange') {
        this.#ended = this.#seeking = false;
      }
      if (name !== 'playing') return;
      this.#played?.resolve();
      this.#played = null;
    }
    override [onSession](): void {
      super[onSession]();
      this.#ended = this.#seeking = false;
    }
    override [onGivenUp](error?: ErrorDetail): void {
      super[onGivenUp](error);
      this.#ended = this.#seeking = false;
      this.#settle(error ? new ViewerError(error.id, error.message)
        : new DOMException('another character was loaded, or the viewer was removed', 'AbortError'));
    }

    // There is no source to seek in.
    get #isIdle(): boolean { return !this[parts].connected || !this.src; }
    #begin(): void {
      if (this.#playing) return;
      this.#playing = true;
      this[emit]('play');
    }
    #seek(to: { time?: number; frame?: number }): void {
      this.#seeking = true;
      this.#ended = false;
      this[emit]('seeking');
      if (this.#isIdle) this.#sought = to;
    }
    #settle(reason: Error): void {
      this.#played?.reject(reason);
      this.#played = null;
    }
    // -1 as the sequence says, 0 never, 1 always.
    #loopMode(): number {
      if (!this.hasAttribute('loop')) return -1;
      return this.loop ? 1 : 0;
    }
  };
}
