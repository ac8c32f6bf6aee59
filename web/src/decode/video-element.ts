// SPDX-License-Identifier: Apache-2.0
// Carries out the player's decode requests with a <video> element, for pages without VideoDecoder (Firefox for Android,
// plain http). Samples become media segments on one timeline that only grows: loops, seeks and other renditions append to
// it. The element plays at the pace at which the player takes pictures, and may skip some. The player reads a picture's
// frame index from its barcode; the element's media time is a first guess. New pictures are announced by
// requestVideoFrameCallback; without it the element's time is polled.
import type { DecoderFault } from '../wasm/generated/abi.js';
import type { DecoderCallbacks, Picture, PictureDecoder } from './frame-decoder.js';
import { initSegment, mediaType, SegmentWriter, type TrackConfig, type TrackSample } from './media-segments.js';

const FRAME_US = 40_000; // between the player's timestamps, at any frame rate of the sequence
const START_US = 1_000_000; // media time of timestamp 0, so that no decoding time is negative
const INSIDE_US = FRAME_US / 4; // offset of a seek from the beginning of a frame
const NEAR_S = 0.1; // within this distance of the goal the element plays on instead of seeking
const TRY_MS = 80; // between repeated offers of a sought picture
const MAX_TRIES = 25;
const KEPT_BEHIND_S = 4;
const MAX_BEHIND_S = 12;
const HAVE_CURRENT_DATA = 2; // readyState
const MIN_RATE = 0.0625; // range of playback rates that browsers support
const MAX_RATE = 16;
const RATE_STEP = 0.03; // relative; smaller changes of the rate are left out
const STUCK_MS = 2000; // timeout of an awaited picture, in time of turns; then the element seeks it. Doubles per seek
const SEEK_MS = 6000; // the same timeout while the element seeks, which takes long on slow machines
const LONGEST_TURN_MS = 100; // a longer turn counts as this towards the timeouts: the page was suspended
const MAX_NUDGES = 2;
const HELD_BACK_US = 30 * FRAME_US; // browsers hold the last pictures back until more samples come or the stream ends
const MAX_SKIPPED = 8; // frames per seek while play() is refused
const REFUSED_MS = 1000; // pause before the next play() after a refused one

type MediaSourceClass = typeof MediaSource;
const sourceClass = (): MediaSourceClass | undefined =>
  globalThis.MediaSource ?? (globalThis as { ManagedMediaSource?: MediaSourceClass }).ManagedMediaSource;

class VideoElementDecoder implements PictureDecoder {
  readonly #callbacks: DecoderCallbacks;
  readonly #writer = new SegmentWriter(FRAME_US, START_US);
  #video: HTMLVideoElement | null = null;
  #source: MediaSource | null = null;
  #buffer: SourceBuffer | null = null;
  #url = '';
  #track: TrackConfig | null = null;
  #pending: (() => void)[] = []; // queued operations on the buffer; the first is active
  #samples: TrackSample[] = [];
  #ended = false; // the player has flushed: the next sample, if any, is a key
  #goal = -1; // timestamp of the picture to seek; Infinity: the next wanted one's; -1: none
  #sought = false; // the element seeks the goal, or has reached it
  #picture: Picture | null = null;
  #taken = -1; // timestamp of the picture that the player removed last
  #takenMs = 0; // time of that removal
  given = 0;
  #again = -1; // timestamp of the last sought picture
  #timer = 0;
  #last = -1; // greatest timestamp of a sample
  #pace = 0;
  #polls = false;
  #callback = 0;
  #turnMs = 0; // time of the last feed
  #stuckMs = 0; // time of turns without an awaited picture or operation
  #nudges = 0; // seeks after timeouts, since the last progress
  #refusedMs = -Infinity; // time of the last refused play()

  constructor(callbacks: DecoderCallbacks) {
    this.#callbacks = callbacks;
  }

