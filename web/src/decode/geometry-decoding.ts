// SPDX-License-Identifier: Apache-2.0
// Decodes the geometry of layered characters in a worker, one for all viewers of a page. After each tick a player lists
// the GOPs that it needs; decoded frames are handed to it before a later tick. Without a worker (forbidden by a policy,
// failed or unresponsive) the players decode in slices on the main thread. Part of fourdvt-more.js.
import type { PlayerFiles } from '../wasm/files.js';
import { readDecodeJob, readGeometryMesh } from '../wasm/generated/abi.js';
import type { TurnHook, WasmModule } from '../wasm/wasm-abi.js';
import type { FromWorker, ToWorker, WantedJob } from './geometry-messages.js';

const SILENCE_MS = 2000; // timeout of an awaited frame, in time of turns
const LONGEST_TURN_MS = 100; // a longer turn counts as this towards the timeout: the page was suspended
const ASLEEP_MS = 250; // without a turn for as long, a frame wakes the frame loop

/** Owner of a player and its frame loop; holds one hook. */
export interface Turning {
  setHook(hook: TurnHook): void;
  wake(): void;
}

type Files = Pick<PlayerFiles, 'worker' | 'workerWasm'>;
type Frame = Extract<FromWorker, { kind: 'frame' }>;

interface TrustedTypes {
  createPolicy(name: string, rules: { createScriptURL(url: string): string }): { createScriptURL(url: string): string };
}
let policy: ReturnType<TrustedTypes['createPolicy']> | undefined;

// Converts the address of the worker's script, or of its copy, for pages that require trusted types. Their policy must
// allow the name `fourdvt`, which only this file uses.
function trusted(script: string): string {
  const { trustedTypes } = globalThis as { trustedTypes?: TrustedTypes };
  try {
    policy ??= trustedTypes?.createPolicy('fourdvt', { createScriptURL: (url) => url });
  } catch {
    return script; // the name is not allowed; the page may not require trusted types, though
  }
  return policy?.createScriptURL(script) ?? script;
}

class GeometryWorker {
  readonly #files: Files;
  readonly #opening = new AbortController(); // aborted once the worker is ready or has failed
  readonly #joined = new Map<number, Joined>();
  #worker: Worker | null = null;
  #last = 0;
  ready = false;
  failed = false;

