// SPDX-License-Identifier: Apache-2.0
// Faults of network, server, decoder, GPU and page around a valid character. The viewer must recover from transient
// faults; a permanent fault gives one error with its ID. In all cases: no unhandled rejection, no uncaught exception, and
// after removal of the element every decoder and picture is closed. Writes a table: fault, visible effect, recovery time
// or error.
import assert from 'node:assert/strict';

import {
  advances, browserOffline, errors, everywhere, finish, firstError, framesShown, get, ofCharacter, open, panel, panelText, pass,
  passUntil, plays, row, runScenes, sceneTest, seconds, seenCount, until, wait,
} from './fault_scenes.mjs';
import { kElsewhere, launch, readCanvas, waitForEvent } from './harness.mjs';
import { coverage } from './ssim.mjs';

for (const [title, scene] of everywhere) sceneTest(title, scene);
sceneTest('the browser is offline for 10 s', browserOffline);

// Runs in the page before its scripts.
function makeHideable() {
  globalThis.pageHidden = false;
  Object.defineProperty(document, 'hidden', { get: () => globalThis.pageHidden });
  globalThis.setHidden = (hidden) => {
    globalThis.pageHidden = hidden;
    document.dispatchEvent(new Event('visibilitychange'));
  };
}

async function hiddenForAMinute() {
  const scene = await open('page hidden for a minute', { before: makeHideable });
  await plays(scene);
  await get(scene, () => globalThis.setHidden(true));
  await pass(scene, 60_000);
  assert.deepEqual(await get(scene, () => [globalThis.live.decoders, globalThis.live.pictures]), [0, 0]);
  const back = Date.now();
  await get(scene, () => globalThis.setHidden(false));
  assert.ok(await advances(scene));
  row(scene.name, 'nothing', `plays ${seconds(Date.now() - back)} after it is seen again`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
}

sceneTest('a hidden page holds no decoder, and a paused viewer stays paused', async () => {
  const scene = await open('page hidden', { before: makeHideable });
  await plays(scene);
  await get(scene, () => globalThis.setHidden(true));
  const shown = await framesShown(scene);
  await pass(scene, 2000);
  await wait(500);
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
  await pass(scene, 700);
  await wait(300);
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

sceneTest('a GL context that is given back', async () => {
  const scene = await open('GL context lost and given back');
  await plays(scene);
  const lost = Date.now();
  await get(scene, async () => {
    const gl = globalThis.viewer.shadowRoot.querySelector('canvas').getContext('webgl2');
    const extension = gl.getExtension('WEBGL_lose_context');
    extension.loseContext();
    await globalThis.testClock.turn(500);
    extension.restoreContext();
  });
  await until(scene, () => globalThis.seen.filter((e) => e.type === 'canplay').length === 2);
  assert.ok(await advances(scene));
  assert.ok(coverage(await readCanvas(scene.page)) > 0.02);
  row(scene.name, 'the poster for a moment', `plays ${seconds(Date.now() - lost)} after it is back`);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
});

sceneTest('a GL context that is never given back: the poster, and a button', async () => {
  const scene = await open('GL context lost for good');
  await plays(scene);
  await get(scene, () => {
    const canvas = globalThis.viewer.shadowRoot.querySelector('canvas');
    canvas.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
  });
  const told = await passUntil(scene, () => globalThis.seen.some((e) => e.type === 'error'));
  assert.equal((await firstError(scene)).id, 'gpu-failure');
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

sceneTest('an element that is moved goes on; one that comes back is where it was', async () => {
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

sceneTest('another src while loading, removal while loading', async () => {
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

sceneTest('files that are damaged, and a server that knows no ranges', async () => {
  for (const [name, file, fault, id] of [
    ['a video that ends too early', '.mp4', { truncate: 2000 }, 'fetch-failed'],
    ['wrong bytes', '.mp4', { spoil: true }, 'files-differ'],
    ['a manifest that ends too early', '.gltf', { truncate: 3000 }, 'manifest-invalid'],
    ['200 for a range', '', { whole: true }, null],
  ]) {
    const scene = await open(name, { faults: (r) => (ofCharacter(r) && r.url.endsWith(file) ? fault : null) });
    if (id) {
      assert.equal((await firstError(scene)).id, id);
      assert.equal((await panel(scene)).error, true);
    } else {
      await plays(scene);
      assert.deepEqual(await errors(scene), []);
    }
    row(name, id ? 'poster, panel' : 'nothing', id ? `\`${id}\`` : 'plays; whole files are downloaded');
    await finish(scene);
  }
});

sceneTest('what cannot work is one error with its own ID', async () => {
  const cases = [
    ['wasm refused by the page\'s policy', 'wasm-refused',
      { policy: "script-src 'self' 'unsafe-inline'" }, (line) => /Content Security Policy|wasm/i.test(line)],
    ['wasm file missing', 'fetch-failed', { faults: (r) => (/\.wasm\?v=\w{8}$/.test(r.url) ? { status: 404 } : null) }],
    ['wasm file cut short', 'wasm-refused', { before: () => {
      const native = globalThis.fetch;
      globalThis.fetch = async (url, init) => (String(url).includes('.wasm')
        ? new Response((await (await native(url, init)).arrayBuffer()).slice(0, 5000)) : native(url, init));
    } }],
    ['wasm of another build', 'wasm-refused', { before: () => {
      const native = globalThis.fetch;
      globalThis.fetch = async (url, init) => {
        const answer = await native(url, init);
        if (!String(url).includes('.wasm')) return answer;
        const bytes = new Uint8Array(await answer.arrayBuffer());
        bytes[bytes.length - 1] ^= 1; // the last digit of its stamp
        return new Response(bytes);
      };
    } }],
    ['no memory for wasm', 'out-of-memory', { before: () => {
      WebAssembly.instantiate = () => Promise.reject(new RangeError('WebAssembly.Memory(): could not allocate memory'));
    } }],
    ['page without https or MediaSource', 'insecure-context', { host: kElsewhere, before: () => { delete globalThis.MediaSource; } }],
    ['src that is no address', 'invalid-argument', { src: 'http://[' }],
    ['src of an unknown scheme', 'fetch-failed', { src: 'gopher://somewhere/character.gltf' }, (line) => /gopher/.test(line)],
  ];
  for (const [name, id, options, expected] of cases) {
    const scene = await open(name, options);
    const error = await firstError(scene);
    assert.equal(error.id, id, `${name}: ${error.message}`);
    assert.ok(error.message.length > 20 && !error.message.includes('\n'), error.message);
    await pass(scene, 1000);
    await wait(100);
    assert.equal((await errors(scene)).length, 1, `${name}: one error`);
    assert.equal((await panel(scene)).error, true);
    assert.equal(await panelText(scene), options.host ? 'This page must come over https to show the character.' : `${id}: ${error.message}`);
    const refusal = await get(scene, () => globalThis.viewer.play().then(() => 'plays', (reason) => reason.id));
    assert.equal(refusal, id, `${name}: play() says why not`);
    row(name, 'poster, panel', `\`${id}\``);
    await finish(scene, expected);
  }
});

// What web/README.md lists; style and icon are the test page's own.
const kPolicy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; img-src 'self' data:; style-src 'unsafe-inline'";

sceneTest('the policy that the documents list is enough; another origin that it blocks is an error at once', async () => {
  const allowed = await open('page with a policy', { policy: kPolicy });
  await plays(allowed);
  assert.deepEqual(await errors(allowed), []);
  await finish(allowed);
  const blocked = await open('origin blocked by connect-src', { policy: kPolicy, elsewhere: { 'Access-Control-Allow-Origin': '*' } });
  const { id, message } = await firstError(blocked);
  assert.equal(id, 'fetch-failed');
  assert.match(message, /character\.gltf: .*connect-src/);
  assert.equal(await seenCount(blocked, 'stalled'), 0);
  assert.equal((await panel(blocked)).error, true);
  row(blocked.name, 'poster, panel', '`fetch-failed`, which names the directive');
  await finish(blocked, (line) => /violates the following Content Security Policy|Content Security Policy.*connect-src|Fetch API cannot load/.test(line));
});

sceneTest('the second part of the player cannot be had: an error says why, and the motion plays on; it comes once it can', async () => {
  const lacks = (scene) => get(scene, () => globalThis.viewer.shadowRoot.querySelector('.note:not([hidden])')?.textContent ?? '');
  const hasControls = () => globalThis.viewer.shadowRoot.querySelector('.controls') !== null;
  for (const [name, file, fault, reason] of [
    ['an HTML page in place of fourdvt-more.js', /fourdvt-more\.js/, { text: '<!doctype html><title>shop</title>' }, /fourdvt-more\.js.*HTML page in place of the file/],
    ['no fourdvt-more.wasm', /fourdvt-more\.wasm/, { status: 404 }, /fourdvt-more\.wasm.*HTTP 404/],
  ]) {
    const scene = await open(name, { faults: (r) => (file.test(r.url) ? fault : null) });
    const { id, message } = await firstError(scene);
    assert.equal(id, 'fetch-failed');
    assert.match(message, reason);
    assert.ok(await advances(scene));
    assert.match(await lacks(scene), reason);
    assert.equal((await panel(scene)).error, false);
    scene.faults = null;
    await get(scene, () => globalThis.viewer.load());
    await until(scene, hasControls);
    assert.equal(await lacks(scene), '');
    assert.deepEqual(await errors(scene), ['fetch-failed']);
    row(name, 'a line; the motion plays on without controls and sound', '`fetch-failed`; comes with the next load');
    await finish(scene, (line) => /Failed to load module script|Failed to fetch dynamically/.test(line));
  }
  const passing = await open('503 for fourdvt-more.js for a while', { faults: (r) => (/fourdvt-more\.js/.test(r.url) ? { status: 503 } : null) });
  await plays(passing);
  await until(passing, () => globalThis.seen.some((e) => e.type === 'stalled'));
  passing.faults = null;
  await passUntil(passing, hasControls);
  assert.deepEqual(await errors(passing), []);
  await finish(passing, (line) => /Failed to fetch dynamically/.test(line));
});

sceneTest('addresses of all kinds: signed by the page, redirected, in a blob with whole addresses', async () => {
  const signed = await open('signed files', { src: null, faults: (r) => (ofCharacter(r) && !r.url.endsWith('?key=1') ? { status: 403 } : null) });
  await get(signed, () => {
    globalThis.viewer.sign = async (url) => `${url}?key=1`;
    globalThis.viewer.src = 'character/character.gltf';
  });
  await plays(signed);
  assert.deepEqual(await errors(signed), []);
  await finish(signed);
  const refused = await open('unsigned files', { faults: (r) => (ofCharacter(r) && !r.url.includes('.gltf') ? { status: 403 } : null) });
  assert.match((await firstError(refused)).message, /HTTP 403: .*property sign/);
  await finish(refused);
  const redirects = ({ url }, response) => {
    if (url !== '/latest/character.gltf') return false;
    response.writeHead(302, { Location: '/character/character.gltf' }).end();
    return true;
  };
  const latest = await open('redirected manifest', { src: 'latest/character.gltf', serving: { handle: redirects } });
  await plays(latest);
  assert.equal(await get(latest, () => globalThis.viewer.currentSrc), `${latest.url}latest/character.gltf`);
  assert.deepEqual(await errors(latest), []);
  await finish(latest);
  const blob = await open('manifest in a blob', { src: null });
  await get(blob, async () => {
    const base = new URL('character/character.gltf', location.href), text = await (await fetch(base)).text();
    const whole = JSON.stringify(JSON.parse(text), (key, value) => (key === 'uri' && !value.startsWith('data:') ? new URL(value, base).href : value));
    globalThis.viewer.src = URL.createObjectURL(new Blob([whole]));
  });
  await plays(blob);
  assert.deepEqual(await errors(blob), []);
  await get(blob, () => { globalThis.viewer.src = `data:model/gltf+json,${encodeURIComponent('{"extensions":{"x":{"uri":"walk.bin"}}}')}`; });
  const { id, message } = await firstError(blob);
  assert.equal(id, 'manifest-invalid');
  assert.match(message, /"walk\.bin" lies in no folder/);
  await finish(blob);
});

sceneTest('a host that does not exist is an error after a while', async () => {
  const scene = await open('unknown host', { src: 'http://nowhere.invalid/character/character.gltf' });
  const ms = await passUntil(scene, () => globalThis.seen.some((e) => e.type === 'error'));
  assert.ok(ms < 30_000, seconds(ms));
  const { id, message } = await firstError(scene);
  assert.equal(id, 'fetch-failed');
  assert.match(message, /http:\/\/nowhere\.invalid has never answered/);
  assert.deepEqual(await panel(scene), { error: true, note: false, play: false });
  row(scene.name, 'poster, "Waiting for the network", panel', `\`fetch-failed\` after ${seconds(ms)}`);
  await finish(scene);
});

sceneTest('options and snapshots that cannot be drawn are refused, and the picture stays', async () => {
  const scene = await open('wrong options', { src: null });
  const refused = await get(scene, async () => {
    const { viewer } = globalThis;
    const nameOf = (set) => { try { set(); return 'taken'; } catch (reason) { return reason.name; } };
    viewer.renderOptions = { debug: 'layer', debugLayer: 200 }; // no character yet: its last layer
    viewer.src = 'character/character.gltf';
    await new Promise((done) => viewer.addEventListener('canplay', done, { once: true }));
    const { extensions } = await (await fetch(viewer.src)).json();
    const { layerCount } = extensions.FOURDVT_layered_video_texture;
    const names = [
      nameOf(() => { viewer.renderOptions = { debugLayer: layerCount }; }),
      nameOf(() => { viewer.renderOptions = { debugLayer: layerCount - 1 }; }),
      nameOf(() => { viewer.renderOptions = { background: [0, 0, 0] }; }),
      nameOf(() => { viewer.renderOptions = { samples: NaN }; }),
    ];
    for (const snapshot of [{ width: 0, height: 10 }, { width: 10, height: 5000 }, { width: 10, height: 10, pose: { distance: NaN } }]) {
      names.push(await viewer.toBlob(snapshot).then(() => 'taken', (reason) => reason.name));
    }
    const { width, height } = await createImageBitmap(await viewer.toBlob({ width: 33, height: 44 }));
    const { samples, debugLayer } = viewer.renderOptions;
    return { names, width, height, samples, last: debugLayer === layerCount - 1 };
  });
  assert.deepEqual(refused, {
    names: ['RangeError', 'taken', 'TypeError', 'RangeError', 'RangeError', 'RangeError', 'RangeError'], width: 33, height: 44, samples: 4, last: true,
  });
  assert.ok(await advances(scene));
  assert.ok(coverage(await readCanvas(scene.page)) > 0.02);
  assert.deepEqual(await errors(scene), []);
  await finish(scene);
});

sceneTest('promises that an element makes to its page', async () => {
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

sceneTest('after a click the wheel zooms until the pointer leaves, and then scrolls the page again', async () => {
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

sceneTest('a page that is hidden for a minute is seen again', hiddenForAMinute);

runScenes('faults', launch);
