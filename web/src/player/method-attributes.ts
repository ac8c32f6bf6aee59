// SPDX-License-Identifier: Apache-2.0
// Drawing method of a character from cameras by an element's attributes method, cameras, visibility. A missing or invalid value is
// the default; the player checks the method's name.
import { DEFAULT_METHOD } from './commands.js';
import { VISIBILITIES, type Method, type Visibility } from './wasm-player.js';

const MAX_CAMERAS = 31; // of a character

export function methodOf(element: Element): Method {
  const cameras = Number(element.getAttribute('cameras') ?? NaN);
  const visibility = element.getAttribute('visibility') as Visibility | null;
  return {
    name: element.getAttribute('method') || DEFAULT_METHOD.name,
    closest: Number.isInteger(cameras) && cameras >= 0 && cameras <= MAX_CAMERAS ? cameras : DEFAULT_METHOD.closest,
    visibility: visibility && VISIBILITIES.includes(visibility) ? visibility : DEFAULT_METHOD.visibility,
  };
}
