// SPDX-License-Identifier: Apache-2.0
// Addresses of the player's files, as literal `new URL(…, import.meta.url)`, which bundlers recognise.

export interface PlayerFiles {
  readonly wasm: string;
  /** Script of the player's second part. */
  readonly more: string;
  readonly moreWasm: string;
  /** The worker that decodes geometry. */
  readonly worker: string;
  readonly workerWasm: string;
  readonly opencv: string;
  readonly opencvWasm: string;
}

/** Files beside this script; `opencv` is empty where it was not built. */
export const FILES: PlayerFiles = {
  wasm: new URL(`fourdvt-viewer.wasm${FOURDVT_VERSION}`, import.meta.url).href,
  more: new URL(`fourdvt-more.js${FOURDVT_VERSION}`, import.meta.url).href,
  moreWasm: new URL(`fourdvt-more.wasm${FOURDVT_VERSION}`, import.meta.url).href,
  worker: new URL(`fourdvt-worker.js${FOURDVT_VERSION}`, import.meta.url).href,
  workerWasm: new URL(`fourdvt-worker.wasm${FOURDVT_VERSION}`, import.meta.url).href,
  opencv: FOURDVT_OPENCV ? new URL(`fourdvt-opencv.js${FOURDVT_VERSION}`, import.meta.url).href : '',
  opencvWasm: FOURDVT_OPENCV ? new URL(`fourdvt-opencv.wasm${FOURDVT_VERSION}`, import.meta.url).href : '',
};

/** Returns all addresses for a page's `wasmUrl`: the others lie beside it, except an `opencvUrl` that the page has set. */
export function filesOf(wasmUrl: string, opencvUrl: string, base: string): PlayerFiles {
  const wasm = new URL(wasmUrl, base).href, opencv = opencvUrl && new URL(opencvUrl, base).href;
  if (wasm === FILES.wasm && opencv === FILES.opencv) return FILES;
  const at = (name: string, where = wasm): string => new URL(`fourdvt-${name}${FOURDVT_VERSION}`, where).href;
  const own = wasm === FILES.wasm ? FILES
    : { wasm, more: at('more.js'), moreWasm: at('more.wasm'), worker: at('worker.js'), workerWasm: at('worker.wasm'), opencv: at('opencv.js'), opencvWasm: at('opencv.wasm') };
  return opencv === FILES.opencv ? own : { ...own, opencv, opencvWasm: at('opencv.wasm', opencv) };
}
