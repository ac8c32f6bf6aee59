// SPDX-License-Identifier: Apache-2.0
// The package in built pages: by Vite and by webpack, which must include all of the player's files, and in TypeScript with
// React; and a page that keeps the player's files elsewhere.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readdirSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { environment, kPatienceMs, launch, openPage, requireFromWeb } from './harness.mjs';
import { serve } from './server.mjs';

const kSite = resolve(environment('SITE'));
const kWeb = fileURLToPath(new URL('../../web', import.meta.url));
const kBody = '<fourdvt-viewer src="/character/character.gltf" sequence="walk" autoplay loop style="width: 200px"></fourdvt-viewer>';
let folder, browser, server;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-bundlers-'));
  const player = join(folder, 'node_modules/fourdvt-viewer');
  mkdirSync(player, { recursive: true });
  for (const name of ['package.json', 'react.d.ts', 'react.js']) cpSync(join(kWeb, name), join(player, name));
  cpSync(join(kSite, 'fourdvt-viewer'), join(player, 'dist'), { recursive: true });
  symlinkSync(join(kWeb, 'node_modules/@types'), join(folder, 'node_modules/@types'));
  writeFileSync(join(folder, 'package.json'), '{ "type": "module" }');
  writeFileSync(join(folder, 'main.js'), "import 'fourdvt-viewer';\nimport 'fourdvt-viewer/react';\n");
  writeFileSync(join(folder, 'index.html'), `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><script type="module" src="/main.js"></script>${kBody}`);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

afterEach(() => server?.close());

// Shows the page, and waits until its second part and its worker are loaded.
async function expectAll(site, pages = {}) {
  symlinkSync(join(kSite, 'character'), join(site, 'character'));
  server = await serve(site, 0, { pages });
  const page = await openPage(browser, { viewport: { width: 240, height: 300 } });
  const warnings = [];
  page.on('console', (line) => { if (line.type() === 'warning') warnings.push(line.text()); });
  await page.goto(server.url);
  const becomes = async (condition) => {
    const handle = await page.waitForFunction(condition, null, { timeout: kPatienceMs, polling: 50 });
    assert.equal(await handle.jsonValue(), true);
  };
  await becomes(() => document.querySelector('fourdvt-viewer').error ?? document.querySelector('fourdvt-viewer').shadowRoot.querySelector('[part=controls]') !== null);
  await page.evaluate(() => document.querySelector('fourdvt-viewer').goTo('pickup')); // the first motion may be decoded before the worker is there
  await becomes(() => document.querySelector('fourdvt-viewer').error ?? document.querySelector('fourdvt-viewer').stats?.workerFrames > 0);
  assert.deepEqual([...page.troubles, ...page.reported, ...warnings.filter((line) => line.includes('fourdvt'))], []);
  await page.close();
}

test('Vite takes all files along', async () => {
  const { build } = await import(requireFromWeb.resolve('vite').replace('index.cjs', 'dist/node/index.js'));
  await build({ root: folder, logLevel: 'error', build: { outDir: 'vite' } });
  const files = readdirSync(join(folder, 'vite/assets')).filter((name) => name.endsWith('.wasm')).map((name) => name.replace(/-[\w-]{8}\.wasm$/, '')).sort();
  assert.deepEqual(files.filter((name) => name !== 'fourdvt-opencv'), ['fourdvt-more', 'fourdvt-viewer', 'fourdvt-worker']);
  await expectAll(join(folder, 'vite'));
});

test('webpack takes all files along', async () => {
  const webpack = requireFromWeb('webpack'), out = join(folder, 'webpack');
  const stats = await new Promise((done, fail) => {
    webpack({ mode: 'production', context: folder, entry: './main.js', output: { path: out } }, (reason, result) => (reason ? fail(reason) : done(result)));
  });
  assert.deepEqual(stats.toJson().errors, []);
  writeFileSync(join(out, 'index.html'), `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><script src="main.js"></script>${kBody}`);
  await expectAll(out);
});

test('a page that keeps the files elsewhere names the wasm file, also by a relative address, after the import', async () => {
  const site = join(folder, 'elsewhere');
  cpSync(join(kSite, 'fourdvt-viewer'), join(site, 'assets/player'), { recursive: true });
  cpSync(join(site, 'assets/player/fourdvt-viewer.js'), join(site, 'viewer.js'));
  writeFileSync(join(site, 'index.html'), `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">${kBody}<script type="module">
    import { FourdvtViewer } from './viewer.js';
    FourdvtViewer.wasmUrl = 'assets/player/fourdvt-viewer.wasm';
  </script>`);
  await expectAll(site);
});

test('TypeScript knows the element in JSX', () => {
  const check = (attributes) => {
    writeFileSync(join(folder, 'page.tsx'), `import 'fourdvt-viewer/react';\nexport const page = <fourdvt-viewer ${attributes} />;\n`);
    return spawnSync(process.execPath, [requireFromWeb.resolve('typescript/package.json').replace('package.json', 'bin/tsc'), '--noEmit', '--strict', '--skipLibCheck', '--jsx', 'preserve',
      '--target', 'es2022', '--module', 'nodenext', '--moduleResolution', 'nodenext', '--types', 'react', join(folder, 'page.tsx')], { encoding: 'utf8', cwd: folder });
  };
  const fits = check('src="a.gltf" autoplay camera-controls min-camera-orbit="auto 0deg auto" className="big"');
  assert.equal(fits.status, 0, fits.stdout);
  assert.match(check('src={7}').stdout, /page\.tsx.*'number' is not assignable/);
  assert.match(check('sequences="walk"').stdout, /page\.tsx.*sequences/);
});
