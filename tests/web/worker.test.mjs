// SPDX-License-Identifier: Apache-2.0
// The worker that decodes geometry: one for all viewers of a page, exact frames, characters dropped when they leave. Pages
// where it cannot start, fails, stops answering or sends wrong data play on without it, with one warning.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage } from './harness.mjs';
import { serve } from './server.mjs';

// The stamp of the build under test: section fourdvt of the worker's module.
const [kSection] = WebAssembly.Module.customSections(new WebAssembly.Module(readFileSync(join(environment('SITE'), 'fourdvt-viewer/fourdvt-worker.wasm'))), 'fourdvt');
const kReady = `postMessage({ kind: 'ready', stamp: '${Buffer.from(kSection)}' })`;
const kPolicy = "default-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' data:";

let server, other, browser;
let misbehave = () => ({});
before(async () => {
  const site = environment('SITE');
  const html = '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><style>fourdvt-viewer { width: 160px; height: 220px; }</style><main></main>';
  const page = (headers = {}) => ({ html, headers });
  server = await serve(site, 0, { pages: {
    '/blank.html': page(),
    '/self.html': page({ 'Content-Security-Policy': kPolicy }),
    // The header is sent with the page alone, not with the worker's script.
    '/isolated.html': page({ 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' }),
    '/trusted.html': page({ 'Content-Security-Policy': `${kPolicy}; require-trusted-types-for 'script'; trusted-types fourdvt` }),
    '/untrusted.html': page({ 'Content-Security-Policy': `${kPolicy}; require-trusted-types-for 'script'; trusted-types 'none'` }),
    '/none.html': page({ 'Content-Security-Policy': `${kPolicy}; worker-src 'none'` }),
  }, misbehave: (request) => misbehave(request) });
  other = await serve(site, 0, { headers: { 'Access-Control-Allow-Origin': '*' } });
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
  await other?.close();
});

// A page with so many viewers that can play, paused; `posted` has the kinds of messages to workers, `warnings` the viewer's.
// script: in place of fourdvt-worker.js; missing: its wasm.
async function open({ page: name = 'blank.html', viewers = 1, scripts = server.url, script, missing = false } = {}) {
  const page = await openPage(browser);
  page.warnings = [];
  page.on('console', (line) => { if (line.type() === 'warning' && line.text().startsWith('fourdvt-viewer')) page.warnings.push(line.text()); });
  await page.addInitScript(() => {
    globalThis.posted = [];
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...rest) {
      globalThis.posted.push(message);
      return post.call(this, message, ...rest);
    };
  });
  if (script) await page.route('**/fourdvt-worker.js*', (route) => route.fulfill({ contentType: 'text/javascript', body: script }));
  misbehave = missing ? ({ url }) => (url.includes('fourdvt-worker.wasm') ? { status: 404 } : {}) : () => ({});
  await page.goto(server.url + name);
  await page.evaluate(async ({ viewers, scripts }) => {
    await import(`${scripts}fourdvt-viewer/fourdvt-viewer.js`);
    globalThis.viewers = await Promise.all(Array.from({ length: viewers }, async () => {
      const viewer = document.createElement('fourdvt-viewer');
      viewer.setAttribute('src', '/character/character.gltf');
      viewer.setAttribute('sequence', 'walk');
      const end = new Promise((done, fail) => {
        viewer.addEventListener('canplay', done, { once: true });
        viewer.addEventListener('error', ({ detail }) => fail(new Error(JSON.stringify(detail))));
      });
      document.querySelector('main').append(viewer);
      await end;
      return viewer;
    }));
  }, { viewers, scripts });
  return page;
}

// The page's answer once it is true.
const until = (page, check, argument) =>
  page.waitForFunction(check, argument, { timeout: kPatienceMs }).then((handle) => handle.jsonValue());
const workerStarts = (page) => until(page, () => globalThis.posted.some(({ kind }) => kind === 'mesh'));

// Seeks a frame of another motion, whose geometry nobody has decoded yet: { frame, workerFrames }.
function seekFresh(page, sequence = 'pickup', frame = 37) {
  return page.evaluate(async ({ sequence, frame, patienceMs }) => {
    const [viewer] = globalThis.viewers;
    const seeked = () => new Promise((done, fail) => {
      viewer.addEventListener('seeked', done, { once: true });
      setTimeout(() => fail(new Error('no seeked')), patienceMs);
    });
    viewer.sequence = sequence;
    const end = seeked();
    viewer.seekFrame(frame);
    await end;
    if (viewer.frame !== frame || viewer.sequence !== sequence) throw new Error(`${viewer.sequence} ${viewer.frame}`);
    return viewer.stats.workerFrames;
  }, { sequence, frame, patienceMs: kPatienceMs });
}

const warned = async (page, pattern) => {
  for (const end = Date.now() + kPatienceMs; !page.warnings.length && Date.now() < end;) await new Promise((next) => setTimeout(next, 50));
  assert.equal(page.warnings.length, 1, page.warnings.join('\n'));
  assert.match(page.warnings[0], pattern);
};

async function close(page, troubles = []) {
  assert.equal(page.troubles.length, troubles.length, page.troubles.join('\n'));
  page.troubles.forEach((text, i) => assert.match(text, troubles[i]));
  await page.close();
}

test('one worker decodes for all viewers, and forgets those that have gone', async () => {
  const page = await open({ page: 'self.html', viewers: 3 });
  await until(page, () => globalThis.posted.filter(({ kind }) => kind === 'mesh').length === 3);
  assert.equal(page.workers().length, 1);
  const frames = await seekFresh(page);
  assert.ok(frames > 15, `${frames} of the worker`); // GOPs of 20 frames
  const sizes = await page.evaluate(() => globalThis.posted.filter(({ kind }) => kind === 'wanted').map(({ jobs }) => jobs.length));
  assert.ok(sizes.length && Math.max(...sizes) <= 4, sizes.join());
  await page.evaluate(() => globalThis.viewers.forEach((viewer) => viewer.remove()));
  const left = await until(page, () => {
    const numbers = globalThis.posted.filter(({ kind }) => kind === 'leave').map(({ character }) => character);
    return numbers.length === 3 && numbers.sort();
  });
  assert.deepEqual(left, [1, 2, 3]);
  assert.deepEqual(page.warnings, []);
  await close(page);
});

test('scripts from another origin bring the worker, too', async () => {
  const page = await open({ scripts: other.url });
  await workerStarts(page);
  assert.ok(await seekFresh(page) > 15);
  assert.equal(page.workers().length, 1);
  await close(page);
});

test('a cross-origin isolated page has the worker, also with scripts from another origin', async () => {
  for (const scripts of [server.url, other.url]) {
    const page = await open({ page: 'isolated.html', scripts });
    assert.equal(await page.evaluate(() => globalThis.crossOriginIsolated), true);
    await workerStarts(page);
    assert.equal(page.workers().length, 1);
    assert.deepEqual(page.warnings, []);
    await close(page);
  }
});

test('a page that requires trusted types has the worker if it allows the policy fourdvt; else one warning, and the page decodes', async () => {
  const allowed = await open({ page: 'trusted.html' });
  await workerStarts(allowed);
  assert.deepEqual(allowed.warnings, []);
  await close(allowed);
  const page = await open({ page: 'untrusted.html' });
  await warned(page, /without a worker \(.*TrustedScriptURL/);
  assert.equal(await seekFresh(page), 0);
  await close(page, [/TrustedTypePolicy named 'fourdvt'/, /TrustedScriptURL/]);
});

test('a policy that forbids workers: one warning, and the page decodes', async () => {
  const page = await open({ page: 'none.html' });
  await warned(page, /geometry is decoded without a worker \(the page's policy forbids it: allow .* in worker-src\)/);
  assert.equal(await seekFresh(page), 0);
  await close(page, [/worker/i]);
});

test('a worker whose wasm is missing: one warning, and the page decodes', async () => {
  const page = await open({ missing: true });
  await warned(page, /without a worker \(.*fourdvt-worker\.wasm.*: 404\)/);
  assert.equal(await seekFresh(page), 0);
  await close(page);
});

test('a worker script that throws: one warning, and the page decodes', async () => {
  const page = await open({ script: "throw new Error('broken')" });
  await warned(page, /without a worker \(.*broken/);
  assert.equal(await seekFresh(page), 0);
  await close(page);
});

test('a worker script of another build: one warning, and the page decodes', async () => {
  const page = await open({ script: "onmessage = ({ data }) => { if (data.kind === 'start') postMessage({ kind: 'ready', stamp: 'an earlier one' }); }" });
  await warned(page, /another build: upload all files/);
  assert.equal(await seekFresh(page), 0);
  await close(page);
});

test('a silent worker is left after two seconds, and the seek ends', async () => {
  const page = await open({ script: `onmessage = ({ data }) => { if (data.kind === 'start') ${kReady}; }` });
  await workerStarts(page);
  assert.equal(await seekFresh(page), 0);
  await warned(page, /silent for 2 s/);
  assert.equal(await seekFresh(page, 'run', 9), 0);
  await close(page);
});

test('frames of another size, of unknown jobs and out of order are not shown', async () => {
  const page = await open({ script: `onmessage = ({ data: { kind, character, jobs } }) => {
    if (kind === 'start') ${kReady};
    for (const { id } of jobs ?? []) {
      const frame = (job, frame, bytes) => postMessage({ kind: 'frame', character, job, frame, data: new ArrayBuffer(bytes), seconds: 0 });
      frame(id + 1000, 0, 8);
      frame(id, 5, 8);
      frame(id, 0, 8);
      frame(id, 1, 8);
    }
  };` });
  await workerStarts(page);
  assert.equal(await seekFresh(page), 0);
  assert.equal(await seekFresh(page, 'run', 9), 0);
  assert.deepEqual(page.warnings, []);
  await close(page);
});
