// SPDX-License-Identifier: Apache-2.0
// axe-core on every page of the site and of the examples, and on a viewer in each of its states.
import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, requireFromWeb } from './harness.mjs';
import { serve } from './server.mjs';

const kSite = environment('SITE');
const kPages = readdirSync(kSite, { recursive: true }).filter((path) => path.endsWith('.html') && !/^(character|cameras|fourdvt-viewer)\//.test(path)).sort();
const kState = (attributes) => ({ html: `<!doctype html><html lang="en"><meta charset="utf-8"><title>state</title><link rel="icon" href="data:,"><main><h1>state</h1>
<script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script><fourdvt-viewer alt="A man walks" ${attributes}></fourdvt-viewer></main>`, headers: {} });
const kSource = 'src="/character/character.gltf" sequence="walk"';
const kStates = {
  '/state/playing.html': kState(`${kSource} autoplay loop camera-controls interaction-prompt`),
  '/state/controls.html': kState(`${kSource} controls camera-controls motion-controls`),
  '/state/idle.html': kState(`${kSource} preload="none" poster="/character/poster.webp"`),
  '/state/error.html': kState('src="/nowhere/character.gltf"'),
};

let server, browser, page;
before(async () => {
  server = await serve(kSite, 0, { pages: kStates });
  browser = await launch();
  page = await openPage(browser, { viewport: { width: 390, height: 844 } });
  await page.addInitScript({ path: requireFromWeb.resolve('axe-core/axe.min.js') });
});
after(async () => {
  await browser?.close();
  await server?.close();
});

async function violations(path) {
  await page.goto(server.url + path);
  // Viewers have loaded what is on the screen, with their buttons, or have failed.
  await page.waitForFunction(() => [...document.querySelectorAll('fourdvt-viewer[src]')].every((v) => (v.readyState >= 3 && v.shadowRoot.querySelector('[part=controls]')) || v.error || v.loading === 'lazy' ||
    v.preload === 'none' || v.getBoundingClientRect().top > innerHeight), null, { timeout: kPatienceMs, polling: 100 });
  const prompt = page.locator('[interaction-prompt] [part=prompt]');
  if (await prompt.count()) await prompt.waitFor({ state: 'visible', timeout: kPatienceMs });
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  return found.violations.flatMap(({ id, help, nodes }) => nodes.map(({ target, failureSummary }) => `${path}: ${id}: ${help}: ${target.flat().join(' > ')}: ${failureSummary.split('\n')[1]?.trim()}`));
}

test('axe-core finds what is wrong', async () => {
  await page.goto(`${server.url}state/idle.html`);
  const found = await page.evaluate(() => {
    document.documentElement.removeAttribute('lang');
    return globalThis.axe.run(document);
  });
  assert.deepEqual(found.violations.map(({ id }) => id), ['html-has-lang']);
});

for (const path of [...Object.keys(kStates).map((name) => name.slice(1)), ...kPages]) {
  test(path, async () => { assert.deepEqual(await violations(path), []); });
}
