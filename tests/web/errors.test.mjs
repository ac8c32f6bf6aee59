// SPDX-License-Identifier: Apache-2.0
// Damaged characters in the player: one error event with an ID each, and the same element then shows a good character.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { rehash } from './content_hash.mjs';
import { environment, kPatienceMs, launch, openPage, readCanvas } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage } from './ssim.mjs';

const kExtension = 'FOURDVT_layered_video_texture';
const kPage = `<!doctype html><title>errors</title><link rel="icon" href="data:,"><link rel="stylesheet" href="page.css">
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script><fourdvt-viewer></fourdvt-viewer>`;

/** @param damage (folder, manifest, extension) edits files; a changed manifest is written back. */
function damaged(name, ids, damage) {
  return { name, ids, damage };
}
// Damages files and recomputes the content hashes to match.
const forged = (name, ids, damage) => damaged(`${name}, and the hashes agree`, ids, (folder, gltf, extension) => {
  damage(folder, gltf, extension);
  rehash(folder, extension);
});
const manifestCase = (name, ids, change) => damaged(name, ids, (folder, gltf, extension) => { change(extension, gltf); });
const patch = (folder, uri, change) => {
  const file = join(folder, uri);
  writeFileSync(file, change(readFileSync(file)));
};
// Deterministic noise, so that a failure can be repeated.
function noise(bytes, from = 0, to = bytes.length) {
  let state = 0x2545f491;
  for (let i = from; i < to; ++i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    bytes[i] = state >>> 24;
  }
  return bytes;
}

const kCases = [
  damaged('manifest is missing', ['fetch-failed'], (folder) => rmSync(join(folder, 'character.gltf'))),
  damaged('manifest is cut off', ['manifest-invalid'], (folder) => {
    patch(folder, 'character.gltf', (b) => b.subarray(0, b.length / 2));
  }),
  damaged('manifest is not JSON', ['manifest-invalid'], (folder) => writeFileSync(join(folder, 'character.gltf'), '<html>')),
  manifestCase('manifest without our extension', ['manifest-invalid'], (_, gltf) => { delete gltf.extensions[kExtension]; }),
  manifestCase('manifest of a newer version', ['unsupported'], (e) => { e.version = 99; }),
  manifestCase('manifest with a text as a count', ['manifest-invalid'], (e) => { e.vertexCount = 'many'; }),
  manifestCase('manifest with an absurd count', ['manifest-invalid'], (e) => { e.sequences[0].frameCount = 1e15; }),
  manifestCase('manifest that leads out of the folder', ['manifest-invalid'], (e) => { e.sequences[0].stream.uri = '../../secret.bin'; }),
  manifestCase('manifest with another mesh\'s counts', ['mesh-data-invalid', 'stream-invalid'], (e) => { e.vertexCount -= 1; }),
  damaged('stream is missing', ['fetch-failed'], (folder, _, e) => rmSync(join(folder, e.sequences[0].stream.uri))),
  ...[damaged, forged].map((kind) => kind('stream has another magic number', [kind === forged ? 'stream-invalid' : 'files-differ'], (folder, _, e) => {
    patch(folder, e.sequences[0].stream.uri, (b) => noise(b, 0, 4));
    delete e.start; // which has the header, too
  })),
  damaged('stream is cut off', ['fetch-failed'], (folder, _, e) => {
    patch(folder, e.sequences[0].stream.uri, (b) => b.subarray(0, b.length / 3));
  }),
  damaged('stream is cut off in its header', ['fetch-failed'], (folder, _, e) => {
    patch(folder, e.sequences[0].stream.uri, (b) => b.subarray(0, 20));
  }),
  ...[damaged, forged].map((kind) => kind('stream chunks are noise', [kind === forged ? 'stream-invalid' : 'files-differ'], (folder, _, e) => {
    patch(folder, e.sequences[0].stream.uri, (b) => noise(b, e.sequences[0].stream.headerLength));
  })),
  ...[damaged, forged].map((kind) => kind('base mesh is noise', [kind === forged ? 'mesh-data-invalid' : 'files-differ'], (folder, _, e) => {
    patch(folder, e.mesh.uri, (b) => noise(b, e.mesh.byteOffset, e.mesh.byteOffset + e.mesh.byteLength));
    delete e.start; // which has the mesh, too
  })),
  damaged('every video is missing', ['fetch-failed'], (folder, _, e) => {
    for (const { uri } of e.sequences[0].renditions) rmSync(join(folder, uri));
  }),
  damaged('every video is cut off', ['fetch-failed'], (folder, _, e) => {
    for (const { uri } of e.sequences[0].renditions) patch(folder, uri, (b) => b.subarray(0, b.length / 4));
  }),
  ...[damaged, forged].map((kind) => kind('video samples are noise', [kind === forged ? 'video-invalid' : 'files-differ'], (folder, _, e) => {
    for (const { uri } of e.sequences[0].renditions) patch(folder, uri, (b) => noise(b));
  })),
  manifestCase('video of an unknown codec', ['decoder-unsupported'], (e) => { for (const rendition of e.sequences[0].renditions) rendition.codec = 'xyz9.1'; }),
];

