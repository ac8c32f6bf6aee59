// SPDX-License-Identifier: Apache-2.0
// The commands of one character, each written once, for <fourdvt-viewer> and <fourdvt-character>. A command is
// remembered as a wish. A character that is loaded fulfils it at once; one that comes later begins with all wishes.
// Does not load or draw anything.
import type {
  Align, CharacterInfo, Method, Placement, PlayerState, Quality, RenderOptions, SceneMesh, WasmPlayer,
} from './wasm-player.js';

export interface Wishes {
  /** -1 as the sequence says, 0 never, 1 always. */
  loop: number;
  rate: number;
  placement: Placement;
  travel: boolean;
  align: Align;
  method: Method;
  quality: Quality | null;
  /** Options and scene belong to the canvas, so only its main character is given any. */
  options: RenderOptions | null;
  scene: SceneMesh[] | null;
  /** Null: the first sequence of the character. */
  sequence: string | null;
  frame: number;
  /** Seconds; null: the frame says where. */
  time: number | null;
  playing: boolean;
}

/** A loaded character that fulfils the wishes. */
export interface Performer {
  readonly character: CharacterInfo | null;
  state(): PlayerState | null;
  /** The value as shown; NaN if the character has no such parameter. */
  parameter(name: string): number;
  /** Runs the action on the player. False, after an error event, if the player refuses it. */
  run(action: (player: WasmPlayer) => void): boolean;
}

/** As render::MethodOptions begins; no name: the character's own. */
export const DEFAULT_METHOD: Method = { name: '', closest: 4, visibility: 'offset' };
// What a player does that has just read its manifest: these wishes need not be told to it.
const NEW_PLAYER: Wishes = {
  loop: -1, rate: 1, placement: { x: 0, z: 0, heading: 0 }, travel: false, align: 'baked',
  method: DEFAULT_METHOD, quality: null, options: null, scene: null,
  sequence: null, frame: 0, time: null, playing: false,
};
// How a player fulfils each wish, in the order in which a new player is told them.
const FULFIL: { [K in keyof Wishes]: (player: WasmPlayer, wish: NonNullable<Wishes[K]>) => void } = {
  loop: (player, loop) => player.setLoop(loop),
  rate: (player, rate) => player.setRate(rate),
  placement: (player, placement) => player.place(placement),
  travel: (player, on) => player.setTravel(on),
  align: (player, align) => player.setAlign(align),
  method: (player, method) => player.setMethod(method),
  quality: (player, quality) => player.setQuality(quality),
  options: (player, options) => player.setOptions(options),
  scene: (player, meshes) => player.setScene(meshes),
  sequence: (player, name) => player.selectSequence(name),
  frame: (player, frame) => player.seekFrame(frame),
  time: (player, time) => player.seek(time),
  playing: (player, on) => (on ? player.play() : player.pause()),
};
const WISHES = Object.keys(FULFIL) as (keyof Wishes)[];

function fulfil(player: WasmPlayer, name: keyof Wishes, wish: Wishes[keyof Wishes]): void {
  (FULFIL[name] as (player: WasmPlayer, wish: unknown) => void)(player, wish);
}

export class Commands {
  readonly #wishes: Wishes = { ...NEW_PLAYER };
  readonly #parameters = new Map<string, number>();
  // Where the last performer was when it left; a command removes the part that it decides anew.
  #left: Partial<Wishes> = {};
  #performer: Performer | null = null;

