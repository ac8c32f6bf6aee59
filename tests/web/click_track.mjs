// SPDX-License-Identifier: Apache-2.0
// A site whose character plays a click track, pages that show it, and detection of the clicks in a page's sound.
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { environment, kPatienceMs, launch, openPage } from './harness.mjs';
import { serve } from './server.mjs';

const kRate = 24_000, kOverlapS = 0.03;
const kFps = 8; // of the motions: software rendering shows no more, and sound of pictures that do not keep up is silent
// Seconds; unevenly apart, so that a wrong click is not taken for the right one. Not in the first or last 50 ms of a segment.
export const kClicks = { walk: [0.2, 0.5, 0.8, 1.2, 1.6, 2.0, 2.3, 2.8, 3.1], run: [0.15, 0.48, 0.9, 1.2, 1.6, 2.1] };
export const kDurations = { walk: 3.5, run: 2.375 }, kSegments = { walk: 4, run: 1 };
const kSteps = [0.2, 0.65], kStepS = 0.1; // phases of the class at which its feet come down, here
export const kPaces = { walk: 1, run: 1 }; // media time over time, at rate 1

// A RIFF file of clicks in silence: [from, from + seconds) of a motion that loops.
function clickTrack(clicks, durationS, from, seconds) {
  const count = Math.round(seconds * kRate), data = new Int16Array(count);
  for (let i = 0; i < count; ++i) {
    const at = (from + i / kRate) % durationS, click = clicks.find((c) => at >= c && at < c + 0.004);
    if (click !== undefined) data[i] = 26_000 * Math.sin(2 * Math.PI * 2000 * (at - click) + 1);
  }
  const header = Buffer.alloc(44);
  header.write('RIFF', 0);
  header.write('WAVEfmt ', 8);
  header.write('data', 36);
  for (const [at, value] of [[4, 36 + 2 * count], [16, 16], [24, kRate], [28, 2 * kRate], [40, 2 * count]]) header.writeUInt32LE(value, at);
  for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) header.writeUInt16LE(value, at);
  return Buffer.concat([header, Buffer.from(data.buffer)]);
}

export const extensionOf = (gltf) => gltf.extensions.FOURDVT_layered_video_texture;
function withClicks(folder) {
  const path = join(folder, 'character.gltf'), gltf = JSON.parse(readFileSync(path));
  for (const sequence of extensionOf(gltf).sequences) {
    const { name } = sequence;
    delete sequence.sound;
    const fps = sequence.members.length > 1 ? sequence.fps / 3 : kFps;
    for (const member of sequence.members) member.duration *= sequence.fps / fps;
    sequence.fps = fps;
    if (name === 'locomotion') {
      kDurations[name] = sequence.frameCount / fps;
      kPaces[name] = kDurations[name] / sequence.members[0].duration; // at the slowest, where it begins
      kClicks[name] = kSteps.map((phase) => phase * kDurations[name]);
      const file = clickTrack([0.0001], 1, 0, kStepS), segments = [[file.length, Math.round(kStepS * kRate)]];
      writeFileSync(join(folder, 'step.wav'), file);
      sequence.sound = { sampleRate: kRate, channels: 1, segmentDuration: kStepS, steps: kSteps,
        encodings: [{ uri: 'step.wav', byteLength: file.length, type: 'audio/wav', priming: 0, segments }] };
      continue;
    }
    if (!kClicks[name]) continue;
    const segmentS = kDurations[name] / kSegments[name];
    const files = Array.from({ length: kSegments[name] }, (_, i) => clickTrack(kClicks[name], kDurations[name], i * segmentS, segmentS + kOverlapS));
    const uri = `${name}-clicks.wav`, segments = files.map((file) => [file.length, Math.round((segmentS + kOverlapS) * kRate)]);
    writeFileSync(join(folder, uri), Buffer.concat(files));
    const byteLength = segments.reduce((sum, [bytes]) => sum + bytes, 0);
    sequence.sound = { sampleRate: kRate, channels: 1, segmentDuration: segmentS, encodings: [{ uri, byteLength, type: 'audio/wav', priming: 0, segments }] };
  }
  writeFileSync(path, JSON.stringify(gltf));
}

