// SPDX-License-Identifier: Apache-2.0
// fourdvt-more.js: the page's side of what the player's second part has.
export { readLook } from './look.js';
export { isSubFaster, measurePath } from './measure-path.js';
export { MotionControls } from './motion-controls.js';
export { advise } from './advice.js';
export { LiveStream } from './live.js';
export { loadOpenCvFlow } from './opencv-flow.js';
export { makeVideoDecoder } from './video-element.js';
