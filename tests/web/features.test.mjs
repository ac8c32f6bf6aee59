// SPDX-License-Identifier: Apache-2.0
// The features of <fourdvt-viewer> one by one, each over a base without a page; the whole element is tested in browsers.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { load, loadTogether } from './load_source.mjs';

const all = await loadTogether('element/overlay', 'element/presence', 'element/viewer', 'fourdvt-viewer');

// Stands for a document, its elements and their methods.
const kStub = new Proxy(function stub() {}, { get: (_, name) => (name === Symbol.toPrimitive ? () => '' : kStub), set: () => true, apply: () => kStub, construct: () => kStub });
const kMethods = ['offerPlay', 'progress', 'fail', 'recover', 'idle', 'dropCanvas', 'setPoster', 'loading'];

// The base of the element's class, which is none on a server: attributes, and a list of the events that it dispatches.
Object.assign(Object.getPrototypeOf(all.FourdvtViewer).prototype, {
  baseURI: 'http://page.example/',
  attachShadow: () => kStub,
  addEventListener() {},
  dispatchEvent({ type, detail }) { this.events.push(detail === null ? [type] : [type, detail]); },
  getAttribute(name) { return this.attributes.get(name) ?? null; },
  hasAttribute(name) { return this.attributes.has(name); },
  setAttribute(name, value) { this.change(name, String(value)); },
  toggleAttribute(name, on) { this.change(name, on ? '' : null); },
  change(name, value) {
    const before = this.getAttribute(name);
    if (value === null) this.attributes.delete(name);
    else this.attributes.set(name, value);
    if (all.FourdvtViewer.observedAttributes.includes(name)) this.attributeChangedCallback(name, before, value);
  },
});
all.Viewer.prototype.updateTexts = () => undefined;
all.Presence.prototype.review = () => undefined;

// An element in a document without a page: `viewer` is what its features share, `shown` what its overlay was called to show.
function makeElement() {
  let viewer;
  all.Viewer.prototype.connect = function connect() { viewer = this; };
  Object.assign(globalThis, { document: kStub, CSSStyleSheet: kStub, matchMedia: () => ({ matches: false }) });
  let element;
  try {
    element = Object.assign(new all.FourdvtViewer(), { events: [], attributes: new Map() });
  } finally {
    for (const name of ['document', 'CSSStyleSheet', 'matchMedia']) delete globalThis[name];
  }
  element.connectedCallback();
  viewer.connected = true;
  viewer.picture.checkRatio = () => undefined;
  const shown = [];
  for (const name of kMethods) viewer.overlay[name] = (...values) => shown.push([name, ...values]);
  Object.defineProperty(viewer, 'current', { writable: true, value: null });
  Object.defineProperty(viewer, 'size', { value: { width: 320, height: 400 } });
  return { element, viewer, shown, commands: viewer.commands, loading: viewer.features.find((feature) => 'presence' in feature), settings: () => Object.assign({}, ...viewer.call('settings')) };
}
const types = ({ events }) => events.map(([name]) => name);

test('the script can be imported on a server, where there are no elements', () => {
  assert.equal(typeof globalThis.HTMLElement, 'undefined');
  assert.equal(typeof all.FourdvtViewer, 'function');
  assert.ok(all.FourdvtViewer.observedAttributes.includes('camera-orbit'));
  assert.equal(new Set(all.FourdvtViewer.observedAttributes).size, all.FourdvtViewer.observedAttributes.length);
});

// --- playback ---

test('play dispatches one event, and settles with what comes of it', async () => {
  const { element, viewer } = makeElement();
  const first = element.play(), again = element.play();
  assert.deepEqual(types(element).filter((name) => name === 'play'), ['play']);
  assert.equal(element.paused, false);
  viewer.report('playing');
  await Promise.all([first, again]);
  const refused = element.play();
  viewer.call('giveUp', { id: 'files-differ', message: 'two bakes' });
  await assert.rejects(refused, { id: 'files-differ', message: 'two bakes' });
  const stopped = element.play();
  element.pause();
  await assert.rejects(stopped, { name: 'AbortError' });
  assert.equal(element.paused, true);
  const left = element.play();
  viewer.call('giveUp');
  await assert.rejects(left, { name: 'AbortError' });
});

