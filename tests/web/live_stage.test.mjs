// SPDX-License-Identifier: Apache-2.0
// A live stage end to end: the sample's videos as cameras, `fourdvt live`, the viewer in a page. Behaviour when the
// server goes away and comes back, when it plays another stage, and without the required token.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { environment, kPatienceMs, launch, openPage, outputFolder, readCanvas, writePicture } from './harness.mjs';
import { coverage } from './ssim.mjs';

const kSample = fileURLToPath(new URL('../../site/sample/actor_a', import.meta.url));
const kCameras = ['cam00', 'cam02', 'cam04', 'cam05', 'cam07']; // no two face each other

let folder, browser;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-live-'));
  for (const name of ['cameras', 'background', 'run']) symlinkSync(join(kSample, name), join(folder, name));
  const rig = JSON.parse(readFileSync(join(kSample, 'live.json'), 'utf8'));
  const sources = Object.fromEntries(kCameras.map((name) => [name, rig.sources[name]]));
  writeFileSync(join(folder, 'RIG.json'), JSON.stringify({ ...rig, fps: 10, reduce: 4, sources })); // a busy machine keeps up
  browser = await launch();
});
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

// A server that listens; { url, port, stop }.
async function startServer(port = 0, more = []) {
  const process = spawn(environment('BIN'), ['live', join(folder, 'RIG.json'), '--port', String(port), '--web', environment('SITE'), ...more], { stdio: ['ignore', 'pipe', 'pipe'] });
  let text = '';
  const listening = new Promise((done, fail) => {
    const read = (part) => {
      text += part;
      const found = text.match(/https?:\/\/[^\s:]+:(\d+)/);
      if (found) done(Number(found[1]));
    };
    process.stdout.on('data', read);
    process.stderr.on('data', read);
    process.on('exit', (code) => fail(new Error(`fourdvt live ended with ${code}: ${text}`)));
  });
  const ended = new Promise((done) => process.on('exit', done));
  const at = await listening;
  return { port: at, url: `http://localhost:${at}`, text: () => text, stop: async (signal = 'SIGINT') => (process.kill(signal), ended) };
}

const liveState = (page, state) => page.waitForFunction((wanted) => document.querySelector('fourdvt-viewer').liveState === wanted, state, { timeout: kPatienceMs, polling: 100 });
const framesShown = (page) => page.evaluate(() => document.querySelector('fourdvt-viewer').stats?.framesShown ?? 0);
async function advances(page, frames = 10) {
  const from = await framesShown(page);
  await page.waitForFunction((to) => document.querySelector('fourdvt-viewer').stats?.framesShown >= to, from + frames, { timeout: kPatienceMs, polling: 100 });
}

// Requires that so many pictures were checked at least, and that each was of its surface's frame.
async function paired(page, pictures) {
  const { barcodeChecked, barcodeMismatches } = await page.evaluate(() => ({ ...document.querySelector('fourdvt-viewer').stats }));
  assert.ok(barcodeChecked >= pictures, `${barcodeChecked} pictures were checked`);
  assert.equal(barcodeMismatches, 0);
}

test('the console shows the performer, comes back after the server, and pairs every picture with its surface', async () => {
  let server = await startServer();
  const page = await openPage(browser);
  try {
    await page.goto(`${server.url}/live/`);
    await liveState(page, 'live');
    await advances(page, 20);
    const shown = await readCanvas(page);
    writePicture(join(outputFolder('live'), 'performer.png'), shown);
    assert.ok(coverage(shown) > 0.02, `the performer covers ${coverage(shown)} of the picture`);
    await page.waitForFunction((count) => document.querySelectorAll('.live-cameras li:not(.away)').length === count, kCameras.length, { timeout: kPatienceMs });
    await page.screenshot({ path: join(outputFolder('live'), 'console.png'), fullPage: true });
    await paired(page, 20);
    await server.stop('SIGKILL');
    await liveState(page, 'stalled');
    server = await startServer(server.port);
    await liveState(page, 'live');
    await advances(page);
    await paired(page, 10); // counted anew: another session is another character
    assert.equal(await page.evaluate(() => document.getElementById('notice').hidden), true);
  } finally {
    await page.close();
    assert.equal(await server.stop(), 0, 'Ctrl-C ends it');
  }
});

test('a page without the word gets no frame, and says why', async () => {
  const tokens = join(folder, 'tokens');
  const server = await startServer(0, ['--tokens', tokens]);
  const page = await openPage(browser);
  try {
    const word = readFileSync(tokens, 'utf8').match(/^console\s+(\S+)/m)[1];
    await page.goto(`${server.url}/live/`);
    await page.waitForFunction(() => !document.getElementById('notice').hidden, null, { timeout: kPatienceMs });
    assert.match(await page.evaluate(() => document.getElementById('notice').textContent), /token/);
    assert.equal(await framesShown(page), 0);
    await page.goto('about:blank');
    await page.goto(`${server.url}/live/#token=${word}`);
    await liveState(page, 'live');
    await advances(page, 5);
  } finally {
    await page.close();
    await server.stop();
  }
});
