// SPDX-License-Identifier: Apache-2.0
// How <fourdvt-character> joins the <fourdvt-viewer> around it although neither file imports the other: it dispatches a
// bubbling event whose detail is a Companion. It leaves by an abort signal.
import type { Commands } from '../player/commands.js';

export const JOIN_EVENT = 'fourdvt-join';

export interface Companion {
  readonly commands: Commands;
  /** Address of its character.gltf; null: the viewer's. */
  readonly src: string | null;
  /** Aborted when it leaves the document or changes its source. */
  readonly left: AbortSignal;
  emit(name: string, detail?: unknown): void;
}
