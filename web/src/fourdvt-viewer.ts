// SPDX-License-Identifier: Apache-2.0
// <fourdvt-viewer>, of its features, and <fourdvt-character>. Attributes and events follow <model-viewer> and the media
// element; web/README.md lists them.
import { withAppearance } from './element/appearance.js';
import { ViewerBase } from './element/base.js';
import { withCamera, type Orbit } from './element/camera.js';
import { withExtras } from './element/extras.js';
import { withLoading } from './element/loading.js';
import { withMedia, type PictureMetadata } from './element/media.js';
import { withMotion } from './element/motion.js';
import { withPlayback } from './element/playback.js';
import { withPresence } from './element/presence.js';
import type { ErrorDetail } from './report/errors.js';
import { FILES } from './wasm/files.js';
import { FourdvtCharacter } from './element/fourdvt-character.js';
import type { LiveState } from './live/live.js';
import type { Snapshot } from './session/session-host.js';
import type { ViewerStats } from './element/stats.js';
import type { UploadChoice as UploadPath } from './decode/upload-path.js';
import type { Align, ParameterInfo, Placement, RenderOptions, SceneMesh, SequenceInfo } from './player/wasm-player.js';

export { FourdvtCharacter };
export type { Align, ErrorDetail, LiveState, Orbit, ParameterInfo, PictureMetadata, Placement, RenderOptions, SceneMesh, SequenceInfo, Snapshot, UploadPath, ViewerStats };

export class FourdvtViewer extends withExtras(withAppearance(withCamera(withMotion(withMedia(withPlayback(withLoading(withPresence(ViewerBase)))))))) {
  /** Address of the player's wasm file, with the others beside it: beside the script, unless it is set before the first element loads. */
  static wasmUrl = FILES.wasm;
  /** Address of the OpenCV module, which is fetched only for align="flow-opencv"; its wasm file lies beside it. */
  static opencvUrl = FILES.opencv;
}

for (const [name, element] of Object.entries({ 'fourdvt-viewer': FourdvtViewer, 'fourdvt-character': FourdvtCharacter })) {
  if (globalThis.customElements?.get(name) === undefined) globalThis.customElements?.define(name, element); // not on a server
}

declare global {
  interface HTMLElementTagNameMap {
    'fourdvt-viewer': FourdvtViewer;
    'fourdvt-character': FourdvtCharacter;
  }
}
