// SPDX-License-Identifier: Apache-2.0
// Cache of decoded segments of one motion's sound, fetched on demand; drops the least recently used ones. Part of
// fourdvt-more.js.
import type { SideFiles } from '../more/session-side.js';
import type { SoundEncoding, SoundSegment, SoundTrack } from './sound-manifest.js';

let nextId = -1; // the player's ranges have IDs from 0

export interface DecodedSound {
  buffer: AudioBuffer;
  /** Time of the first sample after the encoder's priming. */
  fromS: number;
}

/** Seconds of the encoder's priming in a decoded segment, which some decoders return; judged by the segment's length. */
export function primingIn(decodedS: number, segment: SoundSegment, primingS: number): number {
  return decodedS > segment.durationS + primingS / 2 ? primingS : 0;
}

/** Returns the encodings that the browser may play, most certain first; all encodings if it reports none as playable. */
export function playable(encodings: readonly SoundEncoding[], canPlay: (type: string) => string): SoundEncoding[] {
  const rank = ({ type }: SoundEncoding): number => ['probably', 'maybe'].indexOf(canPlay(type));
  const known = encodings.filter((e) => rank(e) >= 0).sort((a, b) => rank(a) - rank(b));
  return known.length ? known : [...encodings];
}

export class SoundBuffers {
  readonly #decode: (bytes: ArrayBuffer) => Promise<AudioBuffer>;
  readonly #files: () => SideFiles | null;
  readonly #failed: (reason: unknown) => void;
  readonly #encodings: SoundEncoding[];
  readonly #held = new Map<number, DecodedSound | 'coming'>();
  #over = false;

  /** files: returns null while there is no session. failed: called when no encoding can be used. */
  constructor(track: SoundTrack, decode: (bytes: ArrayBuffer) => Promise<AudioBuffer>, files: () => SideFiles | null, failed: (reason: unknown) => void) {
    const probe = document.createElement('audio');
    this.#encodings = playable(track.encodings, (type) => probe.canPlayType(type));
    this.#decode = decode;
    this.#files = files;
    this.#failed = failed;
  }

  get count(): number { return this.#encodings[0]?.segments.length ?? 0; }

  /** Returns a segment, or null and begins to fetch it. kept: maximum number of segments in the cache. */
  get(index: number, kept = 1): DecodedSound | null {
    const known = this.#held.get(index);
    if (known) {
      this.#held.delete(index); // moves to the end of the order of use
      this.#held.set(index, known);
      return known === 'coming' ? null : known;
    }
    const files = this.#files();
    if (this.#over || !files) return null;
    this.#held.set(index, 'coming');
    void this.#load(index, files).then((sound) => {
      if (sound && !this.#over) this.#held.set(index, sound);
      else this.#held.delete(index);
      for (const old of this.#held.keys()) if (this.#held.size > kept && old !== index) this.#held.delete(old);
    }, (reason: unknown) => {
      if (!this.#over) this.#failed(reason);
      this.dispose();
    });
    return null;
  }
  dispose(): void {
    this.#over = true;
    this.#held.clear();
  }

  // Fetches and decodes a segment; null if cancelled. Drops an encoding that fails to decode and tries the next.
  async #load(index: number, files: SideFiles): Promise<DecodedSound | null> {
    for (;;) {
      const encoding = this.#encodings[0]!, segment = encoding.segments[index]!;
      const bytes = await files.range(nextId--, encoding.uri, segment.offset, segment.bytes);
      if (!bytes) return null;
      try {
        const buffer = await this.#decode(bytes.slice().buffer);
        return { buffer, fromS: primingIn(buffer.duration, segment, encoding.primingS) };
      } catch (reason) {
        if (this.#encodings[0] === encoding) {
          if (this.#encodings.length === 1) throw new Error(`${encoding.uri}: this browser does not decode it (${String(reason)}); upload the file again`);
          this.#encodings.shift();
        }
      }
    }
  }
}
