// SPDX-License-Identifier: Apache-2.0
// What a visitor meets when something goes wrong around a good character: the network, the server, the decoder, the GPU,
// the page. Faults that pass must pass; what stays is one error with its ID. Over all of them: no unhandled rejection, no
// uncaught exception, and after the element has gone every decoder and picture is closed. Writes a table: fault, what
// the visitor sees, recovery time or error.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, launch, openPage, outputFolder, readCanvas, waitForEvent } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage } from './ssim.mjs';

const kPatienceMs = 60_000;
const kElsewhere = 'visitor.test'; // a name of this machine that is neither localhost nor https
let browser, minute;
const table = [];
before(async () => {
  browser = await launch([`--host-resolver-rules=MAP ${kElsewhere} 127.0.0.1`]);
  minute = outage(60_000); // beside the other tests; the last one waits for it
  minute.catch(() => undefined);
});
after(async () => {
  await browser?.close();
  table.sort();
  writeFileSync(join(outputFolder('faults'), 'faults.md'), ['| fault | seen | recovery or error |', '|---|---|---|', ...table, ''].join('\n'));
});

const row = (fault, seen, end) => table.push(`| ${fault} | ${seen} | ${end} |`);
const seconds = (ms) => `${(ms / 1000).toFixed(1)} s`;
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const ofCharacter = (request) => request.url.includes('/character/');

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
async function open(name, options = {}) {
  const { serving = {}, attributes = { autoplay: '' }, host = '127.0.0.1', policy = '' } = options;
  const scene = { name, faults: null, troubles: [] };
  const misbehave = (request) => scene.faults?.(request);
  const html = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><style>fourdvt-viewer { width: 160px; height: 220px; }</style><main></main><aside></aside>`;
  const headers = policy ? { 'Content-Security-Policy': policy } : {};
  scene.server = await serve(environment('SITE'), 0, { ...serving, misbehave, pages: { '/blank.html': { html, headers } } });
  if (options.elsewhere) scene.elsewhere = await serve(environment('SITE'), 0, { headers: options.elsewhere, misbehave });
  scene.page = await openPage(browser, { viewport: { width: 200, height: 260 } }, 'i420');
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

const get = (scene, what, argument) => scene.page.evaluate(what, argument);
const until = (scene, condition, argument = null) =>
  scene.page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 50 });
const errors = (scene) => get(scene, () => globalThis.seen.filter((e) => e.type === 'error').map((e) => e.id));
const seenCount = (scene, type) => get(scene, (type) => globalThis.seen.filter((e) => e.type === type).length, type);
const framesShown = (scene) => get(scene, () => globalThis.viewer.stats?.framesShown ?? 0);
const plays = (scene) => until(scene, () => globalThis.viewer.stats?.framesShown > 10);
const panel = (scene) => get(scene, () => {
  const shown = (name) => !globalThis.viewer.shadowRoot.querySelector(name).hidden;
  return { error: shown('.error'), note: shown('.note'), play: shown('.play') };
});
// True if new frames come within a while.
async function advances(scene) {
  const from = await framesShown(scene);
  return until(scene, (from) => globalThis.viewer.stats?.framesShown > from + 3, from).then(() => true);
}
async function firstError(scene) {
  const handle = await until(scene, () => globalThis.seen.find((e) => e.type === 'error'));
  return handle.jsonValue();
}

// Removes the viewer and checks what must hold whatever has happened.
async function finish(scene, expectedConsole = () => false) {
  const left = await get(scene, async () => {
    globalThis.viewer?.remove();
    await new Promise((next) => setTimeout(next, 300));
    return { decoders: globalThis.live.decoders, pictures: globalThis.live.pictures };
  });
  assert.deepEqual(left, { decoders: 0, pictures: 0 }, `${scene.name}: everything is closed`);
  const requests = scene.server.requests.length;
  await wait(600);
  assert.equal(scene.server.requests.length, requests, `${scene.name}: nothing more is fetched`);
  const troubles = scene.page.troubles.filter((line) =>
    !/^console: (Failed to load resource|.*net::ERR_)/.test(line) && !line.includes('CONTEXT_LOST') && !expectedConsole(line));
  assert.deepEqual(troubles, [], scene.name);
  await scene.page.close();
  await scene.server.close();
  await scene.elsewhere?.close();
}

async function outage(ms) {
  const scene = await open(`server away for ${seconds(ms)}`);
  await plays(scene);
  scene.faults = (request) => (ofCharacter(request) ? { away: true } : null);
  const other = await get(scene, () => {
    const other = globalThis.viewer.sequences.map((s) => s.name).find((name) => name !== globalThis.viewer.sequence);
    globalThis.viewer.goTo(other);
    return other;
  });
  await wait(ms);
  assert.ok(await advances(scene), 'what is there plays on');
  assert.ok((await seenCount(scene, 'stalled')) > 0);
  assert.deepEqual(await panel(scene), { error: false, note: true, play: false }, 'a quiet sign, no error');
  const back = Date.now();
  scene.faults = null;
  await until(scene, (other) => globalThis.viewer.sequence === other && !globalThis.viewer.inTransition, other);
  const recovery = Date.now() - back;
  assert.ok(await advances(scene));
  await until(scene, () => globalThis.viewer.shadowRoot.querySelector('.note').hidden);
  assert.deepEqual(await errors(scene), []);
  row(`${scene.name} while another motion is asked for`, 'the motion goes on, "Waiting for the network"', `${seconds(recovery)} after it is back`);
  await finish(scene);
}

async function outageWhileLoading() {
  const scene = await open('server away before anything is loaded', { faults: (r) => (ofCharacter(r) ? { away: true } : null) });
  await wait(4000);
  assert.deepEqual(await panel(scene), { error: false, note: true, play: false });
  scene.faults = null;
  const back = Date.now();
  await plays(scene);
  row(scene.name, 'poster, "Waiting for the network"', `${seconds(Date.now() - back)} until it plays`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

async function browserOffline() {
  const scene = await open('browser offline for 10 s');
  await plays(scene);
  await scene.page.context().setOffline(true);
  const other = await get(scene, () => (globalThis.viewer.sequence = globalThis.viewer.sequences.at(-1).name));
  await wait(10_000);
  assert.ok((await seenCount(scene, 'waiting')) > 0, 'a cut to a motion that does not come waits');
  const back = Date.now();
  await scene.page.context().setOffline(false);
  await until(scene, (other) => globalThis.viewer.sequence === other && globalThis.seen.at(-1).type === 'playing', other);
  row(`${scene.name} while a motion is cut to`, 'the last picture stands, "Waiting for the network"', `${seconds(Date.now() - back)} after it is back`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

async function serverErrors() {
  const until5 = Date.now() + 5000;
  const scene = await open('503 for 5 s', { faults: (r) => (ofCharacter(r) && Date.now() < until5 ? { status: 503 } : null) });
  await plays(scene);
  row(scene.name, 'poster, "Waiting for the network"', `${seconds(Date.now() - until5)} until it plays`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

async function slowServer() {
  const began = Date.now();
  const scene = await open('50 kB/s', { faults: (r) => (ofCharacter(r) ? { bytesPerS: 50_000 } : null) });
  await until(scene, () => globalThis.viewer.stats?.framesShown > 0);
  const first = Date.now() - began;
  assert.ok(await advances(scene));
  assert.equal(await seenCount(scene, 'stalled'), 0, 'slow is not away');
  assert.deepEqual(await errors(scene), []);
  row(scene.name, 'poster and progress, then it plays with pauses', `first picture after ${seconds(first)}`);
  await finish(scene);
}

async function stalls() {
  let stalled = 0;
  const scene = await open('an answer that never ends', {
    faults: (r) => (r.url.endsWith('.mp4') && stalled++ === 0 ? { stallAfter: 2000 } : null),
  });
  const began = Date.now();
  await plays(scene);
  assert.ok(stalled > 1, 'it was asked for again');
  assert.ok((await seenCount(scene, 'stalled')) > 0);
  row(scene.name, 'poster and progress', `plays after ${seconds(Date.now() - began)}`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

test('the network and the server come back', () => Promise.all([
  outage(2000), outage(10_000), outageWhileLoading(), browserOffline(), serverErrors(), slowServer(), stalls(),
]));

test('a motion that is not there is an error, and is played once it is there', async () => {
  const scene = await open('404 for one motion');
  await plays(scene);
  const other = await get(scene, () => globalThis.viewer.sequences.at(-1).name);
  scene.faults = (r) => (r.url.includes(`/${other}.`) ? { status: 404 } : null);
  await get(scene, (other) => globalThis.viewer.goTo(other), other);
  const error = await firstError(scene);
  assert.equal(error.id, 'fetch-failed');
  assert.match(error.message, new RegExp(`${other}\\.(bin|mp4).*404`));
  assert.ok(await advances(scene), 'what is there plays on');
  assert.equal((await panel(scene)).error, false);
  scene.faults = null;
  await get(scene, (other) => globalThis.viewer.goTo(other), other);
  await until(scene, (other) => globalThis.viewer.sequence === other, other);
  assert.ok(await advances(scene));
  assert.deepEqual(await errors(scene), ['fetch-failed']);
  row(scene.name, 'the motion before plays on', '`fetch-failed`; chosen again it plays');
  await finish(scene);
});

test('the shown motion fails: a panel with a button that tries again', async () => {
  const scene = await open('404 for the character', { faults: (r) => (r.url.endsWith('.mp4') ? { status: 404 } : null) });
  assert.equal((await firstError(scene)).id, 'fetch-failed');
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
  row(scene.name, 'poster, "This character cannot be shown", "Try again"', '`fetch-failed`; the button loads it');
  await finish(scene);
});

test('another origin: its permission is needed, and a refusal is told from a lost network', async () => {
  const refused = await open('no permission from the other origin', { elsewhere: {} });
  const error = await firstError(refused);
  assert.equal(error.id, 'fetch-failed');
  assert.match(error.message, /Access-Control-Allow-Origin/);
  row(refused.name, 'poster, panel', '`fetch-failed`, which names the header');
  await finish(refused, (line) => line.includes('CORS policy'));
  const allowed = await open('with permission', { elsewhere: { 'Access-Control-Allow-Origin': '*' } });
  await plays(allowed);
  assert.deepEqual(await errors(allowed), []);
  await finish(allowed);
});

test('the browser takes the decoder away', async () => {
  const scene = await open('decoder taken away');
  await plays(scene);
  for (let i = 0; i < 6; ++i) {
    await get(scene, () => { for (const lose of [...globalThis.live.lose]) lose(); });
    assert.ok(await advances(scene));
  }
  assert.deepEqual(await errors(scene), []);
  row(scene.name, 'a short stop', 'at once');
  // In a pause no decoder is asked for before it is needed.
  await get(scene, () => {
    globalThis.viewer.pause();
    for (const lose of [...globalThis.live.lose]) lose();
  });
  await wait(500);
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
});

test('a hidden page holds no decoder, and a paused viewer stays paused', async () => {
  const scene = await open('page hidden', {
    before: () => {
      globalThis.pageHidden = false;
      Object.defineProperty(document, 'hidden', { get: () => globalThis.pageHidden });
      globalThis.setHidden = (hidden) => {
        globalThis.pageHidden = hidden;
        document.dispatchEvent(new Event('visibilitychange'));
      };
    },
  });
  await plays(scene);
  await get(scene, () => globalThis.setHidden(true));
  const shown = await framesShown(scene);
  await wait(2000);
  assert.equal(await framesShown(scene), shown, 'the clock stands still');
  assert.equal(await get(scene, () => globalThis.live.decoders), 0);
  const back = Date.now();
  await get(scene, () => globalThis.setHidden(false));
  assert.ok(await advances(scene));
  row(scene.name, 'nothing', `plays ${seconds(Date.now() - back)} after it is seen again`);
  await get(scene, () => {
    globalThis.viewer.pause();
    globalThis.setHidden(true);
    globalThis.setHidden(false);
  });
  const still = await framesShown(scene);
  await wait(700);
  assert.equal(await framesShown(scene), still);
  assert.equal(await get(scene, () => globalThis.viewer.paused), true);
  // Another source does not start what somebody has paused, although the element says autoplay.
  await get(scene, () => globalThis.viewer.load());
  await until(scene, () => globalThis.seen.filter((e) => e.type === 'canplay').length === 2);
  assert.equal(await get(scene, () => globalThis.viewer.paused), true);
  assert.equal((await panel(scene)).play, true, 'a button offers to play');
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
});

test('a GL context that is never given back: the poster, and a button', async () => {
  const scene = await open('GL context lost for good');
  await plays(scene);
  const lost = Date.now();
  await get(scene, () => {
    const canvas = globalThis.viewer.shadowRoot.querySelector('canvas');
    canvas.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
  });
  assert.equal((await firstError(scene)).id, 'gpu-failure');
  const told = Date.now() - lost;
  const poster = () => get(scene, () => getComputedStyle(globalThis.viewer.shadowRoot.querySelector('.poster')).opacity);
  await until(scene, () => getComputedStyle(globalThis.viewer.shadowRoot.querySelector('.poster')).opacity === '1');
  assert.equal(await poster(), '1');
  await get(scene, () => globalThis.viewer.shadowRoot.querySelector('.retry').click());
  await until(scene, () => globalThis.seen.filter((e) => e.type === 'canplay').length === 2);
  assert.ok(await advances(scene));
  assert.ok(coverage(await readCanvas(scene.page)) > 0.02);
  row(scene.name, 'poster, panel', `\`gpu-failure\` after ${seconds(told)}; the button loads it`);
  await finish(scene);
});