test('the end pauses; a pause before the source keeps autoplay from beginning', () => {
  const { element, viewer, shown, settings } = makeElement();
  element.autoplay = true;
  assert.equal(settings().playing, true);
  viewer.reducedMotion = { matches: true };
  assert.equal(settings().playing, false, 'visitors who want little motion');
  element.play().catch(() => undefined);
  for (const name of ['pause', 'ended']) viewer.report(name);
  assert.deepEqual([element.paused, element.ended], [true, true]);
  assert.deepEqual(shown.at(-1), ['offerPlay', true], 'no dead end');
  viewer.report('playing');
  assert.deepEqual([element.paused, element.ended], [false, false]);
  element.pause();
  assert.equal(settings().playing, false);
});

test('autoplay is paused until it plays, and dispatches play before playing', () => {
  const { element, viewer, settings } = makeElement();
  element.autoplay = true;
  viewer.commands.begin(settings());
  assert.equal(viewer.commands.settings.playing, true);
  assert.equal(element.paused, true);
  viewer.report('playing');
  assert.deepEqual(types(element), ['play', 'playing']);
  assert.equal(element.paused, false);
  viewer.report('pause');
  viewer.report('pause');
  assert.deepEqual(types(element).slice(2), ['pause'], 'once');

  const other = makeElement();
  other.element.autoplay = true;
  other.commands.begin(other.settings());
  other.element.pause();
  assert.deepEqual(types(other.element), [], 'it has not played');
  assert.equal(other.commands.settings.playing, false);
});

test('what is sought before there is a source is sought in it, once', () => {
  const { element, viewer, settings } = makeElement();
  element.currentTime = 1.5;
  assert.equal(element.currentTime, 1.5);
  assert.equal(settings().time, 1.5);
  assert.equal(settings().time, undefined);
  element.seekFrame(7);
  assert.equal(settings().frame, 7);
  assert.deepEqual(types(element), ['seeking', 'seeking']);
  assert.throws(() => { element.currentTime = 'soon'; }, TypeError);
  assert.throws(() => { element.playbackRate = 5; }, RangeError);
  element.playbackRate = 0;
  assert.deepEqual([element.playbackRate, element.defaultPlaybackRate], [0, 1]);
  assert.equal(element.seeking, true);
  viewer.report('seeked');
  assert.equal(element.seeking, false);
});

test('loop is as the sequence says, never or always', () => {
  const { element, viewer, settings } = makeElement();
  const mode = () => settings().loop;
  assert.equal(mode(), -1);
  element.loop = true;
  assert.equal(mode(), 1);
  assert.equal(viewer.commands.settings.loop, 1);
  element.loop = false;
  assert.equal(mode(), 0);
});

// --- the media element's contract ---

function makeMedia() {
  const made = makeElement();
  made.viewer.current = { duration: 1.5 };
  made.viewer.session = { character: {}, ended: false, live: null, later: { loaded: {} }, main: null, transport: { busy: true }, dispose() {}, wake() {} };
  made.element.attributes.set('src', 'a/character.gltf');
  return made;
}

test('media: readyState follows the events; loadeddata comes before canplay, once', () => {
  const { element, viewer } = makeMedia(), states = [];
  for (const name of ['loadedmetadata', 'canplay', 'loadeddata', 'playing', 'canplaythrough', 'waiting', 'playing']) {
    viewer.report(name);
    states.push(element.readyState);
  }
  assert.deepEqual(states, [1, 3, 3, 3, 4, 2, 3]);
  assert.deepEqual(types(element), ['durationchange', 'loadedmetadata', 'loadeddata', 'canplay', 'play', 'playing', 'canplaythrough', 'waiting', 'playing']);
  viewer.call('giveUp');
  assert.equal(element.readyState, 0);
  element.events.length = 0;
  viewer.report('canplaythrough');
  viewer.report('sequencechange');
  assert.equal(element.readyState, 3, 'another motion may not be buffered');
  viewer.call('begin');
  for (const name of ['loadedmetadata', 'loadeddata']) viewer.report(name);
  assert.ok(types(element).includes('loadeddata'), 'another session begins anew');
});

