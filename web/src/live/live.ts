// SPDX-License-Identifier: Apache-2.0
// A live stream over a WebSocket (native/package/FORMAT.md, "A live stream"): passes manifest and frames to the player,
// measures the offset of the server's clock, and reconnects after losses. Replaces a session's Transport; there are no
// files. Does not decode or draw anything. Part of fourdvt-more.js.
import type { SessionSide, SideActor } from '../more/session-side.js';
import { viewOf } from '../page/documents.js';
import { PICTURE_KINDS, type PictureKind } from '../wasm/generated/abi.js';
import type { WasmModule } from '../wasm/wasm-abi.js';

/** connecting: no frame has come yet; stalled: the connection is lost, or no frame has come for 1.5 s. */
export type LiveState = 'connecting' | 'live' | 'stalled';

const STALL_MS = 1500;      // without a frame: the state is `stalled`
const SILENCE_MS = 10_000;  // without a message: the connection counts as lost
const WATCH_MS = 500;
const PING_MS = 5000;
const HIDDEN_MS = 10_000;   // a page hidden for longer closes the connection
const FIRST_PAUSE_MS = 250;
const LONGEST_PAUSE_MS = 4000;
const PATIENCE = 7;         // failed attempts before an error is reported, if none has ever succeeded
const MAX_BYTES = 2 ** 23; // per message
const MAX_INVALID = 5;     // connections with an invalid message, without a valid one between
const GOOD_FRAMES = 25;     // frames on one connection after which it counts as valid
const MAX_EARLY = 8;       // frames that wait for the player
const MAX_PONGS = 12;      // latest pongs kept; the clock's offset is the quickest one's
const SLOTS = 4;            // decoded pictures
const CLOSED = { token: 4401, origin: 4403 };

type PlayerCall = (module: WasmModule, handle: number) => number;
interface Box {
  min: [number, number, number];
  max: [number, number, number];
}
interface Manifest {
  extensions?: { FOURDVT_layered_video_texture?: { live?: { session?: unknown } } };
}

/** Members of the character's actor that this file uses. */
export interface LiveActor {
  run(action: (player: { call(action: PlayerCall): void }) => void): unknown;
  readonly player: { call(action: PlayerCall): void } | null;
}

export interface LiveHost {
  actor(): LiveActor | null;
  emit(name: string, detail?: unknown): void;
  /** Called when waiting for the network begins, and when it ends. */
  network(waiting: boolean): void;
  /** Loads another character by its manifest, in place of the present one. */
  replace(manifest: unknown): void;
  /** Ends the session with an error. */
  fail(id: string, message: string): void;
}

/** Access to the browser, which tests replace. */
export interface LivePage {
  open(url: string): WebSocket;
  now(): number; // ms
  random(): number;
  setTimeout(run: () => void, ms: number): number;
  clearTimeout(timer: number): void;
  /** Listens to `online` or `visibilitychange`. */
  listen(name: string, run: () => void, signal: AbortSignal): void;
  readonly hidden: boolean;
  readonly origin: string;
}

// LivePage of the window that shows the viewer.
const pageOf = (view: typeof globalThis): LivePage => ({
  open: (url) => new WebSocket(url),
  now: () => performance.now(),
  random: () => Math.random(),
  setTimeout: (run, ms) => globalThis.setTimeout(run, ms) as unknown as number,
  clearTimeout: (timer) => globalThis.clearTimeout(timer),
  listen(name, run, signal) {
    view.addEventListener(name, run, { signal, capture: true }); // visibilitychange bubbles up from the document
  },
  get hidden() { return view.document.hidden; },
  get origin() { return location.origin; },
});

const isLocal = (host: string): boolean => /^(localhost|127\..*|\[::1])$/.test(host);
const sessionOf = (manifest: unknown): unknown => (manifest as Manifest | null)?.extensions?.FOURDVT_layered_video_texture?.live?.session;

const feed = (bytes: Uint8Array): PlayerCall => (module, handle) => {
  const at = module._fdvt_alloc(bytes.length || 1);
  module.HEAPU8.set(bytes, at);
  const ok = module._fdvt_live_frame(handle, at, bytes.length);
  module._fdvt_free(at);
  return ok;
};

