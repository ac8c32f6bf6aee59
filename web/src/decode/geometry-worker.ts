// SPDX-License-Identifier: Apache-2.0
// fourdvt-worker.js: decodes geometry of a page's characters off the main thread, frame by frame, the most urgent jobs
// first. Receives chunks and returns decoded frames; contains no player.
import { readDecodedFrame, type WorkerExports } from '../wasm/generated/abi.js';
import type { FromWorker, Opening, ToWorker, WantedJob } from './geometry-messages.js';

// Exports of the module, by C names: without Emscripten's script they have no underscore in front.
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
  decoder: number; // handle; 0: the chunk cannot be decoded
  chunk: number; // address of the chunk's bytes
  next: number; // frame to decode next
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

// Copies bytes into a new block of the module's memory, which the caller frees.
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

// Returns the job to go on with: the first unfinished one in rounds over all characters by rank of urgency.
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

// Decodes one frame and schedules the next turn behind waiting messages.
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
  } catch (reason) { // a trap in wasm, or out of memory
    scope.postMessage({ kind: 'failed', reason: String(reason) });
  }
};
