// SPDX-License-Identifier: Apache-2.0
// Fetches files and byte ranges of files. Faults that pass are waited out, with growing pauses, for as long as somebody
// wants the bytes: no network, 5xx, 408 and 429, an answer that stalls. Faults that stay end the fetch with an error: any
// other status, a file that is too short, an address that the browser refuses, a server that does not allow this page or
// has never answered it. If a server ignores Range and answers with the whole file (200), the file is kept and cut up here.
import { ViewerError } from './errors.js';

const FIRST_PAUSE_MS = 300;
const LONGEST_PAUSE_MS = 6000;
const LONGEST_ASKED_PAUSE_MS = 60_000; // by Retry-After
const STALL_S = 10; // without a byte
const MOST_BYTES = 2 ** 25; // of a file whose length the manifest does not say
const MOST_TRIES = 7; // of a server that has never answered: about 10 s, if no request stalls

/** Hears when waiting for the network begins, and when it ends. */
export type Report = (waiting: boolean) => void;

class PassingFault extends Error {
  readonly pauseMs: number;
  constructor(pauseMs = 0) {
    super();
    this.pauseMs = pauseMs;
  }
}

// Origins that exist: any outage of theirs passes.
const answered = new Set([globalThis.location?.origin]);

// Addresses that the page's policy blocks, as the browser reports them.
const blocked = new Set<string>();
globalThis.addEventListener?.('securitypolicyviolation', (e) => {
  if (e.disposition === 'enforce') blocked.add(e.blockedURI);
});

const parse = (url: string): URL => new URL(url, globalThis.document?.baseURI);
const cannotLoad = (url: string, why: string): ViewerError => new ViewerError('fetch-failed', `${url}: ${why}`);

// Throws if the browser refuses the address itself, so that no attempt can succeed.
function checkRefused(url: string): void {
  const { protocol, username, hostname, href, hash } = parse(url);
  if (!/^https?:$/.test(protocol) || username) throw cannotLoad(url, 'browsers load https addresses without a password; correct the address');
  if (blocked.has(href.slice(0, href.length - hash.length))) throw cannotLoad(url, "the page's content-security policy blocks it; add its origin to connect-src");
  if (protocol === 'http:' && globalThis.location?.protocol === 'https:' && !/^(localhost|127\..*|\[::1])$/.test(hostname)) {
    throw cannotLoad(url, 'a page over https cannot load over http; use an https address');
  }
}

// Ends early if the browser finds a network again.
const pause = (ms: number, signal?: AbortSignal): Promise<void> =>
  new Promise((resolve) => {
    const end = (): void => {
      clearTimeout(timer);
      globalThis.removeEventListener?.('online', end);
      signal?.removeEventListener('abort', end);
      resolve();
    };
    const timer = setTimeout(end, ms);
    globalThis.addEventListener?.('online', end);
    signal?.addEventListener('abort', end);
  });

interface Watch {
  readonly signal: AbortSignal;
  heard(): void;
  end(): void;
}

// A signal that aborts at end(), with `signal`, or after STALL_S seconds without heard(). A timer counts the seconds one by one:
// a page that was busy for as long reads the bytes that came meanwhile before the count is full.
function watchForStall(signal?: AbortSignal): Watch {
  const abort = new AbortController();
  let quiet = 0;
  const end = (): void => {
    clearInterval(timer);
    signal?.removeEventListener('abort', end);
    abort.abort();
  };
  const timer = setInterval(() => ++quiet >= STALL_S && end(), 1000);
  signal?.addEventListener('abort', end);
  if (signal?.aborted) end();
  return { signal: abort.signal, heard: () => (quiet = 0), end };
}

// Half of each pause is random, so that the visitors of a server that comes back do not all ask at once.
async function patiently<T>(url: string, attempt: () => Promise<T>, report: Report, signal?: AbortSignal): Promise<T> {
  const { origin } = parse(url);
  let waiting = false, tries = 0;
  const tell = (now: boolean): void => {
    if (waiting !== now) report((waiting = now));
  };
  try {
    for (let ms = FIRST_PAUSE_MS; ; ms = Math.min(2 * ms, LONGEST_PAUSE_MS)) {
      try {
        return await attempt();
      } catch (reason) {
        if (signal?.aborted || !(reason instanceof PassingFault)) throw reason;
        if (globalThis.navigator?.onLine !== false && !answered.has(origin) && ++tries === MOST_TRIES) {
          throw cannotLoad(url, `${origin} has never answered; correct the address, or start its server`);
        }
        tell(true);
        await pause(Math.max(reason.pauseMs, ms * (0.5 + Math.random() / 2)), signal);
        if (signal?.aborted) throw reason;
      }
    }
  } finally {
    tell(false);
  }
}

interface Answer {
  status: number;
  /** Errors: PassingFault; ViewerError 'fetch-failed' if there are more than `most` bytes. */
  read(most?: number): Promise<Uint8Array<ArrayBuffer>>;
  /** The body as it comes, instead of `read`. A fault ends it, and is reported: a reader may get another error. */
  stream(report: (fault: unknown) => void): ReadableStream<Uint8Array>;
  drop(): void;
}