let folder, server, browser, page;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-errors-'));
  cpSync(environment('SITE'), folder, { recursive: true });
  kCases.forEach((entry, index) => makeCase(entry, `case${index}`));
  makeCase({ damage: (target, _, e) => {
    patch(target, e.sequences[1].stream.uri, (b) => noise(b, e.sequences[1].stream.headerLength));
  } }, 'one-motion');
  makeCase({ damage: (target, _, e) => rmSync(join(target, e.sequences[0].renditions.at(-1).uri)) }, 'one-rendition');
  writeFileSync(join(folder, 'errors.html'), kPage);
  writeFileSync(join(folder, 'page.css'), 'fourdvt-viewer { width: 300px; height: 400px; }');
  server = await serve(folder);
  browser = await launch();
  page = await openPage(browser, { viewport: { width: 320, height: 420 } });
  await page.goto(`${server.url}errors.html`);
});
after(async () => {
  await browser?.close();
  await server?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

function makeCase({ damage }, name) {
  const target = join(folder, name);
  cpSync(join(folder, 'character'), target, { recursive: true });
  const manifest = join(target, 'character.gltf');
  const gltf = JSON.parse(readFileSync(manifest, 'utf8'));
  const before = JSON.stringify(gltf);
  damage(target, gltf, gltf.extensions[kExtension]);
  if (JSON.stringify(gltf) !== before) writeFileSync(manifest, JSON.stringify(gltf));
}

// Sets src; returns the first event of `ends`, and the number of error events until shortly after it.
const load = (src, ends = ['canplay', 'error']) => page.evaluate(async ({ src, ends, patience }) => {
  const viewer = document.querySelector('fourdvt-viewer');
  let errors = 0;
  const first = await new Promise((done) => {
    const timer = setTimeout(() => done({ type: 'nothing' }), patience);
    const finish = (event) => { clearTimeout(timer); done({ type: event.type, detail: event.detail ?? null }); };
    viewer.addEventListener('error', (event) => { ++errors; finish(event); });
    if (ends.includes('canplay')) viewer.addEventListener('canplay', finish, { once: true });
    viewer.src = src;
    viewer.play();
  });
  await new Promise((next) => setTimeout(next, 300));
  return { ...first, errors };
}, { src, ends, patience: kPatienceMs });

kCases.forEach(({ name, ids }, index) => {
  test(name, async () => {
    const { type, detail, errors } = await load(`case${index}/character.gltf`, ['error']); // damage behind the beginning may be met after canplay
    assert.equal(type, 'error');
    console.log(`${name}: ${detail.id}: ${detail.message} (${errors})`);
    assert.ok(ids.includes(detail.id), `expected ${ids.join(' or ')}, got ${detail.id}: ${detail.message}`);
    assert.ok(detail.message.length > 20 && !detail.message.includes('\n'), `one clear line: ${detail.message}`);
  });
});

test('one damaged motion does not take the others along', async () => {
  assert.equal((await load('one-motion/character.gltf')).type, 'canplay');
  const outcome = await page.evaluate(async (patience) => {
    const viewer = document.querySelector('fourdvt-viewer');
    const [good, bad] = viewer.sequences.map((s) => s.name);
    const detail = await new Promise((done) => {
      const timer = setTimeout(() => done({ id: 'no error event' }), patience);
      viewer.addEventListener('error', (event) => { clearTimeout(timer); done(event.detail); }, { once: true });
      viewer.sequence = bad;
    });
    viewer.sequence = good;
    viewer.play();
    const frames = new Set();
    const end = performance.now() + patience;
    while (frames.size < 4 && performance.now() < end) {
      if (viewer.sequence === good) frames.add(viewer.frame);
      await new Promise((next) => setTimeout(next, 20));
    }
    return { detail, frames: frames.size };
  }, kPatienceMs);
  assert.equal(outcome.detail.id, 'files-differ', JSON.stringify(outcome.detail));
  assert.ok(outcome.frames >= 4, 'the undamaged motion plays on');
});

test('a rendition whose file is missing is left out, and the console names it', async () => {
  const warnings = [];
  const note = (message) => message.type() === 'warning' && warnings.push(message.text());
  page.on('console', note);
  const { type, errors } = await load('one-rendition/character.gltf');
  assert.equal(type, 'canplay');
  const end = Date.now() + kPatienceMs;
  while (!warnings.length && Date.now() < end) await page.waitForTimeout(50);
  page.off('console', note);
  assert.match(warnings.join(), /fetch-failed: .*walk\.([0-9a-f]{8}\.)?mp4/);
  const later = await page.evaluate(async () => {
    const viewer = document.querySelector('fourdvt-viewer'), frames = new Set();
    for (let i = 0; i < 40; ++i) {
      frames.add(viewer.frame);
      await new Promise((next) => setTimeout(next, 50));
    }
    return frames.size;
  });
  assert.ok(later >= 4, 'it plays on');
  assert.equal(errors, 0);
});

test('the same element still shows a good character', async () => {
  const { type, detail } = await load('character/character.gltf');
  assert.equal(type, 'canplay', JSON.stringify(detail));
  await page.waitForTimeout(500);
  assert.ok(coverage(await readCanvas(page)) > 0.02);
  const uncaught = page.troubles.filter((line) => !line.startsWith('console: Failed to load resource'));
  assert.deepEqual(uncaught, []);
});