test('an element that is moved goes on; one that comes back is where it was', async () => {
  const scene = await open('element moved');
  await plays(scene);
  const other = await get(scene, () => (globalThis.viewer.sequence = globalThis.viewer.sequences.at(-1).name));
  await until(scene, (other) => globalThis.viewer.sequence === other, other);
  const moved = await get(scene, async () => {
    const { viewer } = globalThis;
    viewer.setAttribute('camera-orbit', '77deg 10deg 3m');
    viewer.jumpCameraToGoal();
    const canvas = viewer.shadowRoot.querySelector('canvas');
    const shown = viewer.stats.framesShown;
    document.querySelector('aside').append(viewer);
    await new Promise((next) => setTimeout(next, 0));
    return { same: canvas === viewer.shadowRoot.querySelector('canvas'), went: viewer.stats.framesShown >= shown,
      sequence: viewer.sequence, azimuth: viewer.getCameraOrbit().azimuth };
  });
  assert.deepEqual(moved, { same: true, went: true, sequence: other, azimuth: 77 });
  assert.ok(await advances(scene));
  const back = await get(scene, async () => {
    const { viewer } = globalThis;
    viewer.pause();
    const seeked = new Promise((done) => viewer.addEventListener('seeked', done, { once: true }));
    viewer.seekFrame(7);
    await seeked;
    viewer.remove();
    await new Promise((next) => setTimeout(next, 50));
    const gone = viewer.shadowRoot.querySelector('canvas') === null;
    const canplay = new Promise((done) => viewer.addEventListener('canplay', done, { once: true }));
    document.querySelector('main').append(viewer);
    await canplay;
    return { gone, sequence: viewer.sequence, frame: viewer.frame, azimuth: viewer.getCameraOrbit().azimuth, paused: viewer.paused };
  });
  assert.deepEqual(back, { gone: true, sequence: other, frame: 7, azimuth: 77, paused: true });
  row(scene.name, 'nothing', 'goes on');
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
});

