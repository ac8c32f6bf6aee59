// SPDX-License-Identifier: Apache-2.0
// Names of a character's files: a page reads them from the manifest, with hashes or without. If a new bake has replaced
// the playing one, whose file names no longer exist, the page continues with the new one.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { advances, errors, finish, get, open, plays, row, runScenes, sceneTest, until } from './fault_scenes.mjs';
import { environment, launch } from './harness.mjs';

const kKept = ['poster.webp', 'character.start.bin'];

// The site's character as a bake whose names have `mark` in place of hashes; `query`: of its manifest's address. What the
// server does with a request: names that this bake does not have are 404.
function bakeNamed(mark, query = '') {
  const there = new Map(); // name → the file that the site has
  const text = readFileSync(join(environment('SITE'), 'character', 'character.gltf'), 'utf8');
  const manifest = JSON.stringify(JSON.parse(text, (key, value) => {
    if (key !== 'uri' || kKept.includes(value)) return value;
    const name = value.replace(/(\.[0-9a-f]{8})?(\.\w+)$/, `${mark}$2`);
    there.set(name, value);
    return name;
  }));
  const files = new Set(there.values());
  return (request) => {
    const [, folder, name, rest] = /^(.*\/)([^/?]*)(.*)$/.exec(request.url);
    if (name === 'character.gltf') return rest === query ? { text: manifest } : null;
    if (there.has(name)) return { url: folder + there.get(name) };
    return files.has(name) || /\.0000000\d\./.test(name) ? { status: 404 } : null;
  };
}

const missing = (scene) => scene.server.requests.filter((r) => r.status === 404).map((r) => r.path);

for (const [title, mark] of [['without hashes, of an earlier version', ''], ['with hashes', '.00000001']]) {
  sceneTest(`names ${title}, are those of the manifest`, async () => {
    const scene = await open(`names ${title}`, { faults: bakeNamed(mark) });
    await plays(scene);
    assert.deepEqual(await errors(scene), []);
    assert.deepEqual(missing(scene), []);
    await finish(scene);
  });
}

sceneTest('a new bake removes the files of the one that plays: the new one is loaded', async () => {
  const scene = await open('a new bake under new names', { faults: bakeNamed('.00000001') });
  await plays(scene);
  const other = await get(scene, () => globalThis.viewer.sequences[1].name);
  scene.faults = bakeNamed('.00000002');
  await get(scene, (name) => { globalThis.viewer.sequence = name; }, other);
  await until(scene, () => globalThis.seen.filter((e) => e.type === 'canplay').length === 2);
  await until(scene, (name) => globalThis.viewer.sequence === name && globalThis.viewer.stats?.framesShown > 1, other);
  assert.ok(await advances(scene));
  assert.deepEqual(await errors(scene), []);
  assert.ok(missing(scene).every((path) => path.includes('.00000001.')) && missing(scene).length > 0, missing(scene).join(' '));
  row(scene.name, 'the last picture, then the new bake', 'at once');
  await finish(scene);
});

sceneTest('a companion goes on with the new bake, too', async () => {
  const scene = await open('a new bake of a companion');
  await plays(scene);
  const [first, other] = await get(scene, () => globalThis.viewer.sequences.map((s) => s.name));
  scene.faults = bakeNamed('.00000001', '?other');
  await get(scene, (first) => {
    const companion = (globalThis.companion = document.createElement('fourdvt-character'));
    globalThis.refused = [];
    companion.addEventListener('error', (e) => globalThis.refused.push(e.detail.message));
    companion.setAttribute('sequence', first);
    companion.setAttribute('src', 'character/character.gltf?other');
    globalThis.viewer.append(companion);
  }, first);
  await until(scene, () => globalThis.companion.present);
  scene.faults = bakeNamed('.00000002', '?other');
  await get(scene, (other) => globalThis.companion.goTo(other), other);
  await until(scene, () => globalThis.refused.length > 0 || performance.getEntriesByType('resource').some((e) => /\.00000002\.mp4/.test(e.name)));
  assert.deepEqual(await get(scene, () => globalThis.refused), []);
  assert.deepEqual(await errors(scene), []);
  row(scene.name, 'the companion is away for a moment', 'at once');
  await finish(scene);
});

runScenes('names', launch);
