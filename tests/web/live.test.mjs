// SPDX-License-Identifier: Apache-2.0
// A live stream in the browser: a WebSocket server sends the surfaces of the fuzzing corpus and pictures that the page
// itself has encoded. It is interrupted, begins anew, refuses, and ends.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, readCanvas, waitForEvent } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage } from './ssim.mjs';

const kGop = 12, kSamples = 48, kPeriodMs = 40;
const kManifest = {
  version: 4, appearance: 'cameras', name: 'body', vertexCount: 200, faceCount: 400, groundY: 0,
  bounds: { min: [-0.4, 0.1, -0.4], max: [0.4, 1.7, 0.4] },
  cameras: [[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0.9, 3, 1], [0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, 0, 0, 0.9, 3, 1]].map((camFromWorld, k) =>
    ({ name: `cam${k}`, width: 100, height: 120, fx: 190, fy: 190, cx: 50, cy: 60, camFromWorld })),
  live: {
    session: '0000000000000001', fps: 25, layout: [64, 48], codec: 'vp8', width: 192, height: 64, tiles: [0, 16, 64, 48],
    barcode: { rect: [0, 4, 128, 4], cellSize: 4 }, origin: [-1, 0, -1], step: 0.0005,
  },
};

// Chunks of one frame, out of the messages of the corpus.
function corpusChunks() {
  const file = readFileSync(new URL('../fuzz/corpus/live_player_fuzz/frames.bin', import.meta.url)), chunks = [];
  for (let at = 0; at < file.length; ) {
    const message = file.subarray(at + 4, (at += 4 + file.readUInt32LE(at)));
    if (message.length) chunks.push(message.subarray(28, 28 + message.readUInt32LE(20)));
  }
  return chunks;
}

// Runs in the page: pictures of frames 0 … count - 1, encoded.
async function encodePictures({ count, gop }) {
  const [width, height] = [192, 64], samples = [];
  const encoder = new VideoEncoder({
    output(chunk) {
      const bytes = new Uint8Array(chunk.byteLength);
      chunk.copyTo(bytes);
      samples.push({ key: chunk.type === 'key', base64: btoa(String.fromCharCode(...bytes)) });
    },
    error: (reason) => console.error(String(reason)),
  });
  encoder.configure({ codec: 'vp8', width, height, bitrate: 4_000_000, latencyMode: 'realtime' });
  for (let number = 0; number < count; ++number) {
    const planes = new Uint8Array(width * height * 1.5).fill(150, 0, width * height).fill(100, width * height);
    const gray = number ^ (number >> 1);
    let crc = 0;
    for (let bit = 11; bit >= 0; --bit) crc = ((crc << 1) ^ (((crc >> 3) ^ (gray >> bit)) & 1 ? 3 : 0)) & 15;
    const bits = (gray << 4) | crc;
    for (let y = 4; y < 8; ++y)
      for (let x = 0; x < 128; ++x) planes[y * width + x] = (bits >> (15 - ((x >> 2) & 15))) & 1 ? 235 : 16;
    const frame = new VideoFrame(planes, { format: 'I420', codedWidth: width, codedHeight: height, timestamp: number * 40_000 });
    encoder.encode(frame, { keyFrame: number % gop === 0 });
    frame.close();
  }
  await encoder.flush();
  return samples;
}

