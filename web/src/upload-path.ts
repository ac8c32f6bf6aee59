// SPDX-License-Identifier: Apache-2.0
// How a decoded picture gets into a texture. 'i420' copies its planes and converts colours with the player's own
// matrix, the same on every machine; 'rgba' lets the browser upload the VideoFrame, without a copy on most GPUs. Which
// is faster is measured once per tab, with a decoded frame of the character.
import type { PictureKind } from './wasm-player.js';

export type UploadPath = PictureKind | 'auto';
const KEY = 'fourdvt-upload-path';
// 'i420' also checks the frame's number by its barcode and has exact colours, so 'rgba' must take less than this share
// of its time. On a GPU it is several times as fast; in software rendering the two differ by noise only.
const MAX_RGBA_SHARE = 0.5;
const RUNS = 4;

export function rememberedPath(): PictureKind | null {
  try {
    const value = sessionStorage.getItem(KEY);
    return value === 'i420' || value === 'rgba' ? value : null;
  } catch {
    return null;
  }
}
export function rememberPath(path: PictureKind): void {
  try {
    sessionStorage.setItem(KEY, path);
  } catch {
    return; // storage is blocked: it is measured again next time
  }
}

/** Uploads a picture into an existing RGBA8 texture of its size. Leaves it bound, and the default unpack state behind. */
export function uploadPicture(gl: WebGL2RenderingContext, texture: WebGLTexture, picture: VideoFrame | ImageBitmap): void {
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  defaultUnpack(gl);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, picture);
}

function defaultUnpack(gl: WebGL2RenderingContext): void {
  gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null);
  for (const name of [gl.UNPACK_ROW_LENGTH, gl.UNPACK_SKIP_ROWS, gl.UNPACK_SKIP_PIXELS]) gl.pixelStorei(name, 0);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
}

function makeTexture(gl: WebGL2RenderingContext, format: number, width: number, height: number): WebGLTexture {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  return texture;
}

// Waits until the texture has its pixels, by reading one of them.
function force(gl: WebGL2RenderingContext, texture: WebGLTexture): void {
  const framebuffer = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(framebuffer);
}

async function timePlanes(gl: WebGL2RenderingContext, frame: VideoFrame): Promise<number> {
  const { width, height } = frame.visibleRect!;
  const pixels = new Uint8Array(frame.allocationSize());
  const start = performance.now();
  await frame.copyTo(pixels);
  const elapsed = performance.now() - start;
  const textures = [0, 1, 1].map((s) => makeTexture(gl, gl.R8, width >> s, height >> s));
  const upload = performance.now();
  gl.activeTexture(gl.TEXTURE0);
  defaultUnpack(gl);
  textures.forEach((texture, plane) => {
    const s = plane ? 1 : 0;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width >> s, height >> s, gl.RED, gl.UNSIGNED_BYTE, pixels);
  });
  textures.forEach((texture) => force(gl, texture));
  const total = elapsed + performance.now() - upload;
  textures.forEach((texture) => gl.deleteTexture(texture));
  return total;
}

function timeVideoFrame(gl: WebGL2RenderingContext, frame: VideoFrame): number {
  const { width, height } = frame.visibleRect!;
  const texture = makeTexture(gl, gl.RGBA8, width, height);
  const start = performance.now();
  uploadPicture(gl, texture, frame);
  force(gl, texture);
  const total = performance.now() - start;
  gl.deleteTexture(texture);
  return total;
}

/** The faster path for frames like this one, by the fastest run of each. Calls `touched` after it changed GL state. */
export async function measurePath(gl: WebGL2RenderingContext, frame: VideoFrame, touched: () => void):
    Promise<PictureKind> {
  if (frame.format !== 'I420' && frame.format !== 'NV12') return 'rgba';
  let planes = Infinity;
  let whole = Infinity;
  const alignment = gl.getParameter(gl.UNPACK_ALIGNMENT) as number;
  for (let run = 0; run < RUNS; ++run) {
    planes = Math.min(planes, await timePlanes(gl, frame));
    whole = Math.min(whole, timeVideoFrame(gl, frame));
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, alignment);
    touched();
  }
  return whole < MAX_RGBA_SHARE * planes ? 'rgba' : 'i420';
}
