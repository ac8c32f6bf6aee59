// SPDX-License-Identifier: Apache-2.0
// A page that watches a live stream and keeps every message with its arrival time, by the machine's clock, which
// cameras and server share in these measurements.
import { closeSync, mkdirSync, openSync, writeFileSync, writeSync } from 'node:fs';
import { join } from 'node:path';

const kPagePath = '/live/live.css'; // any file without scripts

// Runs in the page before its scripts. `frames`: {ms, data}; `pictures`: times of decoded pictures; `states`: {ms,
// state}.
function keepMessages() {
  const kept = (globalThis.kept = { manifests: [], frames: [], pictures: [], states: [], latencies: [] });
  globalThis.WebSocket = class extends WebSocket {
    constructor(...words) {
      super(...words);
      this.addEventListener('message', ({ data }) => {
        const ms = performance.timeOrigin + performance.now();
        if (typeof data !== 'string') kept.frames.push({ ms, data });
        else if (data.includes('"extensions"')) kept.manifests.push({ ms, text: data });
      });
    }
  };
  if (typeof VideoDecoder === 'undefined') return;
  globalThis.VideoDecoder = class extends VideoDecoder {
    constructor({ output, error }) {
      super({ error, output(picture) { kept.pictures.push(performance.timeOrigin + performance.now()); output(picture); } });
    }
  };
}

// Runs in a page of the server's own origin: browsers let no other page connect to this machine.
function watchWithViewer({ address, width, height }) {
  const viewer = document.createElement('fourdvt-viewer'), note = (state) => kept.states.push({ ms: Date.now(), state });
  viewer.style.cssText = `display: block; width: ${width}px; height: ${height}px`;
  viewer.addEventListener('livestatechange', (e) => note(e.detail));
  viewer.addEventListener('error', (e) => note(`error: ${e.detail.message}`));
  viewer.addEventListener('canplay', () => note('canplay'));
  viewer.id = 'viewer';
  viewer.autoplay = true;
  viewer.src = address;
  document.body.replaceChildren(viewer);
  setInterval(() => { if (Number.isFinite(viewer.liveLatency)) kept.latencies.push(1000 * viewer.liveLatency); }, 53);
  return import('/fourdvt-viewer/fourdvt-viewer.js').then(() => undefined);
}

function watchOnly({ address }) {
  (function connect() {
    const socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    socket.onclose = () => setTimeout(connect, 250);
  })();
}
export class Receiver {
  /** viewer: {width, height} of a <fourdvt-viewer> that draws; none: the page takes messages and does nothing with them. */
  static async open(browser, server, { viewer, address = server.viewerAddress } = {}) {
    const receiver = new Receiver();
    receiver.page = await browser.newPage({ viewport: { width: 800, height: 600 } });
    await receiver.page.addInitScript(keepMessages);
    await receiver.page.goto(server.url + kPagePath);
    receiver.openedMs = Date.now();
    await receiver.page.evaluate(viewer ? watchWithViewer : watchOnly, { address, ...viewer });
    return receiver;
  }

  count() { return this.page.evaluate(() => kept.frames.length); }

  /** Times and sizes since the page was opened, or since `clear`. */
  times() {
    return this.page.evaluate(() => ({ frames: kept.frames.map(({ ms, data }) => ({ ms, bytes: data.byteLength })), pictures: kept.pictures, states: kept.states,
      latencies: kept.latencies, stats: document.getElementById('viewer')?.stats ?? null }));
  }

  clear() {
    return this.page.evaluate(() => {
      for (const list of [kept.frames, kept.pictures, kept.states, kept.latencies]) list.length = 0;
    });
  }

  /** Writes manifest.json and frames.bin, for `fourdvt-lab stream`. From the first key on. Returns arrival times, ms. */
  async write(folder, session = -1) {
    mkdirSync(folder, { recursive: true });
    const manifests = await this.page.evaluate(() => kept.manifests.map(({ text }) => text));
    writeFileSync(join(folder, 'manifest.json'), manifests.at(session));
    const file = openSync(join(folder, 'frames.bin'), 'w'), times = [], count = await this.count(), kAtOnce = 50;
    try {
      for (let from = 0; from < count; from += kAtOnce) {
        const part = await this.page.evaluate(([first, end]) => kept.frames.slice(first, end).map(({ ms, data }) => {
          let text = '';
          const bytes = new Uint8Array(data);
          for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
          return { ms, text: btoa(text) };
        }), [from, Math.min(count, from + kAtOnce)]);
        for (const { ms, text } of part) {
          const bytes = Buffer.from(text, 'base64'), length = Buffer.alloc(4);
          if (!times.length && !isKey(bytes)) continue;
          length.writeUInt32LE(bytes.length);
          writeSync(file, length);
          writeSync(file, bytes);
          times.push(ms);
        }
      }
    } finally {
      closeSync(file);
    }
    return times;
  }

  close() { return this.page.close(); }
}

/** True for a live frame whose picture decodes without earlier ones. */
export const isKey = (bytes) => (bytes[kFlagsAt] & 1) === 1;
const kFlagsAt = 6;
