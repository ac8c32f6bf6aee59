// SPDX-License-Identifier: Apache-2.0
// The page's AudioContext, suspended while no sound uses it, and conversion from the page's clock to its own. Part of
// fourdvt-more.js.
const UNLOCKING = ['pointerup', 'keydown', 'touchend', 'click'] as const; // events after which browsers allow sound
const UNTIMED_S = 1; // context time by which a device has output timestamps, if ever
const REST_MS = 5000; // without a user before the context is suspended

export class AudioOutput {
  static #ofPage: AudioOutput | null = null;
  static #failed = false;
  readonly context = new AudioContext({ latencyHint: 'interactive' });
  readonly #changed = new Set<() => void>();
  readonly #users = new Set<object>();
  #rests = false;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** Returns the page's output, created at the first call; null where the browser has no sound. */
  static ofPage(): AudioOutput | null {
    if (!this.#ofPage && !this.#failed) {
      try {
        this.#ofPage = new AudioOutput();
      } catch (reason) {
        this.#failed = true;
        console.warn('fourdvt-viewer: this browser plays no sound:', reason);
      }
    }
    return this.#ofPage;
  }
  /** True if sound is due, but the autoplay policy blocks it until the visitor's first input. */
  static get blocked(): boolean { return this.#ofPage !== null && !this.#ofPage.#rests && this.#ofPage.context.state !== 'running'; }
  /** Removes a user; the context is suspended some seconds after the last one has left. */
  static leave(user: object): void { if (this.#ofPage) this.#ofPage.#leave(user); }

  private constructor() {
    for (const type of UNLOCKING) addEventListener(type, () => { if (!this.#rests) this.#resume(); }, { capture: true, passive: true });
    this.context.addEventListener('statechange', () => { for (const run of this.#changed) run(); });
    this.#resume();
  }

  /** Adds a user and resumes the context. True if it runs already; else it starts soon, or at the visitor's next input. */
  enter(user: object): boolean {
    this.#users.add(user);
    clearTimeout(this.#timer);
    if (this.#rests) this.#resume();
    this.#rests = false;
    return this.context.state === 'running';
  }
  #leave(user: object): void {
    if (!this.#users.delete(user) || this.#users.size) return;
    this.#timer = setTimeout(() => {
      this.#rests = true;
      void this.context.suspend().catch(() => undefined);
    }, REST_MS);
  }
  #resume(): void {
    if (this.context.state !== 'running') void this.context.resume().catch(() => undefined);
  }

  /** Calls `run` whenever the context starts or stops. */
  onChange(run: () => void, signal: AbortSignal): void {
    this.#changed.add(run);
    signal.addEventListener('abort', () => this.#changed.delete(run));
  }

  /** Context time, seconds, audible at a time of the page's clock, milliseconds; NaN while unknown. */
  heardAt(pageMs: number): number {
    const { context } = this, { contextTime, performanceTime } = context.getOutputTimestamp?.() ?? {};
    if (contextTime && performanceTime) return contextTime + (pageMs - performanceTime) / 1000;
    if (contextTime === 0 && context.currentTime < UNTIMED_S) return NaN;
    const latency = context.outputLatency || context.baseLatency || 0;
    return context.currentTime - latency + (pageMs - performance.now()) / 1000;
  }
}
