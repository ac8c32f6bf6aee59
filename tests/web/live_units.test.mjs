// SPDX-License-Identifier: Apache-2.0
// web/src/live/live.ts without a browser: with fakes of WebSocket, page and player, and a clock that the test advances.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { requireFromWeb } from './harness.mjs';

const { buildSync } = requireFromWeb('esbuild');
const kServerAheadMs = 1_700_000_000_000;
let folder, LiveStream;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-live-'));
  const outfile = join(folder, 'live.mjs');
  buildSync({ entryPoints: [fileURLToPath(new URL('../../web/src/live/live.ts', import.meta.url))], outfile, bundle: true, format: 'esm', logLevel: 'silent' });
  ({ LiveStream } = await import(pathToFileURL(outfile).href));
});
after(() => rmSync(folder, { recursive: true, force: true }));

const manifestOf = (session) => JSON.stringify({ extensions: { FOURDVT_layered_video_texture: { live: { session } } } });

class Socket {
  readyState = 1;
  sent = [];
  closed = false;
  constructor(url) { this.url = url; }
  send(text) { this.sent.push(JSON.parse(text)); }
  close() { this.closed = true; }
  // Messages of the server.
  text(value) { this.onmessage({ data: typeof value === 'string' ? value : JSON.stringify(value) }); }
  frame(...bytes) { this.onmessage({ data: Uint8Array.from(bytes).buffer }); }
  end(code = 1006) { this.onclose({ code }); }
}

// A stream with everything around it. random: 1, so that pauses have their full length.
function scene(url = 'ws://localhost:8090/live?token=secret', { origin = 'http://localhost', actor = true } = {}) {
  const s = { sockets: [], events: [], waits: [], fed: [], failures: [], replaced: [], nowMs: 0, timers: new Map(), heard: {}, hidden: false, capturedUs: 0, complaint: null };
  let lastTimer = 0;
  const memory = new Uint8Array(1 << 20);
  const module = {
    HEAPU8: memory,
    _fdvt_alloc: () => 64,
    _fdvt_free() {},
    _fdvt_live_frame(handle, at, size) {
      if (size && s.complaint) return 0;
      s.fed.push(size ? [...memory.subarray(at, at + size)] : 'gap');
      return 1;
    },
    _fdvt_live_captured_us: () => s.capturedUs,
  };
  const player = { call(action) { if (!action(module, 1)) throw Object.assign(new Error(s.complaint), { id: 'stream-invalid' }); } };
  s.actor = { player, run: (action) => action(player) };
  const there = { actor: actor ? s.actor : null };
  s.bring = () => (there.actor = s.actor);
  const page = {
    open: (address) => {
      const socket = new Socket(address);
      s.sockets.push(socket);
      return socket;
    },
    now: () => s.nowMs,
    random: () => 1,
    setTimeout(run, ms) {
      s.timers.set(++lastTimer, { run, due: s.nowMs + ms });
      return lastTimer;
    },
    clearTimeout: (timer) => s.timers.delete(timer),
    listen: (name, run) => (s.heard[name] = run),
    get hidden() { return s.hidden; },
    origin,
  };
  s.turn = (ms) => {
    const end = s.nowMs + ms;
    for (;;) {
      const [next] = [...s.timers].filter(([, { due }]) => due <= end).sort(([, a], [, b]) => a.due - b.due);
      if (!next) break;
      s.timers.delete(next[0]);
      s.nowMs = Math.max(s.nowMs, next[1].due);
      next[1].run();
    }
    s.nowMs = end;
  };
  s.hide = (hidden) => {
    s.hidden = hidden;
    s.heard.visibilitychange();
  };
  s.stream = new LiveStream(url, {
    actor: () => there.actor,
    emit: (name, detail) => s.events.push([name, detail?.id ?? detail]),
    network: (waiting) => s.waits.push(waiting),
    replace: (manifest) => s.replaced.push(manifest.extensions.FOURDVT_layered_video_texture.live.session),
    fail(id, message) {
      s.failures.push([id, message]);
      s.stream.dispose();
    },
  }, page);
  s.manifest = s.stream.manifest();
  Object.defineProperty(s, 'socket', { get: () => s.sockets.at(-1) });
  s.begin = (session = 'a') => {
    s.socket.text(manifestOf(session));
    s.socket.frame(1);
  };
  return s;
}

test('manifest and frames are handed over, and the state follows them', async () => {
  const s = scene();
  assert.equal(s.stream.state, 'connecting');
  assert.equal(s.socket.url, 'ws://localhost:8090/live?token=secret');
  assert.equal(s.socket.binaryType, 'arraybuffer');
  s.socket.text(manifestOf('a'));
  assert.equal((await s.manifest).extensions.FOURDVT_layered_video_texture.live.session, 'a');
  s.socket.frame(1, 2);
  s.socket.frame(3);
  assert.deepEqual(s.fed, [[1, 2], [3]]);
  assert.equal(s.stream.state, 'live');
  s.turn(1400);
  assert.equal(s.stream.state, 'live');
  s.turn(700);
  assert.equal(s.stream.state, 'stalled');
  s.socket.frame(4);
  assert.deepEqual(s.events, [['livestatechange', 'live'], ['livestatechange', 'stalled'], ['livestatechange', 'live']]);
  assert.equal(s.sockets.length, 1);
  assert.deepEqual(s.waits, []);
});

