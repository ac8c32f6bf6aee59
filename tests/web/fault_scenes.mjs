// SPDX-License-Identifier: Apache-2.0
// What the tests of faults share: a page with a viewer on a server that misbehaves on request, and the faults of network,
// server and decoder that every browser must get over. Each test file lists its scenes and then runs them.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { installClock } from './clock.mjs';
import { environment, openPage, outputFolder, readCanvas } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage } from './ssim.mjs';

const kPatienceMs = 60_000;
const kSceneMs = 240_000;  // a scene that takes longer hangs, and is named
const kBeside = 2;       // scenes that run at a time: each has a page and a server of its own and waits for both
const kLongestPauseMs = 6000;  // between two requests for the same bytes
const kProbeAgainMs = 15_000;   // between two probes of a server that is away
const table = [];
/** The browser that the faults happen in, and the viewer's upload path. */
export const stage = { browser: null, uploadPath: 'i420' };
const servers = new Set();

const scenes = [];
/** Like node's test. */
export const sceneTest = (title, scene) => scenes.push([title, scene]);
/** Runs the scenes in the browser that `start` gives, some at a time, and writes the table. */
export function runScenes(name, start) {
  describe(name, { concurrency: kBeside }, () => {
    before(async () => { stage.browser = await start(); });
    after(async () => {
      await closeStage();
      writeTable(name);
    });
    for (const [title, scene] of scenes) test(title, { timeout: kSceneMs }, scene);
  });
}

// Closes the browser, and the servers of scenes that failed: they would keep the process, and the test would time out.
async function closeStage() {
  await stage.browser?.close();
  await Promise.all([...servers].map((server) => server.close()));
}

async function serveSite(options) {
  const server = await serve(environment('SITE'), 0, options);
  servers.add(server);
  return server;
}
async function closeServer(server) {
  if (servers.delete(server)) await server.close();
}

// Fault, what the visitor sees, recovery time or error.
function writeTable(name) {
  table.sort();
  writeFileSync(join(outputFolder(name), 'faults.md'), ['| fault | seen | recovery or error |', '|---|---|---|', ...table, ''].join('\n'));
}

export const row = (fault, seen, end) => table.push(`| ${fault} | ${seen} | ${end} |`);
export const seconds = (ms) => `${(ms / 1000).toFixed(1)} s`;
/** Real time. */
export const wait = (ms) => new Promise((done) => setTimeout(done, ms));
export const ofCharacter = (request) => request.url.includes('/character/');

// Runs in the page before its scripts: counts what must be closed, keeps the error callbacks of the decoders.
function countResources() {
  const live = (globalThis.live = { decoders: 0, pictures: 0, lose: new Set() });
  const NativeDecoder = globalThis.VideoDecoder;
  if (!NativeDecoder) return; // a page without https
  globalThis.VideoDecoder = class extends NativeDecoder {
    constructor(init) {
      super({
        error: init.error,
        output: (picture) => {
          ++live.pictures;
          init.output(picture);
        },
      });
      ++live.decoders;
      this.lose = () => {
        this.close();
        init.error(new DOMException('Codec reclaimed due to inactivity.', 'QuotaExceededError'));
      };
      live.lose.add(this.lose);
    }
    close() {
      if (live.lose.delete(this.lose)) --live.decoders;
      super.close();
    }
  };
  const close = VideoFrame.prototype.close;
  VideoFrame.prototype.close = function () {
    if (this.format !== null) --live.pictures;
    close.call(this);
  };
  const clone = VideoFrame.prototype.clone;
  VideoFrame.prototype.clone = function () {
    ++live.pictures;
    return clone.call(this);
  };
}