test('another src while loading, removal while loading', async () => {
  const scene = await open('src changed while loading', { faults: (r) => (ofCharacter(r) ? { bytesPerS: 200_000 } : null) });
  for (const ms of [0, 100, 400, 900]) {
    await wait(ms);
    await get(scene, (ms) => { globalThis.viewer.src = `character/character.gltf?${ms}`; }, ms);
  }
  for (const ms of [0, 200, 700]) {
    await get(scene, async (ms) => {
      await new Promise((next) => setTimeout(next, ms));
      globalThis.viewer.remove();
      await new Promise((next) => setTimeout(next, 20));
      document.querySelector('main').append(globalThis.viewer);
    }, ms);
  }
  scene.faults = null;
  await plays(scene);
  row(scene.name, 'poster', 'the last one plays');
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
});

test('what cannot work is one error with its own ID', async () => {
  const cases = [
    ['wasm refused by the page\'s policy', 'wasm-refused',
      { policy: "script-src 'self' 'unsafe-inline'" }, (line) => /Content Security Policy|wasm/i.test(line)],
    ['wasm file missing', 'fetch-failed', { faults: (r) => (r.url.endsWith('.wasm') ? { status: 404 } : null) }],
    ['wasm file cut short', 'wasm-refused', { before: () => {
      const native = globalThis.fetch;
      globalThis.fetch = async (url, init) => (String(url).endsWith('.wasm')
        ? new Response((await (await native(url, init)).arrayBuffer()).slice(0, 5000)) : native(url, init));
    } }],
    ['no memory for wasm', 'out-of-memory', { before: () => {
      WebAssembly.instantiate = () => Promise.reject(new RangeError('WebAssembly.Memory(): could not allocate memory'));
    } }],
    ['page without https', 'insecure-context', { host: kElsewhere }],
    ['src that is no address', 'invalid-argument', { src: 'http://[' }],
  ];
  for (const [name, id, options, expected] of cases) {
    const scene = await open(name, options);
    const error = await firstError(scene);
    assert.equal(error.id, id, `${name}: ${error.message}`);
    assert.ok(error.message.length > 20 && !error.message.includes('\n'), error.message);
    await wait(300);
    assert.equal((await errors(scene)).length, 1, `${name}: one error`);
    assert.equal((await panel(scene)).error, true);
    const refusal = await get(scene, () => globalThis.viewer.play().then(() => 'plays', (reason) => reason.id));
    assert.equal(refusal, id, `${name}: play() says why not`);
    row(name, 'poster, panel', `\`${id}\``);
    await finish(scene, expected);
  }
});