test('media: another motion has another duration; a seek ends with a timeupdate', () => {
  const { element, viewer } = makeMedia();
  viewer.report('loadedmetadata');
  viewer.report('sequencechange');
  viewer.current = { duration: 2 };
  viewer.report('sequencechange');
  viewer.report('seeked');
  assert.deepEqual(types(element), ['durationchange', 'loadedmetadata', 'sequencechange', 'durationchange', 'sequencechange', 'timeupdate', 'seeked']);
  assert.deepEqual([element.seekable.length, element.seekable.start(0), element.seekable.end(0)], [1, 0, 2]);
  assert.throws(() => element.seekable.end(1), { name: 'IndexSizeError' });
  viewer.session.live = {};
  assert.equal(element.seekable.length, 0);
});

test('media: networkState is empty, idle, loading or without a source', () => {
  const { element, viewer } = makeMedia();
  assert.equal(element.networkState, 2);
  viewer.session.transport.busy = false;
  assert.equal(element.networkState, 1);
  viewer.session = null;
  assert.equal(element.networkState, 1, 'it waits until it is near the screen');
  viewer.report('error', { id: 'fetch-failed', message: 'gone' });
  assert.equal(element.networkState, 3);
  element.attributes.set('src', '');
  assert.equal(element.networkState, 0);
});

test('media: volume and muted', () => {
  const { element, viewer } = makeMedia();
  element.attributes.set('muted', '');
  viewer.features.find((feature) => 'muted' in feature).connect();
  assert.equal(element.muted, true);
  element.defaultMuted = false;
  assert.equal(element.muted, true, 'the attribute is what it begins with');
  element.muted = false;
  element.muted = false;
  element.volume = 0.5;
  assert.throws(() => { element.volume = 1.1; }, { name: 'IndexSizeError' });
  assert.deepEqual(types(element), ['volumechange', 'volumechange']);
  assert.equal(element.volume, 0.5);
});

test('media: a callback gets the next new picture, once', () => {
  const { element, viewer, commands } = makeMedia(), seen = [];
  let state = { framesShown: 4, currentTimeS: 0.2 };
  commands.attach({ character: null, state: () => state, parameter: () => NaN, run: () => true });
  element.requestVideoFrameCallback((now, metadata) => seen.push(['a', metadata.presentedFrames, metadata.mediaTime, metadata.width]));
  element.cancelVideoFrameCallback(element.requestVideoFrameCallback(() => seen.push('cancelled')));
  viewer.call('picture');
  viewer.call('picture');
  element.requestVideoFrameCallback(() => seen.push('b'));
  viewer.call('picture'); // the camera has moved
  assert.deepEqual(seen, [['a', 4, 0.2, 320]]);
  state = { framesShown: 5, currentTimeS: 0.24 };
  const { setTimeout } = globalThis, late = [];
  globalThis.setTimeout = (run) => late.push(run);
  element.requestVideoFrameCallback(() => { throw new Error('mine'); });
  element.requestVideoFrameCallback(() => seen.push('c'));
  viewer.call('picture');
  globalThis.setTimeout = setTimeout;
  assert.deepEqual(seen.slice(1), ['b', 'c'], 'one that throws takes no other along');
  assert.throws(late[0], /mine/);
});