  constructor(files: Files) {
    this.#files = files;
    const script = new URL(files.worker);
    document.addEventListener('securitypolicyviolation', ({ effectiveDirective, blockedURI }) => {
      if (effectiveDirective === 'worker-src' && (blockedURI.startsWith('blob') || blockedURI === script.href)) this.fail(`the page's policy forbids it: allow ${blockedURI} in worker-src`);
    }, { signal: this.#opening.signal });
    if (script.origin === globalThis.origin) this.#open(script.href, () => this.#openCopy());
    else void this.#openCopy();
  }

  #open(script: string, onUnloaded: () => void): void {
    try {
      this.#worker = new Worker(trusted(script));
    } catch (reason) {
      return this.fail(String(reason));
    }
    this.#worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.#take(data);
    this.#worker.onerror = (event) => {
      event.preventDefault();
      if (event.message) this.fail(event.message);
      else setTimeout(onUnloaded); // after the task in which the browser reports a policy violation
    };
    this.post({ kind: 'start', wasm: this.#files.workerWasm });
  }
  // Opens a copy of the script, for a script of another origin, or one without the header that a cross-origin isolated
  // page requires.
  async #openCopy(): Promise<void> {
    const { worker } = this.#files;
    try {
      const answer = this.failed ? null : await fetch(worker);
      if (!answer) return;
      if (!answer.ok) throw new Error(`${worker}: ${answer.status}`);
      const copy = URL.createObjectURL(new Blob([await answer.text()], { type: 'text/javascript' }));
      setTimeout(() => URL.revokeObjectURL(copy), 60_000);
      this.#open(copy, () => this.fail('it does not load'));
    } catch (reason) {
      this.fail(String(reason));
    }
  }

  post(message: ToWorker, transfer: Transferable[] = []): void { this.#worker?.postMessage(message, transfer); }

  join(actor: Turning): void {
    const joined = new Joined(this, ++this.#last, actor);
    this.#joined.set(this.#last, joined);
    actor.setHook(joined);
  }
  drop(number: number): void { this.#joined.delete(number); }

  fail(reason: string): void {
    if (this.failed) return;
    this.failed = true;
    this.#opening.abort();
    this.#worker?.terminate();
    console.warn(`fourdvt-viewer: geometry is decoded without a worker (${reason})`);
  }

  #take(message: FromWorker): void {
    if (message.kind === 'ready' && message.stamp === FOURDVT_WORKER) {
      this.ready = true;
      this.#opening.abort();
    } else if (message.kind === 'ready') this.fail('fourdvt-worker.js is of another build: upload all files of the player again');
    else if (message.kind === 'failed') this.fail(message.reason);
    else this.#joined.get(message.character)?.take(message);
  }
}

// Hook of one character: passes its jobs to the worker, and decoded frames to its player.
class Joined implements TurnHook {
  readonly #worker: GeometryWorker;
  readonly #number: number;
  readonly #actor: Turning;
  #on = false;
  readonly #frames: Frame[] = []; // decoded, not handed to the player yet
  #posted = new Map<number, number>(); // number of wanted frames, by job
  readonly #next = new Map<number, number>(); // next frame from the worker, by job
  #turnMs = 0; // time of the last turn
  #silentMs = 0;

  constructor(worker: GeometryWorker, number: number, actor: Turning) {
    this.#worker = worker;
    this.#number = number;
    this.#actor = actor;
  }

  take(frame: Frame): void {
    this.#silentMs = 0;
    this.#next.set(frame.job, frame.data.byteLength ? frame.frame + 1 : Infinity);
    this.#frames.push(frame);
    if (performance.now() - this.#turnMs > ASLEEP_MS) this.#actor.wake();
  }

  beforeTick(module: WasmModule, handle: number): void {
    if (!this.#worker.failed && this.#worker.ready) this.#on ||= this.#begin(module, handle);
    if (!this.#on) return;
    for (const { job, frame, data, seconds } of this.#frames.splice(0)) {
      const at = module._fdvt_alloc(data.byteLength || 1);
      module.HEAPU8.set(new Uint8Array(data), at);
      module._fdvt_frame_decoded(handle, job, frame, at, data.byteLength, seconds);
      module._fdvt_free(at);
    }
    if (!this.#worker.failed) return;
    this.#on = false;
    module._fdvt_decode_elsewhere(handle, 0);
  }

  afterTick(module: WasmModule, handle: number): void {
    this.#listen();
    if (!this.#on || this.#worker.failed) return;
    const jobs: WantedJob[] = [], transfer: Transferable[] = [];
    for (let at = module._fdvt_decode_job(handle, 0); at; at = module._fdvt_decode_job(handle, jobs.length)) {
      const { id, wanted, chunk, ...layout } = readDecodeJob(module.HEAPU8, at);
      const bytes = this.#posted.has(id) ? null : (chunk.slice().buffer as ArrayBuffer);
      jobs.push(bytes ? { id, wanted, opening: { ...layout, chunk: bytes } } : { id, wanted });
      if (bytes) transfer.push(bytes);
    }
    const posted = new Map(jobs.map(({ id, wanted }) => [id, wanted]));
    const same = posted.size === this.#posted.size && [...posted].every(([id, wanted]) => this.#posted.get(id) === wanted);
    if (same) return;
    for (const id of this.#posted.keys()) if (!posted.has(id)) this.#next.delete(id);
    this.#posted = posted;
    this.#worker.post({ kind: 'wanted', character: this.#number, jobs }, transfer);
  }

  leave(): void {
    this.#worker.drop(this.#number);
    if (this.#on && !this.#worker.failed) this.#worker.post({ kind: 'leave', character: this.#number });
  }

  // Posts the mesh and turns the player's own decoding off; false while the player has no mesh.
  #begin(module: WasmModule, handle: number): boolean {
    const at = module._fdvt_geometry_mesh(handle);
    if (!at) return false;
    const mesh = readGeometryMesh(module.HEAPU8, at);
    const [faces, base] = [mesh.faces.slice().buffer as ArrayBuffer, mesh.base.slice().buffer as ArrayBuffer];
    this.#worker.post({ kind: 'mesh', character: this.#number, faces, base }, [faces, base]);
    module._fdvt_decode_elsewhere(handle, 1);
    return true;
  }

  // Adds up the time for which an awaited frame has not come; after the timeout the worker counts as failed.
  #listen(): void {
    const nowMs = performance.now();
    const awaited = [...this.#posted].some(([id, wanted]) => (this.#next.get(id) ?? 0) < wanted);
    if (awaited) this.#silentMs += Math.min(nowMs - this.#turnMs, LONGEST_TURN_MS);
    else this.#silentMs = 0;
    this.#turnMs = nowMs;
    if (this.#silentMs > SILENCE_MS) this.#worker.fail(`it has been silent for ${SILENCE_MS / 1000} s`);
  }
}

let worker: GeometryWorker | undefined;

/** Decodes the actor's geometry in the page's worker from now on, unless that has failed. */
export function decodeBeside(actor: Turning, files: Files): void {
  worker ??= new GeometryWorker(files);
  if (!worker.failed) worker.join(actor);
}
