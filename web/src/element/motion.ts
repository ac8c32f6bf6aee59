// SPDX-License-Identifier: Apache-2.0
// Feature: the shown motion, transitions to others, and steering by keys and joystick.
import type { More } from '../player/wasm-module.js';
import type { Settings } from '../player/wasm-player.js';
import type { Loading } from './loading.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

type Steering = InstanceType<More['Steering']>;
type Steered = ConstructorParameters<More['Steering']>[1];

export class Motion implements Feature {
  readonly #viewer: Viewer;
  readonly #loading: Loading;
  readonly #steered: Steered;
  #steering: Steering | null = null;
  #goal: string | null = null; // target of a transition that waits for the player's second part

  /** steered: the viewer's element. */
  constructor(viewer: Viewer, loading: Loading, steered: Steered) {
    this.#viewer = viewer;
    this.#loading = loading;
    this.#steered = steered;
  }

  get sequence(): string { return this.#viewer.current?.name ?? valueOf(this.#viewer.element, 'sequence'); }
  get state(): string { return this.#goal ?? (this.#viewer.state?.goal || this.sequence); }
  // Starts a transition. Transitions need the second part: until it is loaded the present motion plays on.
  goTo(state: string): void {
    const { session, commands, character } = this.#viewer;
    const waits = character && !session!.later.loaded && commands.settings.playing && this.#viewer.state?.hasFrame;
    this.#goal = waits && character.sequences.some(({ name }) => name === state) ? state : null;
    if (!this.#goal) return commands.goTo(state);
    void session!.later.rest().then(() => {
      if (this.#goal === state && this.#viewer.session === session) commands.goTo(state);
      this.#goal = null;
    });
  }

  settings(): Partial<Settings> {
    const { element } = this.#viewer;
    this.#goal = null;
    return { sequence: element.getAttribute('sequence'), travel: valueOf(element, 'travel') };
  }
  update(name: string, changed: boolean): void {
    const { element, commands, session } = this.#viewer;
    const sequence = valueOf(element, 'sequence');
    if (name === 'sequence' && sequence) this.#select(sequence); // also for the same name, to return from goTo()
    if (!changed) return;
    if (name === 'motion-controls') this.#steering?.update();
    if (name === 'align') session?.later.setAlign(valueOf(element, 'align'));
    if (name === 'travel') commands.set('travel', valueOf(element, 'travel'));
  }
  more(more: More): void {
    const viewer = this.#viewer, { connected, overlay, commands } = viewer;
    if (!connected) return;
    this.#steering ??= new more.Steering(overlay.stage, this.#steered, (name) => commands.requestedParameter(name), () => {
      viewer.touch();
      viewer.session?.wake();
    });
  }
  // Drops a waiting transition at a seek, which is within the shown motion.
  handle(event: string): void { if (event === 'seeking') this.#goal = null; }
  // Starts the waiting transition in a new session of the same source.
  begin(): void {
    if (this.#goal) this.#viewer.commands.goTo(this.#goal);
    this.#goal = null;
  }
  disconnect(): void {
    this.#steering?.dispose();
    this.#steering = null;
  }
  frame(stepS: number): boolean { return this.#steering?.step(stepS) ?? false; }

  #select(name: string): void {
    this.#goal = null;
    if (this.#viewer.commands.select(name) && !this.#loading.standsStill) this.#loading.forgetError();
  }
}
