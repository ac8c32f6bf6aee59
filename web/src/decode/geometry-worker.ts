// SPDX-License-Identifier: Apache-2.0
// fourdvt-worker.js: decodes geometry of a page's characters beside its main thread, one frame after the other, those
// that are wanted first before the others. Has no players: chunks come in, decoded frames go out.
import { readDecodedFrame, type WorkerExports } from '../wasm/generated/abi.js';
import type { FromWorker, Opening, ToWorker, WantedJob } from './geometry-messages.js';

// The module has no script of Emscripten's, so its functions are exported by their own names.
type Exports = {
  [Name in keyof WorkerExports as Name extends `_${infer Plain}` ? Plain : never]: WorkerExports[Name];
} & { memory: WebAssembly.Memory; _initialize(): void };

interface Scope {
  onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
}

interface Job {
  id: number;
  wanted: number;
  decoder: number; // 0: it does not decode
  chunk: number; // address of its bytes
  next: number; // frame
}

interface Character {
  mesh: number;
  jobs: Job[];
}

const scope = self as unknown as Scope;
const characters = new Map<number, Character>();
const turns = new MessageChannel();
let wasm: Exports | null = null;
let running = false;

const bytesAt = (): Uint8Array => new Uint8Array(wasm!.memory.buffer);

// A block of the module's memory, to be freed.
function put(bytes: ArrayBuffer): number {
  const at = wasm!.fdvt_worker_alloc(bytes.byteLength || 1);
  if (!at) throw new RangeError('no memory');
  bytesAt().set(new Uint8Array(bytes), at);
  return at;
}

async function start(url: string): Promise<void> {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  const nothing = (): number => 0;
  const module = await WebAssembly.compile(await answer.arrayBuffer());
  const [section] = WebAssembly.Module.customSections(module, 'fourdvt');
  if (!section || new TextDecoder().decode(section) !== FOURDVT_WORKER) throw new Error(`${url} is of another build`);
  const instance = await WebAssembly.instantiate(module, {
    env: { emscripten_notify_memory_growth: nothing },
    wasi_snapshot_preview1: { proc_exit: nothing, fd_write: nothing, fd_close: nothing, fd_seek: nothing },
  });
  wasm = instance.exports as unknown as Exports;
  wasm._initialize();
  scope.postMessage({ kind: 'ready', stamp: FOURDVT_WORKER });
}

function addMesh(character: number, faces: ArrayBuffer, base: ArrayBuffer): void {
  const [a, b] = [put(faces), put(base)];
  characters.set(character, { mesh: wasm!.fdvt_worker_mesh(a, faces.byteLength, b, base.byteLength), jobs: [] });
  wasm!.fdvt_worker_free(a);
  wasm!.fdvt_worker_free(b);
}

function open(mesh: number, { id, wanted }: WantedJob, opening: Opening): Job {
  const { chunk, frames, layers, members, references, alignments } = opening;
  const at = put(chunk);
  const decoder = wasm!.fdvt_worker_open(mesh, at, chunk.byteLength, frames, layers, members, references, alignments);
  return { id, wanted, decoder, chunk: at, next: 0 };
}
function close(job: Job): void {
  if (job.decoder) wasm!.fdvt_worker_close(job.decoder);
  wasm!.fdvt_worker_free(job.chunk);
}

function setJobs(character: Character, wanted: WantedJob[]): void {
  const before = new Map(character.jobs.map((job) => [job.id, job]));
  character.jobs = wanted.flatMap((job) => {
    const known = before.get(job.id);
    before.delete(job.id);
    if (known) return [Object.assign(known, { wanted: job.wanted })];
    return job.opening ? [open(character.mesh, job, job.opening)] : [];
  });
  before.forEach(close);
}

function leave(number: number): void {
  const character = characters.get(number);
  if (!character) return;
  character.jobs.forEach(close);
  wasm!.fdvt_worker_drop_mesh(character.mesh);
  characters.delete(number);
}

// The most urgent job of any character, before the second of any.
function nextJob(): [number, Job] | null {
  for (let rank = 0, more = true; more; ++rank) {
    more = false;
    for (const [number, { jobs }] of characters) {
      const job = jobs[rank];
      more ||= !!job;
      if (job && job.next < job.wanted) return [number, job];
    }
  }
  return null;
}

// Decodes one frame, and comes again after the messages that wait.
function turn(): void {
  const found = nextJob();
  running = !!found;
  if (!found) return;
  const [character, job] = found;
  const startMs = performance.now();
  const at = job.decoder && wasm!.fdvt_worker_next(job.decoder); // may move the memory
  const data = at ? readDecodedFrame(bytesAt(), at).data : new Uint8Array();
  const frame = data.slice().buffer as ArrayBuffer;
  const seconds = (performance.now() - startMs) / 1000;
  scope.postMessage({ kind: 'frame', character, job: job.id, frame: job.next++, data: frame, seconds }, [frame]);
  if (!data.length) job.wanted = 0;
  turns.port2.postMessage(0);
}
turns.port1.onmessage = turn;

function serve(message: ToWorker): void {
  switch (message.kind) {
    case 'start':
      start(message.wasm).catch((reason: unknown) => scope.postMessage({ kind: 'failed', reason: String(reason) }));
      break;
    case 'mesh': addMesh(message.character, message.faces, message.base); break;
    case 'leave': leave(message.character); break;
    case 'wanted': {
      const character = characters.get(message.character);
      if (character) setJobs(character, message.jobs);
      if (!running) turn();
    }
  }
}

scope.onmessage = ({ data }) => {
  try {
    serve(data);
  } catch (reason) { // a trap in wasm, or no memory
    scope.postMessage({ kind: 'failed', reason: String(reason) });
  }
};
