// SPDX-License-Identifier: Apache-2.0
// Messages between a page and its worker that decodes geometry (fourdvt-worker.js). Characters are numbered by the page.
import type { DecodeJobRecord } from '../wasm/generated/abi.js';

/** Layout of a job's chunk. */
export type Opening = Omit<DecodeJobRecord, 'id' | 'wanted' | 'chunk'> & { chunk: ArrayBuffer };

export interface WantedJob {
  id: number;
  /** So many of its first frames. */
  wanted: number;
  /** With the first message that names the job, since the one before did not. */
  opening?: Opening;
}

export type ToWorker =
  | { kind: 'start'; wasm: string }
  | { kind: 'mesh'; character: number; faces: ArrayBuffer; base: ArrayBuffer }
  /** All jobs of the character, the most urgent first; those that are missing are forgotten. */
  | { kind: 'wanted'; character: number; jobs: WantedJob[] }
  | { kind: 'leave'; character: number };

export type FromWorker =
  /** stamp: of the build, which the page's script must share. */
  | { kind: 'ready'; stamp: string }
  | { kind: 'failed'; reason: string }
  /** data: empty if the frame does not decode; no further one of the job follows then. */
  | { kind: 'frame'; character: number; job: number; frame: number; data: ArrayBuffer; seconds: number };
