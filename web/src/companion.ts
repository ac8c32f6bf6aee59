// SPDX-License-Identifier: Apache-2.0
// How <fourdvt-character> comes into the <fourdvt-viewer> around it, without either knowing the other: it dispatches a
// bubbling event with a Companion, and leaves by an abort signal.
import type { Commands } from './commands.js';

export const JOIN_EVENT = 'fourdvt-join';

export interface Companion {
  readonly commands: Commands;
  /** Of its character.gltf; null: the viewer's own. */
  readonly src: string | null;
  /** Aborted when it goes away or takes another source. */
  readonly left: AbortSignal;
  emit(name: string, detail?: unknown): void;
}
