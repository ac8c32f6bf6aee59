// SPDX-License-Identifier: Apache-2.0
// Upload paths of decoded pictures into textures. 'i420' copies the planes and converts colours with the player's own
// matrix, the same on every machine. 'rgba' and 'rgba-sub' let the browser upload the VideoFrame, into a new storage of
// the texture or into its present one; one may be several times as fast, depending on the browser. The choice is
// measured once per tab, with a decoded frame of the character. 'video' uploads the picture of a <video> element, in
// browsers without VideoDecoder.
import { ViewerError } from '../report/errors.js';
import type { PictureKind } from '../wasm/generated/abi.js';

export type UploadPath = PictureKind | 'rgba-sub';
export type UploadChoice = UploadPath | 'auto';
const UPLOAD_PATHS: readonly unknown[] = ['i420', 'rgba', 'rgba-sub', 'video'];
const asPath = (value: string | null): UploadPath | null => (UPLOAD_PATHS.includes(value) ? (value as UploadPath) : null);
export const kindOf = (path: UploadPath): PictureKind => (path === 'rgba-sub' ? 'rgba' : path);
const KEY = 'fourdvt-upload-path';

export function rememberedPath(): UploadPath | null {
  try {
    return asPath(sessionStorage.getItem(KEY));
  } catch {
    return null;
  }
}
/** Returns the path to begin with. Errors: ViewerError 'insecure-context', 'decoder-unsupported' if there is none. */
export function choosePath(wanted: UploadChoice, live: boolean): UploadPath {
  if (typeof VideoDecoder !== 'undefined') return asPath(wanted) ?? rememberedPath() ?? 'i420';
  if (!live && ('MediaSource' in globalThis || 'ManagedMediaSource' in globalThis)) return 'video';
  if (!globalThis.isSecureContext) {
    throw new ViewerError('insecure-context', `${location.origin}: browsers decode video for pages over https (or from localhost) only; serve this page over https`);
  }
  throw new ViewerError('decoder-unsupported', 'this browser has no WebCodecs VideoDecoder: open the page in a newer one');
}

export function rememberPath(path: UploadPath): void {
  try {
    sessionStorage.setItem(KEY, path);
  } catch {
    return; // storage is blocked: the next page measures again
  }
}

/**
 * Uploads a picture into an RGBA texture. sub: into the present storage, which has the picture's size; otherwise into a
 * new one, for which the texture must be mutable. Leaves the texture bound and the unpack state at its defaults.
 */
export function uploadPicture(gl: WebGL2RenderingContext, texture: WebGLTexture,
                              picture: VideoFrame | HTMLVideoElement | ImageBitmap, sub: boolean): void {
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  defaultUnpack(gl);
  if (sub) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, picture);
  else gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, picture);
}

export function defaultUnpack(gl: WebGL2RenderingContext): void {
  gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null);
  for (const name of [gl.UNPACK_ROW_LENGTH, gl.UNPACK_SKIP_ROWS, gl.UNPACK_SKIP_PIXELS]) gl.pixelStorei(name, 0);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
}
