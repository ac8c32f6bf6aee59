// SPDX-License-Identifier: Apache-2.0
// Reads the sound of a motion from a manifest (native/package/FORMAT.md, "Sound"). Part of fourdvt-more.js.
import { extensionOf } from '../net/manifest.js';

const MAX_SEGMENTS = 65_536, MAX_BYTES = 2 ** 24, MAX_SEGMENT_S = 60, MIN_SEGMENT_S = 0.5;

/** Byte range of one segment, a sound file by itself, in the file of an encoding. */
export interface SoundSegment {
  offset: number; // bytes
  bytes: number;
  /** Duration without the encoder's priming. */
  durationS: number;
}
export interface SoundEncoding {
  uri: string;
  /** MIME type with its codec. */
  type: string;
  primingS: number;
  segments: SoundSegment[];
}
export interface SoundTrack {
  /** Distance between the beginnings of segments, seconds. */
  segmentS: number;
  encodings: SoundEncoding[];
  /** For a class of motions, phases of footfalls in 0..1, at which the sound plays; null: it plays all the time. */
  steps: number[] | null;
}

const isNumber = (value: unknown, low: number, high: number): value is number => typeof value === 'number' && value >= low && value <= high;

function readEncoding(given: Record<string, unknown>, rate: number): SoundEncoding {
  const { uri, type, priming, segments } = given;
  if (typeof uri !== 'string' || typeof type !== 'string' || !isNumber(priming, 0, 65_536)) throw new TypeError('an encoding needs uri, type and priming');
  if (!Array.isArray(segments) || segments.length < 1 || segments.length > MAX_SEGMENTS) throw new TypeError('segments must be a list');
  let offset = 0;
  const list = (segments as unknown[]).map((pair) => {
    const [bytes, samples] = Array.isArray(pair) ? pair as unknown[] : [];
    if (!isNumber(bytes, 1, MAX_BYTES) || !isNumber(samples, 1, MAX_BYTES)) throw new TypeError('a segment must be [bytes, samples]');
    const segment = { offset, bytes, durationS: samples / rate };
    offset += bytes;
    return segment;
  });
  return { uri, type, primingS: priming / rate, segments: list };
}

/** Reads a motion's sound; null if it has none. Errors: TypeError for an invalid entry. */
export function readSound(manifest: unknown, sequence: string): SoundTrack | null {
  const { sequences } = (extensionOf(manifest) ?? {}) as { sequences?: { name?: unknown; sound?: unknown }[] };
  const sound = sequences?.find(({ name }) => name === sequence)?.sound as Record<string, unknown> | undefined;
  if (!sound) return null;
  const { sampleRate, segmentDuration, encodings, steps } = sound;
  if (!isNumber(sampleRate, 8000, 192_000) || !isNumber(segmentDuration, 1e-3, MAX_SEGMENT_S) || !Array.isArray(encodings)) {
    throw new TypeError('sound needs sampleRate, segmentDuration and encodings');
  }
  const several = (encodings as { segments?: unknown[] }[])[0]?.segments?.length ?? 0;
  if (encodings.length < 1 || encodings.length > 8 || encodings.some((e: { segments?: unknown[] }) => e?.segments?.length !== several)) throw new TypeError('encodings must be 1 to 8, with as many segments each');
  if (several > 1 && segmentDuration < MIN_SEGMENT_S) throw new TypeError('segmentDuration is too short');
  if (steps !== undefined && !(Array.isArray(steps) && steps.every((phase) => isNumber(phase, 0, 1)))) throw new TypeError('steps must be phases');
  return {
    segmentS: segmentDuration,
    encodings: (encodings as Record<string, unknown>[]).map((encoding) => readEncoding(encoding, sampleRate)),
    steps: (steps as number[] | undefined) ?? null,
  };
}