// A server of live streams: { url, connections, session, refuse (a close code), drop(), pings, close() }.
async function serveLive(samples) {
  const chunks = corpusChunks(), sockets = new Set(), server = createServer();
  const live = { connections: 0, pings: 0, ended: 0, session: kManifest.live.session, refuse: 0 };
  const header = (opcode, length) => {
    const bytes = length < 126 ? Buffer.from([0x80 | opcode, length]) : Buffer.alloc(length < 65536 ? 4 : 10);
    if (bytes.length === 4) bytes.set([0x80 | opcode, 126]), bytes.writeUInt16BE(length, 2);
    if (bytes.length === 10) bytes.set([0x80 | opcode, 127]), bytes.writeBigUInt64BE(BigInt(length), 2);
    return bytes;
  };
  const nowUs = () => Math.round((performance.timeOrigin + performance.now()) * 1000);
  const frameOf = (count) => {
    const index = count % kSamples, { key, base64 } = samples[index];
    const chunk = chunks[index % chunks.length], sample = Buffer.from(base64, 'base64'), head = Buffer.alloc(28);
    head.write('4DVL');
    head.writeUInt16LE(1, 4);
    head.writeUInt16LE(key ? 1 : 0, 6);
    head.writeUInt32LE(index + 4096 * Math.floor(count / kSamples), 8); // as the barcode says; a gap before a key
    head.writeBigInt64LE(BigInt(nowUs()), 12);
    head.writeUInt32LE(chunk.length, 20);
    head.writeUInt32LE(sample.length, 24);
    return Buffer.concat([head, chunk, sample]);
  };
  let count = 0;
  server.on('upgrade', (request, socket) => {
    ++live.connections;
    sockets.add(socket);
    const accept = createHash('sha1').update(`${request.headers['sec-websocket-key']}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
    const send = (opcode, data) => socket.write(Buffer.concat([header(opcode, data.length), data]));
    if (live.refuse) return send(8, Buffer.from([live.refuse >> 8, live.refuse & 255]));
    const extension = { ...kManifest, live: { ...kManifest.live, session: live.session } };
    send(1, Buffer.from(JSON.stringify({ asset: { version: '2.0' }, extensions: { FOURDVT_layered_video_texture: extension } })));
    count += kGop - (count % kGop); // a key
    const timer = setInterval(() => send(2, frameOf(count++)), kPeriodMs);
    let pending = Buffer.alloc(0);
    socket.on('data', (data) => { // short masked messages; a close is answered, or browsers hold the connection for a minute
      pending = Buffer.concat([pending, data]);
      while (pending.length >= 6 && pending.length >= 6 + (pending[1] & 127)) {
        const length = pending[1] & 127, mask = pending.subarray(2, 6);
        const text = Buffer.from(pending.subarray(6, 6 + length)).map((byte, i) => byte ^ mask[i % 4]);
        const opcode = pending[0] & 15;
        pending = pending.subarray(6 + length);
        if (opcode === 8) socket.end(Buffer.concat([header(8, text.length), text]));
        if (opcode !== 1) continue;
        ++live.pings;
        send(1, Buffer.from(JSON.stringify({ type: 'pong', t: JSON.parse(text).t, now: nowUs() })));
      }
    });
    socket.on('error', () => undefined);
    socket.on('close', () => {
      ++live.ended;
      clearInterval(timer);
      sockets.delete(socket);
    });
  });
  live.drop = () => { for (const socket of sockets) socket.destroy(); };
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  live.url = `ws://127.0.0.1:${server.address().port}/live?token=secret`;
  live.close = () => {
    live.drop();
    server.close();
  };
  return live;
}

let server, browser, page, live;
before(async () => {
  browser = await launch();
  server = await serve(environment('SITE'));
  page = await openPage(browser, { viewport: { width: 320, height: 420 } });
  await page.context().grantPermissions(['local-network-access']); // a page that no server has sent is of no network
  await page.route('**/blank.html', (route) => route.fulfill({
    contentType: 'text/html', body: '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">' }));
  await page.goto(`${server.url}blank.html`);
  live = await serveLive(await page.evaluate(encodePictures, { count: kSamples, gop: kGop }));
});
after(async () => {
  await browser?.close();
  live?.close();
  await server?.close();
});
const viewer = (what) => page.evaluate((what) => document.querySelector('fourdvt-viewer')[what], what);
const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });
const shown = async (more) => until((least) => document.querySelector('fourdvt-viewer').stats?.framesShown >= least, (await viewer('stats')).framesShown + more);

test('a live stream is shown, with its state and latency', async () => {
  await page.evaluate(async (src) => {
    await import('/fourdvt-viewer/fourdvt-viewer.js');
    const viewer = document.createElement('fourdvt-viewer');
    globalThis.states = [];
    viewer.addEventListener('livestatechange', (e) => globalThis.states.push(e.detail));
    viewer.setAttribute('autoplay', '');
    viewer.src = src;
    document.body.append(viewer);
  }, live.url);
  await waitForEvent(page, 'canplay');
  await shown(10);
  assert.equal(await viewer('liveState'), 'live');
  await until(() => { // 0 where the error of the clock, up to half a trip, exceeds it
    const { liveLatency } = document.querySelector('fourdvt-viewer');
    return liveLatency > 0 && liveLatency < 30;
  });
  assert.equal(await viewer('duration'), Infinity);
  const stats = await viewer('stats');
  assert.ok(stats.barcodeChecked >= 10);
  assert.equal(stats.barcodeMismatches, 0);
  assert.ok(coverage(await readCanvas(page)) > 0.02);
  assert.ok(await page.evaluate(async () => (await document.querySelector('fourdvt-viewer').toBlob({ width: 64, height: 64 })).size > 100));
  assert.ok(live.pings > 0);
});

test('paused it holds a frame, and goes on with the newest', async () => {
  await page.evaluate(() => document.querySelector('fourdvt-viewer').pause());
  const frame = await viewer('frame');
  await page.waitForTimeout(400);
  assert.equal(await viewer('frame'), frame);
  await page.evaluate(() => document.querySelector('fourdvt-viewer').play());
  await shown(3);
});

test('after an interruption the same player goes on', async () => {
  const { framesShown } = await viewer('stats');
  live.drop();
  await until(() => globalThis.states.at(-1) === 'stalled');
  await until(() => globalThis.states.at(-1) === 'live');
  assert.ok((await viewer('stats')).framesShown >= framesShown);
  await shown(5);
  assert.equal(live.connections, 2);
});

test('a stream that has begun anew is loaded in place, and the camera stays', async () => {
  await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.setAttribute('camera-orbit', '70deg 20deg 2.5m');
    viewer.jumpCameraToGoal();
    globalThis.viewerEvents.length = 0;
  });
  const orbit = await page.evaluate(() => document.querySelector('fourdvt-viewer').getCameraOrbit());
  live.session = '0000000000000002';
  live.drop();
  await waitForEvent(page, 'canplay');
  await shown(5);
  assert.deepEqual(await page.evaluate(() => document.querySelector('fourdvt-viewer').getCameraOrbit()), orbit);
  assert.equal((await viewer('stats')).barcodeMismatches, 0);
});

test('a refused token is one error, and another src closes the connection', async () => {
  await page.evaluate(() => { globalThis.viewerEvents.length = 0; });
  live.refuse = 4401;
  live.drop();
  await until(() => globalThis.viewerEvents.some(({ type }) => type === 'error'));
  const { detail } = await page.evaluate(() => globalThis.viewerEvents.find(({ type }) => type === 'error'));
  assert.equal(detail.id, 'fetch-failed');
  assert.match(detail.message, /token/);
  assert.doesNotMatch(detail.message, /secret/);
  const { connections } = live;
  await page.waitForTimeout(600);
  assert.equal(live.connections, connections);
  live.refuse = 0;
  await page.evaluate(() => {
    globalThis.viewerEvents.length = 0;
    document.querySelector('fourdvt-viewer').load();
  });
  await waitForEvent(page, 'canplay');
  const { ended } = live;
  await page.evaluate(() => document.querySelector('fourdvt-viewer').remove());
  for (const end = Date.now() + kPatienceMs; live.ended === ended && Date.now() < end; ) await page.waitForTimeout(20);
  assert.equal(live.ended, ended + 1);
  assert.deepEqual(page.troubles, []);
});
