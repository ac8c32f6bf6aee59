// SPDX-License-Identifier: Apache-2.0
// Asks the browser which renditions of a character it can decode, and which of those smoothly, before one is tried. Part of
// fourdvt-more.js.

interface Rendition {
  codec: string;
  width: number;
  height: number;
  byteLength: number;
}
interface Sequence {
  frameCount: number;
  fps: number;
  renditions: Rendition[];
}
interface Manifest {
  extensions: { FOURDVT_layered_video_texture: { sequences: Sequence[] } };
}

/** Gets each rendition that does not play smoothly; plays: it can be decoded. */
export type Judge = (sequence: number, rendition: number, plays: boolean) => void;

// A browser that has no answer is expected to play it.
async function canDecode({ codec, width, height }: Rendition): Promise<boolean> {
  const config = { codec, codedWidth: width, codedHeight: height };
  return (await VideoDecoder.isConfigSupported(config).catch(() => null))?.supported !== false;
}
async function isSmooth({ codec, width, height, byteLength }: Rendition, { frameCount, fps }: Sequence): Promise<boolean> {
  const video = { contentType: `video/mp4; codecs="${codec}"`, width, height, bitrate: Math.ceil((8 * byteLength * fps) / frameCount), framerate: fps };
  const info = await navigator.mediaCapabilities?.decodingInfo({ type: 'file', video }).catch(() => null);
  return !info?.supported || info.smooth; // what it says of files that it does not play says nothing of their samples
}

/** manifest: one that the player has read. */
export async function judgeRenditions(manifest: unknown, judge: Judge): Promise<void> {
  const { sequences } = (manifest as Manifest).extensions.FOURDVT_layered_video_texture;
  await Promise.all(sequences.flatMap((sequence, s) => sequence.renditions.map(async (rendition, r) => {
    const plays = await canDecode(rendition);
    if (!plays || !(await isSmooth(rendition, sequence))) judge(s, r, plays);
  })));
}