export class LiveStream {
  /** True as of a Transport that still has ranges to fetch: a live stream does not end. */
  readonly busy = true;
  readonly #url: URL;
  readonly #host: LiveHost;
  readonly #page: LivePage;
  readonly #abort = new AbortController();
  readonly #first: Promise<unknown>;
  #resolve: (manifest: unknown) => void = () => undefined;
  #socket: WebSocket | null = null;
  #state: LiveState = 'connecting';
  #manifest: unknown = undefined; // of the played character
  #greeted = false;  // the connection's manifest has come
  #met = false;      // a message has come on any connection
  #fails = 0;        // attempts since the last frame
  #invalid = 0;      // invalid messages since the last valid connection
  #good = 0;         // frames of this connection
  #reported = false; // an error has been reported since then
  #waiting = false;  // last value reported to the host
  #early: Uint8Array[] = [];
  #retry = 0;
  #watch = 0;
  #hide = 0;
  #heardMs = 0;
  #frameMs = 0;
  #pingMs = 0;
  #pongs: { tripMs: number; aheadMs: number }[] = []; // round trips, and offsets of the server's clock from the page's
  #bounds: Box | null = null;

  /** Does not connect before manifest() is called; stays connected until dispose(). */
  constructor(url: string, host: LiveHost, page: LivePage) {
    this.#url = new URL(url);
    this.#host = host;
    this.#page = page;
    this.#first = new Promise((resolve) => (this.#resolve = resolve));
  }