test('frames that come before the player are kept, if they are few', () => {
  const s = scene(undefined, { actor: false });
  s.socket.text(manifestOf('a'));
  for (let i = 0; i < 3; ++i) s.socket.frame(i);
  s.bring();
  s.socket.frame(3);
  assert.deepEqual(s.fed, [[0], [1], [2], [3]]);
  const many = scene(undefined, { actor: false });
  many.socket.text(manifestOf('a'));
  for (let i = 0; i < 9; ++i) many.socket.frame(i);
  many.bring();
  many.socket.frame(9);
  assert.deepEqual(many.fed, [[9]]);
});

test('a lost connection is made again after growing pauses; the same session goes on after a gap', () => {
  const s = scene();
  s.begin();
  const pauses = [];
  for (let i = 0; i < 7; ++i) {
    const [count, since] = [s.sockets.length, s.nowMs];
    s.socket.end();
    while (s.sockets.length === count) s.turn(50);
    pauses.push(s.nowMs - since);
  }
  assert.deepEqual(pauses, [250, 500, 1000, 2000, 4000, 4000, 4000]);
  assert.equal(s.stream.state, 'stalled');
  assert.deepEqual(s.waits, [true]);
  s.begin();
  assert.deepEqual(s.replaced, []);
  assert.deepEqual(s.fed.filter((frame, i) => frame !== 'gap' || s.fed[i - 1] !== 'gap'), [[1], 'gap', [1]]);
  assert.equal(s.stream.state, 'live');
  assert.deepEqual(s.waits, [true, false]);
  s.socket.end();
  s.turn(250);
  assert.equal(s.sockets.length, 9, 'a frame ends the row of pauses');
});

test('the browser comes online, or the page is shown: it connects at once', () => {
  const s = scene();
  s.begin();
  for (let i = 0; i < 6; ++i) {
    s.socket.end();
    if (i < 5) s.turn(5000);
  }
  const count = s.sockets.length;
  s.heard.online();
  assert.equal(s.sockets.length, count + 1);
  s.heard.online();
  assert.equal(s.sockets.length, count + 1, 'not while there is a connection');
});

test('a page that stays hidden lets the connection go', () => {
  const s = scene();
  s.begin();
  s.hide(true);
  s.turn(9000);
  s.socket.frame(2);
  s.hide(false);
  s.turn(1400);
  assert.equal(s.sockets.length, 1, 'not in 9 s');
  s.socket.frame(3);
  const first = s.socket;
  s.hide(true);
  for (let i = 0; i < 10; ++i) {
    s.turn(999);
    s.socket.frame(4);
  }
  assert.ok(!first.closed);
  s.turn(20);
  assert.ok(first.closed);
  assert.equal(s.fed.at(-1), 'gap');
  s.turn(60_000);
  assert.equal(s.sockets.length, 1);
  s.hide(false);
  assert.equal(s.sockets.length, 2);
  s.begin();
  assert.equal(s.stream.state, 'live');
  s.hide(true);
  s.socket.end();
  s.turn(60_000);
  assert.equal(s.sockets.length, 2, 'nothing is tried while it is hidden');
});

test('another session is another character', () => {
  const s = scene();
  s.begin('a');
  s.socket.end();
  s.turn(250);
  s.begin('b');
  assert.deepEqual(s.replaced, ['b']);
  s.socket.end();
  s.turn(250);
  s.begin('b');
  assert.deepEqual(s.replaced, ['b']);
});

test('the camera stays if the boxes are alike', () => {
  const { stream } = scene();
  const box = (x) => ({ min: [x - 0.5, 0, -0.5], max: [x + 0.5, 1.8, 0.5] });
  assert.equal(stream.keepsCamera(box(0)), false);
  assert.equal(stream.keepsCamera(box(0.2)), true);
  assert.equal(stream.keepsCamera(box(1)), false);
});

for (const [code, words] of [[4401, /token/], [4403, /pages of http:\/\/localhost;/]]) {
  test(`close code ${code} is one error without further attempts`, () => {
    const s = scene();
    s.socket.end(code);
    s.turn(60_000);
    assert.equal(s.failures.length, 1);
    assert.match(s.failures[0][1], words);
    assert.doesNotMatch(s.failures[0][1], /secret/, 'the token stays out of messages');
    assert.equal(s.sockets.length, 1);
    assert.equal(s.timers.size, 0);
  });
}

test('a server that never answers is one error, and is tried on', () => {
  const s = scene();
  for (let i = 0; i < 12; ++i) {
    s.socket.end();
    s.turn(4000);
  }
  assert.deepEqual(s.events, [['error', 'fetch-failed']]);
  assert.equal(s.sockets.length, 13);
  s.begin();
  assert.equal(s.stream.state, 'live');
});