test('media times: ranges join, loops wrap, and what is held decides that it plays through', async () => {
  const { MediaTimes, withRange } = await load('more/media-times');
  assert.deepEqual(withRange([[0, 1], [3, 4]], [1, 2]), [[0, 2], [3, 4]]);
  assert.deepEqual(withRange([[0, 1], [3, 4]], [0.5, 3.5]), [[0, 4]]);
  assert.deepEqual(withRange([[3, 4]], [0, 1]), [[0, 1], [3, 4]]);
  const viewer = Object.assign(new EventTarget(), { paused: true, currentTime: 1, duration: 2, readyState: 3 }), reports = [];
  const held = [[0, 0.5], [0.75, 2]], heap = new Uint8Array(64);
  const module = { HEAPU8: heap, _fdvt_buffered: (_, i) => held[i] ? (new Float64Array(heap.buffer, 16, 2).set(held[i]), 16) : 0 };
  let player = null, bytes = 0;
  const times = new MediaTimes(viewer, { player: () => player, bytes: () => bytes }, (name) => reports.push(name));
  const on = (name, at = viewer.currentTime) => { viewer.currentTime = at; viewer.dispatchEvent(new Event(name)); };
  assert.deepEqual(times.buffered(), []);
  on('playing');
  assert.deepEqual(reports, [], 'nothing is known to be held');
  player = { call: (action) => action(module, 7) };
  assert.deepEqual(times.buffered(), held);
  on('canplay');
  assert.deepEqual(reports, ['canplaythrough']);
  on('timeupdate', 1.5);
  on('timeupdate', 0.25); // a loop
  on('seeking', 0.5);
  on('timeupdate', 0.9); // of the seek
  assert.deepEqual(times.played, [[0, 0.5], [1, 2]]);
  on('sequencechange', 0);
  assert.deepEqual(times.played, []);

  const after = (ms) => new Promise((done) => setTimeout(done, ms));
  reports.length = 0;
  viewer.readyState = 1;
  bytes = 50;
  times.turn();
  await after(450);
  assert.deepEqual(reports, [], 'the player reports the way to the first picture by itself');
  viewer.readyState = 4;
  times.turn();
  bytes = 120;
  times.turn();
  await after(450);
  assert.deepEqual(reports, ['progress'], 'once in a while');
  bytes = 130;
  times.turn();
  times.dispose();
  await after(450);
  assert.deepEqual(reports, ['progress']);
  times.turn();
  await after(450);
  assert.deepEqual(reports, ['progress', 'progress'], 'also after the element was put back');
  times.dispose();
});

// --- motion ---

function makeMotion() {
  const made = makeElement();
  made.viewer.current = { name: 'locomotion', parameters: [{ name: 'speed', min: 0, max: 2 }] };
  return made;
}

test('motion: numbers are checked, settings and options follow the attributes', () => {
  const { element, commands, settings } = makeMotion();
  assert.throws(() => element.setParameter('speed', NaN), TypeError);
  assert.throws(() => { element.heading = 'north'; }, TypeError);
  assert.throws(() => { element.placement = { x: Infinity }; }, TypeError);
  element.setParameter('speed', 1.5);
  assert.equal(element.getParameter('speed'), 1.5);
  assert.deepEqual(element.events, [['parameterchange', { name: 'speed', value: 1.5 }]]);
  element.placement = { x: 2 };
  assert.deepEqual(element.placement, { x: 2, z: 0, heading: 0 });
  element.travel = true;
  element.sequence = 'run';
  const { sequence, travel } = settings();
  assert.deepEqual({ sequence, travel }, { sequence: 'run', travel: true });
  assert.equal(commands.settings.sequence, 'run');
  element.align = 'flow-dis';
  assert.equal(element.align, 'flow-dis');
  element.align = 'sideways';
  assert.equal(element.align, 'baked');
});

test('motion: attributes wait until the element is in a document; the same sequence again is another command', () => {
  const { element, viewer, commands } = makeMotion();
  viewer.connected = false;
  element.sequence = 'run';
  assert.equal(commands.settings.sequence, null);
  viewer.connected = true;
  element.sequence = 'run';
  assert.equal(commands.settings.sequence, 'run');
  commands.goTo('walk');
  element.sequence = 'run';
  assert.equal(commands.settings.sequence, 'run');
});

