// SPDX-License-Identifier: Apache-2.0
// Reads the drawing method of characters from cameras from an element's attributes method, cameras and visibility. Missing
// or invalid values are replaced by defaults, except the method's name, which the player checks.
import { DEFAULT_METHOD } from './commands.js';
import { VISIBILITIES, type Method, type Visibility } from './wasm-player.js';

const MAX_CAMERAS = 31; // maximum per character

export function methodOf(element: Element): Method {
  const cameras = Number(element.getAttribute('cameras') ?? NaN);
  const visibility = element.getAttribute('visibility') as Visibility | null;
  return {
    name: element.getAttribute('method') || DEFAULT_METHOD.name,
    closest: Number.isInteger(cameras) && cameras >= 0 && cameras <= MAX_CAMERAS ? cameras : DEFAULT_METHOD.closest,
    visibility: visibility && VISIBILITIES.includes(visibility) ? visibility : DEFAULT_METHOD.visibility,
  };
}
