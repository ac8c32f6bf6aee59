// SPDX-License-Identifier: Apache-2.0
// When a foot comes down next, from the phase that a class of motions is at: its speed follows from the phases before, as the visitor
// may change it at any time. Part of fourdvt-more.js.
const JUMP = 0.2; // of the phase between two turns: a seek
const SMOOTHING = 4; // turns

export class StepSchedule {
  readonly #steps: readonly number[];
  #last: { phase: number; atS: number } | null = null; // the phase goes on over loops' ends
  #perS = 0; // phases a second
  #scheduled = 0; // phase up to which steps were given

  /** steps: phases in 0..1. */
  constructor(steps: readonly number[]) {
    this.#steps = steps;
  }

  /** Times at which feet come down within `aheadS` of `nowS`, each given once. phase: at `nowS`, in 0..1. */
  due(phase: number, nowS: number, aheadS: number, loops: boolean): number[] {
    const last = this.#last;
    const ahead = last ? phase - last.phase + (loops ? Math.round(last.phase - phase) : 0) : NaN;
    if (!last || !(ahead >= 0 && ahead < JUMP) || !(nowS > last.atS)) {
      if (last && nowS <= last.atS) return [];
      this.#last = { phase, atS: nowS };
      this.#perS = 0;
      this.#scheduled = phase;
      return [];
    }
    const perS = ahead / (nowS - last.atS), now = last.phase + ahead;
    this.#perS = this.#perS ? this.#perS + (perS - this.#perS) / SMOOTHING : perS;
    this.#last = { phase: now, atS: nowS };
    const until = now + this.#perS * aheadS, times: number[] = [];
    for (let pass = Math.floor(this.#scheduled); pass <= until && this.#perS > 0 && (loops || pass === 0); ++pass) {
      for (const step of this.#steps) {
        const at = pass + step;
        if (at > this.#scheduled && at <= until) times.push(nowS + (at - now) / this.#perS);
      }
    }
    this.#scheduled = Math.max(this.#scheduled, until);
    return times.sort((a, b) => a - b);
  }
}
