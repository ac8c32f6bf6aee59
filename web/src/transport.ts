// SPDX-License-Identifier: Apache-2.0
// Fetches byte ranges of files. If a server ignores Range and answers with the whole file (200), the file is kept and
// cut up here. Transient failures are tried again twice.
import { ViewerError } from './errors.js';

const RETRY_DELAYS_MS = [250, 1000];
const wait = (ms: number, signal: AbortSignal): Promise<void> =>
  new Promise((resolve) => {
    const timer = setTimeout(resolve, ms);
    signal.addEventListener('abort', () => (clearTimeout(timer), resolve()), { once: true });
  });

export class Transport {
  readonly #base: string;
  readonly #running = new Map<number, AbortController>();
  readonly #whole = new Map<string, Promise<Uint8Array>>();
  // The ranges of the first seconds: a second player on another upload path gets them without downloading them again.
  #replay: Map<string, Uint8Array> | null = new Map();
  bytesReceived = 0;

  constructor(manifestUrl: string) {
    this.#base = manifestUrl;
  }

  /** Resolves to null if the range was cancelled. Errors: ViewerError 'fetch-failed'. */
  async range(id: number, uri: string, offset: number, bytes: number): Promise<Uint8Array | null> {
    const url = new URL(uri, this.#base).href;
    const key = `${url}#${offset}+${bytes}`;
    const known = this.#replay?.get(key);
    if (known) return known;
    const abort = new AbortController();
    this.#running.set(id, abort);
    try {
      const part = await this.#withRetries(url, offset, bytes, abort.signal);
      this.#replay?.set(key, part);
      return part;
    } catch (reason) {
      if (abort.signal.aborted) return null;
      throw reason;
    } finally {
      if (this.#running.get(id) === abort) this.#running.delete(id);
    }
  }

  cancel(id: number): void {
    this.#running.get(id)?.abort();
  }
  cancelAll(): void {
    for (const abort of this.#running.values()) abort.abort();
  }
  /** Keeps no more ranges for a second player: the upload path is decided. */
  stopReplay(): void {
    this.#replay = null;
  }
  dispose(): void {
    this.cancelAll();
    this.#whole.clear();
    this.#replay = null;
  }

  async #withRetries(url: string, offset: number, bytes: number, signal: AbortSignal): Promise<Uint8Array> {
    for (let attempt = 0; ; ++attempt) {
      try {
        return await this.#fetchRange(url, offset, bytes, signal);
      } catch (reason) {
        const delay = RETRY_DELAYS_MS[attempt];
        if (signal.aborted || delay === undefined || reason instanceof ViewerError) {
          throw reason instanceof ViewerError ? reason : new ViewerError('fetch-failed', `${url}: network error`);
        }
        await wait(delay, signal);
      }
    }
  }

  async #fetchRange(url: string, offset: number, bytes: number, signal: AbortSignal): Promise<Uint8Array> {
    const whole = this.#whole.get(url);
    if (whole) return slice(url, await whole, offset, bytes);
    const headers = { Range: `bytes=${offset}-${offset + bytes - 1}` };
    const response = await fetch(url, { headers, signal, credentials: 'same-origin' });
    if (response.status >= 500 || response.status === 429) throw new Error(`HTTP ${response.status}`);
    if (!response.ok) throw new ViewerError('fetch-failed', `${url}: HTTP ${response.status}`);
    if (response.status === 206) {
      const part = new Uint8Array(await response.arrayBuffer());
      this.bytesReceived += part.length;
      return slice(url, part, 0, bytes);
    }
    return this.#keepWhole(url, response, offset, bytes);
  }

  // Several answers may bring the same file at the same time; only the first is read to its end.
  async #keepWhole(url: string, response: Response, offset: number, bytes: number): Promise<Uint8Array> {
    let whole = this.#whole.get(url);
    if (whole) {
      await response.body?.cancel();
    } else {
      whole = response.arrayBuffer().then((buffer) => {
        this.bytesReceived += buffer.byteLength;
        return new Uint8Array(buffer);
      });
      this.#whole.set(url, whole);
      whole.catch(() => this.#whole.delete(url));
    }
    return slice(url, await whole, offset, bytes);
  }
}

function slice(url: string, from: Uint8Array, offset: number, bytes: number): Uint8Array {
  if (offset + bytes > from.length) {
    throw new ViewerError('fetch-failed', `${url}: the file has less than ${offset + bytes} bytes; upload it again`);
  }
  return from.subarray(offset, offset + bytes);
}

/** Fetches the manifest as JSON. Errors: ViewerError 'fetch-failed', 'manifest-invalid'. */
export async function fetchManifest(url: string, signal: AbortSignal): Promise<unknown> {
  const response = await fetch(url, { signal, credentials: 'same-origin' }).catch(() => null);
  if (!response?.ok) {
    throw new ViewerError('fetch-failed', `${url}: ${response ? `HTTP ${response.status}` : 'network error'}; src must name a character.gltf`);
  }
  const text = await response.text();
  try {
    return JSON.parse(text) as unknown;
  } catch {
    throw new ViewerError('manifest-invalid', `${url}: not JSON; src must name a character.gltf`);
  }
}
