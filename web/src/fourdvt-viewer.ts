// SPDX-License-Identifier: Apache-2.0
// fourdvt-viewer.js: defines <fourdvt-viewer> and <fourdvt-character>.
import type { UploadChoice as UploadPath } from './decode/upload-path.js';
import { FourdvtCharacter } from './element/fourdvt-character.js';
import type { PictureMetadata } from './element/media.js';
import type { ViewerStats } from './element/stats.js';
import { FourdvtViewer, type Orbit } from './element/viewer-element.js';
import type { LiveState } from './live/live.js';
import type { Align, ParameterInfo, Placement, RenderOptions, SceneMesh, SequenceInfo } from './player/wasm-player.js';
import type { ErrorDetail } from './report/errors.js';
import type { Snapshot } from './session/session-host.js';

export { FourdvtCharacter, FourdvtViewer };
export type { Align, ErrorDetail, LiveState, Orbit, ParameterInfo, PictureMetadata, Placement, RenderOptions, SceneMesh, SequenceInfo, Snapshot, UploadPath, ViewerStats };

for (const [name, element] of Object.entries({ 'fourdvt-viewer': FourdvtViewer, 'fourdvt-character': FourdvtCharacter })) {
  if (globalThis.customElements?.get(name) === undefined) globalThis.customElements?.define(name, element); // neither exists on a server
}

declare global {
  interface HTMLElementTagNameMap {
    'fourdvt-viewer': FourdvtViewer;
    'fourdvt-character': FourdvtCharacter;
  }
}
