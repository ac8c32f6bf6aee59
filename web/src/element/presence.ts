// SPDX-License-Identifier: Apache-2.0
// Feature: the viewer's place on the page, the attribute `loading`, and its share of the page's budget. A viewer far from
// the screen is freed; one off screen stands still.
import { viewOf } from '../page/documents.js';
import { Stage } from '../session/stage.js';
import { PageBudget, type Priority, type Reservation, type Member } from './budget.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

const PHONE = '(hover: none) and (pointer: coarse)';
const PHONE_BYTES = 160e6, DESKTOP_BYTES = 400e6;
const PHONE_DECODERS = 4, DESKTOP_DECODERS = 12;
const MARGINS = ['0px', '100%', '200%', '300%']; // around the screen; crossing one triggers a new allocation
const STEPS = [0, 0.25, 0.5, 0.75, 1];

let budget: PageBudget | null = null;
const observers = new WeakMap<typeof globalThis, IntersectionObserver[]>();
const observed = new WeakMap<Element, Presence>();

// Returns the page's budget, created for the first viewer; viewers moved into other documents share it.
function ofPage(): PageBudget {
  if (budget) return budget;
  const { deviceMemory = 8 } = navigator as { deviceMemory?: number }, phone = matchMedia(PHONE).matches;
  return (budget = new PageBudget({
    usedBytes: () => Stage.usedBytes(),
    bytes: phone || deviceMemory <= 4 ? PHONE_BYTES : DESKTOP_BYTES,
    decoders: phone ? PHONE_DECODERS : DESKTOP_DECODERS,
    now: () => performance.now(),
    later: (run) => queueMicrotask(run),
  }));
}
// Returns the window's observers, created for its first viewer.
function observersOf(view: typeof globalThis): IntersectionObserver[] {
  let all = observers.get(view);
  if (!all) {
    observers.set(view, (all = MARGINS.map((rootMargin, i) => new view.IntersectionObserver((entries) => {
      for (const entry of entries) observed.get(entry.target)?.onSeen(i ? null : entry);
    }, { rootMargin, threshold: i ? 0 : STEPS }))));
  }
  return all;
}

/** Members of Loading that this file uses. */
export interface Loader {
  /** True while the viewer must not load, by preload="none". */
  readonly waits: boolean;
  /** Allows the viewer to hold a character, or frees it. */
  allow(load: boolean): void;
}

export class Presence implements Feature, Member {
  readonly #viewer: Viewer;
  readonly #loader: Loader;
  #reservation: Reservation = { load: false, run: false };
  #seen: IntersectionObserverEntry | null = null;
  #left = new AbortController(); // aborted when the viewer leaves its document

  constructor(viewer: Viewer, loader: Loader) {
    this.#viewer = viewer;
    this.#loader = loader;
    observed.set(viewer.element, this);
  }

  connect(): void {
    const { element } = this.#viewer, { signal } = (this.#left = new AbortController());
    for (const observer of observersOf(viewOf(element))) {
      observer.observe(element);
      signal.addEventListener('abort', () => observer.unobserve(element));
    }
    element.ownerDocument.addEventListener('visibilitychange', () => this.review(), { signal });
    ++Stage.viewers;
    ofPage().add(this);
  }
  disconnect(): void {
    this.#left.abort();
    this.#seen = null;
    this.#reservation = { load: false, run: false };
    --Stage.viewers;
    ofPage().remove(this);
  }
  update(name: string): void { if (name === 'loading') this.review(); }
  // Allocates again after an error, which frees a decoder, and at progress, which uses memory.
  handle(event: string): void { if (/error|progress/.test(event)) this.review(); }
  touch(): void { if (!this.#reservation.run) this.review(); }
  /** Called when the viewer crosses a margin of the screen. entry: its visible part; null: unchanged. */
  onSeen(entry: IntersectionObserverEntry | null): void {
    if (entry) this.#seen = entry;
    this.review();
  }

  priority(): Priority {
    const { element, session, touchedMs } = this.#viewer, shown = session ? session.ended || session.drawing.shown : !element.hasAttribute('src');
    const { left, right, top, bottom, width, height } = element.getBoundingClientRect(), { innerWidth, innerHeight } = viewOf(element);
    const across = Math.max(0, left - innerWidth, -right) / innerWidth, down = Math.max(0, top - innerHeight, -bottom) / innerHeight;
    const { width: w, height: h } = this.#seen?.intersectionRect ?? { width, height };
    // A viewer without area may be shown at any time and counts as near, as does one clipped by a scroller.
    const distance = this.#loader.waits ? Infinity : width * height === 0 ? 1 : Math.max(across, down, this.#onScreen ? 0 : 0.01);
    return { mode: valueOf(element, 'loading'), distance, area: w * h, shown, touchedMs };
  }
  reserved(reservation: Reservation): void {
    const { load } = this.#reservation;
    this.#reservation = reservation;
    if (load !== reservation.load) this.#loader.allow(reservation.load);
    this.review();
  }

  get #onScreen(): boolean { return this.#seen?.isIntersecting ?? true; }

  /** Starts or stops the session by its reservation and visibility, and schedules a new allocation. */
  review(): void {
    const { element, session, connected } = this.#viewer, decodes = this.#reservation.run && !element.ownerDocument.hidden;
    if (connected) ofPage().review();
    session?.setActive(decodes && (this.#onScreen || !session.drawing.shown), decodes, this.#onScreen);
  }
}
