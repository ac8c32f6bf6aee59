// SPDX-License-Identifier: Apache-2.0
// Orbit of the view's camera: a goal, the present pose, which approaches the goal smoothly, and limits from the
// character's bounding box. Does not touch the DOM. Degrees and metres; azimuth 0 shows the performer's front, positive
// azimuths move the camera towards +x.
import type { CharacterInfo, OrbitPose } from '../player/wasm-player.js';

export interface OrbitText {
  azimuth: number;
  elevation: number;
  /** Metres; null: the distance that shows the whole character. */
  distance: number | null;
}

const DEFAULT: OrbitText = { azimuth: 0, elevation: 6, distance: null };
const DAMPING_S = 0.09;        // time constant of the glide towards the goal
const FOLLOW_S = 0.12;         // time constants of following a travelling character, here its place, below its heading
const FOLLOW_TURN_S = 0.5;
const FOLLOW_JUMP_M = 3;       // the camera jumps instead of gliding if the character is further away than this
const FOLLOW_JUMP_HEIGHTS = 2; // or than this many of its heights, whichever is less
const MAX_ELEVATION = 85;
const GROUND_CLEARANCE_M = 0.05; // of the camera above the ground, at most 5 % of the character's height
const GROUND_CLEARANCE = 0.05;
const MARGIN = 1.08;           // factor of the automatic distance, for free space around the character
const MIN_DISTANCE = 0.35;     // in automatic distances
const MAX_DISTANCE = 3;

// Reads up to three quantities: angles in degrees, lengths in metres. Missing or unreadable ones are `fallback`.
const quantities = (text: string | null, fallback: number): number[] => {
  const tokens = (text ?? '').trim().split(/\s+/);
  return [0, 1, 2].map((i) => {
    const token = tokens[i] ?? '', value = parseFloat(token);
    if (!Number.isFinite(value)) return fallback;
    return value * (token.endsWith('rad') ? 180 / Math.PI : token.endsWith('cm') ? 0.01 : 1);
  });
};

/** Reads azimuth, elevation and distance, such as "30deg 10deg 3m". "auto" in one of the three places: its default. */
export function parseOrbit(text: string | null): OrbitText {
  const [azimuth = NaN, elevation = NaN, distance = NaN] = quantities(text, NaN);
  return {
    azimuth: Number.isNaN(azimuth) ? DEFAULT.azimuth : azimuth,
    elevation: Number.isNaN(elevation) ? DEFAULT.elevation : elevation,
    distance: distance > 0 ? distance : null,
  };
}

/** Reads a point in metres, such as "0m 0.9m 0m"; null if the text is not three numbers. */
export function parseTarget(text: string | null): [number, number, number] | null {
  const values = (text ?? '').trim().split(/\s+/).map(parseFloat);
  return values.length === 3 && values.every(Number.isFinite) ? (values as [number, number, number]) : null;
}

const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
const radians = (degrees: number): number => (degrees * Math.PI) / 180;

/** position: follows a travelling character; behind: also turns with it. */
export type Follow = 'none' | 'position' | 'behind';

export class OrbitCamera {
  #home: OrbitText = DEFAULT;
  #goal: OrbitText = { ...DEFAULT };
  #now = { azimuth: DEFAULT.azimuth, elevation: DEFAULT.elevation, distance: 3 };
  #target: [number, number, number] = [0, 0.9, 0];
  #half: [number, number] = [0.5, 0.9]; // bounding box, metres: half the diagonal of its base, half its height
  #groundY = 0;
  #aspect = 1;
  #fixedTarget: [number, number, number] | null = null;
  #place = { x: 0, z: 0, heading: 0 };
  #seen = { x: 0, z: 0, heading: 0 }; // place and heading that the camera has reached in following
  #following: Follow = 'none';
  #min: number[] = []; // limits of azimuth, elevation, distance
  #max: number[] = [];
  fov = 35;

