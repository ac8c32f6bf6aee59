// SPDX-License-Identifier: Apache-2.0
// Fuzzes the resolution of a character's file names: whatever a manifest calls its files, the page fetches nothing outside of the
// manifest's folder. Prints its seed, another one every run; FOURDVT_FUZZ_SEED=N repeats a run. Executed from source.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { requireFromWeb } from './harness.mjs';

const kNames = 20_000;
const kBases = ['https://site.example/people/anna/character.gltf', 'https://site.example/character.gltf', 'https://site.example/a%2fb/../c/character.gltf?v=1#x',
  'http://localhost:8080/deep/er/character.gltf'];
// Two dots stay in these as Node 20 resolves them.
const kUnresolved = ['a/.b/..', 'a//.b/../c', 'walk//.bin/../..'];
const kPieces = ['..', '.', '/', '//', '\\', '%2e', '%2E%2e', '%2f', '%5c', '%00', '\0', '\t', '\n', ' ', ':', '@', '?', '#', ';', '&', '=', 'a', 'walk', '.bin', 'https:', 'http://', 'file:///',
  'javascript:', 'data:,', 'blob:', 'other.example', 'site.example', 'people', 'anna', '[::1]', '%', '\u2025', '\uff0e', '\uff0f', '\u3002', '\ud800', '\ufeff', '~', '*', '|'];

// xorshift32
const randomOf = (seed) => {
  let x = seed >>> 0 || 1;
  return (n) => {
    x ^= x << 13; x >>>= 0; x ^= x >>> 17; x ^= x << 5; x >>>= 0;
    return x % n;
  };
};

let folder, Transport;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-addresses-'));
  writeFileSync(join(folder, 'package.json'), '{"type": "module"}');
  const outfile = join(folder, 'transport.mjs');
  requireFromWeb('esbuild').buildSync({ entryPoints: [fileURLToPath(new URL('../../web/src/net/transport.ts', import.meta.url))], outfile, bundle: true, format: 'esm', logLevel: 'silent' });
  ({ Transport } = await import(pathToFileURL(outfile).href));
});
after(() => rmSync(folder, { recursive: true, force: true }));

/** Paths that a server may read in an address: unescaped up to three times, with slashes for backslashes. */
function readings(url) {
  const found = [new URL(url).pathname];
  for (let i = 0; i < 3; ++i) {
    try {
      found.push(decodeURIComponent(found.at(-1)));
    } catch { break; }
  }
  return found.map((path) => path.replaceAll('\\', '/'));
}

// Runs with a fetch that answers everything and lists the addresses.
async function listingFetches(run) {
  const fetched = [], before = globalThis.fetch;
  globalThis.fetch = (url) => {
    fetched.push(String(url));
    return Promise.resolve(new Response('abcd', { status: 206, headers: { 'Content-Range': 'bytes 0-3/4' } }));
  };
  try {
    await run(fetched);
  } finally {
    globalThis.fetch = before;
  }
}

test('no address with two dots left in it is fetched', () => listingFetches(async (fetched) => {
  for (const name of kUnresolved) {
    const transport = new Transport(kBases[1]);
    await transport.range(1, name, 0, 4).catch((reason) => assert.equal(reason.id, 'manifest-invalid'));
    transport.dispose();
  }
  assert.deepEqual(fetched.filter((url) => /\/\.\.(\/|$)/.test(url)), []);
}));

test('no name of a file leads out of the manifest\'s folder', async (t) => {
  const seed = Number(process.env.FOURDVT_FUZZ_SEED ?? 1 + Math.floor(Math.random() * 0x7ffffffe)), random = randomOf(seed);
  t.diagnostic(`seed ${seed}`);
  let refused = 0;
  await listingFetches(async (fetched) => {
    for (let i = 0; i < kNames; ++i) {
      const base = kBases[random(kBases.length)], inside = new URL('.', base).href;
      const name = i % 10 === 0 ? 'walk.bin' : Array.from({ length: 1 + random(7) }, () => kPieces[random(kPieces.length)]).join('');
      const transport = new Transport(base);
      fetched.length = 0;
      await transport.range(1, name, 0, 4).catch(() => ++refused);
      transport.dispose();
      for (const url of fetched) {
        assert.ok(url.startsWith(inside), `seed ${seed}: "${name}" of ${base} is fetched from ${url}`);
        const below = url.slice(inside.length);
        for (const path of readings(`http://x/${below.split(/[?#]/)[0]}`)) assert.ok(!/(^|\/)\.\.(\/|$)/.test(path), `seed ${seed}: "${name}" of ${base} climbs: ${url}`);
      }
    }
  });
  t.diagnostic(`${kNames} names, ${refused} refused`);
  assert.ok(refused > kNames / 20 && refused < 0.9 * kNames);
});