test('promises that an element makes to its page', async () => {
  const scene = await open('promises', { attributes: { 'camera-controls': '' }, src: null });
  await get(scene, () => {
    globalThis.viewer.currentTime = 0.4;
    globalThis.viewer.src = 'character/character.gltf';
  });
  await waitForEvent(scene.page, 'canplay');
  assert.ok(Math.abs((await get(scene, () => globalThis.viewer.currentTime)) - 0.4) < 0.05, 'a time that was set before is kept');
  assert.equal((await panel(scene)).play, true, 'without autoplay a button offers to play');
  const played = await get(scene, async () => {
    const promise = globalThis.viewer.play();
    const atOnce = globalThis.seen.some((e) => e.type === 'playing');
    await promise;
    return { atOnce, then: globalThis.seen.some((e) => e.type === 'playing') };
  });
  assert.deepEqual(played.then, true, 'play() resolves when it plays');
  assert.equal((await panel(scene)).play, false);
  const told = await get(scene, async () => {
    const [parameter] = globalThis.viewer.sequences.flatMap((s) => s.parameters);
    globalThis.viewer.setParameter(parameter.name, parameter.max);
    return globalThis.seen.filter((e) => e.type === 'parameterchange').map((e) => e.value === parameter.max);
  });
  assert.deepEqual(told, [true], 'whoever shows the value hears of it');
  const refused = await get(scene, async () => {
    globalThis.viewer.pause();
    globalThis.viewer.sequence = globalThis.viewer.sequences.at(-1).name; // it has to be fetched
    const promise = globalThis.viewer.play();
    globalThis.viewer.goTo('no such motion');
    return promise.then(() => 'played', (reason) => reason.id);
  });
  assert.equal(refused, 'played', 'a command that is refused changes nothing');
  const outcome = await get(scene, async () => {
    globalThis.viewer.load();
    const promise = globalThis.viewer.play();
    globalThis.viewer.load();
    return promise.then(() => 'played', (reason) => reason.name);
  });
  assert.equal(outcome, 'AbortError');
  await plays(scene);
  await finish(scene);
});

test('after a click the wheel zooms until the pointer leaves, and then scrolls the page again', async () => {
  const scene = await open('wheel', { attributes: { 'camera-controls': '' } });
  await waitForEvent(scene.page, 'canplay');
  const zooms = async () => {
    const distance = () => get(scene, () => {
      globalThis.viewer.jumpCameraToGoal();
      return globalThis.viewer.getCameraOrbit().distance;
    });
    const before = await distance();
    await scene.page.mouse.wheel(0, -200);
    await wait(200);
    return (await distance()) !== before;
  };
  await get(scene, () => { document.body.style.minHeight = '3000px'; });
  await scene.page.mouse.move(30, 40); // beside the button
  assert.equal(await zooms(), false, 'the page scrolls');
  await get(scene, () => scrollTo(0, 0));
  await scene.page.mouse.down();
  await scene.page.mouse.up();
  assert.equal(await zooms(), true);
  await scene.page.mouse.move(190, 250);
  await scene.page.mouse.move(30, 40); // beside the button
  assert.equal(await zooms(), false);
  await finish(scene);
});

test('the server comes back after a minute', () => minute);
