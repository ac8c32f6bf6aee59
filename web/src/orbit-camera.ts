// SPDX-License-Identifier: Apache-2.0
// The orbit the visitor looks along: goal, damped current pose, limits from the character's bounding box. No DOM.
// Degrees and metres; azimuth 0 looks at the performer's front, positive moves the camera towards +X.
import type { CharacterInfo, OrbitPose } from './wasm-player.js';

export interface OrbitText {
  azimuth: number;
  elevation: number;
  /** Null: as far as the whole character needs. */
  distance: number | null;
}

const DEFAULT: OrbitText = { azimuth: 0, elevation: 6, distance: null };
const DAMPING_S = 0.09;        // time constant towards the goal
const MAX_ELEVATION = 85;
const GROUND_CLEARANCE_M = 0.05;
const MARGIN = 1.08;           // air round the character at the automatic distance
const NEAREST = 0.35;          // closest and farthest, in automatic distances
const FARTHEST = 3;

/** "30deg 10deg 3m"; "auto" for a part keeps its default. */
export function parseOrbit(text: string | null): OrbitText {
  const part = (token: string | undefined, fallback: number): number => {
    const value = parseFloat(token ?? '');
    if (!Number.isFinite(value)) return fallback;
    return token!.endsWith('rad') ? (value * 180) / Math.PI : value;
  };
  const [azimuth, elevation, distance] = (text ?? '').trim().split(/\s+/);
  const metres = parseFloat(distance ?? '');
  return {
    azimuth: part(azimuth, DEFAULT.azimuth),
    elevation: part(elevation, DEFAULT.elevation),
    distance: Number.isFinite(metres) && metres > 0 ? metres * (distance!.endsWith('cm') ? 0.01 : 1) : null,
  };
}

/** "0m 0.9m 0m", or null. */
export function parseTarget(text: string | null): [number, number, number] | null {
  const values = (text ?? '').trim().split(/\s+/).map(parseFloat);
  return values.length === 3 && values.every(Number.isFinite) ? (values as [number, number, number]) : null;
}

const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
const radians = (degrees: number): number => (degrees * Math.PI) / 180;

export class OrbitCamera {
  #home: OrbitText = DEFAULT;
  #goal: OrbitText = { ...DEFAULT };
  #now = { azimuth: DEFAULT.azimuth, elevation: DEFAULT.elevation, distance: 3 };
  #target: [number, number, number] = [0, 0.9, 0];
  #half: [number, number] = [0.5, 0.9]; // half width (over all azimuths) and half height of the box, metres
  #groundY = 0;
  #aspect = 1;
  #fixedTarget: [number, number, number] | null = null;
  fov = 35;

  /** The orbit of attributes: where Home returns to. */
  setHome(orbit: OrbitText): void {
    this.#home = orbit;
    this.#goal = { ...orbit };
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

  get pose(): OrbitPose {
    return { ...this.#now, target: this.#target, fov: this.fov };
  }
  get goal(): { azimuth: number; elevation: number; distance: number } {
    return { ...this.#goal, distance: this.#goal.distance ?? this.#fit() };
  }

  rotate(azimuth: number, elevation: number): void {
    this.#goal.azimuth += azimuth;
    this.#goal.elevation += elevation;
    this.#limit();
  }
  /** factor < 1 comes closer. */
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
  }

  /** Moves towards the goal; true while it has not arrived. */
  update(dtS: number): boolean {
    const goal = this.goal;
    const k = 1 - Math.exp(-dtS / DAMPING_S);
    const now = this.#now;
    const away = Math.abs(goal.azimuth - now.azimuth) + Math.abs(goal.elevation - now.elevation) +
      90 * Math.abs(goal.distance / now.distance - 1);
    if (away < 0.02) {
      const moved = away > 0;
      this.jump();
      return moved;
    }
    now.azimuth += k * (goal.azimuth - now.azimuth);
    now.elevation += k * (goal.elevation - now.elevation);
    now.distance += k * (goal.distance - now.distance);
    return true;
  }

  // Distance at which the whole box is in the picture from every azimuth.
  #fit(): number {
    const tan = Math.tan(radians(this.fov / 2));
    const [width, height] = this.#half;
    return MARGIN * Math.max(height / tan, width / (tan * this.#aspect)) + width * 0.7;
  }
  #limit(): void {
    const fit = this.#fit();
    if (this.#goal.distance !== null) this.#goal.distance = clamp(this.#goal.distance, NEAREST * fit, FARTHEST * fit);
    const drop = (this.#target[1] - this.#groundY - GROUND_CLEARANCE_M) / this.goal.distance;
    const lowest = -Math.asin(clamp(drop, 0, 1)) * (180 / Math.PI);
    this.#goal.elevation = clamp(this.#goal.elevation, lowest, MAX_ELEVATION);
  }
}
