// SPDX-License-Identifier: Apache-2.0
// Predicts the times at which feet come down from the phase of a class of motions. Its speed is measured, since the visitor may change
// it at any time. Part of fourdvt-more.js.
const JUMP = 0.2; // of the phase between two turns: a seek
const BACK_S = 0.1; // by which a clock may be corrected
const MEASURED_S = 0.1; // over which the speed is measured, at least
const SMOOTHING = 2;

interface At {
  phase: number; // going on over loops' ends
  s: number;
}

export class StepSchedule {
  readonly #steps: readonly number[];
  #last: At | null = null;
  #since: At | null = null; // where the speed is measured from
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
    if (!last || !(ahead > -JUMP && ahead < JUMP) || nowS < last.s - BACK_S) {
      this.#last = this.#since = { phase, s: nowS };
      this.#perS = 0;
      this.#scheduled = phase;
      return [];
    }
    const now = last.phase + ahead, since = this.#since!;
    this.#last = { phase: now, s: nowS };
    if (nowS - since.s >= MEASURED_S) {
      const perS = Math.max(0, (now - since.phase) / (nowS - since.s));
      this.#perS = this.#perS ? this.#perS + (perS - this.#perS) / SMOOTHING : perS;
      this.#since = this.#last;
    }
    if (!(this.#perS > 0)) return [];
    const until = Math.min(now + 1, now + this.#perS * aheadS), times: number[] = [];
    for (let pass = Math.floor(this.#scheduled); pass <= until && (loops || pass === 0); ++pass) {
      for (const step of this.#steps) {
        const at = pass + step;
        if (at > this.#scheduled && at <= until) times.push(nowS + (at - now) / this.#perS);
      }
    }
    this.#scheduled = Math.max(this.#scheduled, until);
    return times.sort((a, b) => a - b);
  }
}