// One request. Errors: PassingFault; ViewerError 'fetch-failed'.
async function ask(url: string, init: RequestInit, signal?: AbortSignal): Promise<Answer> {
  const { signal: watched, heard, end } = watchForStall(signal);
  const failed = (): never => {
    end();
    throw new PassingFault();
  };
  const response = await fetch(url, { credentials: 'same-origin', ...init, signal: watched }).catch(() => null);
  if (!response) {
    if (watched.aborted) throw new PassingFault();
    end();
    await pause(0); // the browser reports what the policy blocks in a task of its own
    checkRefused(url);
    if (await refusesThisPage(url, init, signal)) {
      throw cannotLoad(url, 'the server answers, but does not allow this page to read it; let it send Access-Control-Allow-Origin, and allow the header Range');
    }
    throw new PassingFault();
  }
  answered.add(parse(url).origin);
  const { status } = response;
  if (status >= 500 || status === 429 || status === 408) {
    end();
    throw new PassingFault(Math.min(1000 * (Number(response.headers.get('Retry-After')) || 0), LONGEST_ASKED_PAUSE_MS));
  }
  if (!response.ok) {
    end();
    throw cannotLoad(url, `HTTP ${status}`);
  }
  const reader = response.body?.getReader();
  let bytes = 0, limit = MOST_BYTES;
  const next = async (): Promise<Uint8Array | undefined> => {
    const part = (await reader?.read().catch(failed))?.value;
    heard();
    if (!part) {
      end();
    } else if (!((bytes += part.length) <= limit)) {
      end();
      throw cannotLoad(url, `the server sends more than ${limit} bytes; upload the file again`);
    }
    return part;
  };
  return {
    status,
    drop: end,
    stream: (report) => new ReadableStream({
      async pull(to) {
        const part = await next().catch((fault: unknown) => {
          report(fault);
          throw fault;
        });
        if (part) to.enqueue(part);
        else to.close();
      },
    }),
    async read(most = MOST_BYTES) {
      limit = most;
      const parts: Uint8Array[] = [];
      for (let part = await next(); part; part = await next()) parts.push(part);
      return new Uint8Array(await new Blob(parts as BlobPart[]).arrayBuffer());
    },
  };
}

// A browser does not say why a request failed. If the same address answers a request whose answer nobody may read, and
// refuses the readable one again, it is the server's word and not the network.
async function refusesThisPage(url: string, init: RequestInit, signal?: AbortSignal): Promise<boolean> {
  if (parse(url).origin === globalThis.location?.origin) return false;
  const answers = (more: RequestInit): Promise<boolean> => {
    const { signal: watched, end } = watchForStall(signal);
    return fetch(url, { ...more, signal: watched }).then(() => true, () => false).finally(end); // nobody reads the body
  };
  return (await answers({ mode: 'no-cors' })) && !(await answers({ credentials: 'same-origin', ...init }));
}

/** A whole file. `report` hears when waiting for the network begins and ends. Errors: ViewerError 'fetch-failed'. */
export function fetchFile(url: string, report: Report = () => undefined, signal?: AbortSignal, init: RequestInit = {}): Promise<Uint8Array<ArrayBuffer>> {
  return patiently(url, async () => (await ask(url, init, signal)).read(), report, signal);
}

/** A wasm file, compiled while it comes. Errors: ViewerError 'fetch-failed'; the browser's, if it refuses the file. */
export function compileFile(url: string, report: Report, cache: RequestCache): Promise<WebAssembly.Module> {
  return patiently(url, async () => {
    let fault: unknown;
    const body = (await ask(url, { cache })).stream((reason) => (fault = reason));
    // The type is given here: no server needs to have it.
    const wasm = new Response(body, { headers: { 'Content-Type': 'application/wasm' } });
    return WebAssembly.compileStreaming(wasm).catch((reason: unknown) => { throw fault ?? reason; });
  }, report);
}

export class Transport {
  readonly #base: string;
  readonly #report: Report;
  readonly #init: RequestInit;
  readonly #running = new Map<number, AbortController>();
  readonly #whole = new Map<string, Promise<Uint8Array>>();
  readonly #lengths = new Map<string, number>(); // of files, in bytes, by the manifest
  readonly #abort = new AbortController();
  #waiting = 0; // fetches that wait for the network
  // The ranges of the first seconds: a second player on another upload path gets them without downloading them again.
  #replay: Map<string, Uint8Array> | null = new Map();
  bytesReceived = 0;

  /**
   * `report` hears when waiting for the network begins, and when nothing waits any more. `init`, for all requests: `cache` is
   * 'reload' to take nothing from the browser's cache, which may hold files of an earlier bake; `credentials`.
   */
  constructor(manifestUrl: string, report: Report = () => undefined, init: Pick<RequestInit, 'cache' | 'credentials'> = {}) {
    this.#base = manifestUrl;
    this.#report = report;
    this.#init = init;
  }