  get state(): LiveState { return this.#state; }

  /** Seconds from the capture of the shown frame to now, at least 0; NaN before the first pong or frame. Accurate to half
   * the shortest round trip of the latest pongs. */
  get latency(): number {
    let capturedUs = 0;
    try {
      this.#host.actor()?.player?.call((module, handle) => {
        capturedUs = module._fdvt_live_captured_us(handle);
        return 1;
      });
    } catch { /* the player has ended */ }
    const [best] = [...this.#pongs].sort((a, b) => a.tripMs - b.tripMs);
    return best && capturedUs ? Math.max(0, (this.#page.now() + best.aheadMs) / 1000 - capturedUs / 1e6) : NaN;
  }

  /** Returns the call by which a new player that has read the manifest starts to play this stream. */
  load(path: PictureKind, readable: boolean): PlayerCall {
    return (module, handle) => module._fdvt_live_load(handle, PICTURE_KINDS.indexOf(path), Number(readable), SLOTS);
  }

  /** True if the camera may stay: the last character's bounding box was nearly the same. */
  keepsCamera({ min, max }: Box): boolean {
    const before = this.#bounds;
    this.#bounds = { min, max };
    const size = Math.hypot(...max.map((high, i) => high - min[i]!));
    return !!before && [...min, ...max].every((value, i) => Math.abs(value - [...before.min, ...before.max][i]!) < 0.15 * size);
  }

  /** Returns true, and reconnects, for a player's error that the stream has caused. */
  takes({ id, message }: { id: string; message: string }): boolean {
    if (id !== 'stream-invalid') return false;
    this.#refuse(message);
    return true;
  }

  // --- interface of Transport ---

  /** Resolves to the first manifest. Never rejects: errors go to the host. */
  manifest(): Promise<unknown> {
    const { signal } = this.#abort;
    this.#page.listen('online', () => this.#connectNow(), signal);
    this.#page.listen('visibilitychange', () => this.#onVisibility(), signal);
    if (!this.#page.hidden) this.#connect();
    return this.#first;
  }
  address(uri: string): Promise<string> { return Promise.resolve(uri); }
  range(): Promise<null> { return Promise.resolve(null); }
  cancel(): void { /* nothing is fetched */ }
  cancelAll(): void { /* nothing is fetched */ }
  stopReplay(): void { /* nothing is fetched */ }
  dispose(): void {
    this.#wait(false);
    this.#abort.abort();
    this.#hang();
    this.#page.clearTimeout(this.#hide);
  }

  // --- connecting ---

  get #name(): string { return `${this.#url.origin}${this.#url.pathname}`; } // without a token in the query

  #connect(): void {
    this.#hang();
    const { protocol, hostname } = this.#url;
    if (protocol === 'ws:' && this.#page.origin.startsWith('https:') && !isLocal(hostname)) {
      return this.#end('fetch-failed', `${this.#name}: a page that comes over https cannot connect over ws; use a wss address (fourdvt live with a certificate)`);
    }
    let socket: WebSocket;
    try {
      socket = this.#page.open(this.#url.href);
    } catch (reason) {
      return this.#end('fetch-failed', `${this.#name}: the browser does not connect to it (${String(reason)}); correct the address`);
    }
    this.#socket = socket;
    socket.binaryType = 'arraybuffer';
    const ofSocket = (run: (event: MessageEvent) => void) => (event: MessageEvent): void => { if (this.#socket === socket) run(event); };
    socket.onmessage = ofSocket((event) => this.#onMessage(event.data as string | ArrayBuffer));
    socket.onclose = (event): void => { if (this.#socket === socket) this.#onClose(event.code); };
    this.#heardMs = this.#page.now();
    this.#pingMs = -Infinity;
    this.#look();
  }

  // Closes the connection and stops its timers; late events of the connection are ignored.
  #hang(): void {
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
    this.#page.clearTimeout(this.#retry);
    this.#page.clearTimeout(this.#watch);
    this.#retry = 0;
    this.#greeted = false;
    this.#good = 0;
    this.#early = [];
  }

  #connectNow(): void {
    if (this.#retry) this.#connect();
  }

  #connectLater(): void {
    if (this.#abort.signal.aborted || this.#page.hidden) return;
    const ms = Math.min(FIRST_PAUSE_MS * 2 ** this.#fails++, LONGEST_PAUSE_MS);
    this.#retry = this.#page.setTimeout(() => this.#connect(), ms * (0.5 + this.#page.random() / 2));
  }

  #onClose(code: number): void {
    if (code === CLOSED.token) return this.#end('fetch-failed', `${this.#name}: the server refuses the token; take the whole address that fourdvt live prints`);
    if (code === CLOSED.origin) return this.#end('fetch-failed', `${this.#name}: the server does not serve pages of ${this.#page.origin}; let it allow this origin`);
    this.#drop();
    if (!this.#met && this.#fails >= PATIENCE) {
      this.#report('fetch-failed', `${this.#name}: no answer; correct the address, start its server, or allow it in the page's connect-src`);
    }
    this.#connectLater();
  }

  // Closes the connection: the next one's frames do not continue those received so far.
  #drop(): void {
    this.#hang();
    this.#wait(true);
    if (this.#state === 'live') this.#become('stalled');
    this.#host.actor()?.run((player) => player.call(feed(new Uint8Array())));
  }

  #onVisibility(): void {
    this.#page.clearTimeout(this.#hide);
    this.#hide = 0;
    if (this.#page.hidden) {
      this.#hide = this.#page.setTimeout(() => this.#drop(), HIDDEN_MS);
    } else if (!this.#socket) {
      this.#connect();
    }
  }

  // Checks the timeouts every WATCH_MS while there is a connection.
  #look(): void {
    this.#watch = this.#page.setTimeout(() => this.#look(), WATCH_MS);
    const now = this.#page.now();
    if (now - this.#heardMs > SILENCE_MS) return this.#onClose(0);
    if (this.#state === 'live' && now - this.#frameMs > STALL_MS) this.#become('stalled');
    if (this.#greeted && now - this.#pingMs >= PING_MS) this.#ping(now);
  }

  // --- messages ---

  #onMessage(data: string | ArrayBuffer): void {
    this.#met = true;
    this.#heardMs = this.#page.now();
    if (typeof data === 'string') return data.length > MAX_BYTES ? this.#refuse('a message of more than 8 MiB') : this.#onText(data);
    if (data.byteLength > MAX_BYTES) this.#refuse('a message of more than 8 MiB');
    else if (!this.#greeted) this.#refuse('a frame before the manifest');
    else this.#onFrame(new Uint8Array(data));
  }

  #onText(text: string): void {
    let value: unknown;
    try {
      value = JSON.parse(text);
    } catch { /* refused below */ }
    if (typeof value !== 'object' || value === null) return this.#refuse('a message that is no JSON');
    if (this.#greeted) this.#onPong(value as { type?: unknown; t?: unknown; now?: unknown });
    else this.#onManifest(value);
  }

  #onManifest(manifest: unknown): void {
    const session = sessionOf(manifest);
    if (typeof session !== 'string') return this.#refuse('its first message is no manifest of a live stream');
    this.#greeted = true;
    const before = this.#manifest;
    this.#manifest = manifest;
    if (before === undefined) this.#resolve(manifest);
    else if (session !== sessionOf(before)) this.#host.replace(manifest);
    if (this.#greeted && !this.#abort.signal.aborted) this.#ping(this.#page.now());
  }

  #onFrame(bytes: Uint8Array): void {
    this.#frameMs = this.#heardMs;
    const actor = this.#host.actor();
    if (!actor) { // not created yet; dropping frames is safe, since the player begins at a key
      if (this.#early.push(bytes) > MAX_EARLY) this.#early = [];
      return;
    }
    for (const frame of [...this.#early.splice(0), bytes]) {
      const problem = this.#hand(actor, frame);
      if (problem) return this.#refuse(problem);
      if (!this.#greeted) return; // the player's event has closed this connection
    }
    this.#fails = 0;
    if (++this.#good === GOOD_FRAMES) {
      this.#invalid = 0;
      this.#reported = false;
    }
    this.#wait(false);
    this.#become('live');
  }

  // Passes a frame to the player; returns its error message, or an empty text.
  #hand(actor: LiveActor, frame: Uint8Array): string {
    let problem = '';
    actor.run((player) => {
      try {
        player.call(feed(frame));
      } catch (reason) {
        if (typeof (reason as { id?: unknown }).id !== 'string') throw reason; // a trap
        problem = (reason as Error).message;
      }
    });
    return problem;
  }

  #ping(now: number): void {
    this.#pingMs = now;
    if (this.#socket?.readyState === 1) this.#socket.send(JSON.stringify({ type: 'ping', t: now }));
  }

  #onPong({ type, t, now: serverUs }: { type?: unknown; t?: unknown; now?: unknown }): void {
    if (type !== 'pong' || typeof t !== 'number' || typeof serverUs !== 'number') return; // of a newer server
    const now = this.#page.now();
    if (!(t <= now)) return;
    this.#pongs.push({ tripMs: now - t, aheadMs: serverUs / 1000 - (t + now) / 2 });
    this.#pongs.splice(0, this.#pongs.length - MAX_PONGS);
  }

  // --- reports to the host ---

  // Drops the connection because of an invalid message, and reconnects: another connection may be valid.
  #refuse(problem: string): void {
    const message = `${this.#name}: ${problem.replace(/^live stream: /, '')}`;
    this.#drop();
    if (++this.#invalid >= MAX_INVALID) return this.#end('stream-invalid', `${message} (${MAX_INVALID} times in a row); update the server or this page`);
    this.#report('stream-invalid', message);
    this.#connectLater();
  }

  #report(id: string, message: string): void {
    if (!this.#reported) this.#host.emit('error', { id, message });
    this.#reported = true;
  }

  #end(id: string, message: string): void {
    this.#drop();
    this.#host.fail(id, message);
  }

  #wait(waiting: boolean): void {
    if (this.#waiting === waiting || this.#abort.signal.aborted) return;
    this.#host.network((this.#waiting = waiting));
  }

  #become(state: LiveState): void {
    if (this.#state === state) return;
    this.#state = state;
    this.#host.emit('livestatechange', state);
  }
}

/** Creates a session's stream from its options. */
export function connectLive(session: SessionSide): LiveStream {
  return new LiveStream(session.options.src, {
    actor: () => session.main as (SideActor & LiveActor) | null,
    emit: (name, detail) => session.host.emit(name, detail),
    network: session.network,
    replace: (manifest) => session.reopen(session.path, { manifest }),
    fail: (id, message) => session.end({ id, message }),
  }, pageOf(viewOf(session.host.element)));
}