test('motion: what steers comes with the second part and goes with the element', () => {
  const { element, viewer } = makeMotion(), log = [];
  class Steering {
    step(dtS) { log.push(dtS); return true; }
    update() { log.push('update'); }
    dispose() { log.push('dispose'); }
  }
  viewer.frame(0.1);
  const motion = viewer.features.find((feature) => 'goTo' in feature);
  motion.more({ Steering });
  motion.more({ Steering: null });
  assert.equal(viewer.frame(0.2), true);
  element.change('motion-controls', '');
  motion.disconnect();
  viewer.frame(0.3);
  assert.deepEqual(log, [0.2, 'update', 'dispose']);
});

test('steering: a held key turns and changes the parameter; let go, the heading stays', async () => {
  const { Steering } = await load('controls/steering');
  const listeners = {}, stage = {
    addEventListener: (name, listener) => { listeners[name] = listener; }, after() {}, getRootNode: () => ({ adoptedStyleSheets: [], ownerDocument: { defaultView: globalThis } }),
  };
  const make = () => ({ setAttribute() {}, append() {}, addEventListener() {}, remove() {}, style: {} });
  Object.assign(globalThis, { document: { createElement: make }, CSSStyleSheet: class { replaceSync() {} } });
  const log = [];
  const viewer = {
    paused: false, state: 'walk', heading: 10, sequences: [{ name: 'walk', loop: true }, { name: 'wave', loop: false }],
    parameters: [{ name: 'speed', min: 1, max: 3 }], hasAttribute: () => true, getAttribute: (name) => (name === 'motion-controls' ? '' : null),
    getParameter: () => 1, setParameter: (...values) => log.push(values), goTo: (name) => log.push(name), play: () => log.push('play'),
  };
  try {
    const steering = new Steering(stage, viewer, () => undefined, () => log.push('wake'));
    const key = (type, code) => listeners[type]({ code, preventDefault() {}, stopImmediatePropagation() {} });
    key('keydown', 'ArrowRight');
    key('keydown', 'ArrowUp');
    assert.equal(steering.step(0.1), true);
    assert.equal(viewer.heading, -50);
    assert.deepEqual(log.filter(Array.isArray), [['speed', 1 + 2 * 0.7 * 0.1]]);
    key('keyup', 'ArrowRight');
    key('keyup', 'ArrowUp');
    assert.equal(steering.step(0.1), false);
    key('keydown', 'Space');
    assert.ok(log.includes('wave'));
    viewer.paused = true;
    key('keydown', 'Space');
    assert.ok(log.includes('play'));
    steering.dispose();
  } finally {
    delete globalThis.document;
    delete globalThis.CSSStyleSheet;
  }
});

// --- camera ---

test('camera: attributes make the view; turning by itself waits for the visitor', () => {
  const { element, viewer } = makeElement(), { camera } = viewer;
  viewer.session = { wake() {} };
  element.attributes.set('camera-orbit', '40deg 10deg 3m');
  viewer.call('reset');
  assert.deepEqual(element.getCameraOrbit(), { azimuth: 40, elevation: 10, distance: 3 });
  element.setAttribute('field-of-view', '500');
  assert.equal(camera.fov, 35);
  element.setAttribute('field-of-view', '50deg');
  assert.equal(camera.fov, 50);
  element.toggleAttribute('auto-rotate', true);
  assert.equal(viewer.frame(0.5), true);
  element.jumpCameraToGoal();
  assert.ok(element.getCameraOrbit().azimuth > 40);
  viewer.reducedMotion = { matches: true };
  const { azimuth } = element.getCameraOrbit();
  viewer.frame(0.5);
  assert.equal(element.getCameraOrbit().azimuth, azimuth);
});

// --- appearance ---

test('appearance: options, scenes and qualities are checked before they reach the player', () => {
  const { element, commands } = makeElement();
  assert.equal(element.renderOptions.samples, 4);
  element.renderOptions = { samples: 0 };
  assert.deepEqual([element.renderOptions.samples, element.renderOptions.groundShadow], [0, true]);
  assert.throws(() => { element.renderOptions = { samples: 1000 }; }, RangeError);
  assert.throws(() => { element.scene = [{ corners: [1, 2, 3] }]; }, RangeError);
  element.scene = [{ corners: [] }, { corners: Array(18).fill(0) }];
  assert.equal(element.scene.length, 1);
  element.quality = '0';
  assert.equal(commands.settings.quality.rendition, 0);
  element.method = 'fvvr';
  assert.equal(commands.settings.method.name, 'fvvr');
});

