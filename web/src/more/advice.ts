// SPDX-License-Identifier: Apache-2.0
// Configures a character's player once it can play: excludes renditions that the browser cannot decode smoothly, before
// they are tried; sets the time for geometry per turn, and the worker; enables prefetching of other motions. Part of
// fourdvt-more.js.
import { decodeBeside, type Turning } from '../decode/geometry-decoding.js';
import { mediaType } from '../decode/media-segments.js';
import { isFromCameras } from '../net/manifest.js';
import { isOn } from '../page/attributes.js';
import { savesData } from '../page/quality-attribute.js';
import type { PlayerFiles } from '../wasm/files.js';
import type { PlayerCall } from '../wasm/wasm-abi.js';
import type { SessionSide } from './session-side.js';

const LOW_BATTERY = 0.15; // share of the full charge
// Time for geometry per turn: a quarter of a turn at 60 Hz.
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
  judgeRendition(sequence: number, rendition: number, plays: boolean): void;
  lookAhead(atOnce: boolean): void;
  call(action: PlayerCall): void;
}
/** Runs actions on a player as long as there is one. */
export interface Advised extends Turning {
  run(action: (player: Player) => void): unknown;
}
interface Verdict {
  sequence: number;
  rendition: number;
  plays: boolean; // false: cannot be decoded; true: not smoothly
}
// Cached by manifest: a session opens several players in turn, and the browser's answers do not change.
const verdicts = new WeakMap<object, Promise<Verdict | null>[]>();

// Returns true if the browser can decode the rendition, or gives no answer.
async function canDecode({ codec, width, height }: Rendition): Promise<boolean> {
  if (typeof VideoDecoder === 'undefined') return MediaSource.isTypeSupported(mediaType(codec));
  const config = { codec, codedWidth: width, codedHeight: height };
  return (await VideoDecoder.isConfigSupported(config).catch(() => null))?.supported !== false;
}
async function isSmooth({ codec, width, height, byteLength }: Rendition, { frameCount, fps }: Sequence): Promise<boolean> {
  const video = { contentType: mediaType(codec), width, height, bitrate: Math.ceil((8 * byteLength * fps) / frameCount), framerate: fps };
  const info = await navigator.mediaCapabilities?.decodingInfo({ type: 'file', video }).catch(() => null);
  return !info?.supported || info.smooth; // unsupported as a file: no answer for its samples
}

/** Tests the renditions; each resolves to null if the browser plays it smoothly, else to its verdict. */
function findVerdicts(manifest: unknown): Promise<Verdict | null>[] {
  const { sequences = [] } = (manifest as Manifest).extensions.FOURDVT_layered_video_texture;
  return sequences.flatMap((s, sequence) => s.renditions.map(async (r, rendition) => {
    const plays = await canDecode(r);
    return plays && (await isSmooth(r, s)) ? null : { sequence, rendition, plays };
  }));
}
async function judge(manifest: unknown, advised: Advised): Promise<void> {
  let found = verdicts.get(manifest as object);
  if (!found) verdicts.set(manifest as object, (found = findVerdicts(manifest)));
  await Promise.all(found.map(async (verdict) => {
    const v = await verdict;
    if (v) advised.run((player) => player.judgeRendition(v.sequence, v.rendition, v.plays));
  }));
}
/** Applies earlier verdicts to a session's next player, before it fetches a rendition that does not play. */
export function judgeAgain({ main, manifest }: SessionSide): void {
  if (main && verdicts.has(manifest as object)) void judge(manifest, main);
}

interface Battery {
  charging: boolean;
  level: number;
}

// Selects the lowest rendition at low battery, until the element is resized. Only some browsers have the Battery API.
async function spareBattery(advised: Advised): Promise<void> {
  const battery = await (navigator as { getBattery?(): Promise<Battery> }).getBattery?.().catch(() => null);
  if (battery && !battery.charging && battery.level <= LOW_BATTERY) advised.run((player) => player.call((m, handle) => {
    m._fdvt_set_quality(handle, 0, 0);
    return 1;
  }));
}

/** Configures a player that has read `manifest`. element: the viewer of a main character; false for a companion. */
export async function advise(manifest: unknown, advised: Advised, element: Element | false, files: PlayerFiles): Promise<void> {
  advised.run((player) => player.call((m, handle) => {
    m._fdvt_allow_transitions(handle);
    return m._fdvt_slice_decoding(handle, DECODE_SLICE_S);
  }));
  if (!isFromCameras(manifest)) decodeBeside(advised, files);
  await judge(manifest, advised);
  if (!savesData()) advised.run((player) => player.lookAhead(element && isOn(element, 'motion-controls')));
  if (element && (element.getAttribute('quality') || 'auto') === 'auto') await spareBattery(advised);
}
