// SPDX-License-Identifier: Apache-2.0
// Requests of files. Transient faults (no network, statuses 408, 425, 429 and most of 5xx, a stalled answer) are retried
// with growing pauses until the bytes have come or the request is cancelled. Permanent faults end the request with an
// error: any other status, a page in place of the file, an answer that breaks off at the same byte each time, an address
// that the browser refuses, a server that does not allow this page or has never answered.
import { cannotLoad, corsRefusal, isPage, originOf, PageFault, passes, PassingFault, rangeRefusal, refusalOf, StatusFault } from './faults.js';

const FIRST_PAUSE_MS = 300;
const LONGEST_PAUSE_MS = 6000;
const LONGEST_SERVER_PAUSE_MS = 60_000; // maximum pause that a server can set by Retry-After
const STALL_S = 10; // timeout of an answer without a new byte
export const MAX_BYTES = 2 ** 25; // limit of a file whose length is not in the manifest
const MAX_TRIES = 7; // attempts at a server that has never answered: about 10 s, if no request stalls
const PROBE_AGAIN_MS = 15_000; // pause before the next probe of a server that has not answered one
const MAX_BREAKS = 4; // times that an answer may break off at the same byte
const REDIRECTED = 'the address that it redirects to'; // for messages: browsers hide that origin

const silent = new Map<string, number>(); // times of unanswered probes, by origin
let received = 0;
/** Number of chunks that all requests of the page have received: a measure of progress. */
export const partsReceived = (): number => received;

/** Called when waiting for the network begins, and when it ends. */
export type Report = (waiting: boolean) => void;

export interface FileRequest {
  /** Address of the file, for messages. */
  url: string;
  /** Address to fetch, if not `url`. */
  address?: string;
  init?: RequestInit;
  signal?: AbortSignal | undefined;
}

export interface Answer {
  readonly status: number;
  readonly headers: Headers;
  /** Address after redirects; empty without a redirect. */
  readonly redirectedTo: string;
  /** Reads the whole body. Errors: PassingFault; PageFault; ViewerError 'fetch-failed' for more than `most` bytes. */
  read(most?: number): Promise<Uint8Array<ArrayBuffer>>;
  /** Streams the body, instead of `read`. A fault ends the stream and goes to `report`; a reader may get another error. */
  stream(report: (fault: unknown) => void): ReadableStream<Uint8Array>;
  drop(): void;
}

// Origins that have answered at least once: a failed connection to one of them is retried.
const answered = new Set([globalThis.origin]);

// Waits; ends early at the browser's event `online`.
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
  onBytes(): void;
  end(): void;
}

// Makes a signal that aborts at end(), with `signal`, or after STALL_S seconds without onBytes(). Counts the seconds one by
// one, so that a page that was suspended can read received bytes before the timeout.
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
  return { signal: abort.signal, onBytes: () => (quiet = 0), end };
}

/** Repeats an attempt after transient faults. Half of each pause is random, to spread the load on a restarted server. */
export async function patiently<T>(url: string, attempt: () => Promise<T>, report: Report, signal?: AbortSignal): Promise<T> {
  let waiting = false, tries = 0, breaks = 0, brokeAtBytes = NaN;
  const setWaiting = (now: boolean): void => {
    if (waiting !== now) report((waiting = now));
  };
  // Throws if a transient fault has repeated too often for this request.
  const check = (fault: PassingFault): void => {
    if (globalThis.navigator?.onLine === false) return;
    if (!answered.has(fault.origin) && ++tries === MAX_TRIES) {
      const hint = globalThis.crossOriginIsolated ? ', or does not allow this page (Access-Control-Allow-Origin)' : '';
      throw cannotLoad(url, `${fault.origin} has never answered${hint}; correct the address, or start its server`);
    }
    breaks = fault.brokeAtBytes === brokeAtBytes ? breaks + 1 : 1;
    ({ brokeAtBytes } = fault);
    if (breaks === MAX_BREAKS) {
      throw cannotLoad(url, `the answer breaks off after ${brokeAtBytes} bytes each time; let the server send the file's true Content-Length, and no Content-Encoding that it does not have`);
    }
  };
  try {
    for (let ms = FIRST_PAUSE_MS; ; ms = Math.min(2 * ms, LONGEST_PAUSE_MS)) {
      try {
        return await attempt();
      } catch (reason) {
        if (signal?.aborted || !(reason instanceof PassingFault)) throw reason;
        check(reason);
        setWaiting(true);
        await pause(Math.max(reason.pauseMs, ms * (0.5 + Math.random() / 2)), signal);
        if (signal?.aborted) throw reason;
      }
    }
  } finally {
    setWaiting(false);
  }
}

