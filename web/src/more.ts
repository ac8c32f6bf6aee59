// SPDX-License-Identifier: Apache-2.0
// fourdvt-more.js: the TypeScript that goes with the second part of the wasm player.
export { Companions } from './more/companions.js';
export { useFlow, useLook, useRoom } from './more/effects.js';
export { complete } from './more/completion.js';
export { connectLive } from './live/live.js';
export { Extras } from './controls/extras.js';
export { MediaTimes } from './more/media-times.js';
export { canReadBack, isSubFaster } from './more/measure-path.js';
export { renew } from './more/renewal.js';
export { Steering } from './controls/steering.js';
export { makeVideoDecoder } from './decode/video-element.js';
