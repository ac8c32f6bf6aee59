// SPDX-License-Identifier: Apache-2.0
// Counters of a viewer, for its property `stats`.
import type { UploadPath } from '../decode/upload-path.js';
import type { PlayerState } from '../player/wasm-player.js';

export interface ViewerStats {
  framesShown: number;
  framesLate: number;
  barcodeChecked: number;
  barcodeMismatches: number;
  bytesFetched: number;
  encodedBytesHeld: number;
  /** On the GPU, of all viewers of the page: textures, and targets with their samples. */
  textureBytes: number;
  targetBytes: number;
  /** In use in the player's memory, of all viewers of the page; 0 until its second part is there. */
  heapBytes: number;
  /** Rendition of the picture shown, 0: the lowest. */
  rendition: number;
  /** Milliseconds of decoding geometry: for one frame, mean, wherever it was; the most in one turn of the page. 0 until the player's second part is there. */
  decodeMs: number;
  longestDecodeMs: number;
  /** Frames whose geometry was decoded in the page's worker. */
  workerFrames: number;
  uploadPath: UploadPath;
}

export function statsOf(state: PlayerState, uploadPath: UploadPath): ViewerStats {
  const { framesShown, framesLate, barcodeChecked, barcodeMismatches, bytesFetched, encodedBytesHeld, rendition, decodeMs, longestDecodeMs, workerFrames } = state;
  return {
    framesShown, framesLate, barcodeChecked, barcodeMismatches, bytesFetched, encodedBytesHeld, rendition, decodeMs, longestDecodeMs, workerFrames,
    textureBytes: state.liveTextureBytes, targetBytes: state.liveTargetBytes, heapBytes: state.heapBytes, uploadPath,
  };
}
