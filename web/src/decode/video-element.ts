// SPDX-License-Identifier: Apache-2.0
// Carries out the player's decode requests with a <video> element, where there is no VideoDecoder (Firefox for Android,
// pages of plain http): samples become media segments on one timeline that never turns back, so that loops, seeks and
// renditions are only more of it. The element keeps time: it runs at the pace at which the player takes pictures, and may leave
// some out. The player reads a picture's frame from its barcode; the element's media time is a first guess.
// requestVideoFrameCallback announces new ones; without it the element's time is polled.
import type { DecoderFault } from '../wasm/generated/abi.js';
import type { DecoderCallbacks, Picture, PictureDecoder } from './frame-decoder.js';
import { initSegment, mediaType, SegmentWriter, type TrackConfig, type TrackSample } from './media-segments.js';

const FRAME_US = 40_000; // between timestamps of the player, whatever the sequence's frame rate
const START_US = 1_000_000; // of the timeline: decoding times before the first frame must not be negative
const INSIDE_US = FRAME_US / 4; // seeks lead into a frame, not onto its edge
const NEAR_S = 0.1; // from the goal: the element plays into it
const TRY_MS = 80; // between offers of a sought picture
const MAX_TRIES = 25;
const KEPT_BEHIND_S = 4;
const MAX_BEHIND_S = 12;
const HAVE_CURRENT_DATA = 2; // readyState
const MIN_RATE = 0.0625; // the range that browsers play at
const MAX_RATE = 16;
const RATE_STEP = 0.03; // smaller changes are not worth an adjustment
const STUCK_MS = 2000; // of turns without what is awaited, before the element is sent there; twice as long each further time
const SEEK_MS = 6000; // likewise, while it seeks: a slow machine may be on the way
const LONGEST_TURN_MS = 100; // that counts: a page that stands still awaits nothing
const MAX_NUDGES = 2;
const HELD_BACK_US = 30 * FRAME_US; // browsers keep the last pictures to themselves until more samples come, or their end
const MAX_SKIPPED = 8; // frames
const REFUSED_MS = 1000; // before a refused play() is tried again

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
  #pending: (() => void)[] = []; // operations on the buffer, one after the other
  #samples: TrackSample[] = [];
  #ended = false; // no more samples come before the next key
  #goal = -1; // timestamp of the first picture that is wanted; -1: it is there
  #sought = false; // the element has been sent to the goal
  #picture: Picture | null = null;
  #taken = -1; // timestamp of the picture that was taken last
  #takenMs = 0; // time of that
  given = 0;
  #again = -1; // timestamp of the picture that was sought last
  #timer = 0;
  #last = -1; // the greatest timestamp so far
  #pace = 0;
  #polls = false;
  #callback = 0;
  #turnMs = 0; // time of the last feed
  #stuckMs = 0; // since something came of what is awaited
  #nudges = 0; // since then
  #refusedMs = -Infinity; // time at which the browser refused to play

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
    // Samples come in decoding order: one that is presented earlier may follow.
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
    // The element's time may be of the next frame already when that cannot be copied yet: name the one a little before.
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
    this.#goal = Infinity; // the next one that is wanted
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

  // The element shows this frame, or one near it: the first one after a seek counts as the one that was sought.
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

  // While the element stands after a seek: some browsers report a frame before it can be copied, and some report none. The
  // player refuses it once it has it, which it detects some ticks later only.
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

  // --- what is appended ---

  #appendSamples(): void {
    if (!this.#samples.length || !this.#video) return;
    const segment = this.#writer.segment(this.#samples);
    this.#samples = [];
    this.#then(() => this.#buffer!.appendBuffer(segment as BufferSource));
  }

  // sync: the operation raises no updateend.
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
    if (this.#ended) return; // it would take the end away
    if (this.#goal >= 0 || !buffered.length || currentTime - buffered.start(0) < MAX_BEHIND_S) return;
    this.#then(() => this.#buffer!.remove(0, currentTime - KEPT_BEHIND_S));
  }

  // --- where the element is, and how fast ---

  // Sends the element to the goal once that is buffered; then lets it run at the pace, as far as pictures are taken.
  #steer(): void {
    const video = this.#video;
    if (!video || !this.#track) return;
    if (this.#goal < 0 && this.#pace > 0 && !this.#picture && this.#last > this.#taken && this.#mustSeek) this.#seek(this.#nextUs);
    if (this.#goal >= 0) {
      const at = mediaTime(this.#goal);
      // Another rendition goes on where the one before ends: no seek, no gap. One that has ended stays there until it is sent on.
      const goesOn = this.#pace > 0 && !this.#mustSeek && Math.abs(video.currentTime - at) < NEAR_S;
      if (!goesOn && !video.paused) video.pause();
      // The duration, which an end of stream has cut, may lag behind what is buffered.
      if (this.#sought || !covers(video.buffered, at) || at >= video.duration) return;
      this.#sought = true;
      if (!goesOn) {
        video.currentTime = at;
        return;
      }
      this.#taken = this.#goal - FRAME_US; // the goal is the next one
      this.#goal = -1;
    }
    if (this.#pace <= 0 || this.#picture) return video.paused ? undefined : video.pause();
    const rate = Math.min(Math.max((this.#pace * FRAME_US) / 1e6, MIN_RATE), MAX_RATE);
    if (Math.abs(rate / video.playbackRate - 1) > RATE_STEP) video.playbackRate = rate;
    // One that has ended would begin again at the front.
    if (video.paused && !video.ended) video.play().catch((reason: unknown) => this.#onRefused(reason));
  }
  #seek(timestampUs: number): void {
    this.#goal = timestampUs;
    this.#sought = false;
  }

  // It stands at an end that has samples behind it by now, or the browser does not let it play (autoplay policy, saving of power).
  get #mustSeek(): boolean {
    const { ended, buffered, currentTime } = this.#video!;
    return this.#isRefused || (ended && covers(buffered, currentTime + INSIDE_US / 1e6));
  }
  get #isRefused(): boolean { return performance.now() - this.#refusedMs < REFUSED_MS; }
  #onRefused(reason: unknown): void {
    if ((reason as Error).name === 'NotAllowedError') this.#refusedMs = performance.now();
  }
  // The picture to come; one by one they take longer than the pace allows, so that some are left out.
  get #nextUs(): number {
    const passed = this.#isRefused ? Math.floor(((performance.now() - this.#takenMs) / 1000) * this.#pace) : 1;
    return Math.min(this.#taken + FRAME_US * Math.min(Math.max(1, passed), MAX_SKIPPED), this.#last);
  }

  // --- an element that stands still ---

  // Browsers let a seek or a play() come to nothing at times. Sends the element to what is awaited again; if that is of no use,
  // the player takes another element.
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

  // An operation on the buffer is under way, or the browser has all that the wanted picture takes.
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

// Inside the frame.
const mediaTime = (timestampUs: number): number => (START_US + timestampUs + INSIDE_US) / 1e6;

function covers(ranges: TimeRanges, time: number): boolean {
  for (let i = 0; i < ranges.length; ++i) if (ranges.start(i) <= time && time < ranges.end(i)) return true;
  return false;
}
