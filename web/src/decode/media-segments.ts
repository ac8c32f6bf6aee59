// SPDX-License-Identifier: Apache-2.0
// Writes one video track as segments for Media Source Extensions (ISO/IEC 14496-12, byte stream format "ISO BMFF"): one
// initialization segment per decoder configuration, one media segment per run of samples. All frames have the same
// duration. Does not parse the samples.

export interface TrackConfig {
  /** Codec string by RFC 6381, from the manifest: avc1, vp09 or av01. */
  codec: string;
  /** Content of the avcC box; empty for VP9 and AV1. */
  description: Uint8Array;
  width: number;
  height: number;
}

/** One coded picture; samples come in decoding order. */
export interface TrackSample {
  bytes: Uint8Array;
  timestampUs: number;
  key: boolean;
}

const TIMESCALE = 1_000_000; // microseconds
const KEY_FLAGS = 0x02000000; // depends on no other sample
const DELTA_FLAGS = 0x01010000; // depends on others, and is no sync sample
// Frames by which decoding times precede presentation times: more than any encoder reorders.
const REORDERED_FRAMES = 16;

type Part = number[] | Uint8Array;

const u8 = (value: number): number[] => [value & 255];
const u16 = (value: number): number[] => [(value >> 8) & 255, value & 255];
const u32 = (value: number): number[] => [(value >>> 24) & 255, (value >>> 16) & 255, (value >>> 8) & 255, value & 255];
const u64 = (value: number): number[] => [...u32(Math.floor(value / 2 ** 32)), ...u32(value % 2 ** 32)];
const ascii = (text: string): number[] => Array.from(text, (c) => c.charCodeAt(0));
const zeros = (count: number): number[] => new Array<number>(count).fill(0);
const UNITY = [0x10000, 0, 0, 0, 0x10000, 0, 0, 0, 0x40000000].flatMap(u32);

function box(type: string, ...parts: Part[]): Uint8Array {
  const size = parts.reduce((sum, part) => sum + part.length, 8);
  const out = new Uint8Array(size);
  out.set([...u32(size), ...ascii(type)]);
  let at = 8;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}
const full = (type: string, version: number, flags: number, ...parts: Part[]): Uint8Array =>
  box(type, u32(version * 2 ** 24 + flags), ...parts);

// Box with the decoder's configuration, derived from the codec string; the samples contain the rest.
function configBox({ codec, description }: TrackConfig): Uint8Array {
  const [name, ...fields] = codec.split('.');
  if (name === 'vp09') {
    const [profile = 0, level = 10, depth = 8, chroma = 1, primaries = 1, transfer = 1, matrix = 1, full_range = 0] = fields.map(Number);
    return full('vpcC', 1, 0, u8(profile), u8(level), u8((depth << 4) | (chroma << 1) | full_range), u8(primaries),
      u8(transfer), u8(matrix), u16(0));
  }
  if (name === 'av01') {
    const [profile = '0', level = '08M', depth = '08'] = fields;
    const tier = level.endsWith('H') ? 128 : 0;
    const deep = depth === '10' ? 64 : 0;
    return box('av1C', [0x81, (Number(profile) << 5) | parseInt(level, 10), tier | deep | 0x0c, 0]); // 4:2:0
  }
  return box('avcC', description);
}

function sampleEntry(track: TrackConfig): Uint8Array {
  const [name = ''] = track.codec.split('.');
  return box(name, zeros(6), u16(1), zeros(16), u16(track.width), u16(track.height), u32(0x480000), u32(0x480000),
    zeros(4), u16(1), zeros(32), u16(24), u16(0xffff), configBox(track));
}

/** MIME type of a track with this codec, for MediaSource. */
export const mediaType = (codec: string): string => `video/mp4; codecs="${codec}"`;

export function initSegment(track: TrackConfig): Uint8Array {
  const table = box('stbl', full('stsd', 0, 0, u32(1), sampleEntry(track)), full('stts', 0, 0, u32(0)),
    full('stsc', 0, 0, u32(0)), full('stsz', 0, 0, u32(0), u32(0)), full('stco', 0, 0, u32(0)));
  const information = box('minf', full('vmhd', 0, 1, zeros(8)),
    box('dinf', full('dref', 0, 0, u32(1), full('url ', 0, 1))), table);
  const media = box('mdia', full('mdhd', 0, 0, zeros(8), u32(TIMESCALE), u32(0), u16(0x55c4), u16(0)),
    full('hdlr', 0, 0, zeros(4), ascii('vide'), zeros(12), u8(0)), information);
  const header = full('tkhd', 0, 3, zeros(8), u32(1), zeros(8), zeros(16), UNITY, u32(track.width * 65536), u32(track.height * 65536));
  const movie = full('mvhd', 0, 0, zeros(8), u32(TIMESCALE), u32(0), u32(0x10000), u16(0x100), zeros(10), UNITY, zeros(24), u32(2));
  const ftyp = box('ftyp', ascii('iso6'), u32(0), ascii('iso6'), ascii('mp41'));
  const moov = box('moov', movie, box('trak', header, media),
    box('mvex', full('trex', 0, 0, u32(1), u32(1), u32(0), u32(0), u32(0))));
  return concat([ftyp, moov]);
}

/** Writes media segments of one track: numbers the fragments, and assigns decoding times by the samples' order. */
export class SegmentWriter {
  readonly #frameUs: number;
  readonly #startUs: number;
  #sequence = 0;
  #keyUs = 0;
  #sinceKey = 0;

  /** frameUs: a frame's duration; timestamps are multiples of it. startUs: media time of timestamp 0. */
  constructor(frameUs: number, startUs: number) {
    this.#frameUs = frameUs;
    this.#startUs = startUs;
  }

  /** Writes one segment. samples: at least one; the track's first sample is a key, and a key begins a segment. */
  segment(samples: readonly TrackSample[]): Uint8Array {
    const rows: number[] = [];
    let firstUs = 0;
    samples.forEach(({ bytes, timestampUs, key }, index) => {
      if (key) {
        this.#keyUs = timestampUs;
        this.#sinceKey = 0;
      }
      const decodingUs = this.#startUs + this.#keyUs + (this.#sinceKey++ - REORDERED_FRAMES) * this.#frameUs;
      if (index === 0) firstUs = decodingUs;
      rows.push(...u32(this.#frameUs), ...u32(bytes.length), ...u32(key ? KEY_FLAGS : DELTA_FLAGS),
        ...u32(this.#startUs + timestampUs - decodingUs));
    });
    const fragment = (dataOffset: number): Uint8Array => box('moof', full('mfhd', 0, 0, u32(this.#sequence)),
      box('traf', full('tfhd', 0, 0x20000, u32(1)), full('tfdt', 1, 0, u64(firstUs)),
        full('trun', 1, 0xf01, u32(samples.length), u32(dataOffset), rows)));
    ++this.#sequence;
    const moof = fragment(fragment(0).length + 8);
    return concat([moof, box('mdat', ...samples.map(({ bytes }) => bytes))]);
  }
}

function concat(parts: readonly Uint8Array[]): Uint8Array {
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}