  configure(codec: string, description: Uint8Array, width: number, height: number): void {
    const before = this.#track?.codec;
    this.#track = { codec, description: description.slice(), width, height };
    this.#forget();
    const type = mediaType(codec);
    if (!sourceClass()?.isTypeSupported(type)) {
      this.#fail('unsupported', `this browser has neither WebCodecs nor Media Source Extensions for ${codec}: open the page in a newer one, or over https`);
      return;
    }
    if (!this.#video) this.#open(type);
    else if (before !== codec) this.#then(() => this.#buffer!.changeType(type), true);
    const segment = initSegment(this.#track);
    this.#then(() => this.#buffer!.appendBuffer(segment as BufferSource));
  }

  decode(bytes: Uint8Array, timestampUs: number, key: boolean, wanted: boolean): void {
    if (key) this.#appendSamples(); // a segment ends before a key
    if (wanted && this.#goal === Infinity) {
      this.#goal = timestampUs;
      this.#sought = false;
    }
    // Samples come in decoding order: one with an earlier presentation time may follow.
    if (wanted && !this.#sought && timestampUs < this.#goal) this.#goal = timestampUs;
    this.#last = Math.max(this.#last, timestampUs);
    this.#samples.push({ bytes: bytes.slice(), timestampUs, key });
    this.#ended = false;
  }
  flush(): void {
    this.#ended = true;
    this.#appendSamples();
    this.#then(() => {
      if (this.#ended && this.#source?.readyState === 'open') this.#source.endOfStream();
    }, true);
  }
  reset(): void {
    this.#forget();
    this.#video?.pause();
  }
  dispose(): void {
    const video = this.#video;
    this.#video = null;
    this.#pending = [];
    this.#samples = [];
    this.#picture = null;
    clearTimeout(this.#timer);
    if (!video) return;
    if (this.#callback) video.cancelVideoFrameCallback(this.#callback);
    video.removeAttribute('src');
    video.load(); // frees its decoder
    URL.revokeObjectURL(this.#url);
    this.#source = this.#buffer = null;
  }

  feed(pace: number): void {
    this.#pace = pace;
    this.#appendSamples();
    this.#steer();
    this.#watch();
    // Reads the time slightly early: the element's time may reach the next frame before that can be copied.
    if (this.#polls) this.#onFrame((this.#video?.currentTime ?? 0) * 1e6 - START_US - INSIDE_US);
  }
  peek(): Picture | undefined { return this.#picture ?? undefined; }
  shift(): void {
    if (this.#picture) this.#taken = this.#picture.timestampUs;
    this.#takenMs = performance.now();
    this.#picture = null;
    this.#steer();
  }
  get busy(): boolean { return this.#samples.length + this.#pending.length > 0 || this.#goal >= 0 || this.#pace > 0; }

  get missing(): 'decoder' | null { return this.#isAwaited ? 'decoder' : null; }

  #forget(): void {
    this.#samples = [];
    this.#picture = null;
    this.#goal = Infinity; // the next wanted sample sets it
    this.#sought = this.#ended = false;
    this.#moved();
  }

  #open(type: string): void {
    const video = (this.#video = document.createElement('video'));
    video.muted = video.playsInline = video.disableRemotePlayback = true;
    video.preload = 'auto';
    const source = (this.#source = new (sourceClass()!)());
    source.addEventListener('sourceopen', () => {
      if (this.#source !== source || this.#buffer) return;
      this.#buffer = source.addSourceBuffer(type);
      this.#buffer.addEventListener('updateend', () => this.#next());
      this.#next(true);
    });
    video.addEventListener('error', () => {
      if (this.#video !== video) return;
      const { message = '' } = video.error ?? {};
      if (this.#buffer) this.#fail('samples', message);
      else this.#fail('unsupported', `${message}; where this browser has no WebCodecs, the page's policy must allow media-src blob:`);
    });
    for (const event of ['canplay', 'durationchange']) video.addEventListener(event, () => this.#steer());
    video.addEventListener('seeked', () => this.#offerLater());
    video.addEventListener('ended', () => { if (this.#ended && this.#taken !== this.#last && this.#goal < 0) this.#offer(this.#last); });
    video.src = this.#url = URL.createObjectURL(source);
    this.#polls = !('requestVideoFrameCallback' in video);
    if (!this.#polls) this.#await(video);
  }

  #await(video: HTMLVideoElement): void {
    this.#callback = video.requestVideoFrameCallback((_, { mediaTime }) => {
      if (this.#video !== video) return;
      this.#await(video);
      this.#onFrame(Math.round((mediaTime * 1e6 - START_US) / FRAME_US) * FRAME_US);
    });
  }

  // Offers the picture of this frame time, which may be off by some frames. The first picture after a seek gets the
  // timestamp of the goal.
  #onFrame(timeUs: number): void {
    const video = this.#video;
    if (!video || video.seeking || video.readyState < HAVE_CURRENT_DATA) return;
    let timestampUs = Math.floor((timeUs + 1) / FRAME_US) * FRAME_US;
    if (this.#goal >= 0) {
      if (!this.#sought) return;
      this.#again = timestampUs = this.#goal;
      this.#goal = -1;
      this.#offerLater();
    } else if (timestampUs === this.#taken) {
      return;
    }
    this.#offer(timestampUs);
  }
  #offer(timestampUs: number): void {
    this.#moved();
    ++this.given;
    this.#picture = { kind: 'video', timestampUs, video: this.#video! };
    this.#callbacks.onPicture();
  }

  // Repeats the offer of a sought picture while the element is paused: some browsers report a frame before it can be
  // copied, others report none. The player refuses a picture that it has; it detects that some ticks later only.
  #offerLater(tries = 0): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      if (this.#goal >= 0) this.#onFrame(this.#goal);
      else if (this.#pace <= 0 && tries < MAX_TRIES && this.#video && this.#taken === this.#again) {
        this.#offer(this.#again);
        this.#offerLater(tries + 1);
      }
    }, TRY_MS);
  }

  // --- appending ---

  #appendSamples(): void {
    if (!this.#samples.length || !this.#video) return;
    const segment = this.#writer.segment(this.#samples);
    this.#samples = [];
    this.#then(() => this.#buffer!.appendBuffer(segment as BufferSource));
  }

  // Queues an operation on the buffer. sync: one without an `updateend` event.
  #then(operation: () => void, sync = false): void {
    this.#pending.push(() => {
      operation();
      if (sync) queueMicrotask(() => this.#next());
    });
    if (this.#pending.length === 1) this.#next(true);
  }

  #next(first = false): void {
    const buffer = this.#buffer;
    if (!buffer || buffer.updating) return;
    if (!first) {
      this.#pending.shift();
      this.#stuckMs = 0;
    }
    this.#steer();
    const operation = this.#pending[0];
    if (!operation) return this.#freeBehind();
    try {
      operation();
    } catch (reason) {
      this.#fail('samples', String(reason));
    }
  }

  #freeBehind(): void {
    const { buffered, currentTime } = this.#video!;
    if (this.#ended) return; // removal would reopen the stream
    if (this.#goal >= 0 || !buffered.length || currentTime - buffered.start(0) < MAX_BEHIND_S) return;
    this.#then(() => this.#buffer!.remove(0, currentTime - KEPT_BEHIND_S));
  }

  // --- position and rate of the element ---

  // Seeks the goal once that is buffered; afterwards plays at the pace, paused while a picture waits to be taken.
  #steer(): void {
    const video = this.#video;
    if (!video || !this.#track) return;
    if (this.#goal < 0 && this.#pace > 0 && !this.#picture && this.#last > this.#taken && this.#mustSeek) this.#seek(this.#nextUs);
    if (this.#goal >= 0) {
      const at = mediaTime(this.#goal);
      // Plays on into another rendition, which begins where the last one ends, without a seek. An element that has ended
      // must seek.
      const goesOn = this.#pace > 0 && !this.#mustSeek && Math.abs(video.currentTime - at) < NEAR_S;
      if (!goesOn && !video.paused) video.pause();
      // An end of stream has cut the duration, which may still be behind the buffered range.
      if (this.#sought || !covers(video.buffered, at) || at >= video.duration) return;
      this.#sought = true;
      if (!goesOn) {
        video.currentTime = at;
        return;
      }
      this.#taken = this.#goal - FRAME_US; // so that the goal counts as the next picture
      this.#goal = -1;
    }
    if (this.#pace <= 0 || this.#picture) return video.paused ? undefined : video.pause();
    const rate = Math.min(Math.max((this.#pace * FRAME_US) / 1e6, MIN_RATE), MAX_RATE);
    if (Math.abs(rate / video.playbackRate - 1) > RATE_STEP) video.playbackRate = rate;
    // play() of an element that has ended would start from the beginning.
    if (video.paused && !video.ended) video.play().catch((reason: unknown) => this.#onRefused(reason));
  }
  #seek(timestampUs: number): void {
    this.#goal = timestampUs;
    this.#sought = false;
  }

  // True if the element has ended before samples that came later, or the browser refuses to play (autoplay policy, power
  // saving).
  get #mustSeek(): boolean {
    const { ended, buffered, currentTime } = this.#video!;
    return this.#isRefused || (ended && covers(buffered, currentTime + INSIDE_US / 1e6));
  }
  get #isRefused(): boolean { return performance.now() - this.#refusedMs < REFUSED_MS; }
  #onRefused(reason: unknown): void {
    if ((reason as Error).name === 'NotAllowedError') this.#refusedMs = performance.now();
  }
  // Timestamp of the next picture. While play() is refused, seeks skip pictures to keep up with the pace.
  get #nextUs(): number {
    const passed = this.#isRefused ? Math.floor(((performance.now() - this.#takenMs) / 1000) * this.#pace) : 1;
    return Math.min(this.#taken + FRAME_US * Math.min(Math.max(1, passed), MAX_SKIPPED), this.#last);
  }

  // --- timeouts ---

  // Seeks the awaited picture again after a timeout: a browser's seek or play() may have no effect. After MAX_NUDGES
  // reports a fault, upon which the player opens another element.
  #watch(): void {
    const nowMs = performance.now(), turnMs = Math.min(nowMs - this.#turnMs, LONGEST_TURN_MS);
    this.#turnMs = nowMs;
    if (!this.#video) return;
    this.#stuckMs = this.#isAwaited ? this.#stuckMs + turnMs : 0;
    if (this.#stuckMs < (this.#video.seeking ? SEEK_MS : STUCK_MS) * 2 ** this.#nudges) return;
    if (++this.#nudges > MAX_NUDGES) return this.#fail('taken-away', 'the <video> element stands still');
    this.#stuckMs = 0;
    if (this.#goal < 0) this.#goal = this.#nextUs;
    if (this.#goal === Infinity) return;
    this.#sought = true;
    this.#video.currentTime = mediaTime(this.#goal);
  }
  #moved(): void { this.#stuckMs = this.#nudges = 0; }

  // True during an operation on the buffer, or if the browser has all samples that the next picture needs.
  get #isAwaited(): boolean {
    if (this.#pending.length) return true;
    const hasAll = (afterUs: number): boolean => this.#last - afterUs > (this.#ended ? 0 : HELD_BACK_US);
    if (this.#goal >= 0) return hasAll(this.#goal - FRAME_US);
    return this.#pace > 0 && !this.#picture && hasAll(this.#taken);
  }

  #fail(fault: DecoderFault, reason: string): void {
    this.dispose();
    this.#callbacks.onFault(fault, reason);
  }
}

export const makeVideoDecoder = (callbacks: DecoderCallbacks): PictureDecoder => new VideoElementDecoder(callbacks);

// Media time inside the frame, seconds.
const mediaTime = (timestampUs: number): number => (START_US + timestampUs + INSIDE_US) / 1e6;

function covers(ranges: TimeRanges, time: number): boolean {
  for (let i = 0; i < ranges.length; ++i) if (ranges.start(i) <= time && time < ranges.end(i)) return true;
  return false;
}
