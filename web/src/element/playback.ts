// SPDX-License-Identifier: Apache-2.0
// Feature: playing, pausing and seeking, like the media element.
import { deferred, type Deferred } from '../page/promises.js';
import type { Settings } from '../player/wasm-player.js';
import { ViewerError, type ErrorDetail } from '../report/errors.js';
import type { Loading } from './loading.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

export class Playback implements Feature {
  readonly #viewer: Viewer;
  readonly #loading: Loading;
  #playing = false; // state by the dispatched events `play` and `pause`
  #ended = false;
  #seeking = false;
  #stopped = false;
  #sought: { time?: number; frame?: number } = {}; // seek without a source, for the next one
  #played: Deferred | null = null;

  constructor(viewer: Viewer, loading: Loading) {
    this.#viewer = viewer;
    this.#loading = loading;
    viewer.overlay.onPlay = () => this.play();
  }

  /** True if pause() was called after the last play(). */
  get stopped(): boolean { return this.#stopped; }
  get paused(): boolean { return !this.#playing; }
  get ended(): boolean { return this.#ended; }
  get seeking(): boolean { return this.#seeking; }

  play(): Promise<void> {
    const { commands, overlay } = this.#viewer, { error } = this.#loading;
    this.#viewer.touch();
    this.#stopped = false;
    overlay.offerPlay(false);
    const { state } = this.#viewer;
    if (state?.hasFrame && !state.paused && !state.seeking) return Promise.resolve();
    const { promise } = (this.#played ??= deferred());
    if (error && this.#loading.standsStill) this.#settle(new ViewerError(error.id, error.message));
    commands.remember('playing', true);
    this.#begin();
    commands.set('playing', true);
    return promise;
  }
  pause(): void {
    this.#stopped = true;
    this.#settle(new DOMException('paused before it played', 'AbortError'));
    this.#viewer.commands.set('playing', false);
    this.#viewer.report('pause'); // if there is no player that emits it
  }
  seek(timeS: number): void {
    this.#seek({ time: timeS });
    this.#viewer.commands.seek(timeS);
  }
  seekFrame(frame: number): void {
    this.#seek({ frame });
    this.#viewer.commands.seekFrame(frame);
  }

  settings(): Partial<Settings> {
    const { element, reducedMotion } = this.#viewer, sought = this.#sought;
    this.#sought = {};
    const playing = valueOf(element, 'autoplay') && !this.#stopped ? !reducedMotion.matches : this.#playing;
    if (!playing) this.#viewer.report('pause');
    return { loop: this.#loopMode, ...sought, playing };
  }
  update(name: string, changed: boolean): void {
    if (name === 'loop' && changed) this.#viewer.commands.set('loop', this.#loopMode);
  }
  accept(event: string): boolean {
    if (event === 'playing') this.#begin();
    return event !== 'pause' || this.#playing; // one `pause` per `play`
  }
  handle(event: string): void {
    const { commands, overlay } = this.#viewer;
    if (event === 'pause') {
      this.#playing = false;
      commands.remember('playing', false);
    } else if (event === 'ended') {
      this.#ended = true;
      overlay.offerPlay(true);
    } else if (event === 'seeked' || (event === 'error' && this.#loading.standsStill)) {
      this.#seeking = false;
    } else if (event === 'canplay') {
      this.#seeking &&= this.#viewer.state?.seeking ?? false;
    } else if (event === 'playing' || event === 'sequencechange') {
      this.#ended = this.#seeking = false;
    }
    if (event !== 'playing') return;
    this.#played?.resolve();
    this.#played = null;
  }
  begin(): void { this.#ended = this.#seeking = false; }
  giveUp(error?: ErrorDetail): void {
    this.begin();
    this.#settle(error ? new ViewerError(error.id, error.message)
      : new DOMException('another character was loaded, or the viewer was removed', 'AbortError'));
  }

  #begin(): void {
    if (this.#playing) return;
    this.#playing = true;
    this.#viewer.emit('play');
  }
  #seek(to: { time?: number; frame?: number }): void {
    const { connected, element } = this.#viewer;
    this.#seeking = true;
    this.#ended = false;
    this.#viewer.report('seeking');
    if (!connected || !valueOf(element, 'src')) this.#sought = to; // no source yet
  }
  #settle(reason: Error): void {
    this.#played?.reject(reason);
    this.#played = null;
  }
  // Loop mode: -1 as stored with the sequence, 0 never, 1 always.
  get #loopMode(): number {
    const { element } = this.#viewer;
    return element.hasAttribute('loop') ? Number(valueOf(element, 'loop')) : -1;
  }
}
