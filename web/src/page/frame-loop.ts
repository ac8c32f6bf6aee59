// SPDX-License-Identifier: Apache-2.0
// Calls back once per animation frame of the page, as long as something moves and the element is on screen.

const SLOW_S = 0.045;    // of a turn with a draw: then there is no time for all; displays of 30 Hz take 0.033
const MAX_STEP_S = 0.5;  // longer pauses of the page are not caught up
const IDLE_TURNS = 12;   // turns without change after which the loop sleeps

/** Chooses turns that draw. If drawing is slow, moves of the camera alone are drawn every second turn, new pictures always. */
export class DrawPace {
  #drawS = 0; // from a turn that draws to the next, mean
  #drew = false;
  #skipped = false;

  /** Once per turn that could draw. stepS: since the turn before; picture: there is a new one. */
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

  /** `turn` returns true while it needs further turns. Seconds, without the time off-screen. view: the window that shows the element. */
  constructor(turn: (clockS: number, stepS: number) => boolean, view: Pick<Window, 'requestAnimationFrame' | 'cancelAnimationFrame'> = globalThis) {
    this.#turn = turn;
    this.#view = view;
  }

  wake(): void {
    this.#idle = 0;
    if (this.#active) this.#schedule();
  }
  /** False: the element is off-screen, and the clock stands still. */
  setActive(active: boolean): void {
    this.#active = active;
    if (!active) this.stop();
  }
  /** Takes no more turns until it is woken again. */
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
