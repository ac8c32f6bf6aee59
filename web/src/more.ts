// SPDX-License-Identifier: Apache-2.0
// fourdvt-more.js: the page's side of what the player's second part has.
export { Companions } from './companions.js';
export { useFlow, useLook, useRoom } from './effects.js';
export { complete } from './completion.js';
export { connectLive } from './live.js';
export { Extras } from './extras.js';
export { MediaTimes } from './media-times.js';
export { canReadBack, isSubFaster } from './measure-path.js';
export { renew } from './renewal.js';
export { Steering } from './steering.js';
export { makeVideoDecoder } from './video-element.js';
