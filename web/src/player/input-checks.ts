// SPDX-License-Identifier: Apache-2.0
// Checks render options and snapshots from a page. Errors: TypeError for a value of a wrong type, RangeError for a number
// out of range.
import { DEBUG_VIEWS } from '../wasm/generated/abi.js';
import type { OrbitPose, RenderOptions } from './wasm-player.js';

/** Maximum width and height of the canvas, pixels. */
export const MAX_CANVAS_SIDE = 4096;

function checkNumbers(name: string, values: readonly number[], count = values.length): void {
  if (values.length !== count || ![...values].every(Number.isFinite)) throw new TypeError(`${name} must be ${count} finite numbers`);
}
function checkRange(name: string, value: number, min: number, max: number, whole = true): void {
  if (!(value >= min && value <= max && (!whole || Number.isInteger(value)))) {
    throw new RangeError(`${name} must be a${whole ? ' whole' : ''} number from ${min} to ${max}`);
  }
}

/** Checks render options. layers: the character's number of layers, if loaded. */
export function checkRenderOptions({ background, shadowStrength, samples, debug, debugLayer }: RenderOptions, layers = 256): void {
  checkNumbers('background', background ?? [], 4);
  checkRange('shadowStrength', shadowStrength, 0, 1, false);
  checkRange('samples', samples, 0, 64);
  if (!DEBUG_VIEWS.includes(debug)) throw new TypeError(`debug must be one of: ${DEBUG_VIEWS.join(', ')}`);
  checkRange('debugLayer', debugLayer, 0, layers - 1);
}

export function checkSnapshot(width: number, height: number, { azimuth, elevation, distance, target, fov }: OrbitPose): void {
  checkRange('width', width, 1, MAX_CANVAS_SIDE);
  checkRange('height', height, 1, MAX_CANVAS_SIDE);
  checkNumbers('azimuth and elevation', [azimuth, elevation]);
  checkNumbers('target', target ?? [], 3);
  checkRange('distance', distance, 1e-6, 1e6, false);
  checkRange('fov', fov, 1, 179, false);
}