  /** The manifest as JSON. Errors: ViewerError 'fetch-failed', 'manifest-invalid'. */
  async manifest(): Promise<unknown> {
    const bytes = await fetchFile(this.#base, this.#count, this.#abort.signal, this.#init).catch((reason: unknown) => {
      if (reason instanceof ViewerError) throw new ViewerError(reason.id, `${reason.message}; src must name a character.gltf`);
      throw reason;
    });
    try {
      return JSON.parse(new TextDecoder().decode(bytes), (_, value) => this.#note(value)) as unknown;
    } catch (reason) {
      if (reason instanceof ViewerError) throw reason;
      throw new ViewerError('manifest-invalid', `${this.#base}: not JSON; src must name a character.gltf`);
    }
  }

  /** The bytes of the start file, whose name follows from the manifest's. None if it cannot be had at once: all can do without. */
  async start(): Promise<Uint8Array> {
    const url = this.#base.replace(/\.gltf(?=$|[?#])/, '.start.bin');
    if (url === this.#base) return new Uint8Array();
    try {
      const bytes = await (await ask(url, this.#init, this.#abort.signal)).read();
      this.bytesReceived += bytes.length;
      return bytes;
    } catch {
      return new Uint8Array();
    }
  }

  /** Another file that the character needs. Errors: ViewerError 'fetch-failed'. */
  file(url: string): Promise<Uint8Array> {
    return fetchFile(url, this.#count, this.#abort.signal, { credentials: this.#init.credentials });
  }

  /** Resolves to null if the range was cancelled. Errors: ViewerError 'fetch-failed'. */
  async range(id: number, uri: string, offset: number, bytes: number): Promise<Uint8Array | null> {
    const url = this.#locate(uri);
    const key = `${url}#${offset}+${bytes}`;
    const known = this.#replay?.get(key);
    if (known) return known;
    const abort = new AbortController();
    this.#running.set(id, abort);
    try {
      const part = await patiently(url, () => this.#fetchRange(url, offset, bytes, abort.signal), this.#count, abort.signal);
      this.#replay?.set(key, part);
      return part;
    } catch (reason) {
      if (abort.signal.aborted) return null;
      throw reason;
    } finally {
      if (this.#running.get(id) === abort) this.#running.delete(id);
    }
  }

  /** Ranges are on their way. */
  get busy(): boolean { return this.#running.size > 0; }

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
    if (this.#waiting && !this.#abort.signal.aborted) this.#report(false);
    this.#abort.abort();
    this.cancelAll();
    this.#whole.clear();
    this.#replay = null;
  }

  readonly #count = (waiting: boolean): void => {
    this.#waiting += waiting ? 1 : -1;
    if (!this.#abort.signal.aborted && this.#waiting === (waiting ? 1 : 0)) this.#report(waiting);
  };

  // The second check of a file's name, behind the manifest's reader. Escaped dots and slashes may lead out of the folder on a
  // server. Some URL parsers, that of Node 20 for one, do not resolve every "..".
  #locate(uri: string): string {
    try {
      const { href } = new URL(uri, this.#base), folder = new URL('.', this.#base).href;
      if (href.startsWith(folder) && !/\/\.\.|%(2e|2f|5c|25)/i.test(href.slice(folder.length - 1))) return href;
    } catch { /* no address */ }
    throw new ViewerError('manifest-invalid', `${this.#base}: "${uri}" is not in the character's folder; bake it again`);
  }

  // A value of the manifest: checks where it leads if it names a file, and remembers the file's length.
  #note(value: { uri?: string; byteOffset?: number; byteLength?: number } | null): unknown {
    if (value?.uri && !/^data:/.test(value.uri)) {
      const url = this.#locate(value.uri);
      this.#lengths.set(url, Math.max(this.#lengths.get(url) ?? 0, (value.byteOffset ?? 0) + (value.byteLength ?? MOST_BYTES)));
    }
    return value;
  }

  async #fetchRange(url: string, offset: number, bytes: number, signal: AbortSignal): Promise<Uint8Array> {
    let whole = this.#whole.get(url);
    if (!whole) {
      const answer = await ask(url, { ...this.#init, headers: { Range: `bytes=${offset}-${offset + bytes - 1}` } }, signal);
      if (answer.status === 206) {
        const part = await answer.read(this.#lengths.get(url));
        this.bytesReceived += part.length;
        return slice(url, part, 0, bytes);
      }
      // Several answers may bring the same file at the same time; only the first is read to its end.
      whole = this.#whole.get(url);
      if (whole) answer.drop();
      else whole = this.#keepWhole(url, answer);
    }
    return slice(url, await whole, offset, bytes);
  }

  #keepWhole(url: string, answer: Answer): Promise<Uint8Array> {
    const whole = answer.read(this.#lengths.get(url)).then((file) => {
      this.bytesReceived += file.length;
      return file;
    });
    this.#whole.set(url, whole);
    whole.catch(() => this.#whole.delete(url));
    return whole;
  }
}

function slice(url: string, from: Uint8Array, offset: number, bytes: number): Uint8Array {
  if (offset + bytes > from.length) {
    throw cannotLoad(url, `the file has less than ${offset + bytes} bytes; upload it again`);
  }
  return from.subarray(offset, offset + bytes);
}
