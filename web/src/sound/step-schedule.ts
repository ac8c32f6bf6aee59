// SPDX-License-Identifier: Apache-2.0
// Predicts the times of footfalls from the phase of a class of motions, with measured speed, since the visitor may change
// it at any time. Part of fourdvt-more.js.
const JUMP = 0.2; // minimum change of the phase between two turns that counts as a seek
const BACK_S = 0.1; // maximum backward correction of a clock
const MEASURED_S = 0.1; // minimum time over which the speed is measured
const SMOOTHING = 2;

interface At {
  phase: number; // unrolled: increases over loops
  s: number;
}

export class StepSchedule {
  readonly #steps: readonly number[];
  #last: At | null = null;
  #since: At | null = null; // beginning of the present measurement
  #perS = 0; // speed, phases per second
  #scheduled = 0; // phase up to which steps were returned

  /** steps: phases of the footfalls, in 0..1. */
  constructor(steps: readonly number[]) {
    this.#steps = steps;
  }

  /** Returns the times of footfalls from `nowS` to `nowS` + `aheadS`, each once. phase: at `nowS`, in 0..1. */
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
