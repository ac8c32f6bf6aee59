// SPDX-License-Identifier: Apache-2.0
// Loads the second part of the player in a session, after the first picture or on demand, and calls its functions: effects,
// companions, live streams, renewal by another bake, advice, choice of the upload path. A failed load is retried at the
// next use.
import type { LiveStream } from '../live/live.js';
import type { SessionSide, SideActor } from '../more/session-side.js';
import { isOn } from '../page/attributes.js';
import { deferred } from '../page/promises.js';
import { loadMore, type More } from '../player/wasm-module.js';
import type { Align } from '../player/wasm-player.js';
import { mayBeOfTwoBakes, type ErrorDetail } from '../report/errors.js';
import type { Companion } from './companion.js';
import type { Display } from './session-host.js';

export const needsFlow = (align: string): boolean => align.startsWith('flow');

// "Rest": load of the second part. Waits for this many pictures of motion, at most this long, so as not to compete with
// them for network and processor.
const MOVED_PICTURES = 10, LONGEST_REST_MS = 1500;

type Effect = 'useFlow' | 'useLook' | 'useRoom';

/** Members of the session that this file uses. */
export interface LaterSession extends SessionSide {
  readonly host: SessionSide['host'] & { readonly companions: Iterable<Companion>; readonly overlay: Pick<Display, 'incomplete'>; more(more: More): void };
  readonly ended: boolean;
  room: boolean;
  fresh: boolean;
}

export class Later {
  readonly #session: LaterSession;
  readonly #attempts = new Map<Effect, object>(); // latest attempt of each effect
  #companions: InstanceType<More['Companions']> | null = null;
  #looked = false; // a look has been applied
  #unproven = false; // a renewed bake has not been able to play yet
  #held: ErrorDetail[] | null = null; // errors that wait for the result of #renew
  readonly #rest = deferred(); // resolves once the rest is loaded or has failed
  #measures = false;
  #picturesLeft = 0; // pictures left before the rest is loaded; 0: not waiting
  #restTimer = 0;
  #missing = ''; // message of the last error event about the second part
  /** Exports of fourdvt-more.js; null until loaded. */
  loaded: More | null = null;

  constructor(session: LaterSession) {
    this.#session = session;
  }

  async more(): Promise<More> {
    const session = this.#session;
    this.loaded = await loadMore(session.module, session.options.files, session.network);
    this.#companions ??= new this.loaded.Companions(session);
    this.#missing = '';
    session.host.more(this.loaded);
    return this.loaded;
  }

  // --- the session's life ---

