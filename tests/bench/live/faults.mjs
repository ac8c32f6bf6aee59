// SPDX-License-Identifier: Apache-2.0
// Faults of a live system, each injected while a page watches: the frames that the page misses, and the time to
// recovery. Results: {seen, recovery_s or null, figures}.
import { connect } from 'node:net';

import { mean, median, quantile, rowsOf } from './latency.mjs';
import { LiveCamera, LiveServer, Link, pause, until } from './processes.mjs';
import { Receiver } from './receiver.mjs';
import { kCameras, readStream, stage } from './stages.mjs';
import { folderOf, withSystem } from './system.mjs';

const kSize = '320x240', kFps = 25;
const kVictim = 'cam02', kVictimAt = kCameras.indexOf(kVictim);
const kViewer = { width: 160, height: 120 };

const longestGap = (times) => Math.max(0, ...times.slice(1).map((ms, i) => ms - times[i]));
const perSecond = (times, from, to) => times.filter((ms) => ms >= from && ms < to).length / ((to - from) / 1000);
const cameraOf = async (server, name) => (await server.status()).cameras.find((camera) => camera.name === name);

function fault(name, title, use, options = {}) {
  return { name, title, kind: 'fault', measure: (work) => withSystem(stage(work, kSize, kFps), options, async (system) => {
    const receiver = await Receiver.open(system.browser, system.server);
    await pause(5000);
    await receiver.clear();
    return use({ ...system, receiver, work, folder: folderOf(work, name), rows: async () => {
      const arrivals = await receiver.write(folderOf(work, name));
      return rowsOf(readStream(folderOf(work, name), system.stage), arrivals, system.stage);
    } });
  }) };
}

const killed = fault('camera-killed', 'a camera is killed, and started again 5 s later', async ({ server, cameras, add, rows }) => {
  const victim = cameras[kVictimAt];
  await pause(3000);
  await victim.stop('SIGKILL');
  const killedMs = Date.now();
  await pause(5000);
  add(new LiveCamera(server, kVictim));
  const startedMs = Date.now();
  await pause(6000);
  const all = await rows(), shown = (row) => row.cameras[kVictimAt].shown;
  const without = all.filter((row) => row.ms > killedMs + 1000 && row.ms < startedMs), back = all.find((row) => row.ms > startedMs && shown(row));
  const gap = longestGap(all.filter((row) => row.ms > killedMs - 200 && row.ms < startedMs).map((row) => row.ms));
  return {
    seen: `pause of ${Math.round(gap)} ms, then the hull of five cameras at ${perSecond(all.map((row) => row.ms), killedMs + 1000, startedMs).toFixed(1)} a second`,
    recovery_s: back ? (back.ms - startedMs) / 1000 : NaN, recovery: 'from the start of its process to its picture in the page',
    without_share: without.filter((row) => !shown(row)).length / without.length, gap_ms: gap,
  };
});

const late = fault('camera-late', 'a camera comes 200 ms late', async ({ server, cameras, add, rows }) => {
  await pause(4000);
  const before = Date.now();
  await cameras[kVictimAt].stop();
  add(new LiveCamera(server, kVictim, { options: ['--delay-ms', '200'] }));
  const startedMs = Date.now();
  await pause(10_000);
  const camera = await cameraOf(server, kVictim), all = await rows();
  const settled = all.filter((row) => row.ms > startedMs + 4000), first = all.filter((row) => row.ms < before);
  return {
    seen: `${perSecond(all.map((row) => row.ms), startedMs + 4000, startedMs + 10_000).toFixed(1)} hulls a second, ${median(settled.map((row) => row.latency)).toFixed(0)} ms late (before: ${median(first.map((row) => row.latency)).toFixed(0)}), the late camera in ${Math.round(100 * mean(settled.map((row) => Number(row.cameras[kVictimAt].shown))))} % of them; ${camera.late} of its pictures left out`,
    recovery_s: null, recovery: 'none: it is not waited for', others: settled.filter((row) => row.others).length,
  };
});

const clock = fault('clock-off', 'a camera\'s clock is 3 s off', async ({ server, cameras, add, rows }) => {
  await pause(2000);
  await cameras[kVictimAt].stop();
  add(new LiveCamera(server, kVictim, { options: ['--clock-off', '3'] }));
  const startedMs = Date.now();
  await pause(8000);
  const camera = await cameraOf(server, kVictim), all = await rows();
  const back = all.find((row) => row.ms > startedMs && row.cameras[kVictimAt].shown), after = all.filter((row) => back && row.ms >= back.ms);
  return {
    seen: `offset measured: ${camera.clock_offset_ms.toFixed(2)} ms; frames with pictures of different instants: ${after.filter((row) => row.others).length} of ${after.length}`,
    recovery_s: back ? (back.ms - startedMs) / 1000 : NaN, recovery: 'from the start of its process to its picture in the page',
  };
});

