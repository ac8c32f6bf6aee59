// SPDX-License-Identifier: Apache-2.0
// Measures the upload paths of upload-path.ts, once the first picture is shown, with a decoded frame of the character.
import { defaultUnpack, rememberPath, uploadPicture, type UploadPath } from '../decode/upload-path.js';
import type { SessionSide } from './session-side.js';

// Maximum time of the other paths as a share of the time of 'i420', which has exact colours and reads the frame index
// without the GPU. On a GPU the others are several times as fast; in software rendering they differ by noise only.
const MAX_RGBA_SHARE = 0.5;
const RUNS = 4;

// format: of the pixels, with bytes as channels.
function makeTexture(gl: WebGL2RenderingContext, internal: number, format: number, width: number, height: number): WebGLTexture {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, gl.UNSIGNED_BYTE, null);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  return texture;
}

// Waits for the upload to end, by reading back one pixel.
function force(gl: WebGL2RenderingContext, texture: WebGLTexture): void {
  const framebuffer = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  try {
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  } finally {
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(framebuffer);
  }
}

async function timePlanes(gl: WebGL2RenderingContext, frame: VideoFrame, signal: AbortSignal): Promise<number> {
  const { width, height } = frame.visibleRect!;
  const pixels = new Uint8Array(frame.allocationSize());
  const start = performance.now();
  await frame.copyTo(pixels);
  const elapsed = performance.now() - start;
  signal.throwIfAborted(); // the session may have ended; its context is shared
  const textures = [0, 1, 1].map((s) => makeTexture(gl, gl.R8, gl.RED, width >> s, height >> s));
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

function timeWhole(gl: WebGL2RenderingContext, frame: VideoFrame | HTMLVideoElement, sub: boolean): number {
  const { width, height } = 'visibleRect' in frame ? frame.visibleRect! : { width: frame.videoWidth, height: frame.videoHeight };
  const texture = makeTexture(gl, gl.RGBA, gl.RGBA, width, height);
  const start = performance.now();
  uploadPicture(gl, texture, frame, sub);
  force(gl, texture);
  const total = performance.now() - start;
  gl.deleteTexture(texture);
  return total;
}

// Returns the best path for frames like this one, by each path's fastest run. Calls `touched` after changes of GL state.
async function measurePath(gl: WebGL2RenderingContext, frame: VideoFrame, readsPlanes: boolean, signal: AbortSignal, touched: () => void):
    Promise<UploadPath> {
  const times = { i420: Infinity, rgba: Infinity, 'rgba-sub': Infinity };
  const hasPlanes = readsPlanes && (frame.format === 'I420' || frame.format === 'NV12');
  const alignment = gl.getParameter(gl.UNPACK_ALIGNMENT) as number;
  for (let run = 0; run < RUNS; ++run) {
    if (hasPlanes) times.i420 = Math.min(times.i420, await timePlanes(gl, frame, signal));
    times.rgba = Math.min(times.rgba, timeWhole(gl, frame, false));
    times['rgba-sub'] = Math.min(times['rgba-sub'], timeWhole(gl, frame, true));
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, alignment);
    touched();
    if (run && times.i420 <= Math.min(times.rgba, times['rgba-sub'])) break; // 'i420' is the fastest anyway
  }
  const whole = times['rgba-sub'] < times.rgba ? 'rgba-sub' : 'rgba';
  return times[whole] < MAX_RGBA_SHARE * times.i420 ? whole : 'i420';
}

/** Measures the paths with a decoded frame of the main character, closes it, and settles the session on the fastest. */
export async function decidePath(session: SessionSide, frame: VideoFrame): Promise<void> {
  const { gl, path: before } = session;
  let path = before;
  try {
    path = await measurePath(gl, frame, before === 'i420', session.signal, () => session.main?.player?.invalidateState());
  } catch {
    // measurement failed: keeps the path that works
  } finally {
    frame.close();
  }
  if (session.signal.aborted || gl.isContextLost() || session.path !== before) return; // the session has changed its path meanwhile
  rememberPath(path);
  await session.settle(path);
}

/** Returns true if a <video> element's picture uploads faster into existing storage than into new. Changes GL state. */
export function isSubFaster(gl: WebGL2RenderingContext, video: HTMLVideoElement): boolean {
  const alignment = gl.getParameter(gl.UNPACK_ALIGNMENT) as number;
  try {
    const [whole, sub] = [false, true].map((into) => Math.min(timeWhole(gl, video, into), timeWhole(gl, video, into)));
    return sub! < whole!;
  } catch {
    return false; // measurement failed
  } finally {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, alignment);
  }
}

// --- reading back ---

const KNOWN = Uint8Array.of(255, 0, 0, 255, 0, 255, 0, 255, 255, 255, 0, 255, 0, 0, 255, 255); // four pixels
const MAX_OFF = 64; // tolerance: some browsers change the lowest bits, which is harmless
const readable = new WeakMap<WebGL2RenderingContext, boolean>();

/** Returns true if textures can be read back, tested with the calls that read barcodes. Restores the GL state. */
export function canReadBack(gl: WebGL2RenderingContext): boolean {
  let known = readable.get(gl);
  if (known === undefined) readable.set(gl, (known = readsKnown(gl)));
  return known;
}

function readsKnown(gl: WebGL2RenderingContext): boolean {
  const width = KNOWN.length / 4, pixels = new Uint8Array(KNOWN.length);
  const names = [gl.TEXTURE_BINDING_2D, gl.FRAMEBUFFER_BINDING, gl.PIXEL_PACK_BUFFER_BINDING, gl.UNPACK_ALIGNMENT];
  const [oldTexture, oldFramebuffer, oldBuffer, alignment] = names.map((name) => gl.getParameter(name));
  const texture = gl.createTexture(), framebuffer = gl.createFramebuffer(), buffer = gl.createBuffer();
  try {
    defaultUnpack(gl);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, 1, gl.RGBA, gl.UNSIGNED_BYTE, KNOWN);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, pixels.length, gl.STREAM_READ);
    gl.readPixels(0, 0, width, 1, gl.RGBA, gl.UNSIGNED_BYTE, 0);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, pixels);
    return pixels.every((value, i) => Math.abs(value - KNOWN[i]!) <= MAX_OFF);
  } catch {
    return false;
  } finally {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, alignment);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, oldBuffer);
    gl.bindFramebuffer(gl.FRAMEBUFFER, oldFramebuffer);
    gl.bindTexture(gl.TEXTURE_2D, oldTexture);
    gl.deleteBuffer(buffer);
    gl.deleteFramebuffer(framebuffer);
    gl.deleteTexture(texture);
  }
}