// A blank page with a viewer, on a server of its own. options: serving, attributes, before (runs in the page first),
// policy, host, src, elsewhere: the character comes from another origin with these headers.
export async function open(name, options = {}) {
  const { serving = {}, attributes = { autoplay: '' }, host = '127.0.0.1', policy = '' } = options;
  const scene = { name, faults: null, troubles: [] };
  const misbehave = (request) => scene.faults?.(request);
  const html = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><style>fourdvt-viewer { width: 160px; height: 220px; }</style><main></main><aside></aside>`;
  const headers = policy ? { 'Content-Security-Policy': policy } : {};
  scene.server = await serveSite({ ...serving, misbehave, pages: { '/blank.html': { html, headers } } });
  if (options.elsewhere) scene.elsewhere = await serveSite({ headers: options.elsewhere, misbehave });
  scene.page = await openPage(stage.browser, { viewport: { width: 200, height: 260 } }, stage.uploadPath);
  await scene.page.addInitScript(installClock);
  await scene.page.addInitScript(countResources);
  if (options.before) await scene.page.addInitScript(options.before);
  scene.url = scene.server.url.replace('127.0.0.1', host);
  await scene.page.goto(`${scene.url}blank.html`);
  scene.faults = options.faults ?? null;
  await scene.page.evaluate(async ({ attributes, src }) => {
    await import('/fourdvt-viewer/fourdvt-viewer.js');
    const log = (globalThis.seen = []);
    const viewer = (globalThis.viewer = document.createElement('fourdvt-viewer'));
    for (const type of ['stalled', 'waiting', 'playing', 'error', 'canplay', 'sequencechange', 'parameterchange']) {
      viewer.addEventListener(type, (e) => log.push({ type, at: performance.now(), ...e.detail }));
    }
    for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
    if (src !== null) viewer.src = src;
    document.querySelector('main').append(viewer);
  }, { attributes, src: options.src === undefined ? `${scene.elsewhere?.url ?? ''}character/character.gltf` : options.src });
  return scene;
}

export const get = (scene, what, argument) => scene.page.evaluate(what, argument);
export const until = (scene, condition, argument = null) =>
  scene.page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });
/** Turns the page's clock: no real time passes, except for what the page does meanwhile. */
export const pass = (scene, ms) => get(scene, (ms) => globalThis.testClock.turn(ms), ms);
export const pageTime = (scene) => get(scene, () => globalThis.testClock.now());
// Turns the page's clock until the condition holds; returns how far, in ms. Not for what has to be drawn: no machine draws
// as fast as the clock is turned.
export async function passUntil(scene, condition, argument = null) {
  const began = await pageTime(scene);
  for (const end = Date.now() + kPatienceMs; !(await get(scene, condition, argument));) {
    assert.ok(Date.now() < end, `${scene.name}: ${condition} does not come true`);
    await pass(scene, 100);
  }
  return (await pageTime(scene)) - began;
}
export const errors = (scene) => get(scene, () => globalThis.seen.filter((e) => e.type === 'error').map((e) => e.id));
export const seenCount = (scene, type) => get(scene, (type) => globalThis.seen.filter((e) => e.type === type).length, type);
export const framesShown = (scene) => get(scene, () => globalThis.viewer.stats?.framesShown ?? 0);
export const plays = (scene) => until(scene, () => globalThis.viewer.stats?.framesShown > 10);
// It plays, and all of its motion is there.
const playsWhole = async (scene) => {
  await plays(scene);
  await until(scene, () => {
    const { buffered, duration } = globalThis.viewer;
    return buffered.length === 1 && buffered.start(0) === 0 && buffered.end(0) === duration;
  });
};
export const panel = (scene) => get(scene, () => {
  const shown = (name) => !globalThis.viewer.shadowRoot.querySelector(name).hidden;
  return { error: shown('.error'), note: shown('.note'), play: shown('.play') };
});
export const panelText = (scene) => get(scene, () => globalThis.viewer.shadowRoot.querySelector('.message').textContent);
// True if new frames come within a while. Fails with the viewer's state and last events.
export async function advances(scene) {
  const from = await framesShown(scene);
  await until(scene, (from) => globalThis.viewer.stats?.framesShown > from + 3, from).catch(async (reason) => {
    const found = await get(scene, () => {
      const { sequence, state, inTransition, paused, frame, stats, seekable, buffered } = globalThis.viewer;
      const ranges = (r) => Array.from({ length: r.length }, (_, i) => [r.start(i), r.end(i)]);
      return { sequence, state, inTransition, paused, frame, stats, buffered: ranges(buffered), seekable: ranges(seekable), seen: globalThis.seen.slice(-8) };
    });
    throw new Error(`${scene.name}: no new frames after ${from}: ${JSON.stringify(found)}`, { cause: reason });
  });
  return true;
}
export async function firstError(scene) {
  const handle = await until(scene, () => globalThis.seen.find((e) => e.type === 'error'));
  return handle.jsonValue();
}

// Returns the number of requests once none has arrived for a while: those sent before the removal may still be on their way.
async function requestsAtRest(scene) {
  for (let before = -1; ;) {
    const count = scene.server.requests.length;
    if (count === before) return count;
    before = count;
    await wait(500);
  }
}
// Removes the viewer and checks what must hold whatever has happened.
export async function finish(scene, expectedConsole = () => false) {
  const left = await get(scene, async () => {
    globalThis.viewer?.remove();
    const { live } = globalThis;
    for (let i = 0; i < 60 && (i < 1 || live.decoders || live.pictures); ++i) await new Promise((next) => setTimeout(next, 100));
    return { decoders: live.decoders, pictures: live.pictures };
  });
  assert.deepEqual(left, { decoders: 0, pictures: 0 }, `${scene.name}: everything is closed`);
  const lines = (await get(scene, () => globalThis.seen)).flatMap(({ type, id, message }) => (type === 'error' ? [`fourdvt-viewer: ${id}: ${message}`] : []));
  assert.deepEqual(scene.page.reported, lines, `${scene.name}: the console has every error once`);
  const before = await requestsAtRest(scene);
  await pass(scene, kLongestPauseMs);
  await wait(100);
  assert.deepEqual(scene.server.requests.slice(before).map((r) => r.url), [], `${scene.name}: nothing more is fetched`);
  const troubles = scene.page.troubles.filter((line) =>
    !/^console: (Failed to load resource|.*net::ERR_)/.test(line) && !line.includes('CONTEXT_LOST') && !expectedConsole(line));
  assert.deepEqual(troubles, [], scene.name);
  await scene.page.close();
  await closeServer(scene.server);
  await closeServer(scene.elsewhere);
}

// Turns the page's clock until nothing waits for the network any more; returns how far, in ms.
async function recovers(scene) {
  const ms = await passUntil(scene, () => globalThis.viewer.shadowRoot.querySelector('.note').hidden);
  assert.ok(ms < 2 * kLongestPauseMs, `${scene.name}: ${seconds(ms)}`);
  return ms;
}
// The page has noticed that the network is away.
const stalled = (scene) => until(scene, () => globalThis.seen.some((e) => e.type === 'stalled'));

async function outage(ms) {
  const scene = await open(`server away for ${seconds(ms)}`);
  await playsWhole(scene);
  scene.faults = (request) => (ofCharacter(request) ? { away: true } : null);
  const other = await get(scene, () => {
    const other = globalThis.viewer.sequences.map((s) => s.name).find((name) => name !== globalThis.viewer.sequence);
    globalThis.viewer.goTo(other);
    return other;
  });
  await stalled(scene);
  const requests = () => get(scene, () => globalThis.testClock.requests()); // of the page: browsers repeat some on their own
  const before = (await requests()).length;
  await pass(scene, ms);
  const again = (await requests()).slice(before), times = new Map();
  for (const request of again) times.set(request, (times.get(request) ?? 0) + 1);
  assert.ok(again.length > 0, 'it is asked for again');
  const probes = 2 + ms / kProbeAgainMs; // that a server that is away gets, whatever is wanted of it
  for (const [request, count] of times)
    assert.ok(count <= 6 + 2 * ms / kLongestPauseMs + probes, `${request} with pauses that grow: ${count} requests in ${seconds(ms)}`);
  assert.ok(times.size < 8, `few files are wanted at once: ${[...times.keys()]}`);
  assert.ok(await advances(scene), 'what is there plays on');
  assert.deepEqual(await panel(scene), { error: false, note: true, play: false }, 'a quiet sign, no error');
  scene.faults = null;
  const recovery = await recovers(scene);
  await until(scene, (other) => globalThis.viewer.sequence === other && !globalThis.viewer.inTransition, other);
  assert.ok(await advances(scene));
  assert.equal((await panel(scene)).note, false);
  assert.deepEqual(await errors(scene), []);
  row(`${scene.name} while another motion is asked for`, 'the motion goes on, "Waiting for the network"', `${seconds(recovery)} after it is back`);
  await finish(scene);
}

async function outageWhileLoading() {
  const scene = await open('server away before anything is loaded', { faults: (r) => (ofCharacter(r) ? { away: true } : null) });
  await stalled(scene);
  await pass(scene, 4000);
  assert.deepEqual(await panel(scene), { error: false, note: true, play: false });
  scene.faults = null;
  row(scene.name, 'poster, "Waiting for the network"', `${seconds(await recovers(scene))} after it is back`);
  await plays(scene);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

export async function browserOffline() {
  const scene = await open('browser offline for 10 s');
  await plays(scene);
  await scene.page.context().setOffline(true);
  const other = await get(scene, () => (globalThis.viewer.sequence = globalThis.viewer.sequences.at(-1).name));
  await stalled(scene);
  await pass(scene, 10_000);
  await until(scene, () => globalThis.seen.some((e) => e.type === 'waiting')); // a cut to a motion that does not come
  const back = Date.now();
  await scene.page.context().setOffline(false);
  await until(scene, (other) => globalThis.viewer.sequence === other && globalThis.seen.at(-1).type === 'playing', other);
  row(`${scene.name} while a motion is cut to`, 'the last picture stands, "Waiting for the network"', `${seconds(Date.now() - back)} after it is back`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

async function serverErrors() {
  const scene = await open('503 for 5 s', { faults: (r) => (ofCharacter(r) ? { status: 503 } : null) });
  await stalled(scene);
  await pass(scene, 5000);
  scene.faults = null;
  row(scene.name, 'poster, "Waiting for the network"', `${seconds(await recovers(scene))} after it is back`);
  await plays(scene);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

// The page's clock and the server are three times as fast as said: ten seconds without a byte are 3.3 s of a busy machine.
async function slowServer() {
  const scene = await open('10 kB/s', {
    before: () => globalThis.testClock.setRate(3), faults: (r) => (ofCharacter(r) ? { bytesPerS: 30_000 } : null),
  });
  const began = await pageTime(scene);
  await until(scene, () => globalThis.viewer.stats?.framesShown > 0);
  const first = (await pageTime(scene)) - began;
  assert.ok(await advances(scene));
  assert.equal(await seenCount(scene, 'stalled'), 0, 'slow is not away');
  assert.deepEqual(await errors(scene), []);
  row(scene.name, 'poster and progress, then it plays with pauses', `first picture after ${seconds(first)}`);
  await finish(scene);
}

async function stalls() {
  const asked = [];
  const scene = await open('an answer that never ends', {
    faults: (r) => (r.url.endsWith('.mp4') && asked.push(r.headers.range) === 1 ? { stallAfter: 2000 } : null),
  });
  for (const end = Date.now() + kPatienceMs; !asked.length && Date.now() < end;) await wait(20);
  const ms = await passUntil(scene, () => globalThis.seen.some((e) => e.type === 'stalled')) + await recovers(scene);
  await plays(scene);
  assert.ok(asked.filter((range) => range === asked[0]).length > 1, 'it was asked for again');
  assert.ok((await seenCount(scene, 'stalled')) > 0);
  row(scene.name, 'poster and progress', `goes on after ${seconds(ms)}`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

// Another bake of the same character: in it the files of the first two motions have each other's names.
function secondBake() {
  const gltf = JSON.parse(readFileSync(join(environment('SITE'), 'character', 'character.gltf'), 'utf8'));
  const [first, second] = gltf.extensions.FOURDVT_layered_video_texture.sequences;
  const uris = (s) => [s.stream.uri, ...s.renditions.map((r) => r.uri)];
  const swapped = new Map([...uris(first).entries()].flatMap(([i, uri]) => [[uri, uris(second)[i]], [uris(second)[i], uri]]));
  for (const s of [first, second]) {
    s.stream.uri = swapped.get(s.stream.uri);
    for (const r of s.renditions) r.uri = swapped.get(r.uri);
  }
  const manifest = JSON.stringify(gltf);
  return (request, withManifest = true) => {
    const [, folder, name] = /^(.*\/)([^/?]*)/.exec(request.url);
    if (withManifest && name === 'character.gltf') return { text: manifest };
    return swapped.has(name) ? { url: folder + swapped.get(name) } : null;
  };
}

async function missingMotion() {
  const scene = await open('404 for one motion');
  await plays(scene);
  const other = await get(scene, () => globalThis.viewer.sequences.at(-1).name);
  scene.faults = (r) => (r.url.includes(`/${other}.`) ? { status: 404 } : null);
  await get(scene, (other) => globalThis.viewer.goTo(other), other);
  const error = await firstError(scene);
  assert.equal(error.id, 'fetch-failed');
  assert.match(error.message, new RegExp(`/${other}\\.\\S*(bin|mp4): HTTP 404`));
  assert.ok(await advances(scene), 'what is there plays on');
  assert.equal((await panel(scene)).error, false);
  scene.faults = null;
  await get(scene, (other) => globalThis.viewer.goTo(other), other);
  await until(scene, (other) => globalThis.viewer.sequence === other, other);
  assert.ok(await advances(scene));
  assert.deepEqual(await errors(scene), ['fetch-failed']);
  row(scene.name, 'the motion before plays on', '`fetch-failed`; chosen again it plays');
  await finish(scene);
}

async function missingCharacter() {
  const scene = await open('404 for the character', { faults: (r) => (r.url.endsWith('.mp4') ? { status: 404 } : null) });
  const error = await firstError(scene);
  assert.equal(error.id, 'fetch-failed');
  assert.match(error.message, /\/character\/\S+\.mp4: HTTP 404/); // an old manifest out of a cache, whose files are gone
  assert.equal((await panel(scene)).error, true);
  await get(scene, () => globalThis.viewer.play().catch(() => undefined)); // must not become an unhandled rejection
  scene.faults = null;
  await get(scene, () => globalThis.viewer.shadowRoot.querySelector('.retry').click());
  await plays(scene);
  assert.equal((await panel(scene)).error, false);
  assert.equal(await get(scene, () => globalThis.viewer.error), null);
  // load() and the same src again start afresh, too.
  for (const again of [() => globalThis.viewer.load(), () => { globalThis.viewer.src = globalThis.viewer.src; }]) {
    const before = await seenCount(scene, 'canplay');
    await get(scene, again);
    await until(scene, (before) => globalThis.seen.filter((e) => e.type === 'canplay').length > before, before);
  }
  row(scene.name, 'poster, panel with the error, "Try again"', '`fetch-failed`; the button loads it');
  await finish(scene);
}

async function otherOrigin() {
  const refused = await open('no permission from the other origin', { elsewhere: {} });
  const error = await firstError(refused);
  assert.equal(error.id, 'fetch-failed');
  assert.match(error.message, /Access-Control-Allow-Origin/);
  row(refused.name, 'poster, panel', '`fetch-failed`, which names the header');
  await finish(refused, (line) => /CORS policy|Cross-Origin Request Blocked/.test(line));
  const allowed = await open('with permission', { elsewhere: { 'Access-Control-Allow-Origin': '*' } });
  await plays(allowed);
  assert.deepEqual(await errors(allowed), []);
  await finish(allowed);
}

async function newBake() {
  const scene = await open('a new bake in between', { attributes: { autoplay: '', 'camera-controls': '' } });
  await plays(scene);
  const names = await get(scene, () => globalThis.viewer.sequences.map((s) => s.name));
  const bake = secondBake();
  scene.faults = (request) => bake(request);
  await get(scene, (name) => { globalThis.viewer.sequence = name; }, names[1]);
  const asked = Date.now();
  await until(scene, () => globalThis.seen.filter((e) => e.type === 'canplay').length === 2);
  await until(scene, (name) => globalThis.viewer.sequence === name && globalThis.viewer.stats?.framesShown > 1, names[1]);
  const ms = Date.now() - asked;
  assert.ok(await advances(scene));
  assert.equal((await get(scene, () => globalThis.viewer.stats)).barcodeMismatches, 0);
  assert.deepEqual(await errors(scene), []);
  assert.ok(coverage(await readCanvas(scene.page)) > 0.02);
  // And back: every new bake is taken.
  scene.faults = null;
  await get(scene, (name) => { globalThis.viewer.sequence = name; }, names.at(-1));
  await until(scene, (name) => globalThis.viewer.sequence === name && globalThis.seen.at(-1).type === 'playing', names.at(-1));
  await get(scene, (name) => { globalThis.viewer.sequence = name; }, names[0]);
  await until(scene, (name) => globalThis.viewer.sequence === name && globalThis.seen.at(-1).type === 'playing', names[0]);
  assert.deepEqual(await errors(scene), []);
  row(scene.name, 'the last picture, then the new bake', `plays ${seconds(ms)} after a motion is asked for`);
  await finish(scene);
}

async function mixedBakes() {
  const bake = secondBake();
  const scene = await open('files of two bakes', { faults: (request) => bake(request, false) });
  const error = await firstError(scene);
  assert.match(error.id, /^(files-differ|fetch-failed)$/); // other bytes, or fewer than the manifest says
  assert.match(error.message, /\.bin/);
  assert.equal(scene.server.requests.filter((r) => r.path.endsWith('character.gltf')).length, 2);
  await pass(scene, kLongestPauseMs);
  await wait(100);
  assert.equal((await errors(scene)).length, 1);
  assert.equal((await panel(scene)).error, true);
  scene.faults = null;
  await get(scene, () => globalThis.viewer.shadowRoot.querySelector('.retry').click());
  await plays(scene);
  row(scene.name, 'poster, panel', '`files-differ`; the button loads it');
  await finish(scene);
}

async function decoderTaken() {
  const scene = await open('decoder taken away');
  await plays(scene);
  for (let i = 0; i < 6; ++i) {
    await get(scene, () => { for (const lose of [...globalThis.live.lose]) lose(); });
    assert.ok(await advances(scene));
  }
  assert.deepEqual(await errors(scene), []);
  row(scene.name, 'a short stop', 'at once');
  // A decoder lost in a pause is created again only when playing resumes.
  await get(scene, () => {
    globalThis.viewer.pause();
    for (const lose of [...globalThis.live.lose]) lose();
  });
  await pass(scene, 500);
  await wait(100);
  assert.equal(await get(scene, () => globalThis.live.decoders), 0);
  await get(scene, () => globalThis.viewer.play());
  assert.ok(await advances(scene));
  // Every new one is taken as well: an error in the end.
  await get(scene, () => { globalThis.loser = setInterval(() => { for (const lose of [...globalThis.live.lose]) lose(); }, 1); });
  assert.equal((await firstError(scene)).id, 'decoder-lost');
  await get(scene, () => clearInterval(globalThis.loser));
  await until(scene, () => !globalThis.viewer.shadowRoot.querySelector('.error').hidden);
  await get(scene, () => globalThis.viewer.shadowRoot.querySelector('.retry').click());
  assert.ok(await advances(scene));
  row('decoder taken away again and again', 'the last picture, panel', '`decoder-lost`; the button loads it');
  await finish(scene);
}

/** [title, scene]: one test each in every browser. */
export const everywhere = [
  ...[2000, 10_000, 60_000].map((ms) => [`the server is away for ${seconds(ms)} and comes back`, () => outage(ms)]),
  ['the server is away while the character loads', outageWhileLoading],
  ['the server answers 503 for a while', serverErrors],
  ['a slow server is not one that is away', slowServer],
  ['an answer that never ends is asked for again', stalls],
  ['a motion that is not there is an error, and is played once it is there', missingMotion],
  ['the shown motion fails: a panel with a button that tries again', missingCharacter],
  ['another origin: its permission is needed, and a refusal is told from a lost network', otherOrigin],
  ['a new bake in place of the one that plays: it is loaded, and nothing is mixed', newBake],
  ['files of two bakes that stay mixed: loaded again once, then one error', mixedBakes],
  ['the browser takes the decoder away', decoderTaken],
];
