// SPDX-License-Identifier: Apache-2.0
// Live region for screen readers: while the viewer has the focus, announces play and pause, and which side of the
// performer is in view. Part of fourdvt-more.js.
import { fill } from '../report/strings-more.js';

const QUIET_MS = 700; // without a change before an announcement: a held key is announced once
const SIDES = ['front', 'frontLeft', 'left', 'backLeft', 'back', 'backRight', 'right', 'frontRight'];
const HIGH_DEG = 25, LOW_DEG = -5;

export interface Announced extends HTMLElement {
  readonly sequence: string;
  readonly paused: boolean;
  readonly ended: boolean;
  /** Heading of the character, degrees from +z towards +x. */
  readonly heading: number;
}

/** Returns where the view turns to, degrees as the orbit's. */
export type ViewGoal = () => { azimuth: number; elevation: number };

/** Returns the name of the side in view at an azimuth in degrees: 0 is the front, 90 the performer's left. */
export function sideOf(azimuth: number): string {
  return SIDES[((Math.round(azimuth / 45) % 8) + 8) % 8]!;
}

export class Announcer {
  readonly #viewer: Announced;
  readonly #goal: ViewGoal;
  readonly #live: HTMLParagraphElement;
  readonly #abort = new AbortController();
  #strings: Record<string, string> = {};
  readonly #timers = new Map<() => string, ReturnType<typeof setTimeout>>(); // one each for state and view

  constructor(viewer: Announced, root: ShadowRoot, goal: ViewGoal) {
    this.#viewer = viewer;
    this.#goal = goal;
    this.#live = document.createElement('p');
    this.#live.className = 'live';
    this.#live.setAttribute('role', 'status');
    root.append(this.#live);
    const { signal } = this.#abort;
    for (const name of ['playing', 'pause', 'ended', 'sequencechange']) viewer.addEventListener(name, () => this.#later(this.#state), { signal });
    viewer.addEventListener('camera-change', () => this.#later(this.#view), { signal });
  }

  update(strings: Record<string, string>): void { this.#strings = strings; }
  dispose(): void {
    this.#timers.forEach(clearTimeout);
    this.#abort.abort();
    this.#live.remove();
  }

  // Announces text() after QUIET_MS unless it is `said`, the last announcement; then again until it no longer changes: the character may turn.
  #later(text: () => string, said = ''): void {
    clearTimeout(this.#timers.get(text));
    this.#timers.set(text, setTimeout(() => {
      const now = text();
      if (now === said) return;
      if (this.#viewer.matches(':focus-within')) this.#live.textContent = now;
      this.#later(text, now);
    }, QUIET_MS));
  }
  readonly #state = (): string => {
    const { paused, ended, sequence } = this.#viewer;
    return fill(this.#strings[ended ? 'ended' : paused ? 'paused' : 'playing']!, { motion: sequence });
  };
  readonly #view = (): string => {
    const { azimuth, elevation } = this.#goal();
    const height = elevation > HIGH_DEG ? 'above' : elevation < LOW_DEG ? 'below' : '';
    return fill(this.#strings['view']!, { side: this.#strings[sideOf(azimuth - this.#viewer.heading)]!, height: this.#strings[height] ?? '' });
  };
}
