// SPDX-License-Identifier: Apache-2.0
// Detail of the element's `error` event. Compare IDs, never messages. IDs are those of native/base/result.h and these
// three of the page ("ID: meaning; remedy"; site/docs/errors.mjs makes the documents' table of them):
//   insecure-context: this browser decodes video only on https pages and on localhost; serve the page over https
//   wasm-refused: the browser refuses the player's WebAssembly, or it is of another build than the script; add
//     'wasm-unsafe-eval' to script-src of the page's policy, and serve all files of one build unchanged
//   out-of-memory: the browser has no memory left for the character; close other tabs, or offer a smaller character

export interface ErrorDetail {
  id: string;
  message: string;
}

/** Error with a code of MediaError. */
export interface MediaFault extends ErrorDetail {
  readonly code: number;
}

export const withCode = (error: ErrorDetail): MediaFault => {
  const { id } = error, notSupported = /^(manifest|unsupp|decoder-un|insec|wasm|invalid)/.test(id);
  return { ...error, code: id === 'fetch-failed' ? 2 : notSupported ? 4 : 3 }; // 3: MEDIA_ERR_DECODE
};

export class ViewerError extends Error {
  readonly id: string;
  constructor(id: string, message: string) {
    super(message);
    this.id = id;
  }
  get detail(): ErrorDetail {
    return { id: this.id, message: this.message };
  }
}

/** Returns true for errors that occur when a new bake has replaced the playing one on the server. */
export const mayBeOfTwoBakes = ({ id }: ErrorDetail): boolean => id === 'files-differ' || id === 'fetch-failed';

/** Dispatches an event of an element; also logs an error to the console, for pages without a listener. */
export function dispatch(element: Element, name: string, detail?: unknown): void {
  if (name === 'error') {
    const { id, message } = detail as ErrorDetail;
    console.error(`fourdvt-viewer: ${id}: ${message}`);
  }
  element.dispatchEvent(new CustomEvent(name, { detail }));
}

/** Absolute address of `src`. Errors: ViewerError 'invalid-argument'. */
export function characterAddress(src: string, base: string): string {
  try {
    return new URL(src, base).href;
  } catch {
    throw new ViewerError('invalid-argument', `src="${src}" is no address: it must name a character.gltf`);
  }
}

export function asViewerError(reason: unknown): ViewerError {
  if (reason instanceof ViewerError) return reason;
  const text = reason instanceof Error ? `${reason.name}: ${reason.message}` : String(reason);
  return /\bOOM\b|enlarge memory|allocation failed/i.test(text) // out-of-memory messages of Emscripten and browsers
    ? new ViewerError('out-of-memory', `the browser has no memory left for the character (${text}); close other tabs`)
    : new ViewerError('internal', text);
}

/** Base class of the elements; an empty class on a server, so that it can import the script. */
export const PageElement = globalThis.HTMLElement ?? (class {} as typeof HTMLElement);
