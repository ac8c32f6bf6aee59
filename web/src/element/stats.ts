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
  /** GPU memory of all viewers of the page: textures here, render targets with their samples below. */
  textureBytes: number;
  targetBytes: number;
  /** Bytes allocated in the player's memory by all viewers of the page; 0 until the second part is loaded. */
  heapBytes: number;
  /** Rendition of the shown picture; 0: the lowest. */
  rendition: number;
  /** Mean time to decode one frame's geometry, in the page or its worker; below, the longest per turn of the page. 0 until
   * the player's second part is loaded. */
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
