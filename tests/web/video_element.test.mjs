// SPDX-License-Identifier: Apache-2.0
// web/src/decode/video-element.ts without a browser: with a fake <video> element that imitates browsers' behaviour, and a
// clock that the test advances.
import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';

import { load } from './load_source.mjs';

const kFrameUs = 40_000, kStartUs = 1_000_000, kTurnMs = 20;
const { makeVideoDecoder } = await load('decode/video-element');
let nowMs, videos, decoder, shown, faults, last, pace;

class FakeBuffer extends EventTarget {
  updating = false;
  ranges = [];
  holds = () => false; // true: this append never ends
  constructor(source) { super(); this.source = source; }
  get buffered() {
    const { ranges } = this;
    return { length: ranges.length, start: (i) => ranges[i][0], end: (i) => ranges[i][1] };
  }
  appendBuffer(bytes) {
    this.source.readyState = 'open';
    this.#begin(() => {
      const range = rangeOf(bytes);
      if (!range) return;
      const before = this.ranges.at(-1);
      if (before && range[0] <= before[1] + 1e-6) before[1] = Math.max(before[1], range[1]);
      else this.ranges.push(range);
      this.source.duration = Math.max(this.source.duration, range[1]);
    });
  }
  remove(from, to) {
    this.source.readyState = 'open';
    this.#begin(() => { this.ranges = this.ranges.map(([a, b]) => [Math.max(a, to), b]).filter(([a, b]) => a < b); });
  }
  changeType() {}
  #begin(run) {
    this.updating = true;
    if (this.holds()) return;
    this.work = () => {
      this.work = null;
      run();
      this.updating = false;
      this.dispatchEvent(new Event('updateend'));
    };
  }
}

// Presentation times of a media segment, seconds from the first one's start to the last one's end; null for another one.
function rangeOf(bytes) {
  const text = Buffer.from(bytes).toString('latin1'), view = new DataView(bytes.buffer, bytes.byteOffset);
  const tfdt = text.indexOf('tfdt'), trun = text.indexOf('trun');
  if (tfdt < 0) return null;
  const first = Number(view.getBigUint64(tfdt + 8));
  const times = Array.from({ length: view.getUint32(trun + 8) }, (_, i) => first + i * kFrameUs + view.getInt32(trun + 16 + 16 * i + 12));
  return [Math.min(...times) / 1e6, (Math.max(...times) + kFrameUs) / 1e6];
}

class FakeSource extends EventTarget {
  static isTypeSupported = () => true;
  readyState = 'open';
  duration = 0;
  addSourceBuffer() { return (this.buffer = new FakeBuffer(this)); }
  endOfStream() { this.readyState = 'ended'; }
}

