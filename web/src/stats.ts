// SPDX-License-Identifier: Apache-2.0
// Counters of a viewer, for its property `stats`.
import type { UploadPath } from './upload-path.js';
import type { PlayerState } from './wasm-player.js';

export interface ViewerStats {
  framesShown: number;
  framesLate: number;
  barcodeChecked: number;
  barcodeMismatches: number;
  bytesFetched: number;
  encodedBytesHeld: number;
  textureBytes: number;
  /** Of the picture shown, 0: the lowest. */
  rendition: number;
  uploadPath: UploadPath;
}

export function statsOf(state: PlayerState, uploadPath: UploadPath): ViewerStats {
  const { framesShown, framesLate, barcodeChecked, barcodeMismatches, bytesFetched, encodedBytesHeld, rendition } = state;
  return {
    framesShown, framesLate, barcodeChecked, barcodeMismatches, bytesFetched, encodedBytesHeld, rendition,
    textureBytes: state.liveTextureBytes, uploadPath,
  };
}