const cut = fault('connection-cut', 'a camera\'s connection is cut in the middle of a message, five times; and split into single bytes', async ({ server, cameras, add, rows }) => {
  await cameras[kVictimAt].stop();
  const link = add(await new Link(server.port, { pieceBytes: 1 }).listen());
  add(new LiveCamera(server, kVictim, { port: link.port }));
  await until(async () => (await cameraOf(server, kVictim)).connected);
  await pause(3000);
  const cuts = [];
  for (let i = 0; i < 5; ++i) {
    link.cutAfter = 1001 + 777 * i; // a picture's message has some 4,000 bytes
    const count = link.cuts;
    await until(() => link.cuts > count);
    cuts.push(link.cutMs);
    await pause(3000);
  }
  const all = await rows(), refused = (await server.status()).refused;
  const backs = cuts.map((ms) => {
    const gone = all.find((row) => row.ms > ms && !row.cameras[kVictimAt].shown);
    return gone ? (all.find((row) => row.ms > gone.ms && row.cameras[kVictimAt].shown)?.ms ?? NaN) - ms : 0;
  });
  return {
    seen: `single bytes: nothing; cut: the hull of five cameras until it returns, longest pause ${Math.round(longestGap(all.filter((row) => row.ms > cuts[0] - 100).map((row) => row.ms)))} ms; connections and messages refused: ${refused}`,
    recovery_s: Math.max(...backs) / 1000, recovery: `longest of five from the cut to its picture in the page (median ${(median(backs) / 1000).toFixed(2)} s)`,
  };
});

// Performs a WebSocket handshake by hand, then sends bytes that are no valid frames.
function hostile(port, head, body) {
  return new Promise((done) => {
    const socket = connect(port, '127.0.0.1', () => socket.write(head));
    let open = true;
    const end = () => { if (open) { open = false; socket.destroy(); done(); } };
    socket.on('data', () => { for (const part of body) socket.write(part); });
    socket.on('close', end);
    socket.on('error', end);
    setTimeout(end, 3000);
  });
}

const noise = (bytes, seed) => {
  const out = Buffer.alloc(bytes);
  for (let i = 0, x = seed >>> 0 || 1; i < bytes; ++i) {
    x ^= x << 13; x >>>= 0; x ^= x >>> 17; x ^= x << 5; x >>>= 0;
    out[i] = x;
  }
  return out;
};

// Valid binary WebSocket message of a client: masked, with its length.
function message(payload) {
  const head = payload.length < 126 ? Buffer.from([0x82, 0x80 | payload.length]) : Buffer.from([0x82, 0xfe, payload.length >> 8, payload.length & 255]);
  return Buffer.concat([head, Buffer.alloc(4), payload]);
}

const garbage = fault('garbage', 'sixty clients send garbage: without a handshake, after it, as cameras and viewers with tokens', async ({ server, rows }) => {
  await pause(3000);
  const beganMs = Date.now(), jobs = [];
  const upgrade = (path) => `GET ${path} HTTP/1.1\r\nHost: localhost:${server.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n`;
  for (let i = 0; i < 20; ++i) {
    jobs.push(hostile(server.port, noise(20_000, 7 * i + 1), []));
    jobs.push(hostile(server.port, upgrade(`/camera?token=${server.token('camera')}`), [message(noise(100 + 600 * i, i + 1)), message(noise(30_000, i + 2))]));
    jobs.push(hostile(server.port, upgrade(`/live?token=${server.token('viewer')}`), [noise(5000, i + 3)]));
  }
  await Promise.all(jobs);
  const endedMs = Date.now();
  await pause(3000);
  const all = await rows(), refused = (await server.status()).refused, times = all.map((row) => row.ms);
  return {
    seen: `${perSecond(times, beganMs, endedMs).toFixed(1)} hulls a second meanwhile (before ${perSecond(times, beganMs - 3000, beganMs).toFixed(1)}), longest pause ${Math.round(longestGap(times))} ms; connections and messages refused: ${refused}`,
    recovery_s: 0, recovery: 'nothing to recover from', refused,
  };
});

