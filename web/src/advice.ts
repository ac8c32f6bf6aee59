// SPDX-License-Identifier: Apache-2.0
// Advice for a character's player once it can play: which renditions the browser can decode, and which of those smoothly,
// before one is tried; how long a turn may take to decode geometry, and that a worker decodes it; and whether other motions are near. Part of
// fourdvt-more.js.
import type { PlayerFiles } from './files.js';
import { decodeBeside, type Turning } from './geometry-decoding.js';
import { isFromCameras } from './manifest.js';
import { mediaType } from './media-segments.js';
import { savesData, type Quality } from './quality-attribute.js';
import type { TellPlayer } from './wasm-abi.js';

const LOW_BATTERY = 0.15; // of its charge
// A quarter of a turn at 60 Hz.
const DECODE_SLICE_S = 0.004;

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
  extensions: { FOURDVT_layered_video_texture: { sequences?: Sequence[] } }; // a live stream has none
}

interface Player {
  setQuality(quality: Quality): void;
  judgeRendition(sequence: number, rendition: number, plays: boolean): void;
  lookAhead(atOnce: boolean): void;
  tell(action: TellPlayer): void;
}
/** Runs actions on a player as long as there is one. */
export interface Advised extends Turning {
  run(action: (player: Player) => void): unknown;
}

// A browser that has no answer is expected to play it.
async function canDecode({ codec, width, height }: Rendition): Promise<boolean> {
  if (typeof VideoDecoder === 'undefined') return MediaSource.isTypeSupported(mediaType(codec));
  const config = { codec, codedWidth: width, codedHeight: height };
  return (await VideoDecoder.isConfigSupported(config).catch(() => null))?.supported !== false;
}
async function isSmooth({ codec, width, height, byteLength }: Rendition, { frameCount, fps }: Sequence): Promise<boolean> {
  const video = { contentType: mediaType(codec), width, height, bitrate: Math.ceil((8 * byteLength * fps) / frameCount), framerate: fps };
  const info = await navigator.mediaCapabilities?.decodingInfo({ type: 'file', video }).catch(() => null);
  return !info?.supported || info.smooth; // what it says of files that it does not play says nothing of their samples
}

interface Battery {
  charging: boolean;
  level: number;
}

// A battery that runs low gets the lowest rendition, until the element is resized. Only some browsers have its state.
async function spareBattery(advised: Advised): Promise<void> {
  const battery = await (navigator as { getBattery?(): Promise<Battery> }).getBattery?.().catch(() => null);
  if (battery && !battery.charging && battery.level <= LOW_BATTERY) advised.run((player) => player.setQuality({ rendition: 0, mostTexels: 0 }));
}

/** manifest: one that the player has read; element: the viewer, if its keys and buttons are for this character. */
export async function advise(manifest: unknown, advised: Advised, element: Element | false, files: PlayerFiles): Promise<void> {
  advised.run((player) => player.tell((m, handle) => {
    m._fdvt_allow_transitions(handle);
    return m._fdvt_slice_decoding(handle, DECODE_SLICE_S);
  }));
  if (!isFromCameras(manifest)) decodeBeside(advised, files);
  const { sequences = [] } = (manifest as Manifest).extensions.FOURDVT_layered_video_texture;
  await Promise.all(sequences.flatMap((sequence, s) => sequence.renditions.map(async (rendition, r) => {
    const plays = await canDecode(rendition);
    if (!plays || !(await isSmooth(rendition, sequence))) advised.run((player) => player.judgeRendition(s, r, plays));
  })));
  if (!savesData()) advised.run((player) => player.lookAhead(element && element.hasAttribute('motion-controls')));
  if (element && (element.getAttribute('quality') || 'auto') === 'auto') await spareBattery(advised);
}