test('appearance: there is no picture and nothing to count before there is a session', async () => {
  const { element } = makeElement();
  assert.equal(await element.toBlob(), null);
  assert.equal(element.stats, null);
});

// --- loading ---

test('loading: a src that is no address is one error, after whoever has set it could listen', async () => {
  const { element, shown, loading } = makeElement();
  element.src = 'http://[';
  assert.deepEqual(types({ events: shown }), ['dropCanvas', 'idle', 'setPoster', 'offerPlay'], 'the page does not let it load yet');
  assert.deepEqual(types(element), []);
  loading.allow(true);
  assert.deepEqual(types({ events: shown }).slice(4), ['loading', 'offerPlay']);
  assert.deepEqual(types(element), ['loadstart']);
  await Promise.resolve();
  assert.equal(element.error.id, 'invalid-argument');
  const fail = shown.find(([name]) => name === 'fail');
  assert.equal(fail[2], true, 'there is nothing else to look at');
  element.src = '';
  assert.equal(element.error, null);
});

test('loading: crossorigin says whether requests to other origins carry cookies', async () => {
  const { Transport } = await load('net/transport');
  const realFetch = globalThis.fetch, asked = [];
  globalThis.fetch = async (url, { credentials, cache }) => {
    asked.push([url.split('/').pop(), credentials, cache]);
    return new Response('{}');
  };
  try {
    await new Transport('http://other.example/a/character.gltf').manifest();
    const transport = new Transport('http://other.example/a/character.gltf', undefined, { credentials: 'include', cache: 'reload' });
    await transport.manifest();
    transport.expectStart();
    await transport.start('character.start.bin');
    await transport.range(1, 'room.webp', 0, 2);
  } finally {
    globalThis.fetch = realFetch;
  }
  assert.deepEqual(asked, [['character.gltf', undefined, undefined], ['character.gltf', 'include', 'reload'],
    ['character.start.bin', 'include', 'reload'], ['room.webp', 'include', 'reload']]);
});

test('loading: progress never begins full, and errors are forgotten when it can play', () => {
  const { element, viewer, shown } = makeElement();
  viewer.call('handle', 'error', { id: 'fetch-failed', message: 'gone' });
  assert.equal(element.error.id, 'fetch-failed');
  viewer.call('handle', 'progress', { loaded: 5, total: 5 });
  assert.ok(!types({ events: shown }).includes('progress'), 'nothing is loaded');
  viewer.call('handle', 'canplay');
  assert.equal(element.error, null);
});

test('loading: a context that comes back serves the session that has lost it, and no other', () => {
  const { element, viewer, loading: { host } } = makeElement(), session = {};
  viewer.session = session;
  host.lost(session);
  assert.equal(viewer.session, null);
  assert.deepEqual(types(element), ['waiting']);
  assert.equal(host.restored({}), false);
  element.load(); // nothing to load, but the lost session is not wanted any more
  assert.equal(host.restored(session), false);
});

// --- the page's budget ---

const priority = (part = {}) => ({ mode: 'auto', distance: 0, area: 100, shown: true, touchedMs: -Infinity, ...part });
const share = async (priorities, budget, had = []) => {
  const { allocate } = await load('element/budget');
  return allocate(priorities.map(priority), had, { loaded: 100, running: 100, ...budget }, 10_000);
};

