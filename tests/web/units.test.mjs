// SPDX-License-Identifier: Apache-2.0
// Parts of the element that need no browser: byte ranges, manifest flattening, orbit camera, commands,
// frame loop, the flow module. Executed from source.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { get } from 'node:https';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { stampWasm } from '../../wasm/abi.mjs';
import { requireFromWeb } from './harness.mjs';
import { load } from './load_source.mjs';
import { serve, serveOnNextFreePort } from './server.mjs';

const { buildSync } = requireFromWeb('esbuild');
let folder, bytes;

before(() => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-units-'));
  bytes = Uint8Array.from({ length: 5000 }, (_, i) => (i * 7) & 255);
  writeFileSync(join(folder, 'data.bin'), bytes);
  writeFileSync(join(folder, 'package.json'), '{"type": "module"}');  // .js files here are modules, also for Node 18
});
after(() => rmSync(folder, { recursive: true, force: true }));

for (const ranges of [true, false]) {
  test(`ranges come out the same from a server ${ranges ? 'with' : 'without'} range support`, async () => {
    const { Transport } = await load('net/transport');
    const server = await serve(folder, 0, { ranges });
    const transport = new Transport(`${server.url}character.gltf`);
    transport.stopReplay();
    for (const [offset, size] of [[0, 10], [100, 900], [4990, 10]]) {
      assert.deepEqual(await transport.range(offset, 'data.bin', offset, size), bytes.slice(offset, offset + size));
    }
    assert.equal(server.requests.length, ranges ? 3 : 1, 'a whole file is fetched once');
    await assert.rejects(transport.range(9, 'data.bin', 4995, 10), { id: 'fetch-failed' });
    await assert.rejects(transport.range(9, 'none.bin', 0, 10), { id: 'fetch-failed' });
    transport.dispose();
    await server.close();
  });
}

test('the server of the demo, which runs for days, keeps no list of requests', async () => {
  const demo = await serveOnNextFreePort(folder, 18080), recorded = await serve(folder);
  for (const { url } of [demo, recorded]) assert.equal((await fetch(`${url}data.bin`)).status, 200);
  await Promise.all([demo.close(), recorded.close()]);
  assert.deepEqual([demo.requests.length, recorded.requests.length], [0, 1]);
});

