// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: src and poster, loading and its errors, the GL context's loss.
import { asViewerError, characterAddress, withCode, type ErrorDetail, type MediaFault } from '../report/errors.js';
import { filesOf } from '../wasm/files.js';
import { Session } from '../session/session.js';
import type { SignAddress } from '../net/transport.js';
import type { UploadChoice as UploadPath } from '../decode/upload-path.js';
import {
  emit, firstWishes, holds, onArrival, onAttribute, onConnected, onEvent, onGivenUp, onGranted, onLeft, onLost, onRestored, onSession, onTrapped, parts, report, sessionOptions, touched, updateActive,
  type Constructor, type ViewerBase,
} from './base.js';

// Until the stream's index has come the total is too small; this keeps the progress bar from being full too early.
const MIN_TOTAL_BYTES = 300_000;
const CONTEXT_PATIENCE_MS = 5000; // browsers that give a GL context back do so within a second

/** Nothing will come of what is wanted. */
export const standsStill: unique symbol = Symbol();
/** The last error is over. */
export const forgetError: unique symbol = Symbol();

export interface Loading {
  src: string;
  poster: string;
  /** Address of what is loaded. */
  readonly currentSrc: string;
  readonly error: MediaFault | null;
  /** Gives each file of the characters the address that it is fetched from; called again for one that the server refuses. Null: its own. */
  sign: SignAddress | null;
  /** How decoded pictures reach the GPU; 'auto' measures what is faster. Takes effect at the next load. */
  uploadPath: UploadPath;
  /** Loads the character again, from the start. Any error before is forgotten. */
  load(): void;
  readonly [standsStill]: boolean;
  [forgetError](): void;
}

// Static properties of the element.
interface Addresses {
  readonly wasmUrl: string;
  readonly opencvUrl: string;
}

