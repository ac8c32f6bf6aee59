// SPDX-License-Identifier: Apache-2.0
// Applies input of keys and joystick to a character: its heading, its first parameter, its action. Part of fourdvt-more.js.
import { isOn } from '../page/attributes.js';
import { MotionControls } from './motion-controls.js';

const STEER_DEG = 60;            // a held key sets a heading this far from the present one
const PARAMETER_RANGES_S = 0.7;  // share of the parameter's range that a held key crosses per second

/** Members of the viewer that this file uses. */
export interface Steered extends HTMLElement {
  readonly paused: boolean;
  readonly state: string;
  readonly sequences: { name: string; loop: boolean }[];
  readonly parameters: { name: string; min: number; max: number }[];
  heading: number;
  getParameter(name: string): number;
  setParameter(name: string, value: number): void;
  goTo(state: string): void;
  play(): Promise<void>;
}

export class Steering {
  readonly #controls: MotionControls;
  readonly #viewer: Steered;
  readonly #requested: (name: string) => number | undefined;
  #turns = false; // by keys or joystick

  /** requested: returns the value last set for a parameter; wake: requests a turn of the frame loop. */
  constructor(stage: HTMLElement, viewer: Steered, requested: (name: string) => number | undefined, wake: () => void) {
    this.#viewer = viewer;
    this.#requested = requested;
    this.#controls = new MotionControls(stage, {
      steers: () => isOn(viewer, 'motion-controls'),
      act: () => this.#act(),
      onInteract: () => {
        this.#stopTurning(); // not in the next step(): the character would turn on for a frame
        wake();
      },
    });
  }

  dispose(): void { this.#controls.dispose(); }
  /** Shows the joystick if it can steer, else hides it. */
  update(): void { this.#controls.update(); }

  /** Called per turn of the frame loop; true while a key or the joystick is held. */
  step(dtS: number): boolean {
    const viewer = this.#viewer, input = this.#controls.steering;
    if (!input || viewer.paused) return false;
    if (input.turn) {
      viewer.heading -= STEER_DEG * input.turn;
      this.#turns = true;
    } else {
      this.#stopTurning();
    }
    const [parameter] = viewer.parameters;
    if (parameter && (input.change || input.level !== null)) {
      const { name, min, max } = parameter;
      const now = this.#requested(name) ?? viewer.getParameter(name);
      const next = input.level !== null ? min + (max - min) * input.level : now + input.change * (max - min) * PARAMETER_RANGES_S * dtS;
      const value = Math.min(max, Math.max(min, next));
      if (value !== now) viewer.setParameter(name, value);
    }
    return input.turn !== 0 || input.change !== 0 || input.level !== null;
  }

  // Ends a turn once keys and joystick are released: sets the heading's goal, which lies ahead, to the present heading.
  #stopTurning(): void {
    if (!this.#turns || this.#controls.steering?.turn) return;
    this.#turns = false;
    const { heading } = this.#viewer;
    this.#viewer.heading = heading;
  }

  // Plays the motion that the attribute `action` names, else the first one that does not loop.
  #act(): void {
    const viewer = this.#viewer;
    if (viewer.paused) return void viewer.play();
    const action = viewer.getAttribute('action') ?? viewer.sequences.find((s) => !s.loop)?.name;
    if (action && viewer.state !== action) viewer.goTo(action);
  }
}
