// SPDX-License-Identifier: Apache-2.0
// Turns of the page's animation frames, as long as something moves and the element is on screen. Draws nothing.

const MAX_STEP_S = 0.5;  // a longer pause of the page is not caught up
const IDLE_TURNS = 12;   // turns without change after which the loop sleeps

export class FrameLoop {
  readonly #turn: (clockS: number, stepS: number) => boolean;
  #request = 0;
  #lastMs = 0;
  #clockS = 0;
  #idle = 0;
  #active = true;

  /** `turn`: one turn; true while more of them are needed. */
  constructor(turn: (clockS: number, stepS: number) => boolean) {
    this.#turn = turn;
  }

  wake(): void {
    this.#idle = 0;
    if (this.#active) this.#ask();
  }
  /** False: off-screen. The clock stands still. */
  setActive(active: boolean): void {
    this.#active = active;
    if (!active) this.stop();
  }
  /** Until it is woken again. */
  stop(): void {
    cancelAnimationFrame(this.#request);
    this.#request = this.#lastMs = 0;
  }

  #ask(): void {
    this.#request ||= requestAnimationFrame((nowMs) => this.#frame(nowMs));
  }

  #frame(nowMs: number): void {
    this.#request = 0;
    const stepS = this.#lastMs ? Math.min((nowMs - this.#lastMs) / 1000, MAX_STEP_S) : 0;
    this.#lastMs = nowMs;
    this.#clockS += stepS;
    this.#idle = this.#turn(this.#clockS, stepS) ? 0 : this.#idle + 1;
    if (!this.#active || !this.#lastMs) return; // stopped by what the turn did
    if (this.#idle < IDLE_TURNS) this.#ask();
    else this.#lastMs = 0;
  }
}
