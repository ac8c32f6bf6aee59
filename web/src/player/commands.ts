// SPDX-License-Identifier: Apache-2.0
// Settings and commands of one character, for <fourdvt-viewer> and <fourdvt-character>. Applies them at once to a loaded
// character, and all of them to one that is loaded later. Does not load or draw anything.
import type { CharacterInfo, Method, Placement, PlayerState, Settings, WasmPlayer } from './wasm-player.js';

/** Loaded character. */
export interface Instance {
  readonly character: CharacterInfo | null;
  state(): PlayerState | null;
  /** Present value of a parameter; NaN if the character has no such parameter. */
  parameter(name: string): number;
  /** Runs the action on the player. False, after an error event, if the player refuses it. */
  run(action: (player: WasmPlayer) => void): boolean;
}

/** Defaults of render::MethodOptions; an empty name: the character's own method. */
export const DEFAULT_METHOD: Method = { name: '', closest: 4, visibility: 'offset' };
// State of a player that has just read its manifest; the order of the fields is that of their application.
const NEW_PLAYER: Settings = {
  loop: -1, rate: 1, placement: { x: 0, z: 0, heading: 0 }, travel: false, align: 'baked',
  method: DEFAULT_METHOD, quality: null, options: null, scene: null,
  sequence: null, frame: 0, time: null, playing: false,
};
export class Commands {
  readonly #settings: Settings = { ...NEW_PLAYER };
  readonly #parameters = new Map<string, number>();
  // State of the last instance when detached; a command removes the parts that it sets.
  #left: Partial<Settings> = {};
  #instance: Instance | null = null;

  get settings(): Readonly<Settings> { return this.#settings; }

  /** Changes one setting; false, after an error event, if the character refuses it: the earlier value stays. */
  set<Name extends keyof Settings>(name: Name, value: Settings[Name]): boolean {
    return this.#change({ [name]: value }, (player) => player.set[name](value!));
  }
  /** Shows a motion at once, from its first frame. Returns as `set` does. */
  select(sequence: string): boolean { return this.#change({ sequence, frame: 0, time: null }, (player) => player.set.sequence(sequence)); }
  /** Goes to a motion by the best transition. */
  goTo(sequence: string): void { this.#change({ sequence, frame: 0, time: null }, (player) => player.goTo(sequence)); }
  seekFrame(frame: number): void { this.#change({ frame, time: null }, (player) => player.set.frame(frame)); }
  seek(timeS: number): void { this.#change({ frame: 0, time: timeS }, (player) => player.set.time(timeS)); }
  setParameter(name: string, value: number, atOnce: boolean): void {
    this.#parameters.set(name, value);
    const still = !this.#settings.playing; // a still picture does not glide
    this.#instance?.run((player) => player.setParameter(name, value, atOnce || still));
  }
  /** Sets the placement at once; parts left out keep their values. */
  place(part: Partial<Placement>): void { this.set('placement', { ...this.placement, ...part }); }
  /** Turns the character to this heading while it moves; a character loaded later begins with it. */
  steer(heading: number): void {
    if (this.#instance) this.#instance.run((player) => player.steer(heading));
    else this.place({ heading });
  }
  /** Records a setting without applying it: the player has it already, or the caller applies it. */
  remember<Name extends keyof Settings>(name: Name, value: Settings[Name]): void { this.#settings[name] = value; }

  state(): PlayerState | null { return this.#instance?.state() ?? null; }
  get placement(): Placement {
    const { x, z, heading } = this.state() ?? this.#left.placement ?? this.#settings.placement;
    return { x, z, heading };
  }
  /** Present value of a parameter; without a loaded character the value set; NaN if there is neither. */
  parameter(name: string): number { return this.#instance?.parameter(name) ?? this.requestedParameter(name) ?? NaN; }
  requestedParameter(name: string): number | undefined { return this.#parameters.get(name); }

  /** Prepares for another source, which begins with these settings instead of the last instance's state. */
  begin(settings: Partial<Settings> = {}): void {
    this.#left = {};
    Object.assign(this.#settings, { frame: 0, time: null }, settings);
  }
  /** Applies the settings that affect the first rendition, before the player reads its manifest. */
  prepare(player: WasmPlayer): void {
    const { quality, playing } = this.#settings;
    if (quality) player.set.quality(quality);
    if (playing) player.set.playing(true);
  }
  /** Applies all settings to a new instance, which gets every later command. */
  attach(instance: Instance): void {
    this.#instance = instance;
    const settings = { ...this.#settings, ...this.#left };
    for (const [name, value] of this.#parameters) instance.run((player) => player.setParameter(name, value, true));
    for (const name of Object.keys(NEW_PLAYER) as (keyof Settings)[]) {
      const value = settings[name] as never;
      if (value !== NEW_PLAYER[name]) instance.run((player) => player.set[name](value));
    }
  }
  /** Drops the instance and keeps its state, in which the next one of the same source begins. */
  detach(instance: Instance): void {
    if (this.#instance !== instance) return;
    this.#keepState(instance);
    this.#instance = null;
  }

  #change(settings: Partial<Settings>, action: (player: WasmPlayer) => void): boolean {
    const names = Object.keys(settings) as (keyof Settings)[];
    const before = Object.fromEntries(names.map((name) => [name, this.#settings[name]]));
    Object.assign(this.#settings, settings);
    for (const name of names) delete this.#left[name];
    const done = this.#instance?.run(action) ?? true;
    if (!done) Object.assign(this.#settings, before);
    return done;
  }

  // Keeps placement, sequence and frame for a new instance: during a transition frame 0 of its target, during a seek the
  // requested frame.
  #keepState(instance: Instance): void {
    const state = instance.state();
    if (!state?.hasFrame) return;
    const { x, z, heading, goal, frame } = state;
    this.#left = { ...this.#left, placement: { x, z, heading } };
    if (state.seeking) return;
    const shown = instance.character?.sequences[state.sequence]?.name ?? null;
    const arrived = !goal || goal === shown;
    Object.assign(this.#left, arrived ? { sequence: shown, frame, time: null } : { sequence: goal, frame: 0, time: null });
  }
}
