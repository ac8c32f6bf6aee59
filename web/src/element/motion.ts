// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: which motion is shown, its parameters, where the character goes, and keys and joystick that
// steer it.
import { isOn } from '../page/attributes.js';
import type { Wishes } from '../player/commands.js';
import type { SessionOptions } from '../session/session-host.js';
import type { More } from '../player/wasm-module.js';
import { ALIGN_MODES, type Align, type ParameterInfo, type Placement, type SequenceInfo } from '../player/wasm-player.js';
import {
  animate, emit, firstWishes, onAttribute, onLeft, onMore, onSession, parts, sessionOptions, touched, type Constructor, type ViewerBase,
} from './base.js';
import { forgetError, standsStill, type Loading } from './loading.js';
import type { Playback } from './playback.js';

export interface Motion {
  sequence: string;
  readonly sequences: SequenceInfo[];
  /** Parameters of the motion shown, with their ranges; none for a plain motion. */
  readonly parameters: ParameterInfo[];
  /** Lets the motion glide to the value, or jump if `immediate`. A value out of range counts as the range's end. */
  setParameter(name: string, value: number, immediate?: boolean): void;
  /** The value as shown now; NaN if the character has no such parameter. */
  getParameter(name: string): number;
  /** Goes over to another motion by the best transition. A motion without loop returns by itself. */
  goTo(state: string): void;
  /** The motion that was asked for last, or the one that is shown. */
  readonly state: string;
  readonly inTransition: boolean;
  /** Degrees, from +z towards +x. Setting it makes the character turn to it while it moves. */
  heading: number;
  /** Where the character stands. Setting it puts the character there at once. */
  get placement(): Placement;
  set placement(place: Partial<Placement>);
  /** Root motion moves the character over the ground. */
  travel: boolean;
  align: Align;
}

export function withMotion<T extends Constructor<ViewerBase & Loading & Playback>>(Base: T): T & Constructor<Motion> {
  return class extends Base implements Motion {
    static override get observedAttributes(): readonly string[] { return [...super.observedAttributes, 'sequence', 'travel', 'align']; }

    #steering: InstanceType<More['Steering']> | null = null;
    #goal: string | null = null; // of a transition that waits for the player's second part

    get sequence(): string { return this[parts].current?.name ?? this.getAttribute('sequence') ?? ''; }
    set sequence(name: string) { this.setAttribute('sequence', name); }
    get sequences(): SequenceInfo[] { return this[parts].session?.character?.sequences ?? []; }
    get parameters(): ParameterInfo[] { return this[parts].current?.parameters ?? []; }
    setParameter(name: string, value: number, immediate = false): void {
      if (!Number.isFinite(value)) throw new TypeError(`${name} must be a number`);
      this[parts].commands.setParameter(name, value, immediate);
      this[emit]('parameterchange', { name, value });
    }
    getParameter(name: string): number { return this[parts].commands.parameter(name); }
    // Goes over by a transition; until the second part is there, which transitions need, the present motion plays on.
    goTo(state: string): void {
      const { session, commands } = this[parts], waits = session?.character && !session.later.loaded && commands.wishes.playing && commands.state()?.hasFrame;
      this.#goal = waits && this.sequences.some(({ name }) => name === state) ? state : null;
      if (!this.#goal) return commands.goTo(state);
      const go = (): void => {
        if (this.#goal === state && this[parts].session === session) commands.goTo(state);
        this.#goal = null;
      };
      void session!.later.rest().then(go);
    }
    get state(): string { return this.#goal ?? (this[parts].commands.state()?.goal || this.sequence); }
    get inTransition(): boolean { return this[parts].commands.state()?.inTransition ?? false; }
    get heading(): number { return this[parts].commands.placement.heading; }
    set heading(degrees: number) {
      if (!Number.isFinite(degrees)) throw new TypeError('heading must be a number of degrees');
      this[parts].commands.steer(degrees);
    }
    get placement(): Placement { return this[parts].commands.placement; }
    set placement(place: Partial<Placement>) {
      const at = { ...this.placement, ...place };
      if (![at.x, at.z, at.heading].every(Number.isFinite)) throw new TypeError('x, z and heading must be numbers');
      this[parts].commands.place(at);
    }
    get travel(): boolean { return isOn(this, 'travel'); }
    set travel(on: boolean) { this.toggleAttribute('travel', on); }
    get align(): Align {
      const wish = this.getAttribute('align') as Align | null;
      return wish && ALIGN_MODES.includes(wish) ? wish : 'baked';
    }
    set align(value: Align) { this.setAttribute('align', value); }

    override [firstWishes](): Partial<Wishes> {
      this.#goal = null;
      return { ...super[firstWishes](), sequence: this.getAttribute('sequence'), travel: this.travel };
    }
    override [sessionOptions](): Partial<SessionOptions> { return { ...super[sessionOptions](), align: this.align }; }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      const { connected, commands, session } = this[parts];
      if (!connected) return;
      if (name === 'sequence' && value) this.#select(value); // the same one, too: back from where goTo has led
      if (before === value) return;
      if (name === 'motion-controls') this.#steering?.update();
      if (name === 'align') session?.later.setAlign(this.align);
      if (name === 'travel') commands.set('travel', this.travel);
    }

    #select(name: string): void {
      this.#goal = null;
      if (this[parts].commands.select(name) && !this[standsStill]) this[forgetError]();
    }

    override [onMore](more: More): void {
      super[onMore](more);
      const { connected, overlay, commands } = this[parts];
      if (!connected) return;
      this.#steering ??= new more.Steering(overlay.stage, this, (name) => commands.wishedParameter(name), () => {
        this[touched]();
        this[parts].session?.wake();
      });
    }
    // A seek is within the motion that is shown.
    override [emit](name: string, detail?: unknown): void {
      if (name === 'seeking') this.#goal = null;
      super[emit](name, detail);
    }
    // A new session of the same source begins with the goal that waited.
    override [onSession](): void {
      super[onSession]();
      if (this.#goal) this[parts].commands.goTo(this.#goal);
      this.#goal = null;
    }
    override [onLeft](): void {
      super[onLeft]();
      this.#steering?.dispose();
      this.#steering = null;
    }

    override [animate](dtS: number): boolean {
      const moves = super[animate](dtS);
      return this.#steering?.step(dtS) || moves;
    }
  };
}