const slow = fault('slow-viewer', 'a viewer on 1 Mbit/s beside a fast one', async ({ server, browser, add, rows, stage: theStage, work }) => {
  const beganMs = Date.now();
  await pause(8000);
  const link = add(await new Link(server.port, { bytesPerSecond: 125_000 }).listen());
  const slowMs = Date.now();
  const other = await Receiver.open(browser, server, { address: server.viewerAddress.replace(`:${server.port}/`, `:${link.port}/`) });
  await pause(12_000);
  const endMs = Date.now(), folder = folderOf(work, 'slow-viewer-slow');
  const fast = await rows(), arrivals = await other.write(folder), slowRows = rowsOf(readStream(folder, theStage), arrivals, theStage).filter((row) => row.ms < endMs);
  const latencies = (from, to) => fast.filter((row) => row.ms >= from && row.ms < to).map((row) => row.latency), times = fast.map((row) => row.ms);
  const { viewers_skipped: skipped } = await server.status();
  await other.close();
  return {
    seen: `slow: ${perSecond(slowRows.map((row) => row.ms), slowMs + 2000, endMs).toFixed(1)} frames a second, ${(median(slowRows.map((row) => row.latency)) / 1000).toFixed(1)} s old (95 %: ${(quantile(slowRows.map((row) => row.latency), 0.95) / 1000).toFixed(1)} s), ${skipped} left out; fast: ${perSecond(times, slowMs + 2000, endMs).toFixed(1)} a second, ${median(latencies(slowMs + 2000, endMs)).toFixed(0)} ms (before ${perSecond(times, beganMs, slowMs).toFixed(1)}, ${median(latencies(beganMs, slowMs)).toFixed(0)} ms)`,
    recovery_s: slowRows.length ? (slowRows[0].ms - slowMs) / 1000 : NaN, recovery: 'from opening the slow page to its first frame',
  };
});

const restarted = fault('server-restarted', 'the server is killed, and started again 3 s later; pages stay open', async ({ server, browser, add, stage: theStage }) => {
  const viewer = await Receiver.open(browser, server, { viewer: kViewer });
  await until(async () => (await viewer.times()).states.some(({ state }) => state === 'live'), 60_000);
  await pause(3000);
  const killedMs = Date.now();
  await server.stop('SIGKILL');
  await pause(3000);
  const startedMs = Date.now();
  add(await new LiveServer(theStage.folder, { port: server.port }).listening());
  await until(async () => (await viewer.times()).states.filter(({ ms, state }) => ms > startedMs && state === 'live').length > 0, 60_000, 100);
  await pause(2000);
  const { states, frames } = await viewer.times();
  const live = states.find(({ ms, state }) => ms > startedMs && state === 'live'), stalled = states.find(({ ms, state }) => ms >= killedMs && state === 'stalled');
  const first = frames.find(({ ms }) => ms > startedMs);
  await viewer.close();
  return {
    seen: `liveState stalled ${stalled ? `after ${((stalled.ms - killedMs) / 1000).toFixed(1)} s` : 'never'}, the last picture stays; errors shown: ${states.filter(({ state }) => state.startsWith('error')).length}`,
    recovery_s: live ? (live.ms - startedMs) / 1000 : NaN, recovery: `from the server's start to live in the page (first frame: ${first ? ((first.ms - startedMs) / 1000).toFixed(1) : '–'} s); cameras and pages connect by themselves`,
  };
});

const joined = fault('viewer-joins', 'a viewer joins', async ({ browser, server }) => {
  const waits = [], pictures = [];
  for (let i = 0; i < 5; ++i) {
    const viewer = await Receiver.open(browser, server);
    await until(async () => (await viewer.count()) > 0);
    waits.push((await viewer.times()).frames[0].ms - viewer.openedMs);
    await viewer.close();
  }
  const drawn = await Receiver.open(browser, server, { viewer: kViewer });
  await until(async () => (await drawn.times()).pictures.length > 0, 60_000);
  const times = await drawn.times();
  pictures.push(times.pictures[0] - times.frames[0].ms);
  await drawn.close();
  return { seen: `first frame, a key, after ${median(waits).toFixed(0)} ms (five times: ${Math.min(...waits).toFixed(0)} to ${Math.max(...waits).toFixed(0)} ms)`,
    recovery_s: median(waits) / 1000, recovery: `from opening the connection; decoded ${pictures[0].toFixed(0)} ms later, where the player is there by then` };
});

export const faults = [joined, killed, late, clock, cut, garbage, slow, restarted];