  onOpen(): void {
    this.#apply('useRoom');
    this.useLook();
  }
  firstPicture(): void {
    if (needsFlow(this.#session.align)) this.#apply('useFlow');
  }
  /** Called when the character can play: loads the rest at once if it is paused, else after some motion. measures: also
   * measures the upload path. */
  onCanPlay(measures: boolean): void {
    this.#unproven = false;
    this.#measures = measures;
    const { commands, element } = this.#session.host;
    if (this.loaded || !commands.settings.playing || isOn(element, 'motion-controls')) { // the rest has the keys that steer
      this.#loadRest();
    } else {
      this.#picturesLeft = MOVED_PICTURES;
      this.#restTimer = setTimeout(() => this.#loadRest(), LONGEST_REST_MS);
    }
    for (const companion of this.#session.host.companions) this.add(companion);
  }
  /** Called for each further drawn picture. */
  onPicture(): void { if (this.#picturesLeft && --this.#picturesLeft === 0) this.#loadRest(); }
  onClose(): void {
    this.#forgetWait();
    this.#companions?.clear();
  }
  /** Resolves when the rest is loaded, as transitions require, or has failed. */
  rest(): Promise<void> { return this.#rest.promise; }
  #forgetWait(): void {
    clearTimeout(this.#restTimer);
    this.#picturesLeft = 0;
  }

  // Loads the second part and completes the session. After a failure the character plays on; an error that an effect has
  // reported already is not dispatched again.
  #loadRest(): void {
    const session = this.#session;
    this.#forgetWait();
    void this.more().then(({ complete }) => complete(session, this.others, this.#measures), (reason: unknown) => {
      if (session.errorOf(reason).message !== this.#missing) this.#miss(reason);
    }).then(this.#rest.resolve);
  }
  #miss(reason: unknown): void {
    const { host, ended } = this.#session, error = this.#session.errorOf(reason);
    if (ended) return;
    this.#missing = error.message;
    host.overlay.incomplete(error);
    host.emit('error', error);
  }

  // --- effects ---

  get hasLook(): boolean { return this.#session.host.element.matches('[look]:not([look=""],[look=none]),[method=montage4d]'); }

  /** Sets the alignment. Optical flow applies once its module is loaded; a failed load is an error event. */
  setAlign(align: Align): void {
    const session = this.#session;
    session.align = align;
    session.drawing.programsMissing = true;
    if (!needsFlow(align)) session.host.commands.set('align', align);
    else if (session.drawing.shown) this.#apply('useFlow'); // otherwise firstPicture() loads it
  }
  /** Shows or hides the room. It appears once its picture is loaded; a failed load is an error event. */
  setRoom(on: boolean): void {
    this.#session.room = on;
    this.#session.main?.player?.hideRoom();
    this.#apply('useRoom');
  }
  /** Applies the element's look once it is loaded; a failed load is an error event. */
  useLook(): void {
    if (this.#looked || this.hasLook) this.#apply('useLook'); // without any look there is nothing to undo
  }

  // Starts an effect; a later attempt of the same effect replaces it.
  #apply(name: Effect): void {
    const session = this.#session, attempt = {};
    this.#attempts.set(name, attempt);
    const isCurrent = (): boolean => this.#attempts.get(name) === attempt && !session.ended;
    if (!session.main || (name === 'useRoom' && !session.room)) return;
    this.more().then<unknown>((more) => isCurrent() && more[name](session, isCurrent)).then((done) => {
      if (name === 'useLook' && done) this.#looked = true;
    }, (reason: unknown) => {
      if (!isCurrent()) return;
      if (name === 'useFlow') session.align = session.host.commands.settings.align;
      this.#miss(reason);
    });
  }

  // --- other characters in the same canvas ---

  get others(): readonly SideActor[] { return this.#companions?.actors ?? []; }

  /** Adds a companion. Without a main character does nothing: onCanPlay() adds all companions. */
  add(companion: Companion): void {
    const session = this.#session;
    if (!session.main) return;
    this.more().then(() => this.#companions!.add(companion), (reason: unknown) => {
      if (!session.ended && !companion.left.aborted) companion.emit('error', session.errorOf(reason));
    });
  }
  remove(companion: Companion): void {
    this.#companions?.remove(companion);
    this.#session.wake();
  }
  setPlaying(playing: boolean): void {
    this.#companions?.setPlaying(playing);
    if (!playing && this.#picturesLeft) this.#loadRest();
  }

  // --- another source for the same session ---

  /** Creates the live stream of src. */
  async connect(): Promise<LiveStream> {
    const { connectLive } = await this.more();
    return connectLive(this.#session);
  }

  /** Returns true if the error is held back while a new bake is looked for; without one it is dispatched. */
  renews(error: ErrorDetail): boolean {
    if (!this.#session.main || !mayBeOfTwoBakes(error) || (!this.#held && this.#unproven)) return false;
    if (this.#held) this.#held.push(error);
    else void this.#renew((this.#held = [error]));
    return true;
  }
  async #renew(errors: ErrorDetail[]): Promise<void> {
    const session = this.#session;
    const bake = await this.more().then(({ renew }) => renew(session, errors)).catch(() => null);
    this.#held = null;
    if (session.ended || !session.main) return bake?.transport.dispose();
    if (bake) {
      session.fresh = this.#unproven = true;
      session.reopen(session.path, bake);
    } else {
      for (const detail of errors) session.host.emit('error', detail);
    }
  }
}
