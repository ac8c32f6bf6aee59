// SPDX-License-Identifier: Apache-2.0
// Calls back once per animation frame while something changes and the element is on screen.

const SLOW_S = 0.045;    // mean time of a turn with a draw above which draws are skipped; 0.033 at displays of 30 Hz
const MAX_STEP_S = 0.5;  // maximum step of the clock: longer pauses are not made up for
const IDLE_TURNS = 12;   // turns without change after which the loop sleeps

/** Selects turns to draw in: all with a new picture; if drawing is slow, every second turn of camera motion alone. */
export class DrawPace {
  #drawS = 0; // mean time from a turn with a draw to the next turn
  #drew = false;
  #skipped = false;

  /** Returns true to draw; called per turn with a change. stepS: time since the last turn. picture: not the camera alone. */
  takes(stepS: number, picture: boolean): boolean {
    if (this.#drew && stepS > 0) this.#drawS += (stepS - this.#drawS) / 8;
    this.#skipped = !picture && !this.#skipped && this.#drawS > SLOW_S;
    return (this.#drew = !this.#skipped);
  }
}

export class FrameLoop {
  readonly #turn: (clockS: number, stepS: number) => boolean;
  readonly #view: Pick<Window, 'requestAnimationFrame' | 'cancelAnimationFrame'>;
  #request = 0;
  #lastMs = 0;
  #clockS = 0;
  #idle = 0;
  #active = true;
  /** Time of the last turn, ms. */
  turnedMs = 0;

  /** turn: returns true while it needs further turns; gets seconds, without time off-screen. view: the element's window. */
  constructor(turn: (clockS: number, stepS: number) => boolean, view: Pick<Window, 'requestAnimationFrame' | 'cancelAnimationFrame'> = globalThis) {
    this.#turn = turn;
    this.#view = view;
  }

  wake(): void {
    this.#idle = 0;
    if (this.#active) this.#schedule();
  }
  /** active: false stops loop and clock, for an element off-screen. */
  setActive(active: boolean): void {
    this.#active = active;
    if (!active) this.stop();
  }
  /** Stops the loop until the next wake(). */
  stop(): void {
    this.#view.cancelAnimationFrame(this.#request);
    this.#request = this.#lastMs = 0;
  }

  #schedule(): void {
    this.#request ||= this.#view.requestAnimationFrame((nowMs) => this.#frame(nowMs));
  }

  #frame(nowMs: number): void {
    this.#request = 0;
    const stepS = this.#lastMs ? Math.min((nowMs - this.#lastMs) / 1000, MAX_STEP_S) : 0;
    this.#lastMs = nowMs;
    this.turnedMs = performance.now();
    this.#clockS += stepS;
    this.#idle = this.#turn(this.#clockS, stepS) ? 0 : this.#idle + 1;
    if (!this.#active || !this.#lastMs) return; // the turn has stopped the loop
    if (this.#idle < IDLE_TURNS) this.#schedule();
    else this.#lastMs = 0;
  }
}
