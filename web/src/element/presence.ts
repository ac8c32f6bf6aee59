// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: where it is on the page, and what it may have there: `loading`, and the page's ledger. What is far
// from the screen is freed, what is not on it stands still.
import { viewOf } from '../page/documents.js';
import { Ledger, type Claim, type Grant, type LoadingMode, type Member } from './ledger.js';
import { Stage } from '../session/stage.js';
import { holds, onAttribute, onConnected, onEvent, onGranted, onLeft, parts, touched, updateActive, type Constructor, type ViewerBase } from './base.js';

const PHONE = '(hover: none) and (pointer: coarse)';
const PHONE_BYTES = 160e6, DESKTOP_BYTES = 400e6;
const PHONE_DECODERS = 4, DESKTOP_DECODERS = 12;
const MARGINS = ['0px', '100%', '200%', '300%']; // of the screen; crossing one makes the ledger share out anew
const STEPS = [0, 0.25, 0.5, 0.75, 1];

export interface Presence {
  /** 'auto': loads when it is near the screen, 'lazy': when it is on it, 'eager': at once, and is never freed. */
  loading: LoadingMode;
}

interface Watched extends Element {
  [seen](entry: IntersectionObserverEntry | null): void;
}
const seen: unique symbol = Symbol();

let ledger: Ledger | null = null;
const observers = new WeakMap<typeof globalThis, IntersectionObserver[]>();

// Makes the ledger for the first viewer; also those that were moved into other documents share it.
function ofPage(): Ledger {
  if (ledger) return ledger;
  const { deviceMemory = 8 } = navigator as { deviceMemory?: number }, phone = matchMedia(PHONE).matches;
  return (ledger = new Ledger({
    usedBytes: () => Stage.usedBytes(),
    bytes: phone || deviceMemory <= 4 ? PHONE_BYTES : DESKTOP_BYTES,
    decoders: phone ? PHONE_DECODERS : DESKTOP_DECODERS,
    now: () => performance.now(),
    later: (run) => queueMicrotask(run),
  }));
}
// Makes the observers for a window's first viewer.
function observersOf(view: typeof globalThis): IntersectionObserver[] {
  let all = observers.get(view);
  if (!all) {
    observers.set(view, (all = MARGINS.map((rootMargin, i) => new view.IntersectionObserver((entries) => {
      for (const entry of entries) (entry.target as Watched)[seen](i ? null : entry);
    }, { rootMargin, threshold: i ? 0 : STEPS }))));
  }
  return all;
}

export function withPresence<T extends Constructor<ViewerBase>>(Base: T): T & Constructor<Presence> {
  return class extends Base implements Presence, Member {
    static override get observedAttributes(): readonly string[] { return [...super.observedAttributes, 'loading']; }

    #grant: Grant = { load: false, run: false };
    #seen: IntersectionObserverEntry | null = null;
    #left = new AbortController(); // the document

    get loading(): LoadingMode {
      const mode = this.getAttribute('loading');
      return mode === 'lazy' || mode === 'eager' ? mode : 'auto';
    }
    set loading(mode: LoadingMode) { this.setAttribute('loading', mode); }

    override [onConnected](): void {
      super[onConnected]();
      const { signal } = (this.#left = new AbortController());
      for (const observer of observersOf(viewOf(this))) {
        observer.observe(this);
        signal.addEventListener('abort', () => observer.unobserve(this));
      }
      this.ownerDocument.addEventListener('visibilitychange', () => this[updateActive](), { signal });
      ++Stage.viewers;
      ofPage().add(this);
    }
    override [onLeft](): void {
      this.#left.abort();
      this.#seen = null;
      this.#grant = { load: false, run: false };
      --Stage.viewers;
      ofPage().remove(this);
      super[onLeft]();
    }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      if (name === 'loading') this[updateActive]();
    }

    override [onEvent](name: string, detail: unknown): void {
      super[onEvent](name, detail);
      if (/error|progress/.test(name)) this[updateActive](); // others may run now; or it holds more than it did
    }
    override [touched](): void {
      super[touched]();
      if (!this.#grant.run) this[updateActive]();
    }

    [seen](entry: IntersectionObserverEntry | null): void {
      if (entry) this.#seen = entry;
      this[updateActive]();
    }

    claim(): Claim {
      const { session } = this[parts], shown = session ? session.ended || session.drawing.shown : !this.hasAttribute('src');
      const { left, right, top, bottom, width, height } = this.getBoundingClientRect(), { innerWidth, innerHeight } = viewOf(this);
      const across = Math.max(0, left - innerWidth, -right) / innerWidth, down = Math.max(0, top - innerHeight, -bottom) / innerHeight;
      const { width: w, height: h } = this.#seen?.intersectionRect ?? { width, height };
      // Styles may show at any time what they hide; what a scroller clips is near.
      const distance = this[holds]() ? Infinity : width * height === 0 ? 1 : Math.max(across, down, this.#onScreen ? 0 : 0.01);
      return { mode: this.loading, distance, area: w * h, shown, touchedMs: this[parts].touchedMs };
    }
    granted(grant: Grant): void {
      const { load } = this.#grant;
      this.#grant = grant;
      if (load !== grant.load) this[onGranted](grant.load);
      this[updateActive]();
    }

    get #onScreen(): boolean { return this.#seen?.isIntersecting ?? true; }

    override [updateActive](): void {
      const { session } = this[parts], decodes = this.#grant.run && !this.ownerDocument.hidden;
      if (this[parts].connected) ofPage().review();
      session?.setActive(decodes && (this.#onScreen || !session.drawing.shown), decodes, this.#onScreen);
    }
  };
}