test('budget: what is near loads, what is on screen first; what is held is kept until it is far', async () => {
  const reservations = await share([{ distance: 0.5 }, { distance: 1.5 }, { distance: 0.5, mode: 'lazy' }, { distance: 50, mode: 'eager' }]);
  assert.deepEqual(reservations.map(({ load }) => load), [true, false, false, true]);
  const busy = await share([{ shown: false }, { distance: 0.5 }, { distance: 9, mode: 'eager' }]);
  assert.deepEqual(busy.map(({ load }) => load), [true, false, true], 'what is near waits for what is seen');
  const held = await share([{ distance: 2.9 }, { distance: 3.1 }], {}, [{ load: true, run: false }, { load: true, run: false }]);
  assert.deepEqual(held.map(({ load }) => load), [true, false]);
  const few = await share([{ distance: 0.5 }, { distance: 0 }, { distance: 0, area: 500 }], { loaded: 2 });
  assert.deepEqual(few.map(({ load }) => load), [false, true, true]);
});

test('budget: decoders go to viewers on screen: without a picture, then touched, then larger', async () => {
  const run = async (priorities, running) => (await share(priorities, { running })).map((reservation) => reservation.run);
  assert.deepEqual(await run([{ distance: 0.5, shown: false }, {}], 1), [false, true]);
  assert.deepEqual(await run([{ area: 500 }, { shown: false }], 1), [false, true]);
  assert.deepEqual(await run([{ area: 500 }, { touchedMs: 9000 }], 1), [false, true]);
  assert.deepEqual(await run([{ area: 500 }, { touchedMs: 1000 }], 1), [true, false], 'that was long ago');
  assert.deepEqual(await run([{ distance: 0.5 }, {}], 2), [true, true], 'what is left is for those that are near');
});

test('budget: the budget follows what viewers have turned out to hold', async () => {
  const { limitsOf } = await load('element/budget');
  assert.deepEqual(limitsOf(150e6, 4, 0, 0), { loaded: 10, running: 4 });
  assert.deepEqual(limitsOf(150e6, 4, 120e6, 4), { loaded: 5, running: 4 });
  assert.equal(limitsOf(10e6, 4, 120e6, 1).loaded, 1, 'one is always shown');
});

test('budget: one that is heavier than the others is freed once, not for ever', async () => {
  const { PageBudget } = await load('element/budget');
  const members = [], due = [];
  const used = () => members.reduce((sum, { holds, bytes }) => sum + (holds ? bytes : 0), 0);
  const budget = new PageBudget({ usedBytes: used, bytes: 160e6, decoders: 4, now: () => 0, later: (run) => due.push(run) });
  for (let i = 0; i < 10; ++i) {
    const one = { bytes: i < 9 ? 5e6 : 120e6, holds: false, loads: 0, priority: () => priority({ area: 100 - i }), reserved({ load }) {
      if (load && !this.holds) ++this.loads;
      this.holds = load;
    } };
    members.push(one);
    budget.add(one);
  }
  for (let turns = 0; turns < 20; ++turns) {
    for (const run of due.splice(0)) run();
    budget.review();
  }
  assert.deepEqual(members.map(({ loads }) => loads), Array(10).fill(1));
  assert.deepEqual(members.map(({ holds }) => holds), [...Array(9).fill(true), false]);
  assert.ok(used() <= 160e6);
});

test('budget: only those whose reservation changes hear of it, the freed ones first, once a turn', async () => {
  const { PageBudget } = await load('element/budget');
  const due = [], log = [];
  const budget = new PageBudget({ usedBytes: () => 0, bytes: 15e6, decoders: 1, now: () => 0, later: (run) => due.push(run) });
  const turn = () => { for (const run of due.splice(0)) run(); };
  const member = (name, part) => ({ part, priority() { return priority(this.part); }, reserved: ({ load, run }) => log.push(`${name} ${load} ${run}`) });
  const a = member('a', {}), b = member('b', { distance: 0.9 });
  for (const one of [a, b]) budget.add(one);
  assert.equal(due.length, 1);
  turn();
  assert.deepEqual(log.splice(0), ['a true true'], 'there is room for one');
  a.part = { distance: 5 };
  b.part = {};
  budget.review();
  turn();
  assert.deepEqual(log.splice(0), ['a false false', 'b true true']);
  budget.review();
  turn();
  assert.deepEqual(log, []);
  budget.remove(b);
  budget.remove(b);
  turn();
});