  /** Sets the orbit that Home returns to. */
  setHome(orbit: OrbitText): void {
    this.#home = orbit;
    this.#goal = { ...orbit };
  }
  /** Sets lower and upper limits of the orbit, in parseOrbit's format; "auto": no limit of the page's own. */
  setLimits(min: string | null, max: string | null): void {
    this.#min = quantities(min, -Infinity);
    this.#max = quantities(max, Infinity);
  }
  setTarget(target: [number, number, number] | null): void {
    this.#fixedTarget = target;
    if (target) this.#target = target;
  }
  setCharacter(info: CharacterInfo): void {
    const { min, max } = info;
    const size = [max[0] - min[0], max[1] - min[1], max[2] - min[2]] as const;
    this.#half = [Math.hypot(size[0], size[2]) / 2, size[1] / 2];
    this.#groundY = info.groundY;
    if (!this.#fixedTarget) this.#target = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
  }
  setAspect(aspect: number): void {
    this.#aspect = aspect;
  }

  setFollow(follow: Follow): void {
    this.#following = follow;
    if (follow === 'none') this.#seen = { x: 0, z: 0, heading: 0 };
  }
  /** Sets the character's present place, metres, and heading, degrees. */
  follow(place: { x: number; z: number; heading: number }): void {
    this.#place = { x: place.x, z: place.z, heading: place.heading };
  }

  get pose(): OrbitPose {
    const [x, y, z] = this.#target;
    const at = this.#seen;
    const turn = radians(at.heading);
    const target: [number, number, number] = [
      at.x + x * Math.cos(turn) + z * Math.sin(turn), y, at.z - x * Math.sin(turn) + z * Math.cos(turn)];
    return { ...this.#now, azimuth: this.#now.azimuth + this.#behind, target, fov: this.fov };
  }
  /** Orbit that the pose glides to, as far as it does not follow a turning character. */
  get destination(): { azimuth: number; elevation: number } {
    return { azimuth: this.#goal.azimuth + this.#behind, elevation: this.#goal.elevation };
  }
  get #behind(): number { return this.#following === 'behind' ? this.#seen.heading + 180 : 0; }
  get goal(): { azimuth: number; elevation: number; distance: number } {
    return { ...this.#goal, distance: this.#goal.distance ?? this.#fit() };
  }

  rotate(azimuth: number, elevation: number): void {
    this.#goal.azimuth += azimuth;
    this.#goal.elevation += elevation;
    this.#limit();
  }
  /** Multiplies the distance by `factor`. */
  zoom(factor: number): void {
    this.#goal.distance = (this.#goal.distance ?? this.#fit()) * factor;
    this.#limit();
  }
  reset(): void {
    const turns = Math.round((this.#now.azimuth - this.#home.azimuth) / 360);
    this.#goal = { ...this.#home, azimuth: this.#home.azimuth + 360 * turns };
  }
  jump(): void {
    this.#now = this.goal;
    if (this.#following !== 'none') this.#seen = { ...this.#place };
  }

  /** Advances the pose towards the goal by `dtS` seconds; true while the pose changes. */
  update(dtS: number): boolean {
    const following = this.#updateFollow(dtS);
    return this.#updateOrbit(dtS) || following;
  }

  #updateFollow(dtS: number): boolean {
    if (this.#following === 'none') return false;
    const [seen, place] = [this.#seen, this.#place];
    const near = 1 - Math.exp(-dtS / FOLLOW_S);
    const turn = ((((place.heading - seen.heading) % 360) + 540) % 360) - 180;
    const away = Math.hypot(place.x - seen.x, place.z - seen.z);
    if (away > Math.min(FOLLOW_JUMP_M, FOLLOW_JUMP_HEIGHTS * 2 * this.#half[1])) {
      this.#seen = { ...place };
      return true;
    }
    seen.x += near * (place.x - seen.x);
    seen.z += near * (place.z - seen.z);
    seen.heading += (1 - Math.exp(-dtS / FOLLOW_TURN_S)) * turn;
    return away > 1e-4 || (this.#following === 'behind' && Math.abs(turn) > 0.02);
  }

  #updateOrbit(dtS: number): boolean {
    const goal = this.goal;
    const k = 1 - Math.exp(-dtS / DAMPING_S);
    const now = this.#now;
    const away = Math.abs(goal.azimuth - now.azimuth) + Math.abs(goal.elevation - now.elevation) +
      90 * Math.abs(goal.distance / now.distance - 1);
    if (away < 0.02) {
      const moved = away > 0;
      this.#now = goal;
      return moved;
    }
    now.azimuth += k * (goal.azimuth - now.azimuth);
    now.elevation += k * (goal.elevation - now.elevation);
    now.distance += k * (goal.distance - now.distance);
    return true;
  }

  // Distance from which the picture contains the whole bounding box at every azimuth; equal to native/base/camera.cpp's.
  #fit(): number {
    const tan = Math.tan(radians(this.fov / 2));
    const [width, height] = this.#half;
    return MARGIN * Math.max(height / tan + width, width / Math.sin(Math.atan(tan * this.#aspect)));
  }
  #limit(): void {
    const fit = this.#fit();
    const { distance, azimuth } = this.#goal;
    const [turn = -Infinity, low = -Infinity, near = -Infinity] = this.#min, [turnTo = Infinity, high = Infinity, far = Infinity] = this.#max;
    if (distance !== null) this.#goal.distance = clamp(clamp(distance, MIN_DISTANCE * fit, MAX_DISTANCE * fit), near, far);
    this.#goal.azimuth = clamp(azimuth, turn, turnTo);
    const clearance = Math.min(GROUND_CLEARANCE_M, GROUND_CLEARANCE * 2 * this.#half[1]);
    const drop = (this.#target[1] - this.#groundY - clearance) / this.goal.distance;
    const lowest = -Math.asin(clamp(drop, 0, 1)) * (180 / Math.PI);
    this.#goal.elevation = clamp(this.#goal.elevation, Math.max(lowest, low), Math.min(MAX_ELEVATION, high));
  }
}
