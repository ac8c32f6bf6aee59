// SPDX-License-Identifier: Apache-2.0
// Allocates a page's memory and decoders to its viewers by priority: viewers on screen first; viewers far away are freed.

/** auto: loads near the screen; lazy: loads on screen; eager: loads at once. */
export type LoadingMode = 'auto' | 'lazy' | 'eager';

/** Place and state of a viewer. */
export interface Priority {
  readonly mode: LoadingMode;
  /** Distance from the edge of the screen, in screen heights or widths; 0: at least partly on screen. */
  readonly distance: number;
  /** Area on the screen, CSS pixels. */
  readonly area: number;
  /** True if the viewer shows a picture of its present source, or no picture will come. */
  readonly shown: boolean;
  /** Time of the visitor's last input on the viewer, ms; -Infinity: none. */
  readonly touchedMs: number;
}

/** load: the viewer may hold a character. run: it may decode; otherwise its picture stands still. */
export interface Reservation {
  load: boolean;
  run: boolean;
}

export interface Limits {
  /** Maximum number of viewers that hold a character. */
  loaded: number;
  /** Maximum number of viewers that decode. */
  running: number;
}

const NEAR = { auto: 1, lazy: 0, eager: Infinity }; // maximum distance at which a viewer loads
const KEPT = 2; // a loaded viewer is kept this much further away
const RECENT_MS = 3000; // period after an input in which a viewer has priority
const FULL_BYTES = 15_000_000; // minimum counted per viewer, GPU and heap: one that has just begun holds little yet

/**
 * Computes limits from memory in use. used: bytes of the `loaded` viewers that hold a character. least: minimum counted
 * per viewer; the mean when the page was last over budget, so that a large character is not freed and loaded in turn.
 */
export function limitsOf(bytes: number, decoders: number, used: number, loaded: number, least = FULL_BYTES): Limits {
  const each = Math.max(used / (loaded || 1), least);
  return { loaded: Math.max(1, Math.floor(bytes / each)), running: decoders };
}

/** Returns the viewers' reservations, in the order of `priorities`. had: their present ones, kept longer (hysteresis). */
export function allocate(priorities: readonly Priority[], had: readonly Reservation[], { loaded, running }: Limits, nowMs: number): Reservation[] {
  const reservations = priorities.map(() => ({ load: false, run: false }));
  const order = (less: (a: Priority, b: Priority) => number): number[] => priorities.map((_, i) => i).sort((a, b) => less(priorities[a]!, priorities[b]!));
  const busy = priorities.some(({ distance, shown }) => distance === 0 && !shown); // a viewer on screen has no picture yet: viewers off screen wait
  const mayLoad = ({ mode, distance }: Priority, holds: boolean): boolean =>
    distance <= NEAR[mode] + (holds ? KEPT : 0) && (holds || !busy || distance === 0 || mode === 'eager');
  for (const i of order((a, b) => a.distance - b.distance || b.area - a.area)) {
    if (loaded > 0 && mayLoad(priorities[i]!, had[i]?.load ?? false)) {
      reservations[i]!.load = true;
      --loaded;
    }
  }
  // Order: viewers on screen first; then those without a picture; then by the latest recent input; then by visible area.
  const touched = ({ touchedMs }: Priority): number => (nowMs - touchedMs < RECENT_MS ? touchedMs : 0);
  for (const i of order((a, b) => Number(a.distance > 0) - Number(b.distance > 0) || Number(a.shown) - Number(b.shown) ||
                                  touched(b) - touched(a) || b.area - a.area)) {
    if (running > 0 && reservations[i]!.load) {
      reservations[i]!.run = true;
      --running;
    }
  }
  return reservations;
}

/** A viewer that shares the budget. */
export interface Member {
  priority(): Priority;
  /** Called when the viewer's reservation has changed. */
  reserved(reservation: Reservation): void;
}

/** Limits and state of the page. */
export interface BudgetPage {
  /** Bytes on the GPU and in the player's memory, of all viewers. */
  usedBytes(): number;
  bytes: number;
  decoders: number;
  now(): number;
  later(run: () => void): void;
}

export class PageBudget {
  readonly #members = new Map<Member, Reservation>();
  readonly #page: BudgetPage;
  #due = false;
  #least: number | undefined;

  constructor(page: BudgetPage) {
    this.#page = page;
  }

  add(member: Member): void {
    this.#members.set(member, { load: false, run: false });
    this.review();
  }
  remove(member: Member): void {
    if (this.#members.delete(member)) this.review();
  }
  /** Schedules a new allocation, before the page's next turn. */
  review(): void {
    if (this.#due) return;
    this.#due = true;
    this.#page.later(() => {
      this.#due = false;
      this.#share();
    });
  }

  #share(): void {
    const members = [...this.#members.keys()], had = [...this.#members.values()], page = this.#page;
    const used = page.usedBytes(), loaded = had.filter(({ load }) => load).length;
    if (used > page.bytes) this.#least = used / loaded;
    const budget = limitsOf(page.bytes, page.decoders, used, loaded, this.#least);
    const reservations = allocate(members.map((member) => member.priority()), had, budget, page.now());
    const changed = members.filter((member, i) => {
      const before = had[i]!, reservation = reservations[i]!;
      this.#members.set(member, reservation);
      return before.load !== reservation.load || before.run !== reservation.run;
    });
    // Frees first: the others may need the memory.
    const isFreed = (member: Member): boolean => !this.#members.get(member)?.load;
    for (const member of [...changed.filter(isFreed), ...changed.filter((member) => !isFreed(member))]) {
      const reservation = this.#members.get(member);
      if (reservation) member.reserved(reservation);
    }
  }
}
