// SPDX-License-Identifier: Apache-2.0
// Interface by which a <fourdvt-character> joins the <fourdvt-viewer> around it without imports of each other: the
// character dispatches a bubbling event whose detail is a Companion, and leaves by an abort signal.
import type { Commands } from '../player/commands.js';

export const JOIN_EVENT = 'fourdvt-join';

export interface Companion {
  readonly commands: Commands;
  /** Address of its character.gltf; null: the viewer's. */
  readonly src: string | null;
  /** Aborted when the character leaves the document or changes its source. */
  readonly left: AbortSignal;
  emit(name: string, detail?: unknown): void;
}
