// SPDX-License-Identifier: Apache-2.0
// Addresses of the player's files, written out so that bundlers find them.

export interface PlayerFiles {
  readonly wasm: string;
  /** The second part. */
  readonly more: string;
  readonly moreWasm: string;
  /** The worker that decodes geometry. */
  readonly worker: string;
  readonly workerWasm: string;
  readonly opencv: string;
  readonly opencvWasm: string;
}

/** Beside this script; no OpenCV where it was not built. */
export const FILES: PlayerFiles = {
  wasm: new URL(`fourdvt-viewer.wasm${FOURDVT_VERSION}`, import.meta.url).href,
  more: new URL(`fourdvt-more.js${FOURDVT_VERSION}`, import.meta.url).href,
  moreWasm: new URL(`fourdvt-more.wasm${FOURDVT_VERSION}`, import.meta.url).href,
  worker: new URL(`fourdvt-worker.js${FOURDVT_VERSION}`, import.meta.url).href,
  workerWasm: new URL(`fourdvt-worker.wasm${FOURDVT_VERSION}`, import.meta.url).href,
  opencv: FOURDVT_OPENCV ? new URL(`fourdvt-opencv.js${FOURDVT_VERSION}`, import.meta.url).href : '',
  opencvWasm: FOURDVT_OPENCV ? new URL(`fourdvt-opencv.wasm${FOURDVT_VERSION}`, import.meta.url).href : '',
};

/** Addresses for a wasm file that the page names: the others lie beside it, and so does OpenCV's unless the page names that, too. */
export function filesOf(wasmUrl: string, opencvUrl: string, base: string): PlayerFiles {
  const wasm = new URL(wasmUrl, base).href, opencv = opencvUrl && new URL(opencvUrl, base).href;
  if (wasm === FILES.wasm && opencv === FILES.opencv) return FILES;
  const at = (name: string, where = wasm): string => new URL(`fourdvt-${name}${FOURDVT_VERSION}`, where).href;
  const own = wasm === FILES.wasm ? FILES
    : { wasm, more: at('more.js'), moreWasm: at('more.wasm'), worker: at('worker.js'), workerWasm: at('worker.wasm'), opencv: at('opencv.js'), opencvWasm: at('opencv.wasm') };
  return opencv === FILES.opencv ? own : { ...own, opencv, opencvWasm: at('opencv.wasm', opencv) };
}