test('a page over https connects over wss, or to this machine', () => {
  const options = { origin: 'https://page.example' };
  const refused = scene('ws://server.example/live', options);
  assert.deepEqual([refused.failures.length, refused.sockets.length], [1, 0]);
  assert.match(refused.failures[0][1], /wss/);
  for (const url of ['wss://server.example/live', 'ws://localhost:8090/live', 'ws://127.0.0.1:8090/live', 'ws://[::1]/live']) {
    assert.equal(scene(url, options).sockets.length, 1, url);
  }
});

const kInvalid = {
  'text that is no JSON': (s) => s.socket.text('{'),
  'JSON that is no manifest': (s) => s.socket.text('{"asset":{}}'),
  'a frame before the manifest': (s) => s.socket.frame(1),
  'a message of more than 8 MiB': (s) => {
    s.socket.text(manifestOf('a'));
    s.socket.onmessage({ data: new ArrayBuffer(2 ** 23 + 1) });
  },
  'a text of more than 8 MiB': (s) => s.socket.text(`"${'a'.repeat(2 ** 23)}"`),
  'a frame that the player refuses': (s) => {
    s.socket.text(manifestOf('a'));
    s.complaint = 'live stream: not a frame; connect again';
    s.socket.frame(1);
    s.complaint = null;
  },
  'a surface that does not decode': (s) => {
    s.begin();
    assert.ok(s.stream.takes({ id: 'stream-invalid', message: 'live stream: a surface does not decode' }));
  },
};
for (const [name, spoil] of Object.entries(kInvalid)) {
  test(`${name}: one error, and five attempts in a row`, () => {
    const s = scene();
    for (let i = 1; i <= 5; ++i) {
      const { socket } = s;
      spoil(s);
      assert.ok(socket.closed);
      assert.equal(s.failures.length, i < 5 ? 0 : 1);
      assert.equal(s.events.filter(([event]) => event === 'error').length, 1);
      s.turn(4000);
    }
    assert.equal(s.failures[0][0], 'stream-invalid');
    assert.match(s.failures[0][1], /5 times/);
    assert.equal(s.sockets.length, 5);
  });
}

test('frames that go on end the row of invalid connections', () => {
  const s = scene();
  for (let i = 0; i < 12; ++i) {
    s.begin();
    for (let k = 0; k < 25; ++k) s.socket.frame(k);
    s.socket.text('{');
    s.turn(4000);
  }
  assert.equal(s.failures.length, 0);
  assert.equal(s.events.filter(([event]) => event === 'error').length, 12, 'one a row');
});

test('errors of the player that are no fault of the stream are not taken', () => {
  const s = scene();
  assert.equal(s.stream.takes({ id: 'decoder-lost', message: '' }), false);
  assert.ok(!s.socket.closed);
});

test('a dead connection is left', () => {
  const s = scene();
  s.begin();
  const first = s.socket;
  s.turn(10_000);
  assert.ok(!first.closed);
  s.turn(2000);
  assert.ok(first.closed);
  assert.equal(s.sockets.length, 2);
});

test('pings every 5 s tell the server\'s clock, by the quickest answer; the latency follows', () => {
  const s = scene();
  s.begin();
  assert.deepEqual(s.socket.sent, [{ type: 'ping', t: 0 }]);
  assert.ok(Number.isNaN(s.stream.latency));
  const pong = (tripMs, wrongMs) => {
    const { t } = s.socket.sent.at(-1);
    const serverUs = (kServerAheadMs + t + tripMs / 2 + wrongMs) * 1000;
    s.nowMs = t + tripMs;
    s.socket.text({ type: 'pong', t, now: serverUs });
  };
  pong(20, 0);
  assert.ok(Number.isNaN(s.stream.latency), 'nothing is shown yet');
  s.capturedUs = (kServerAheadMs - 130) * 1000;
  assert.ok(Math.abs(s.stream.latency - 0.15) < 1e-6);
  s.capturedUs = (kServerAheadMs + s.nowMs + 5) * 1000;
  assert.equal(s.stream.latency, 0, 'not before its capture');
  s.capturedUs = (kServerAheadMs - 130) * 1000;
  s.turn(5500);
  assert.equal(s.socket.sent.length, 2);
  pong(400, 90);
  s.capturedUs = (kServerAheadMs + s.nowMs - 200) * 1000;
  assert.ok(Math.abs(s.stream.latency - 0.2) < 1e-6, 'a slow answer says less');
  for (const odd of [{ type: 'pong' }, { type: 'pong', t: 1e12, now: 5 }, { type: 'later' }, []]) s.socket.text(odd);
  assert.ok(Math.abs(s.stream.latency - 0.2) < 1e-6);
  assert.deepEqual(s.events, [['livestatechange', 'live']].concat(s.events.slice(1)));
});

test('after dispose nothing runs, and what comes late is not heard', () => {
  const s = scene();
  s.begin();
  const { socket } = s;
  s.stream.dispose();
  assert.ok(socket.closed);
  socket.frame(2);
  socket.end();
  s.turn(60_000);
  assert.equal(s.timers.size, 0);
  assert.equal(s.sockets.length, 1);
  assert.deepEqual(s.fed, [[1]]);
});