const kPage = (attributes) => `<!doctype html><html lang="en"><meta charset="utf-8"><title>sound</title><link rel="icon" href="data:,">
<style>fourdvt-viewer { width: 220px; height: 200px }</style><script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script>
<fourdvt-viewer src="/clicks/character.gltf" sequence="walk" loop upload-path="i420" ${attributes}></fourdvt-viewer>`;

// Runs in the page before its scripts: finds clicks in all that is played, and notes which picture is shown when.
export function listen() {
  const finder = `registerProcessor('finder', class extends AudioWorkletProcessor {
    constructor() { super(); this.quiet = 1e9; }
    process([[samples]]) {
      for (let i = 0; samples && i < samples.length; ++i) {
        if (Math.abs(samples[i]) > 0.15) {
          if (this.quiet > 0.03 * sampleRate) this.port.postMessage(currentTime + i / sampleRate);
          this.quiet = 0;
        } else ++this.quiet;
      }
      return true;
    }
  })`;
  globalThis.clicks = [];   // page times in ms
  globalThis.pictures = []; // { atMs, mediaS, rate, motion }
  const connect = AudioNode.prototype.connect;
  AudioNode.prototype.connect = function (to, ...rest) {
    if (to instanceof AudioDestinationNode) {
      const { context } = this, address = URL.createObjectURL(new Blob([finder], { type: 'text/javascript' }));
      context.audioWorklet.addModule(address).then(() => {
        const node = new AudioWorkletNode(context, 'finder');
        node.port.onmessage = ({ data }) => {
          const { contextTime, performanceTime } = context.getOutputTimestamp();
          globalThis.clicks.push(performanceTime + 1000 * (data - contextTime));
        };
        connect.call(this, node);
        globalThis.listens = true;
      });
    }
    return connect.call(this, to, ...rest);
  };
  addEventListener('loadedmetadata', ({ target }) => {
    const next = () => target.requestVideoFrameCallback((_, { mediaTime }) => {
      const { playbackRate, stats } = target;
      globalThis.pictures.push({ atMs: document.timeline.currentTime, mediaS: mediaTime, rate: playbackRate, motion: stats && target.shown });
      next();
    });
    next();
  }, { capture: true, once: true });
  addEventListener('sequencechange', ({ target }) => { target.shown = target.sequence; }, true);
}

/** The site served, and a browser. open(NAME): a page whose viewer plays, is muted, or is paused. */
export async function openClicks() {
  const site = mkdtempSync(join(tmpdir(), 'fourdvt-sound-'));
  cpSync(environment('SITE'), site, { recursive: true });
  cpSync(join(site, 'character'), join(site, 'clicks'), { recursive: true });
  withClicks(join(site, 'clicks'));
  const pages = {};
  for (const [name, attributes] of [['plays', 'autoplay controls'], ['muted', 'autoplay muted'], ['paused', '']]) pages[`/${name}.html`] = { html: kPage(attributes), headers: {} };
  const server = await serve(site, 0, { pages }), browser = await launch();
  return {
    server,
    async open(name, more = () => undefined) {
      const page = await openPage(browser, { viewport: { width: 300, height: 300 } });
      await page.addInitScript(listen);
      await more(page);
      await page.goto(`${server.url}${name}.html`);
      await until(page, () => globalThis.pictures.length > 2 || document.querySelector('fourdvt-viewer').readyState > 2);
      return page;
    },
    async close() {
      await browser.close();
      await server.close();
      rmSync(site, { recursive: true, force: true });
    },
  };
}

export const wait = (ms) => new Promise((next) => setTimeout(next, ms));
export const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 30 });
export const set = (page, values) => page.evaluate((values) => void Object.assign(document.querySelector('fourdvt-viewer'), values), values);
