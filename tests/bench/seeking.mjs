#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// What a visitor waits for on a slow network once the character plays: a seek to a frame that is not held, two seeks in a row
// of which the second counts, another motion, and the speed slider of a class. In headless Chromium with a cold cache and
// DevTools' throttling; texts and wasm are sent with gzip.
//   node seeking.mjs SITE [--other SITE ...] [--runs 3] [--rate 2000/150] [--out FILE.json]
// SITE: an assembled site (site/assemble.mjs); others are measured with the same player's page in the same run, for
// comparison. Prints for each action the medians of: time from the command to the first picture of what was asked for, bytes
// that came in this time, and bytes of answers that were called off in it or in the 3 seconds after.
import { writeFileSync } from 'node:fs';
import { parseArgs } from 'node:util';

import { launch } from '../web/harness.mjs';
import { serve } from '../web/server.mjs';

const kPatienceMs = 90_000, kAfterMs = 3000, kSoonMs = 300;
const page = (attributes) => ({
  html: `<!doctype html><meta charset="utf-8"><title>plain</title><link rel="icon" href="data:,">
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script>
<fourdvt-viewer src="character/character.gltf" autoplay loop camera-controls ${attributes}></fourdvt-viewer>`,
  headers: { 'Content-Type': 'text/html' },
});
const kPages = { '/pickup.html': page('sequence="pickup"'), '/walk.html': page('sequence="walk"'), '/class.html': page('sequence="locomotion"') };

// act: in the page, with the viewer; again: so, .3 s later, and only from then on is measured; until: events, of which the first
// that comes is the picture that was asked for.
const kActions = {
  'seek to a frame that is not held': { page: 'pickup.html', act: (v) => v.seekFrame(36), until: ['seeked'] },
  'two seeks, .3 s apart': { page: 'pickup.html', act: (v) => v.seekFrame(36), again: (v) => v.seekFrame(2), until: ['seeked'] },
  'another motion at once': { page: 'walk.html', act: (v) => { v.sequence = 'run'; }, until: ['sequencechange'] },
  'another motion by a transition': { page: 'walk.html', act: (v) => v.goTo('pickup'), until: ['transitionstart', 'sequencechange'] },
  'the class that can be steered': { page: 'walk.html', act: (v) => v.goTo('locomotion'), until: ['transitionstart', 'sequencechange'] },
  'the speed slider to its end': { page: 'class.html', act: (v) => v.setParameter('speed_mps', 2.7, true), until: ['timeupdate'] },
};

const { values: options, positionals: sites } = parseArgs({
  allowPositionals: true,
  options: { other: { type: 'string', multiple: true, default: [] }, runs: { type: 'string', default: '3' }, rate: { type: 'string', default: '2000/150' }, out: { type: 'string' } },
});

async function measure(browser, url, { act, again, until }, { kbps, latencyMs }) {
  const context = await browser.newContext({ viewport: { width: 390, height: 844 }, deviceScaleFactor: 2 });
  const tab = await context.newPage(), cdp = await context.newCDPSession(tab);
  const received = new Map(), dropped = [];
  let bytes = 0;
  await cdp.send('Network.enable');
  await cdp.send('Network.setCacheDisabled', { cacheDisabled: true });
  const rate = (kbps * 1000) / 8;
  await cdp.send('Network.emulateNetworkConditions', { offline: false, latency: latencyMs, downloadThroughput: rate, uploadThroughput: rate });
  cdp.on('Network.dataReceived', ({ requestId, encodedDataLength }) => {
    bytes += encodedDataLength;
    received.set(requestId, (received.get(requestId) ?? 0) + encodedDataLength);
  });
  cdp.on('Network.loadingFailed', ({ requestId, canceled }) => { if (canceled) dropped.push(requestId); });
  await tab.goto(url, { waitUntil: 'commit' });
  await tab.waitForFunction(() => document.querySelector('fourdvt-viewer')?.stats?.framesShown >= 3, null, { timeout: kPatienceMs, polling: 30 });
  const from = bytes, first = dropped.length;
  const waited = await tab.evaluate(async ({ act, again, until, soon, patience }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    eval(act)(viewer);
    if (again) await new Promise((resolve) => setTimeout(resolve, soon));
    const begun = performance.now();
    const came = Promise.race(until.map((name) => new Promise((resolve) => viewer.addEventListener(name, resolve, { once: true }))));
    if (again) eval(again)(viewer);
    const late = new Promise((resolve) => setTimeout(resolve, patience, 'late'));
    return (await Promise.race([came, late])) === 'late' ? NaN : performance.now() - begun;
  }, { act: `(${act})`, again: again && `(${again})`, until, soon: kSoonMs, patience: kPatienceMs });
  const came_bytes = bytes - from;
  await tab.waitForTimeout(kAfterMs);
  const thrown = dropped.slice(first).reduce((sum, id) => sum + (received.get(id) ?? 0), 0);
  await context.close();
  return { waited_ms: waited, came_bytes, thrown_bytes: thrown };
}

const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];
const [kbps, latencyMs] = options.rate.split('/').map(Number);
const browser = await launch(), results = [];
try {
  for (const [title, action] of Object.entries(kActions)) {
    for (const site of [...options.other, ...sites]) {
      const server = await serve(site, 0, { gzip: true, pages: kPages }), runs = [];
      for (let i = 0; i < Number(options.runs); ++i) runs.push(await measure(browser, server.url + action.page, action, { kbps, latencyMs }));
      await server.close();
      const of = (name) => median(runs.map((run) => run[name]));
      const result = { action: title, site, rate: options.rate, waited_ms: of('waited_ms'), all_ms: runs.map((r) => Math.round(r.waited_ms)), came_bytes: of('came_bytes'), thrown_bytes: of('thrown_bytes') };
      results.push(result);
      console.log(`${title.padEnd(34)} ${site.padEnd(26)} ${(result.waited_ms / 1000).toFixed(2)} s (${result.all_ms.join(' ')}), ${(result.came_bytes / 1000).toFixed(0)} kB, thrown away ${(result.thrown_bytes / 1000).toFixed(0)} kB`);
    }
  }
} finally {
  await browser.close();
}
if (options.out) writeFileSync(options.out, `${JSON.stringify(results, null, 1)}\n`);
