// SPDX-License-Identifier: Apache-2.0
// Decoded pictures and their turns without a browser: web/src/decode/frame-decoder.ts and the pace of web/src/page/frame-loop.ts.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { load } from './load_source.mjs';

test('a decoder that calls back after it was closed: its pictures are closed, its errors are nobody\'s', async () => {
  const { FrameDecoder } = await load('decode/frame-decoder');
  const made = [];
  globalThis.VideoDecoder = class {
    state = 'unconfigured';
    decodeQueueSize = 0;
    constructor(init) { made.push(Object.assign(this, init)); }
    configure() { this.state = 'configured'; }
    close() { this.state = 'closed'; }
  };
  let open = 0;
  const picture = () => (++open, { timestamp: 0, close: () => --open });
  const faults = [];
  const decoder = new FrameDecoder('rgba', {}, { onPicture() {}, onNoPlanes() {}, onFrame() {}, onFault: (fault) => faults.push(fault) });
  const configure = () => decoder.configure('avc1.640028', new Uint8Array(), 64, 64);
  configure();
  made[0].output(picture());
  configure();
  made[0].output(picture());
  made[0].error(new Error('late'));
  assert.deepEqual([open, made[1].state, faults.length], [0, 'configured', 0], 'the decoder before');
  made[1].error(new Error('wrong bytes'));
  made[1].output(picture());
  assert.deepEqual([open, faults], [0, ['samples']], 'a decoder that failed');
  configure();
  decoder.dispose();
  made[2].output(picture());
  assert.equal(open, 0, 'a decoder after its time');
  delete globalThis.VideoDecoder;
});

test('planes are copied into memory that may grow meanwhile; pictures that nothing waits for are not', async () => {
  const { FrameDecoder } = await load('decode/frame-decoder');
  let decode;
  globalThis.VideoDecoder = class {
    state = 'unconfigured';
    decodeQueueSize = 0;
    constructor(init) { decode = init.output; }
    configure() { this.state = 'configured'; }
    decode() {}
    close() { this.state = 'closed'; }
  };
  globalThis.EncodedVideoChunk = class {};
  let memory = new ArrayBuffer(64), open = 0, copies = 0, grows = true, next = 1;
  const blocks = new Map();
  const heap = {
    allocate: (bytes) => (blocks.set(next, bytes), next++),
    free: (block) => assert.ok(blocks.delete(block), 'freed once'),
    bytes: (block, length) => new Uint8Array(memory, 0, length),
  };
  const picture = (timestamp) => (++open, { timestamp, format: 'NV12', visibleRect: { width: 4, height: 2 }, allocationSize: () => 12,
    close: () => --open,
    copyTo: async (pixels) => {
      ++copies;
      pixels.fill(timestamp);
      if (grows) memory = new ArrayBuffer(128);
      grows = false;
      return [{ offset: 0, stride: 4 }, { offset: 8, stride: 4 }];
    } });
  const settle = () => new Promise((done) => setTimeout(done, 5));
  const decoder = new FrameDecoder('i420', heap, { onPicture() {}, onNoPlanes: () => assert.fail(), onFrame() {}, onFault: () => assert.fail() });
  decoder.configure('avc1.640028', new Uint8Array(), 4, 2);
  decoder.decode(new Uint8Array(1), 7, true, false);
  decode(picture(7));
  assert.deepEqual([open, copies], [0, 0], 'it leads to others only');
  decode(picture(9));
  await settle();
  assert.deepEqual([copies, blocks.size, open], [2, 1, 0], 'copied again, into one block');
  assert.equal(new Uint8Array(memory)[0], 9);
  assert.equal(decoder.peek().timestampUs, 9);
  const { block } = decoder.peek();
  decoder.shift(true);
  assert.ok(blocks.has(block), 'the player frees it');
  decode(picture(10));
  await settle();
  decoder.shift(false);
  assert.equal(blocks.size, 1, 'one that was not wanted is freed');
  decode(picture(11));
  decoder.dispose();
  await settle();
  assert.deepEqual([blocks.size, open], [1, 0], 'a copy on its way');
  delete globalThis.VideoDecoder;
  delete globalThis.EncodedVideoChunk;
});

test('planes that cannot be copied are not the decoder\'s fault; a copy that does not end does not hold up those after it', async () => {
  const { FrameDecoder } = await load('decode/frame-decoder');
  let decode, noPlanes = 0;
  globalThis.VideoDecoder = class {
    state = 'unconfigured';
    decodeQueueSize = 0;
    constructor(init) { decode = init.output; }
    configure() { this.state = 'configured'; }
    close() { this.state = 'closed'; }
  };
  const memory = new Uint8Array(12), heap = { allocate: () => 1, free() {}, bytes: () => memory };
  const picture = (copyTo) => ({ timestamp: 1, format: 'I420', visibleRect: { width: 4, height: 2 }, allocationSize: () => 12, close() {}, copyTo });
  const settle = () => new Promise((done) => setTimeout(done, 5));
  const decoder = new FrameDecoder('i420', heap, { onPicture() {}, onNoPlanes: () => ++noPlanes, onFrame() {}, onFault: () => assert.fail() });
  const configure = () => decoder.configure('avc1.640028', new Uint8Array(), 4, 2);
  configure();
  decode(picture(() => { throw new DOMException('not here', 'SecurityError'); }));
  await settle();
  decode(picture(async () => { throw new DOMException('not here', 'SecurityError'); }));
  await settle();
  assert.equal(noPlanes, 2);
  decode(picture(() => new Promise(() => undefined)));
  assert.equal(decoder.missing, 'upload');
  configure();
  assert.equal(decoder.missing, null);
  decode(picture(async () => [{ offset: 0, stride: 4 }]));
  await settle();
  assert.equal(decoder.peek().timestampUs, 1);
  delete globalThis.VideoDecoder;
});

test('where drawing is slow, the camera alone gets every second turn', async () => {
  const { DrawPace } = await load('page/frame-loop');
  const drawn = (stepS, pictures) => {
    const pace = new DrawPace();
    for (let i = 0; i < 30; ++i) pace.takes(stepS, true);
    return pictures.map((picture) => pace.takes(stepS, picture));
  };
  const still = new Array(8).fill(false);
  for (const hertz of [60, 30]) assert.ok(drawn(1 / hertz, still).every(Boolean), `a display of ${hertz} Hz is not slow`);
  assert.equal(drawn(0.05, still).filter(Boolean).length, 4);
  assert.ok(drawn(0.05, still.map(() => true)).every(Boolean), 'no picture is left out');
});
