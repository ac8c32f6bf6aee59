// SPDX-License-Identifier: Apache-2.0
// Messages between a page and its worker that decodes geometry (fourdvt-worker.js). Characters are numbered by the page.
import type { DecodeJobRecord } from '../wasm/generated/abi.js';

/** A job's chunk with its layout. */
export type Opening = Omit<DecodeJobRecord, 'id' | 'wanted' | 'chunk'> & { chunk: ArrayBuffer };

export interface WantedJob {
  id: number;
  /** Number of frames wanted, from the job's first. */
  wanted: number;
  /** Present if the previous message did not list the job. */
  opening?: Opening;
}

export type ToWorker =
  | { kind: 'start'; wasm: string }
  | { kind: 'mesh'; character: number; faces: ArrayBuffer; base: ArrayBuffer }
  /** All jobs of the character, the most urgent first; jobs not listed are dropped. */
  | { kind: 'wanted'; character: number; jobs: WantedJob[] }
  | { kind: 'leave'; character: number };

export type FromWorker =
  /** stamp: the build's, must equal that of the page's script. */
  | { kind: 'ready'; stamp: string }
  | { kind: 'failed'; reason: string }
  /** data: empty if the frame cannot be decoded; then no further frame of the job follows. */
  | { kind: 'frame'; character: number; job: number; frame: number; data: ArrayBuffer; seconds: number };