/** Makes one attempt. Errors: PassingFault; ViewerError 'fetch-failed'. */
export async function request({ url, address = url, init = {}, signal }: FileRequest): Promise<Answer> {
  const { signal: watched, onBytes, end } = watchForStall(signal), origin = originOf(address);
  const response = await fetch(address, { credentials: 'same-origin', ...init, signal: watched }).catch(() => null);
  if (!response) {
    const stalled = watched.aborted;
    end();
    throw stalled ? new PassingFault(origin) : await faultOf({ url, address, init, signal });
  }
  const { status, headers } = response;
  answered.add(origin);
  if (response.redirected) answered.add(REDIRECTED);
  if (!response.ok) {
    end();
    if (!passes(status)) throw new StatusFault(url, status);
    throw new PassingFault(origin, { pauseMs: Math.min(1000 * (Number(headers.get('Retry-After')) || 0), LONGEST_SERVER_PAUSE_MS) });
  }
  const reader = response.body?.getReader();
  let bytes = 0, limit = MAX_BYTES;
  const broken = (): never => {
    const stalled = watched.aborted;
    end();
    throw new PassingFault(origin, stalled ? {} : { brokeAtBytes: bytes });
  };
  const check = (length: number): void => {
    if (length <= limit) return;
    end();
    throw cannotLoad(url, `the server sends more than ${limit} bytes; upload the file again`);
  };
  const next = async (): Promise<Uint8Array | undefined> => {
    const part = (await reader?.read().catch(broken))?.value;
    onBytes();
    ++received;
    if (!part) {
      end();
      return part;
    }
    if (bytes === 0 && isPage(part)) {
      end();
      throw new PageFault(url);
    }
    check(bytes += part.length);
    return part;
  };
  return {
    status,
    headers,
    redirectedTo: response.redirected ? response.url : '',
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
    async read(most = MAX_BYTES) {
      limit = most;
      if (!headers.has('Content-Encoding')) check(Number(headers.get('Content-Length')));
      const parts: Uint8Array[] = [];
      for (let part = await next(); part; part = await next()) parts.push(part);
      return new Uint8Array(await new Blob(parts as BlobPart[]).arrayBuffer());
    },
  };
}

// Determines the cause of a failed request, which browsers do not report, by probes: if the address answers a request of
// the whole file, or one with an opaque answer, but this request fails again, the server does not allow it. Exception: the
// page's own origin needs no permission, but may redirect to one that does.
async function faultOf({ url, address = url, init = {}, signal }: FileRequest): Promise<Error> {
  await pause(0); // until the browser has reported a policy violation
  const refusal = refusalOf(address), origin = originOf(address), isOwn = origin === globalThis.origin;
  if (refusal) return cannotLoad(url, refusal);
  const probe = (more: RequestInit): Promise<Response | null> => {
    const { signal: watched, end } = watchForStall(signal);
    return fetch(address, { credentials: 'same-origin', ...more, signal: watched }).catch(() => null).finally(end); // the body is not read
  };
  const whole = { ...init, headers: {} }, hasRange = new Headers(init.headers).has('Range');
  const away = (): Error => {
    silent.set(origin, performance.now());
    return new PassingFault(origin);
  };
  if (performance.now() - (silent.get(origin) ?? -Infinity) < PROBE_AGAIN_MS) return new PassingFault(origin);
  if (isOwn) {
    const answer = await probe({ ...whole, redirect: 'manual' });
    if (!answer) return away();
    if (answer.type !== 'opaqueredirect') return hasRange && !(await probe(init)) ? cannotLoad(url, rangeRefusal(isOwn)) : new PassingFault(origin);
  } else if (hasRange && (await probe(whole)) && !(await probe(init))) {
    return cannotLoad(url, rangeRefusal(isOwn));
  }
  if (!(await probe({ mode: 'no-cors' }))) return isOwn ? new PassingFault(REDIRECTED) : away();
  return (await probe(init)) ? new PassingFault(isOwn ? REDIRECTED : origin) : cannotLoad(url, corsRefusal(init.credentials));
}

/** Fetches a whole file. Errors: ViewerError 'fetch-failed'. */
export function fetchFile(url: string, report: Report = () => undefined, signal?: AbortSignal, init: RequestInit = {}): Promise<Uint8Array<ArrayBuffer>> {
  return patiently(url, async () => (await request({ url, init, signal })).read(), report, signal);
}

/** Compiles a wasm file while it is received. Errors: ViewerError 'fetch-failed'; the browser's if it refuses the file. */
export function compileFile(url: string, report: Report, cache: RequestCache): Promise<WebAssembly.Module> {
  return patiently(url, async () => {
    let fault: unknown;
    const body = (await request({ url, init: { cache } })).stream((reason) => (fault = reason));
    // Sets the type that compileStreaming requires, in case the server does not.
    const wasm = new Response(body, { headers: { 'Content-Type': 'application/wasm' } });
    return WebAssembly.compileStreaming(wasm).catch((reason: unknown) => { throw fault ?? reason; });
  }, report);
}
