// SPDX-License-Identifier: Apache-2.0
// Detects a step that a viewer has waited for too long. Counts seconds one by one, so that a page that was suspended can
// progress before the timeout.

const PATIENCE_S = 20;

/** Steps that a picture may wait for, in their order at the start. */
export type Step = 'manifest' | 'player' | 'more' | 'files' | 'decoder' | 'upload' | 'barcode' | 'geometry' | 'display';

/** Detail of the event `stalled`. */
export interface Stall {
  step: Step;
  message: string;
}

const CAUSES: Record<Step, string> = {
  manifest: 'no manifest: its server sends nothing',
  player: 'no player: its wasm does not load, or the browser does not compile it',
  more: "no second part of the player: fourdvt-more.js or its wasm does not load, or the browser does not compile it",
  files: "nothing of the character's files: their server sends nothing",
  decoder: 'no picture from the video decoder; it is opened anew',
  upload: 'no copy of a decoded picture; the browser uploads pictures itself from now on',
  barcode: 'no answer from the GPU to what it was to read; pictures are paired by time from now on',
  geometry: 'no geometry for a decoded picture',
  display: 'no animation frame from the browser',
};

export const stallOf = (step: Step): Stall => ({ step, message: `${PATIENCE_S} s without progress: ${CAUSES[step]}; if it stays so, reload the page` });

/** Awaited step. progress: a text that changes with any progress of the step. */
export interface Awaited {
  step: Step;
  progress: string;
}

export class Watchdog {
  readonly #awaited: () => Awaited | null;
  readonly #report: (step: Step | null) => void;
  #timer: ReturnType<typeof setInterval> | undefined;
  #seen = '';
  #quietS = 0;
  #stalled = false;

  /**
   * awaited: returns null while no visible change is due. report: called with the step after each 20 s without progress,
   * and with null once it progresses.
   */
  constructor(awaited: () => Awaited | null, report: (step: Step | null) => void) {
    this.#awaited = awaited;
    this.#report = report;
  }

  /** Starts to watch; ends by itself when nothing is awaited. */
  wake(): void { this.#timer ??= setInterval(() => this.#look(), 1000); }
  stop(): void {
    clearInterval(this.#timer);
    this.#timer = undefined;
    this.#note('');
  }

  #look(): void {
    const awaited = this.#awaited();
    if (!awaited) return this.stop();
    const seen = `${awaited.step} ${awaited.progress}`;
    if (seen !== this.#seen) return this.#note(seen);
    if (++this.#quietS % PATIENCE_S) return;
    this.#stalled = true;
    this.#report(awaited.step);
  }
  #note(seen: string): void {
    this.#seen = seen;
    this.#quietS = 0;
    if (!this.#stalled) return;
    this.#stalled = false;
    this.#report(null);
  }
}
