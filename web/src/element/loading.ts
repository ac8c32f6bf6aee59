// SPDX-License-Identifier: Apache-2.0
// Feature: source, poster, loading, errors, and loss of the GL context.
import type { UploadChoice } from '../decode/upload-path.js';
import type { SignAddress } from '../net/transport.js';
import { asViewerError, characterAddress, withCode, type ErrorDetail, type MediaFault } from '../report/errors.js';
import { stallOf } from '../report/watchdog.js';
import type { SessionHost } from '../session/session-host.js';
import { Session } from '../session/session.js';
import { filesOf } from '../wasm/files.js';
import { Presence, type Loader } from './presence.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

// Minimum total of the progress bar: before the stream's index has come, the total is too small.
const MIN_TOTAL_BYTES = 300_000;
const CONTEXT_PATIENCE_MS = 5000; // timeout; browsers that restore a GL context do so within a second

export class Loading implements Feature, Loader {
  /** Decides by the viewer's place on the page when the character may be loaded. */
  readonly presence: Presence;
  /** Returns the address to fetch a file from; null: the file's own address. */
  sign: SignAddress | null = null;
  readonly #viewer: Viewer;
  /** Host of the viewer's sessions. */
  readonly host: SessionHost;
  #error: MediaFault | null = null;
  #address = '';
  #base = ''; // base URL of src, kept over a move into another document
  #used = false; // this source has been touched or played: ends preload="none"
  #allowed = false;
  #due: { fresh: boolean } | null = null; // pending load, until the page allows it
  #loading = false;
  #loaded: string | null = null; // src of the present source, or of the last one before the element left the page
  #contextTimer = 0;
  #attempt: object | null = null; // identity of the latest attempt to load
  #lost: object | null = null; // ended session whose GL context may be restored

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    this.presence = new Presence(viewer, this);
    this.host = this.#makeHost();
    viewer.overlay.onRetry = () => this.#request(true, true);
  }

  get currentSrc(): string { return this.#address; }
  get error(): MediaFault | null { return this.#error; }
  load(): void { if (this.#viewer.connected) this.#request(); }

  connect(): void {
    const back = !this.#viewer.changedOutside && this.#loaded !== null && this.#loaded === this.#src;
    if (!back) this.#viewer.call('reset');
    this.#request(back);
  }
  disconnect(): void {
    this.#unload();
    this.#due = null;
    this.#allowed = false;
  }
  allow(load: boolean): void {
    this.#allowed = load;
    if (load) this.#begin();
    else if (this.#viewer.session) this.#free();
  }
  touch(): void {
    this.#used = true;
    this.#begin();
  }
  update(name: string, changed: boolean): void {
    if (name === 'src') this.#request(); // also for the same src, as a retry
    else if (name === 'preload') this.#begin();
    else if (name === 'poster' && changed) this.#viewer.overlay.setPoster(this.#viewer.element.getAttribute('poster'));
  }

  get #src(): string { return valueOf(this.#viewer.element, 'src'); }
  /** True if no picture will come before the next command or source. */
  get standsStill(): boolean {
    const { session, state } = this.#viewer;
    return (session?.ended ?? true) || (state?.failed ?? false);
  }

  // Loads the source once the page allows it. on: continues at the present frame and state. fresh: bypasses the browser's
  // cache, which may hold incomplete files.
  #request(on = false, fresh = false): void {
    const { overlay, commands, companions, session } = this.#viewer;
    this.#unload();
    const attempt = (this.#attempt = {}), aborted = session && this.#loading, emptied = this.#address && !on;
    this.#error = this.#due = null;
    this.#used &&= on;
    this.#loading = false;
    this.#address = '';
    if (aborted) this.#viewer.emit('abort');
    if (emptied && attempt === this.#attempt) this.#viewer.emit('emptied');
    if (attempt !== this.#attempt) return; // a listener has loaded another source
    this.#loaded = this.#src || null;
    overlay.idle();
    if (!this.#src) return;
    overlay.setPoster(valueOf(this.#viewer.element, 'poster') || null);
    if (!on) {
      this.#base = this.#viewer.element.baseURI;
      commands.begin(Object.assign({}, ...this.#viewer.call('settings')));
      if (attempt !== this.#attempt) return;
      for (const { src, commands: its } of companions) if (src === null) its.begin();
    }
    overlay.offerPlay(!commands.settings.playing);
    this.#due = { fresh };
    this.#begin();
  }
  get waits(): boolean {
    const { element, commands, session } = this.#viewer;
    return valueOf(element, 'preload') === 'none' && !this.#used && !commands.settings.playing && !session;
  }
  #begin(): void {
    const { overlay, commands } = this.#viewer, due = this.#due;
    if (!due || this.waits) return;
    if (!this.#allowed) return this.presence.review();
    this.#due = null;
    this.#loading = true;
    overlay.loading();
    overlay.offerPlay(!commands.settings.playing);
    this.#viewer.emit('loadstart');
    this.#startSession(due.fresh);
  }
  // Ends the session to free memory; keeps a copy of the picture, and the state for a later session.
  #free(): void {
    const { overlay, session } = this.#viewer;
    session!.drawing.redraw();
    overlay.keepPicture();
    this.#viewer.session = null;
    session!.dispose();
    overlay.offerPlay(!this.#viewer.commands.settings.playing);
    this.#due = { fresh: false };
    this.#viewer.emit('suspend');
  }

  #startSession(fresh = false): void {
    const attempt = (this.#attempt = {});
    let src: string;
    try {
      src = this.#address = characterAddress(this.#src, this.#base);
    } catch (reason) {
      // Asynchronously: a page may add its listener after setting src.
      return queueMicrotask(() => { if (attempt === this.#attempt) this.#viewer.report('error', asViewerError(reason).detail); });
    }
    const { element, size, statics: { wasmUrl, opencvUrl } } = this.#viewer;
    const session = (this.#viewer.session = new Session({
      src, fresh, signer: this,
      files: filesOf(wasmUrl, opencvUrl, document.baseURI),
      uploadPath: valueOf(element, 'upload-path') as UploadChoice,
      align: valueOf(element, 'align'),
      room: valueOf(element, 'background') === 'room',
      credentials: valueOf(element, 'crossorigin') === 'use-credentials' ? 'include' : 'same-origin',
    }, this.host));
    this.#viewer.call('begin');
    session.resize(size.width, size.height);
    this.presence.review();
    void session.start();
  }

  #unload(): void {
    const { session, overlay } = this.#viewer;
    clearTimeout(this.#contextTimer);
    this.#viewer.session = this.#attempt = this.#lost = null;
    session?.dispose();
    overlay.dropCanvas();
    this.#viewer.call('giveUp');
  }

  #makeHost(): SessionHost {
    const viewer = this.#viewer, { element, overlay, camera, commands, companions } = viewer;
    return {
      element, overlay, camera, commands, companions,
      animate: (stepS) => viewer.frame(stepS),
      emit: (name, detail) => viewer.report(name, detail),
      firstPicture: () => {
        overlay.ready(valueOf(element, 'reveal') !== 'manual');
        this.presence.review(); // lets the page give the decoder's priority to others
        viewer.report('loadeddata');
      },
      picture: () => {
        overlay.uncover();
        viewer.call('picture');
      },
      network: (waiting) => {
        overlay.note(waiting);
        if (waiting) viewer.emit('stalled');
      },
      stalled: (step) => {
        overlay.noteStep(step);
        if (step) viewer.emit('stalled', stallOf(step));
      },
      more: (more) => {
        overlay.complete();
        viewer.call('more', more);
      },
      lost: (session) => this.#onLost(session),
      restored: (session) => this.#onRestored(session),
      trapped: (session) => { if (viewer.session === session) this.#restart(); },
    };
  }

  #onLost(session: object): void {
    if (this.#viewer.session !== session) return;
    this.#lost = session;
    this.#viewer.session = null;
    this.#viewer.emit('waiting');
    this.#awaitContext();
  }
  #onRestored(session: object): boolean {
    if (this.#lost !== session) return false;
    this.#lost = null;
    clearTimeout(this.#contextTimer);
    this.#restart();
    return true;
  }
  #restart(): void {
    this.forgetError();
    if (this.#allowed) this.#startSession();
    else this.#due = { fresh: false };
  }
  // Reports the loss after a timeout, which starts again while the page is hidden: browsers may restore the context once
  // it is shown.
  #awaitContext(): void {
    this.#contextTimer = setTimeout(() => {
      if (document.hidden) this.#awaitContext();
      else this.#viewer.report('error', { id: 'gpu-failure', message: 'the GPU context is lost; try again, or reload the page' });
    }, CONTEXT_PATIENCE_MS);
  }

  handle(name: string, detail: unknown): void {
    const { overlay } = this.#viewer;
    if (name === 'progress') {
      const { loaded, total } = detail as { loaded: number; total: number };
      if (this.#loading) overlay.progress(Math.min(1, loaded / Math.max(total, MIN_TOTAL_BYTES)));
    } else if (name === 'loadedmetadata') {
      void this.#showOwnPoster();
    } else if (name === 'error') {
      this.#onError(detail as ErrorDetail);
    } else if (['canplay', 'playing', 'seeked', 'sequencechange'].includes(name)) {
      if (name === 'canplay') this.#loading = false;
      this.forgetError();
    }
  }

  // Shows the character's own poster if the page has none, unless a start file makes the first picture imminent.
  async #showOwnPoster(): Promise<void> {
    const { session, overlay, character } = this.#viewer, uri = character?.posterUri;
    if (!session || !uri || session.started || overlay.hasPoster) return;
    const url = await session.transport.address(uri).catch(() => null);
    if (url && this.#viewer.session === session && !overlay.hasPoster) overlay.setPoster(url);
  }

  // Shows the error panel if loading has failed or the picture stands still; not for a refused command, which has no
  // effect.
  #onError(error: ErrorDetail): void {
    this.#error = withCode(error);
    const over = this.#loading || (this.#viewer.session?.ended ?? true);
    this.#loading = false;
    if (!over && !this.standsStill) return;
    this.#viewer.call('giveUp', error);
    this.#viewer.overlay.fail(error, over);
  }
  /** Clears the last error and its panel. */
  forgetError(): void {
    this.#error = null;
    this.#viewer.overlay.recover();
  }
}