test('a transient failure is tried again, a cancelled range answers nothing', async () => {
  const { Transport } = await load('net/transport');
  let calls = 0;
  const server = createServer((request, response) => {
    if (request.url === '/never.bin') return;
    response.writeHead(++calls === 1 ? 503 : 206);
    response.end(calls === 1 ? '' : 'abcd');
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const transport = new Transport(`http://127.0.0.1:${server.address().port}/character.gltf`);
  assert.equal(new TextDecoder().decode(await transport.range(1, 'x.bin', 0, 4)), 'abcd');
  assert.equal(calls, 2);
  const never = transport.range(2, 'never.bin', 0, 4);
  transport.cancel(2);
  assert.equal(await never, null);
  transport.dispose();
  server.closeAllConnections?.();
  await new Promise((done) => server.close(done));
});

test('a page that was busy itself does not take that time for a stall; a server that is silent is asked again', async () => {
  const { Transport } = await load('net/transport');
  const { setTimeout: later, setInterval: every } = globalThis;
  globalThis.setTimeout = (run, ms, ...more) => later(run, ms / 100, ...more); // the transport's seconds last 10 ms
  globalThis.setInterval = (run, ms, ...more) => every(run, ms / 100, ...more);
  const asked = [];
  const server = createServer((request, response) => {
    asked.push(request.url);
    response.writeHead(206, { 'Content-Length': 4 });
    response.write('ab');
    if (request.url === '/silent.bin' && asked.length === 2) return;
    later(() => setImmediate(() => {
      response.end('cd');
      for (const until = Date.now() + 300; asked.length === 1 && Date.now() < until;); // what came waits; timers are next
    }), 20);
  });
  try {
    await new Promise((done) => server.listen(0, '127.0.0.1', done));
    const transport = new Transport(`http://127.0.0.1:${server.address().port}/character.gltf`);
    assert.equal(new TextDecoder().decode(await transport.range(1, 'busy.bin', 0, 4)), 'abcd');
    assert.deepEqual(asked, ['/busy.bin']);
    assert.equal(new TextDecoder().decode(await transport.range(2, 'silent.bin', 0, 4)), 'abcd');
    assert.deepEqual(asked, ['/busy.bin', '/silent.bin', '/silent.bin']);
    transport.dispose();
  } finally {
    Object.assign(globalThis, { setTimeout: later, setInterval: every });
    server.closeAllConnections?.();
    await new Promise((done) => server.close(done));
  }
});

// Runs with timers that are a hundred times as fast, and with these globals.
async function hurried(globals, run) {
  const before = { setTimeout: globalThis.setTimeout, ...Object.fromEntries(Object.keys(globals).map((name) => [name, globalThis[name]])) };
  Object.assign(globalThis, globals, { setTimeout: (call, ms, ...more) => before.setTimeout(call, ms / 100, ...more) });
  try {
    return await run();
  } finally {
    Object.assign(globalThis, before);
  }
}

test('a server that has never answered is given up, one that has answered is waited for', async () => {
  const server = await serve(folder);
  const { url } = server;
  const asked = [];
  const fetch = (address, init) => (asked.push(address), globalThis.realFetch(address, init));
  globalThis.realFetch = globalThis.fetch;
  await hurried({ fetch }, async () => {
    const { fetchFile } = await load('net/requests');
    const heard = [];
    await assert.rejects(fetchFile('http://127.0.0.1:1/x.gltf', (waiting) => heard.push(waiting)),
      { id: 'fetch-failed', message: 'http://127.0.0.1:1/x.gltf: http://127.0.0.1:1 has never answered; correct the address, or start its server' });
    assert.deepEqual(heard, [true, false]);
    assert.ok(asked.length >= 8 && asked.length < 14, `seven times, with one look at its permission: ${asked.length} requests`);
    assert.deepEqual(new Uint8Array(await fetchFile(`${url}data.bin`)), bytes);
    await server.close();
    asked.length = 0;
    const stop = new AbortController();
    const later = fetchFile(`${url}data.bin`, undefined, stop.signal).then(() => 'came', () => 'stopped');
    while (asked.length < 24) await new Promise((next) => setTimeout(next, 100));
    stop.abort();
    assert.equal(await later, 'stopped', 'no error before');
  });
});

for (const [what, address, reason] of [
  ['an unknown scheme', 'gopher://somewhere/character.gltf', /^gopher:.*https/],
  ['a file of the visitor', 'file:///home/anna/character.gltf', /cannot load file: addresses; serve the file over https/],
  ['a blob that is gone', 'blob:https://page.example/0f6c', /revoke/],
  ['a broken data: address', 'data:model/gltf+json;base64,%', /^data:model.*data:/],
  ['a password', 'https://me:secret@page.example/character.gltf', /password/],
  ['mixed content', 'http://elsewhere.example/character.gltf', /over https cannot load over http/],
  ['an address that the policy blocks', 'https://blocked.example/character.gltf', /connect-src/],
]) {
  test(`${what} is an error at once`, async () => {
    let asked = 0, listener;
    const fetch = async () => { ++asked; throw new TypeError('Failed to fetch'); };
    await hurried({ fetch, origin: 'https://page.example', addEventListener: (_, call) => { listener ??= call; }, removeEventListener() {} }, async () => {
      const { fetchFile } = await load(`net/requests?${what}`);
      listener({ disposition: 'report', blockedURI: 'https://page.example/character.gltf' });
      listener({ disposition: 'enforce', blockedURI: 'https://blocked.example/character.gltf' });
      await assert.rejects(fetchFile(`${address}#part`), { id: 'fetch-failed', message: reason });
      assert.equal(asked, 1);
    });
  });
}

// Serves the manifest, and for all else bytes without an end.
async function serveEndless(t, manifest) {
  const sent = { bytes: 0, open: 0 };
  const part = Buffer.alloc(1 << 16);
  const server = createServer((request, response) => {
    if (manifest && /^\/a\/character\.gltf(\?|$)/.test(request.url)) return response.end(JSON.stringify(manifest));
    ++sent.open;
    response.on('close', () => --sent.open);
    const more = () => { while (!response.destroyed && response.write(part)) sent.bytes += part.length; };
    response.on('drain', () => { sent.bytes += part.length; more(); });
    response.writeHead(request.headers.range && request.url.includes('part') ? 206 : 200);
    more();
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  t.after(() => {
    server.close();
    server.closeAllConnections?.();
  });
  return { url: `http://127.0.0.1:${server.address().port}/a/character.gltf`, sent };
}

test('an answer without an end is given up at the length of the file', async (t) => {
  const { Transport } = await load('net/transport');
  const MIB = 1 << 20;
  const server = await serveEndless(t, { buffers: [{ uri: 'mesh.bin', byteLength: 3 * MIB }], mesh: { uri: 'mesh.bin', byteOffset: 10, byteLength: MIB }, part: { uri: 'part.bin', byteLength: MIB } });
  const transport = new Transport(server.url);
  await transport.manifest();
  await assert.rejects(transport.range(1, 'mesh.bin', 0, 10), { id: 'fetch-failed', message: /\/a\/mesh\.bin: the server sends more than 3145728 bytes/ });
  await assert.rejects(transport.range(2, 'part.bin', 0, 10), { id: 'fetch-failed', message: /part\.bin.*1048576 bytes/ });
  assert.ok(server.sent.bytes < 40 * MIB, `${server.sent.bytes} bytes`);
  const { fetchFile } = await load('net/requests');
  await assert.rejects(fetchFile(`${server.url}.wasm`), { id: 'fetch-failed', message: /gltf\.wasm: .*33554432 bytes/ });
  while (server.sent.open) await new Promise((next) => setTimeout(next, 10));
  transport.dispose();
  const endless = await serveEndless(t, null);
  await assert.rejects(new Transport(endless.url).manifest(), { id: 'fetch-failed', message: /character\.gltf: .*33554432 bytes/ });
});

test('no file of a character is outside of the manifest\'s folder', async (t) => {
  const { Transport } = await load('net/transport');
  for (const uri of [' //other.example/x', '%2e%2e/x.bin', 'b%2f..%2f..%2fx.bin', 'b%5c%2e%2e', 'b/%2E%2e/../../x.bin', '..\\x.bin', '/x.bin', 'https:x.bin/../../y', 'http://[', 'javascript:0', ' data:,x']) {
    const server = await serveEndless(t, { deep: [{ poster: { uri } }] });
    const transport = new Transport(server.url);
    const refusal = { id: 'manifest-invalid', message: /is not in the character's folder/ };
    await assert.rejects(transport.manifest(), refusal, uri);
    await assert.rejects(transport.range(1, uri, 0, 4), refusal, uri);
    assert.equal(server.sent.bytes, 0);
  }
  const server = await serveEndless(t, { images: [{ uri: 'data:,x' }], a: { uri: 'b/c.bin' }, none: null });
  const manifest = await new Transport(`${server.url}?version=2`).manifest();
  assert.deepEqual(manifest, { images: [{ uri: 'data:,x' }], a: { uri: 'b/c.bin' }, none: null });
});

test('the server of demo.sh --lan: https under an address that other devices reach', async () => {
  const [key, cert] = ['lan.key', 'lan.crt'].map((name) => join(folder, name));
  execFileSync('openssl', ['req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '1', '-subj', '/CN=test', '-keyout', key, '-out', cert],
    { stdio: 'ignore' });
  const tls = { key: readFileSync(key), cert: readFileSync(cert) };
  const server = await serve(folder, 0, { host: '0.0.0.0', tls });
  assert.match(server.url, /^https:\/\/\d+\.\d+\.\d+\.\d+:\d+\/$/);
  const status = await new Promise((done, fail) => {
    get(`${server.url}data.bin`, { rejectUnauthorized: false }, (answer) => done(answer.resume().statusCode)).on('error', fail);
  });
  assert.equal(status, 200);
  await server.close();
});

test('the picture of a light is closed when its pixels are read', async () => {
  const { readLook } = await load('more/look');
  const picture = { width: 64, height: 32, closed: 0, close() { ++this.closed; } };
  const context = { drawImage: ({ closed }) => assert.equal(closed, 0), getImageData: () => ({ data: new Uint8ClampedArray(4) }) };
  const attributes = { look: 'relit', light: 'light.png' };
  const element = { getAttribute: (name) => attributes[name] ?? null, baseURI: 'http://page.example/' };
  const before = { fetch: globalThis.fetch };
  Object.assign(globalThis, {
    fetch: async () => new Response(''), createImageBitmap: async () => picture,
    document: { createElement: () => ({ getContext: () => context }) },
  });
  try {
    await readLook(element);
  } finally {
    Object.assign(globalThis, before);
    delete globalThis.document;
    delete globalThis.createImageBitmap;
  }
  assert.equal(picture.closed, 1);
});

test('JSON is flattened to pointers with escapes', async () => {
  const { flattenJson } = await load('wasm/flat-json');
  const seen = {};
  flattenJson({ a: [1, { 'b/c~': 'x' }], t: true, n: null, e: [], o: {} }, (pointer, value) => { seen[pointer] = value; });
  assert.deepEqual(seen, { '/a/0': 1, '/a/1/b~1c~0': 'x', '/t': true });
});

test('JSON that is nested deeper than a manifest is refused, however deep', async () => {
  const { flattenJson } = await load('wasm/flat-json');
  const nested = (depth) => JSON.parse('[1,'.repeat(depth) + '2' + ']'.repeat(depth));
  flattenJson(nested(64), () => undefined);
  for (const depth of [65, 5000, 200000]) assert.throws(() => flattenJson(nested(depth), () => undefined), { id: 'manifest-invalid' });
});

test('quality: a name, a number, or automatic by the size on screen; the lowest for who saves data', async () => {
  const { qualityOf } = await load('page/quality-attribute');
  const of = (value, height = 100) => Object.values(qualityOf({ getAttribute: () => value }, height)).join();
  assert.equal(of('highest'), '-1,0');
  assert.equal(of('0'), '0,0');
  assert.equal(of('2'), '2,0');
  const before = Object.getOwnPropertyDescriptor(globalThis, 'navigator');
  const visit = (value) => Object.defineProperty(globalThis, 'navigator', { value, configurable: true });
  let reduced = false;
  globalThis.matchMedia = (query) => ({ matches: reduced && query === '(prefers-reduced-data: reduce)' });
  visit({});
  for (const value of [null, '', 'auto', '-1', '0.5', 'best']) assert.equal(of(value, 90), '-2,360', String(value));
  visit({ connection: { saveData: true } });
  assert.equal(of('auto'), '0,0');
  assert.equal(of('highest'), '-1,0');
  visit({});
  reduced = true;
  assert.equal(of('auto'), '0,0');
  delete globalThis.matchMedia;
  delete globalThis.navigator;
  if (before) Object.defineProperty(globalThis, 'navigator', before);
});

test('what a page sets by hand is refused before it reaches the player', async () => {
  const { checkRenderOptions, checkSnapshot } = await load('player/input-checks');
  const options = { background: [0, 0, 0, 0], groundShadow: true, shadowStrength: 0.45, samples: 4, debug: 'none', debugLayer: 0 };
  checkRenderOptions(options);
  checkRenderOptions({ ...options, debug: 'layer', debugLayer: 2, samples: 0, background: Float32Array.of(1, 1, 1, 1) }, 3);
  checkRenderOptions({ ...options, debugLayer: 7 });
  for (const [part, name, layers] of [
    [{ debugLayer: 3 }, 'RangeError', 3], [{ debugLayer: -1 }, 'RangeError'], [{ debugLayer: 0.5 }, 'RangeError'], [{ debugLayer: NaN }, 'RangeError'],
    [{ debugLayer: 1e10 }, 'RangeError'], [{ samples: -1 }, 'RangeError'], [{ samples: 1.5 }, 'RangeError'], [{ samples: Infinity }, 'RangeError'],
    [{ samples: undefined }, 'RangeError'], [{ shadowStrength: NaN }, 'RangeError'], [{ shadowStrength: 2 }, 'RangeError'],
    [{ debug: 'layers' }, 'TypeError'], [{ background: [0, 0, 0] }, 'TypeError'], [{ background: null }, 'TypeError'],
    [{ background: [0, 0, NaN, 0] }, 'TypeError'], [{ background: 'none' }, 'TypeError'],
  ]) {
    assert.throws(() => checkRenderOptions({ ...options, ...part }, layers), { name, message: new RegExp(Object.keys(part)[0]) });
  }
  const pose = { azimuth: 0, elevation: 0, distance: 3, target: [0, 1, 0], fov: 35 };
  checkSnapshot(1, 4096, pose);
  for (const [width, height, part] of [
    [0, 100, {}], [100, 4097, {}], [undefined, 100, {}], [10.5, 10, {}], [9, 9, { azimuth: NaN }], [9, 9, { elevation: undefined }],
    [9, 9, { distance: 0 }], [9, 9, { fov: 180 }], [9, 9, { target: [0, 0] }], [9, 9, { target: [0, 0, Infinity] }], [9, 9, { target: null }],
  ]) {
    assert.throws(() => checkSnapshot(width, height, { ...pose, ...part }), ({ name }) => /^(Range|Type)Error$/.test(name));
  }
});

test('orbit: text, limits from the box, damping at any rate, the whole box is in the picture', async () => {
  const { OrbitCamera, parseOrbit } = await load('camera/orbit-camera');
  assert.deepEqual(parseOrbit('30deg -5deg 3.5m'), { azimuth: 30, elevation: -5, distance: 3.5 });
  assert.deepEqual(parseOrbit('auto 8deg auto'), { azimuth: 0, elevation: 8, distance: null });
  const camera = new OrbitCamera();
  camera.setAspect(0.75);
  camera.setCharacter({ min: [-0.5, 0, -0.3], max: [0.5, 1.8, 0.3], groundY: 0, sequences: [] });
  camera.jump();
  const fit = camera.pose.distance;
  const half = Math.tan((35 / 2) * (Math.PI / 180)) * (fit - Math.hypot(0.5, 0.3));
  assert.ok(half > 0.9 && half * 0.75 > Math.hypot(0.5, 0.3) * 0.9, `half height ${half}`);
  camera.zoom(1e-6);
  camera.rotate(0, -500);
  camera.jump();
  const low = camera.pose;
  assert.ok(Math.abs(low.distance - 0.35 * fit) < 1e-9);
  assert.ok(low.target[1] + low.distance * Math.sin((low.elevation * Math.PI) / 180) > 0.04, 'never below the ground');
  camera.rotate(0, 500);
  camera.jump();
  assert.equal(camera.pose.elevation, 85);
  const figurine = new OrbitCamera();
  figurine.setCharacter({ min: [-0.025, 0, -0.015], max: [0.025, 0.09, 0.015], groundY: 0, sequences: [] });
  figurine.setFollow('position');
  figurine.rotate(0, -500);
  figurine.jump();
  assert.ok(figurine.pose.elevation < -5, 'a figurine is seen from near the ground, too');
  figurine.follow({ x: 0.5, z: 0, heading: 0 });
  figurine.update(1 / 60);
  assert.ok(Math.abs(figurine.pose.target[0] - 0.5) < 1e-9, 'half a metre is far for a figurine: the camera jumps');
  const angles = [1 / 30, 1 / 120].map((dt) => {
    camera.reset();
    camera.jump();
    camera.rotate(90, 0);
    for (let t = 0; t < 0.1 - 1e-9; t += dt) camera.update(dt);
    return camera.pose.azimuth;
  });
  assert.ok(Math.abs(angles[0] - angles[1]) < 0.5 && angles[0] > 45, `${angles}`);
});

test('the second part gets the exports of the first; one that is missing is one clear error', async () => {
  const outfile = join(folder, 'wasm-module.mjs'), player = join(folder, 'player.mjs');
  writeFileSync(player, `export default (options) => new Promise((done) => {
    options.instantiateWasm({}, (instance) => done({ instance }));
  });`);
  buildSync({
    entryPoints: [fileURLToPath(new URL('../../web/src/player/wasm-module.ts', import.meta.url))], outfile, bundle: true,
    format: 'esm', logLevel: 'silent', alias: { 'fourdvt-wasm': player }, define: { FOURDVT_STAMP: '"1234abcd"', FOURDVT_VERSION: '"?v=5"' },
  });
  const { instantiate, loadMore, hasMore } = await import(pathToFileURL(outfile).href);
  // first: (func (export "f") call placeholder.0); second: imports f.
  const kFirst = Uint8Array.from([0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 2, 17, 1, 11, ...Buffer.from('placeholder'), 1, 48, 0, 0, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 1, 10, 6, 1, 4, 0, 16, 0, 11]);
  const kSecond = Uint8Array.from([0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 2, 11, 1, 5, ...Buffer.from('first'), 1, 102, 0, 0]);
  const fetched = [], realFetch = globalThis.fetch;
  let cached = '1234abce', served = '00000000', status = 200; // of the script
  globalThis.fetch = async (address, { cache }) => {
    fetched.push([address, cache]);
    if (address.includes('more.js')) return new Response('export const one = 1;', { status });
    const stamped = stampWasm(address.includes('more') ? kSecond : kFirst, cache === 'reload' ? served : cached);
    return new Response(stamped, { headers: { 'Content-Type': 'text/plain' } });
  };
  try {
    const filesAt = (base) => ({ wasm: `${base}fourdvt-viewer.wasm`, more: `${base}fourdvt-more.js?v=5`, moreWasm: `${base}fourdvt-more.wasm?v=5` });
    const files = filesAt(`${pathToFileURL(folder).href}/`), url = files.wasm;
    const twice = [[url, 'default'], [url, 'reload']];
    await assert.rejects(instantiate(files, () => undefined), { id: 'wasm-refused', message: /another build.*reload the page, or upload/ });
    assert.deepEqual(fetched.splice(0), twice, 'one of another build is fetched again past the cache, once');
    served = '1234abcd';
    const module = await instantiate(files, () => undefined);
    assert.deepEqual(fetched.splice(0), twice);
    await instantiate(files, () => undefined);
    assert.deepEqual(fetched, [], 'compiled once per page');
    assert.throws(() => module.instance.exports.f(), /second part/);
    await assert.rejects(loadMore(module, files, () => undefined), { id: 'fetch-failed', message: /fourdvt-more\.js\?v=5: .*does not run.*text\/javascript.*script-src/ });
    assert.deepEqual(fetched.filter(([address]) => address === files.more), [[files.more, 'reload']], 'a fetch finds out why the script does not load');
    status = 404;
    await assert.rejects(loadMore(module, files, () => undefined), { id: 'fetch-failed', message: /fourdvt-more\.js\?v=5: HTTP 404: .*beside/ });
    status = 200;
    assert.equal(hasMore(module), false);
    writeFileSync(join(folder, 'fourdvt-more.js'), 'export const readLook = 1;');
    const tryAgain = filesAt(`${pathToFileURL(folder).href}/./`); // another address of the same file
    const { readLook } = await loadMore(await instantiate(tryAgain, () => undefined), tryAgain, () => undefined);
    assert.equal(readLook, 1);
    assert.ok(fetched.some(([address]) => address === files.moreWasm || address === tryAgain.moreWasm));
  } finally {
    globalThis.fetch = realFetch;
  }
});

// A character as Commands uses it: lists calls of its player, which refuses `none`.
function makeInstance(state = {}) {
  const calls = [];
  const list = {
    get: (target, name) => target[name] ?? ((...values) => {
      if (values[0] === 'none') throw new Error('refused');
      calls.push([name, ...values]);
    }),
  };
  const player = new Proxy({ set: new Proxy({}, list) }, list);
  return {
    calls, character: { sequences: [{ name: 'walk' }, { name: 'run' }] },
    state: () => ({
      hasFrame: true, seeking: false, sequence: 1, frame: 7, goal: 'run', x: 1, z: 2, heading: 30, ...state,
    }),
    parameter: () => 1.5,
    run(action) {
      try { action(player); } catch { return false; }
      return true;
    },
  };
}

test('commands: settings apply once the character is there; a new one gets those that differ from its own', async () => {
  const { Commands } = await load('player/commands');
  const commands = new Commands();
  commands.begin({ sequence: 'walk', loop: 1 });
  commands.set('playing', true);
  commands.set('travel', true);
  commands.set('travel', false);
  commands.setParameter('speed_mps', 2, false);
  commands.steer(90);
  commands.seek(1);
  assert.deepEqual(commands.placement, { x: 0, z: 0, heading: 90 });
  assert.equal(commands.parameter('speed_mps'), 2);
  const instance = makeInstance();
  commands.attach(instance);
  assert.deepEqual(instance.calls.splice(0), [
    ['setParameter', 'speed_mps', 2, true], ['loop', 1], ['placement', { x: 0, z: 0, heading: 90 }],
    ['sequence', 'walk'], ['time', 1], ['playing', true]]);
  commands.setParameter('speed_mps', 3, false);
  commands.set('playing', false);
  commands.setParameter('speed_mps', 4, false);
  commands.steer(10);
  commands.seek(1);
  commands.goTo('run');
  assert.deepEqual(instance.calls.splice(0), [
    ['setParameter', 'speed_mps', 3, false], ['playing', false], ['setParameter', 'speed_mps', 4, true], ['steer', 10],
    ['time', 1], ['goTo', 'run']]);
  assert.equal(commands.parameter('speed_mps'), 1.5);
});

test('commands: the next instance begins where the last one was, another source as set', async () => {
  const { Commands } = await load('player/commands');
  const commands = new Commands();
  const here = { x: 5, z: 0, heading: 0 };
  commands.begin({ sequence: 'walk', placement: here });
  const next = (state, between = () => undefined) => {
    const [first, second] = [makeInstance(state), makeInstance()];
    commands.attach(first);
    commands.detach(first);
    between();
    commands.attach(second);
    return second.calls;
  };
  const there = ['placement', { x: 1, z: 2, heading: 30 }];
  assert.deepEqual(next({}), [there, ['sequence', 'run'], ['frame', 7]]);
  commands.begin();
  assert.deepEqual(next({ goal: 'walk' }), [there, ['sequence', 'walk']], 'the goal of a transition');
  commands.begin();
  assert.deepEqual(next({ seeking: true }), [there, ['sequence', 'walk']], 'while seeking, what is sought');
  commands.begin();
  assert.deepEqual(next({ hasFrame: false }), [['placement', here], ['sequence', 'walk']]);
  commands.begin();
  assert.deepEqual(next({}, () => commands.set('frame', 3)), [there, ['sequence', 'run'], ['frame', 3]],
    'a command counts more than the place that was left');
  commands.begin();
  assert.deepEqual(next({}, () => commands.begin()), [['placement', here], ['sequence', 'walk']]);
});

test('commands: what the character refuses is not remembered', async () => {
  const { Commands } = await load('player/commands');
  const commands = new Commands();
  commands.begin({ sequence: 'walk' });
  commands.attach(makeInstance());
  assert.equal(commands.set('align', 'none'), false);
  commands.select('none');
  assert.equal(commands.settings.align, 'baked');
  assert.equal(commands.settings.sequence, 'walk');
});

test('frame loop: goes on while something moves, sleeps after, stands still off-screen', async () => {
  const { FrameLoop } = await load('page/frame-loop');
  let waiting = null, busy = true;
  globalThis.requestAnimationFrame = (callback) => { waiting = callback; return 1; };
  globalThis.cancelAnimationFrame = () => { waiting = null; };
  const turns = [];
  const loop = new FrameLoop((clock, step) => { turns.push([clock, step]); return busy; });
  const frame = (ms) => {
    const callback = waiting;
    waiting = null;
    callback?.(ms);
    return callback !== null;
  };
  loop.wake();
  for (const ms of [1000, 1100, 3000]) frame(ms);
  assert.deepEqual(turns.map((turn) => turn.map((s) => Number(s.toFixed(3)))), [[0, 0], [0.1, 0.1], [0.6, 0.5]]);
  busy = false;
  let idle = 0;
  while (frame(3000 + 10 * idle)) ++idle;
  assert.equal(idle, 12);
  loop.setActive(false);
  loop.wake();
  assert.equal(frame(9000), false);
  loop.setActive(true);
  loop.wake();
  assert.ok(frame(9100));
  assert.equal(turns.at(-1)[1], 0, 'the time off-screen is not caught up');
});

test('steps are due once each, whatever the clock does', async () => {
  const { StepSchedule } = await load('sound/step-schedule');
  const heard = [], schedule = new StepSchedule([0.25, 0.75]);
  // 1.25 passes a second for 4 s, turns of 16 ms with a clock that jitters, falls back and repeats itself.
  for (let i = 0; i < 250; ++i) {
    const t = i * 0.016, now = t + [0, 0.004, -0.006, 1e-9, 0][i % 5] - (i === 120 ? 0.05 : 0);
    heard.push(...schedule.due((1.25 * t) % 1, now, 0.25, true));
  }
  const expected = Array.from({ length: 11 }, (_, i) => (0.25 + 0.5 * i) / 1.25).filter((s) => s > 0.15);
  assert.ok(heard.length >= expected.length - 1 && heard.length <= expected.length, `${heard}`);
  for (const s of heard) assert.ok(expected.some((e) => Math.abs(e - s) < 0.03), `${s} is no step`);
  const burst = new StepSchedule([0.5]);
  burst.due(0.1, 1, 0.25, true);
  assert.deepEqual(burst.due(0.12, 1 + 1e-8, 0.25, true), [], 'no speed follows from an instant');
  assert.deepEqual(burst.due(0.13, 0.5, 0.25, true), [], 'another clock');
  const once = new StepSchedule([0.5]), times = [];
  for (let i = 0; i < 200; ++i) times.push(...once.due(Math.min(1, i * 0.01), i * 0.02, 0.25, false));
  assert.equal(times.length, 1);
});

test('sound: the priming that a decoder left in is known, playable encodings go first, wrong manifests are refused', async () => {
  const { primingIn, playable } = await load('sound/sound-buffers');
  const segment = { offset: 0, bytes: 1, durationS: 1 };
  assert.equal(primingIn(1.0001, segment, 0.02), 0);
  assert.equal(primingIn(1.02, segment, 0.02), 0.02);
  const all = [{ type: 'a' }, { type: 'b' }, { type: 'c' }], answers = { a: '', b: 'maybe', c: 'probably' };
  assert.deepEqual(playable(all, (type) => answers[type]).map(({ type }) => type), ['c', 'b']);
  assert.equal(playable(all, () => '').length, 3);
  const { readSound } = await load('sound/sound-manifest');
  const manifest = (change) => {
    const encodings = [{ uri: 'a', type: 'x', priming: 0, segments: [[3, 48], [4, 48]] }];
    return { extensions: { FOURDVT_layered_video_texture: { sequences: [{ name: 'walk', sound: { sampleRate: 48000, segmentDuration: 1, encodings, ...change } }] } } };
  };
  assert.deepEqual(readSound(manifest(), 'walk').encodings[0].segments.map(({ offset }) => offset), [0, 3]);
  assert.equal(readSound(manifest(), 'run'), null);
  for (const wrong of [{ encodings: [] }, { sampleRate: 1 }, { segmentDuration: 0.1 }, { steps: [2] }, { encodings: [{ uri: 'a', type: 'x', priming: 0, segments: [] }] },
    { encodings: [{ uri: 'a', type: 'x', priming: 0, segments: [[1, 1]] }, { uri: 'a', type: 'x', priming: 0, segments: [[1, 1], [1, 1]] }] }]) {
    assert.throws(() => readSound(manifest(wrong), 'walk'), TypeError, JSON.stringify(wrong));
  }
});
