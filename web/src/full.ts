// SPDX-License-Identifier: Apache-2.0
// What a page loads as fourdvt-full.js when it needs the full player: the module, and the page's side of what only that
// has.
export { default } from 'fourdvt-wasm';
export { readLook } from './look.js';
export { loadOpenCvFlow } from './opencv-flow.js';