export function withLoading<T extends Constructor<ViewerBase>>(Base: T): T & Constructor<Loading> {
  return class extends Base implements Loading {
    static override get observedAttributes(): readonly string[] { return [...super.observedAttributes, 'src', 'poster', 'preload']; }

    #error: MediaFault | null = null;
    #address = '';
    #base = ''; // that src is relative to, also after a move into another document
    #sign: SignAddress | null = null;
    #asked = false; // touched or played with this source: preload="none" counts no longer
    #granted = false;
    #wanted: { fresh: boolean } | null = null; // to load, once the page lets it
    #loading = false;
    #loaded: string | null = null; // src of what is shown, or was shown when the element left the page
    #contextTimer = 0;
    #attempt: object | null = null; // to load a source; the latest
    #lost: object | null = null; // the session whose context may come back

    constructor(...args: any[]) {
      super(...args);
      this[parts].overlay.onRetry = () => this.#want(true, true);
    }

    get src(): string { return this.getAttribute('src') ?? ''; }
    set src(value: string) { this.setAttribute('src', value); }
    get poster(): string { return this.getAttribute('poster') ?? ''; }
    set poster(value: string) { this.setAttribute('poster', value); }
    get currentSrc(): string { return this.#address; }
    get error(): MediaFault | null { return this.#error; }
    get sign(): SignAddress | null { return this.#sign; }
    set sign(sign: SignAddress | null) { this.#sign = sign; }
    get uploadPath(): UploadPath { return (this.getAttribute('upload-path') ?? 'auto') as UploadPath; }
    set uploadPath(value: UploadPath) { this.setAttribute('upload-path', value); }
    load(): void { if (this[parts].connected) this.#want(); }

    override [onConnected](): void {
      const back = this.#loaded !== null && this.#loaded === this.src;
      if (!back) this[onArrival]();
      this.#want(back);
      super[onConnected]();
    }
    override [onGranted](load: boolean): void {
      super[onGranted](load);
      this.#granted = load;
      if (load) this.#begin();
      else if (this[parts].session) this.#free();
    }
    override [touched](): void {
      super[touched]();
      this.#asked = true;
      this.#begin();
    }
    override [onLeft](): void {
      this.#unload();
      this.#wanted = null;
      this.#granted = false;
      super[onLeft]();
    }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      if (!this[parts].connected) this.#loaded = null;
      else if (name === 'src') this.#want(); // the same one, too: another try
      else if (name === 'preload') this.#begin();
      else if (name === 'poster' && before !== value) this[parts].overlay.setPoster(value);
    }

    get [standsStill](): boolean {
      const { session, commands } = this[parts];
      return (session?.ended ?? true) || (commands.state()?.failed ?? false);
    }

    // Loads when the page lets it. `on`: goes on where it was. fresh: past the browser's cache, which may hold what was not whole.
    #want(on = false, fresh = false): void {
      const { overlay, commands, companions, session } = this[parts];
      this.#unload();
      const attempt = (this.#attempt = {}), aborted = session && this.#loading, emptied = this.#address && !on;
      this.#error = this.#wanted = null;
      this.#asked &&= on;
      this.#loading = false;
      this.#address = '';
      if (aborted) this[emit]('abort');
      if (emptied && attempt === this.#attempt) this[emit]('emptied');
      if (attempt !== this.#attempt) return; // a listener has loaded another source
      this.#loaded = this.src || null;
      overlay.idle();
      if (!this.src) return;
      overlay.setPoster(this.poster || null);
      if (!on) {
        this.#base = this.baseURI;
        commands.begin(this[firstWishes]());
        if (attempt !== this.#attempt) return;
        for (const { src, commands: its } of companions) if (src === null) its.begin();
      }
      overlay.offerPlay(!commands.wishes.playing);
      this.#wanted = { fresh };
      this.#begin();
    }
    override [holds](): boolean {
      return this.getAttribute('preload') === 'none' && !this.#asked && !this[parts].commands.wishes.playing && !this[parts].session;
    }
    #begin(): void {
      const { overlay, commands } = this[parts], wanted = this.#wanted;
      if (!wanted || this[holds]()) return;
      if (!this.#granted) return this[updateActive]();
      this.#wanted = null;
      this.#loading = true;
      overlay.loading();
      overlay.offerPlay(!commands.wishes.playing);
      this[emit]('loadstart');
      this.#startSession(wanted.fresh);
    }
    // Keeps the picture and the place.
    #free(): void {
      const { overlay, session } = this[parts];
      session!.drawing.redraw();
      overlay.keepPicture();
      this[parts].session = null;
      session!.dispose();
      overlay.offerPlay(!this[parts].commands.wishes.playing);
      this.#wanted = { fresh: false };
      this[emit]('suspend');
    }

    #startSession(fresh = false): void {
      const attempt = (this.#attempt = {});
      let src: string;
      try {
        src = this.#address = characterAddress(this.src, this.#base);
      } catch (reason) {
        // Not at once: whoever has just set it wants to listen first.
        return queueMicrotask(() => { if (attempt === this.#attempt) this[report]('error', asViewerError(reason).detail); });
      }
      const { size, host } = this[parts], { wasmUrl, opencvUrl } = this.constructor as unknown as Addresses;
      const session = (this[parts].session = new Session({
        src, files: filesOf(wasmUrl, opencvUrl, document.baseURI), uploadPath: this.uploadPath, align: 'baked', room: false, fresh,
        credentials: this.getAttribute('crossorigin') === 'use-credentials' ? 'include' : 'same-origin', signer: this, ...this[sessionOptions](),
      }, host));
      this[onSession]();
      session.resize(size.width, size.height);
      this[updateActive]();
      void session.start();
    }

    #unload(): void {
      const { session, overlay } = this[parts];
      clearTimeout(this.#contextTimer);
      this[parts].session = this.#attempt = this.#lost = null;
      session?.dispose();
      overlay.dropCanvas();
      this[onGivenUp]();
    }

    override [onLost](session: object): void {
      super[onLost](session);
      if (this[parts].session !== session) return;
      this.#lost = session;
      this[parts].session = null;
      this[emit]('waiting');
      this.#awaitContext();
    }
    override [onRestored](session: object): boolean {
      if (this.#lost !== session) return super[onRestored](session);
      this.#lost = null;
      clearTimeout(this.#contextTimer);
      this.#restart();
      return true;
    }
    override [onTrapped](session: object): void {
      super[onTrapped](session);
      if (this[parts].session === session) this.#restart();
    }
    #restart(): void {
      this[forgetError]();
      if (this.#granted) this.#startSession();
      else this.#wanted = { fresh: false };
    }
    // A hidden page may get its context back when it is shown again.
    #awaitContext(): void {
      this.#contextTimer = setTimeout(() => {
        if (document.hidden) this.#awaitContext();
        else this[report]('error', { id: 'gpu-failure', message: 'the browser took the GPU away and did not give it back; try again, or reload the page' });
      }, CONTEXT_PATIENCE_MS);
    }

    override [onEvent](name: string, detail: unknown): void {
      const { overlay } = this[parts];
      super[onEvent](name, detail);
      if (name === 'progress') {
        const { loaded, total } = detail as { loaded: number; total: number };
        if (this.#loading) overlay.progress(Math.min(1, loaded / Math.max(total, MIN_TOTAL_BYTES)));
      } else if (name === 'loadedmetadata') {
        void this.#showOwnPoster();
      } else if (name === 'error') {
        this.#onError(detail as ErrorDetail);
      } else if (['canplay', 'playing', 'seeked', 'sequencechange'].includes(name)) {
        if (name === 'canplay') this.#loading = false;
        this[forgetError]();
      }
    }

    // The character's own, where the page gives none and the first picture is not near.
    async #showOwnPoster(): Promise<void> {
      const { session, overlay } = this[parts], uri = session?.character?.posterUri;
      if (!uri || session.started || overlay.hasPoster) return;
      const url = await session.transport.address(uri).catch(() => null);
      if (url && this[parts].session === session && !overlay.hasPoster) overlay.setPoster(url);
    }

    // The panel is for errors that leave nothing to look at, or the wanted motion standing still; a command that was
    // refused changes nothing.
    #onError(error: ErrorDetail): void {
      this.#error = withCode(error);
      const over = this.#loading || (this[parts].session?.ended ?? true);
      this.#loading = false;
      if (!over && !this[standsStill]) return;
      this[onGivenUp](error);
      this[parts].overlay.fail(error, over);
    }
    [forgetError](): void {
      this.#error = null;
      this[parts].overlay.recover();
    }
  };
}