  get wishes(): Readonly<Wishes> { return this.#wishes; }

  /** Changes one wish. False, after an error event, if the character refuses it: then the earlier wish still holds. */
  set<K extends keyof Wishes>(name: K, wish: Wishes[K]): boolean {
    return this.#ask({ [name]: wish }, (player) => fulfil(player, name, wish));
  }
  /** Shows a motion at once, from its first frame. False as of `set`. */
  select(sequence: string): boolean { return this.#ask({ sequence, frame: 0, time: null }, (player) => player.selectSequence(sequence)); }
  /** Goes over to a motion by the best transition. */
  goTo(sequence: string): void { this.#ask({ sequence, frame: 0, time: null }, (player) => player.goTo(sequence)); }
  seekFrame(frame: number): void { this.#ask({ frame, time: null }, (player) => player.seekFrame(frame)); }
  seek(timeS: number): void { this.#ask({ frame: 0, time: timeS }, (player) => player.seek(timeS)); }
  setParameter(name: string, value: number, atOnce: boolean): void {
    this.#parameters.set(name, value);
    const still = !this.#wishes.playing; // a still picture does not glide
    this.#performer?.run((player) => player.setParameter(name, value, atOnce || still));
  }
  /** Puts the character somewhere at once. The parts left out keep their values. */
  place(part: Partial<Placement>): void { this.set('placement', { ...this.placement, ...part }); }
  /** Turns the character to this heading while it moves; one that comes later begins with this heading. */
  steer(heading: number): void {
    if (this.#performer) this.#performer.run((player) => player.steer(heading));
    else this.place({ heading });
  }
  /** Changes the wish alone, where the player has done it by itself or is told in a moment. */
  remember<K extends keyof Wishes>(name: K, wish: Wishes[K]): void { this.#wishes[name] = wish; }

  state(): PlayerState | null { return this.#performer?.state() ?? null; }
  get placement(): Placement {
    const { x, z, heading } = this.state() ?? this.#left.placement ?? this.#wishes.placement;
    return { x, z, heading };
  }
  /** The parameter's value as shown, or as asked for if no character is loaded; NaN if neither is known. */
  parameter(name: string): number { return this.#performer?.parameter(name) ?? this.wishedParameter(name) ?? NaN; }
  wishedParameter(name: string): number | undefined { return this.#parameters.get(name); }

  /** Prepares for another source: its performer begins as last asked for, not where the last performer was. */
  begin(asked: Partial<Wishes> = {}): void {
    this.#left = {};
    Object.assign(this.#wishes, { frame: 0, time: null }, asked);
  }
  /** Sets what decides in which rendition a player that has read no manifest yet begins. */
  prepare(player: WasmPlayer): void {
    const { quality, playing } = this.#wishes;
    if (quality) player.setQuality(quality);
    if (playing) player.play();
  }
  /** Tells a new performer all wishes, and from now on every command. */
  attach(performer: Performer): void {
    this.#performer = performer;
    const wishes = { ...this.#wishes, ...this.#left };
    for (const [name, value] of this.#parameters) performer.run((player) => player.setParameter(name, value, true));
    for (const name of WISHES) {
      if (wishes[name] !== NEW_PLAYER[name]) performer.run((player) => fulfil(player, name, wishes[name]));
    }
  }
  /** Lets the performer go and keeps its place: the next performer of this source begins there. */
  detach(performer: Performer): void {
    if (this.#performer !== performer) return;
    this.#keepPlace(performer);
    this.#performer = null;
  }

  #ask(wish: Partial<Wishes>, action: (player: WasmPlayer) => void): boolean {
    const names = Object.keys(wish) as (keyof Wishes)[];
    const before = Object.fromEntries(names.map((name) => [name, this.#wishes[name]]));
    Object.assign(this.#wishes, wish);
    for (const name of names) delete this.#left[name];
    const done = this.#performer?.run(action) ?? true;
    if (!done) Object.assign(this.#wishes, before);
    return done;
  }

  // During a transition the place is the start of its target. During a seek the wishes hold what is sought.
  #keepPlace(performer: Performer): void {
    const state = performer.state();
    if (!state?.hasFrame) return;
    const { x, z, heading, goal, frame } = state;
    this.#left = { ...this.#left, placement: { x, z, heading } };
    if (state.seeking) return;
    const shown = performer.character?.sequences[state.sequence]?.name ?? null;
    const arrived = !goal || goal === shown;
    Object.assign(this.#left, arrived ? { sequence: shown, frame, time: null } : { sequence: goal, frame: 0, time: null });
  }
}
