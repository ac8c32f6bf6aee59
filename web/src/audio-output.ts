// SPDX-License-Identifier: Apache-2.0
// The page's one AudioContext, and its clock against the page's. Part of fourdvt-more.js.
const UNLOCKING = ['pointerup', 'keydown', 'touchend'] as const; // after which browsers let a page be heard
const UNTIMED_S = 1; // a device that has not said by then what it plays never does

export class AudioOutput {
  static #ofPage: AudioOutput | null = null;
  readonly context = new AudioContext({ latencyHint: 'interactive' });
  #changed = new Set<() => void>();

  static ofPage(): AudioOutput { return (this.#ofPage ??= new AudioOutput()); }
  static get supported(): boolean { return typeof AudioContext === 'function'; }
  /** Something was to be heard, and the browser waits for the visitor's first touch of the page. */
  static get blocked(): boolean { return this.#ofPage !== null && this.#ofPage.context.state !== 'running'; }

  private constructor() {
    const resume = (): void => void this.context.resume().catch(() => undefined);
    for (const type of UNLOCKING) addEventListener(type, () => { if (this.context.state !== 'running') resume(); }, { capture: true, passive: true });
    this.context.addEventListener('statechange', () => { for (const run of this.#changed) run(); });
    resume();
  }

  /** Hears when the browser lets the page be heard, or stops it. */
  onChange(run: () => void, signal: AbortSignal): void {
    this.#changed.add(run);
    signal.addEventListener('abort', () => this.#changed.delete(run));
  }

  /** The context's time of what is heard at a time of the page's clock, milliseconds. NaN: not known yet. */
  heardAt(pageMs: number): number {
    const { context } = this, { contextTime, performanceTime } = context.getOutputTimestamp?.() ?? {};
    if (contextTime && performanceTime) return contextTime + (pageMs - performanceTime) / 1000;
    if (contextTime === 0 && context.currentTime < UNTIMED_S) return NaN;
    const latency = context.outputLatency || context.baseLatency || 0;
    return context.currentTime - latency + (pageMs - performance.now()) / 1000;
  }
}