// An end that was reached stays one, in Firefox, whatever is appended, until the element is sent elsewhere.
class FakeVideo extends EventTarget {
  paused = true;
  ended = false;
  seeking = false;
  playbackRate = 1;
  refuses = false; // to play
  seeks = true; // a seek comes to an end
  stands = false; // its time does
  seekCount = 0;
  callbacks = [];
  #time = 0;
  #shownUs = -1;
  constructor() { super(); videos.push(this); }
  get buffered() { return this.source.buffer?.buffered ?? { length: 0 }; }
  get duration() { return this.source.duration; }
  get readyState() { return this.buffered.length ? 2 : 0; }
  get currentTime() { return this.#time; }
  set currentTime(time) {
    assert.ok(Number.isFinite(time));
    this.#time = time;
    this.seeking = true;
    this.ended = false;
    ++this.seekCount;
    this.#shownUs = -1;
  }
  play() {
    if (this.refuses) return Promise.reject(new DOMException('not by itself', 'NotAllowedError'));
    this.paused = false;
    return Promise.resolve();
  }
  pause() { this.paused = true; }
  load() {}
  removeAttribute() {}
  requestVideoFrameCallback(run) { return this.callbacks.push(run); }
  cancelVideoFrameCallback() { this.callbacks = []; }
  turn() {
    this.source.buffer?.work?.();
    const inside = [...this.source.buffer?.ranges ?? []].find(([a, b]) => a <= this.#time && this.#time <= b);
    if (this.seeking && this.seeks && inside && this.#time < inside[1]) {
      this.seeking = false;
      this.dispatchEvent(new Event('seeked'));
    }
    if (!this.seeking && !this.paused && inside && !this.stands && !this.ended) {
      this.#time = Math.min(this.#time + (kTurnMs / 1000) * this.playbackRate, inside[1]);
      if (this.source.readyState === 'ended' && this.#time >= inside[1]) {
        this.ended = this.paused = true;
        this.dispatchEvent(new Event('ended'));
      }
    }
    const us = Math.floor((this.#time * 1e6 - kStartUs) / kFrameUs) * kFrameUs;
    if (this.seeking || this.ended || !inside || us === this.#shownUs) return;
    this.#shownUs = us;
    for (const run of this.callbacks.splice(0)) run(nowMs, { mediaTime: (us + kStartUs) / 1e6 });
  }
}

beforeEach(() => {
  nowMs = 0;
  videos = [];
  shown = [];
  faults = [];
  last = -1;
  pace = 25;
  const sources = new Map();
  globalThis.performance.now = () => nowMs;
  globalThis.MediaSource = FakeSource;
  globalThis.URL.createObjectURL = (source) => { sources.set('blob:1', source); return 'blob:1'; };
  globalThis.URL.revokeObjectURL = () => undefined;
  globalThis.document = { createElement: () => {
    const video = new FakeVideo();
    Object.defineProperty(video, 'src', { set(url) {
      video.source = sources.get(url);
      queueMicrotask(() => video.source.dispatchEvent(new Event('sourceopen')));
    } });
    return video;
  } };
  decoder = makeVideoDecoder({ onPicture() {}, onNoPlanes() {}, onFrame() {}, onFault: (fault, reason) => faults.push({ fault, reason }) });
});

const video = () => videos.at(-1);
const frames = () => shown.map((us) => us / kFrameUs);
const configure = () => decoder.configure('avc1.42E01E', new Uint8Array(4), 64, 64);
function give(count) {
  for (let i = 0; i < count; ++i) {
    ++last;
    decoder.decode(new Uint8Array(8), last * kFrameUs, last % 10 === 0, true);
  }
}
// Turns of the page, until the condition holds or so much time has passed.
async function run(ms, until = () => false) {
  for (const end = nowMs + ms; nowMs < end && !until(); nowMs += kTurnMs) {
    await new Promise((next) => setImmediate(next));
    video()?.turn();
    decoder.feed(pace);
    for (let picture = decoder.peek(); picture; picture = decoder.peek()) {
      shown.push(picture.timestampUs);
      decoder.shift(true);
    }
  }
}
const shows = (frame) => () => frames().includes(frame);

test('after an end it goes on with samples of another rendition', async () => {
  configure();
  give(20);
  decoder.flush();
  await run(5000, () => video().ended);
  assert.ok(video().ended);
  configure();
  give(20);
  await run(5000, shows(38));
  assert.ok(shows(38)(), `${frames()}`);
  assert.deepEqual(faults, []);
});

test('after an end it goes on with samples of the same one, which may come before the element has noticed the end', async () => {
  for (const noticed of [true, false]) {
    configure();
    give(20);
    decoder.flush();
    await run(5000, () => (noticed ? video().ended : video().source.readyState === 'ended'));
    give(20);
    await run(5000, shows(last - 1));
    assert.ok(shows(last - 1)(), `${frames()}`);
  }
  assert.deepEqual(faults, []);
});

test('the end of a stream stays one', async () => {
  configure();
  give(400);
  decoder.flush();
  await run(30_000, shows(399));
  assert.equal(video().source.readyState, 'ended');
  assert.ok(shows(399)(), `${frames().at(-1)}`);
});

test('where the browser pauses it, it plays again', async () => {
  configure();
  give(60);
  await run(5000, shows(10));
  video().pause();
  await run(5000, shows(40));
  assert.ok(shows(40)(), `${frames()}`);
  assert.equal(video().seekCount, 1);
});

test('where the browser does not let it play, pictures are sought one by one; it plays once it may', async () => {
  configure();
  video().refuses = true;
  give(100);
  await run(4000, shows(40));
  assert.ok(frames().length > 10, `${frames()}`);
  assert.ok(video().paused);
  const { seekCount } = video();
  video().refuses = false;
  await run(4000, () => !video().paused);
  await run(400);
  assert.ok(video().seekCount - seekCount < 60);
  assert.equal(video().paused, false);
  assert.deepEqual(faults, []);
});

for (const [title, stand] of [['a seek that does not end', { seeks: false }], ['a time that stands still', { stands: true }]]) {
  test(`${title} is followed by another seek, in the end by another element`, async () => {
    configure();
    give(90);
    await run(2000, shows(10));
    const before = video().seekCount;
    Object.assign(video(), stand);
    if (!video().seeks) {
      decoder.reset();
      last = 99;
      give(60);
    }
    await run(10_000, () => video().seekCount > before + (stand.seeks === false));
    assert.ok(video().seekCount > before + (stand.seeks === false), 'it is sent there again');
    video().seeks = false;
    await run(60_000, () => faults.length > 0);
    assert.deepEqual(faults, [{ fault: 'taken-away', reason: 'the <video> element stands still' }]);
    configure();
    last = 199;
    give(60);
    await run(5000, shows(210));
    assert.ok(shows(210)());
    assert.equal(videos.length, 2);
  });
}

test('an append that does not end is a fault', async () => {
  configure();
  give(20);
  await run(400, shows(5));
  video().source.buffer.holds = () => true;
  give(20);
  await run(60_000, () => faults.length > 0);
  assert.equal(faults[0].fault, 'taken-away');
});

test('without samples it waits', async () => {
  configure();
  give(20);
  await run(120_000);
  assert.deepEqual(faults, []);
  give(40);
  await run(2000, shows(50));
  assert.ok(shows(50)(), `${frames()}`);
});
