// SPDX-License-Identifier: Apache-2.0
// Every page of the site and every example as a visitor meets it, in three windows: before the player runs, playing, paused. In
// numbers: viewers inside of the window, no sideways scrolling, nothing over the figure but the viewer's corner button, no
// text cut off, enough contrast. Pictures and a sheet of them: build/pages.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage } from './harness.mjs';
import { layoutProblems } from './page_layout.mjs';
import { serve } from './server.mjs';

const kSite = environment('SITE');
const kOut = join(kSite, '../pages');
const kWindows = {
  desktop: { width: 1280, height: 800, mobile: false },
  tablet: { width: 820, height: 1180, mobile: false },
  phone: { width: 390, height: 844, mobile: true },
};
// Pages with viewers. below: the page is longer than the window by design, its later viewers may begin below it; they fill its
// width. world: the scene fills the window, and words lie over it. steady: what keeps its place when the player begins.
const kPages = {
  'index.html': { steady: 'h1, #play, #scrub, #looks, .stage nav a' }, 'steer.html': { world: true }, 'cameras.html': { needs: 'cameras' }, 'methods.html': { needs: 'cameras' }, 'slider.html': { needs: 'cameras' }, 'live/index.html': { live: true },
  'examples/embed.html': {}, 'examples/gallery.html': { below: true }, 'examples/own-controls.html': {}, 'examples/steer.html': { world: true },
};
const kStatus = {
  frames_per_s: 29.8, latency_ms: 84, triangles: 12345, tolerance_px: 1.5, hull_ms: 12.1, picture_ms: 8.4, encode_ms: 14.9, surface_bytes_per_s: 61000, picture_bytes_per_s: 410000,
  skipped: 1, failed: 0, cameras: Array.from({ length: 6 }, (_, i) => ({ name: `cam0${i}`, connected: true, lost: false, late: i, keyed_ms: 6.4, contour_bytes_per_s: 5200, picture_bytes_per_s: 64000 })),
};

let server, browser;
const pictures = [];
before(async () => {
  mkdirSync(kOut, { recursive: true });
  server = await serve(kSite);
  browser = await launch();
});
after(async () => {
  await writeSheet();
  await browser?.close();
  await server?.close();
});

async function setWindow(page, { width, height, mobile }) {
  page.devtools ??= await page.context().newCDPSession(page);
  await page.devtools.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile });
  await page.waitForFunction(([w, h]) => matchMedia(`(width: ${w}px) and (height: ${h}px)`).matches, [width, height], { timeout: kPatienceMs, polling: 50 });
}

// By the browser itself: Playwright's own pictures undo the window's size.
async function photograph(page, file) {
  const { data } = await page.devtools.send('Page.captureScreenshot', { format: 'png' });
  writeFileSync(join(kOut, file), Buffer.from(data, 'base64'));
}

// Waits until every canvas in sight has the size of its viewer, and has been drawn once more.
const settle = (page) => page.evaluate(async (patienceMs) => {
  const fits = (viewer) => {
    const canvas = viewer.shadowRoot?.querySelector('canvas'), box = viewer.getBoundingClientRect();
    return !canvas || box.top > innerHeight || Math.abs(canvas.width / canvas.height - box.width / box.height) < 0.02 * box.width / box.height;
  };
  for (const end = performance.now() + patienceMs; performance.now() < end && ![...document.querySelectorAll('fourdvt-viewer')].every(fits);) await new Promise((next) => setTimeout(next, 50));
  for (let i = 0; i < 3; ++i) await new Promise((next) => requestAnimationFrame(next));
}, kPatienceMs);

async function look(page, name, state, sizes, options) {
  const problems = [];
  for (const size of sizes) {
    await setWindow(page, kWindows[size]);
    await settle(page);
    const found = await page.evaluate(layoutProblems, { state, window: kWindows[size], ...options });
    const file = `${name.replace(/\.html$/, '').replace(/\W+/g, '-')}-${size}-${state}.png`;
    await photograph(page, file);
    pictures.push({ file, name, size, state, found });
    problems.push(...found.map((text) => `${name} ${size} ${state}: ${text}`));
  }
  return problems;
}

// The player's files wait until `release` is called.
async function holdPlayer(page) {
  let release;
  const released = new Promise((done) => { release = done; });
  await page.route('**/fourdvt-viewer.wasm*', (route) => released.then(() => route.continue()).catch(() => undefined));
  return release;
}

// A console with a server behind it that has six cameras; the performer is the sample's character.
async function prepareLive(page) {
  await page.addInitScript((status) => {
    globalThis.WebSocket = class extends EventTarget {
      static OPEN = 1;
      readyState = 1;
      constructor(url) {
        super();
        if (new URL(url).pathname === '/console') setTimeout(() => this.dispatchEvent(new MessageEvent('message', { data: JSON.stringify(status) })), 100);
      }
      send() {}
      close() {}
    };
  }, kStatus);
  const rings = [[[120, 40], [200, 60], [210, 300], [110, 300]]];
  await page.route('**/cameras/cam0*', (route) => (route.request().url().endsWith('.json') ? route.fulfill({ json: { number: 1, crop: [0, 0, 0, 0], size: [320, 320], rings } }) : route.abort()));
}

const viewersPlay = (page) => page.waitForFunction(() => {
  const seen = [...document.querySelectorAll('fourdvt-viewer')].filter((viewer) => viewer.getBoundingClientRect().top < innerHeight);
  return seen.every((viewer) => viewer.readyState >= 2 && (viewer.error || viewer.stats.framesShown > 1 || viewer.paused) && viewer.shadowRoot.querySelector('[part=controls]'));
}, null, { timeout: kPatienceMs, polling: 100 });

for (const [name, options] of Object.entries(kPages)) {
  const absent = options.needs && !existsSync(join(kSite, options.needs));
  test(name, { skip: absent ? `the site has no ${options.needs}` : false }, async () => {
    const page = await openPage(browser, { viewport: { width: 1280, height: 800 } });
    const release = await holdPlayer(page);
    if (options.live) await prepareLive(page);
    await page.goto(server.url + name, { waitUntil: 'load' });
    if (options.live) await page.evaluate(() => { document.getElementById('viewer').src = new URL('character/character.gltf', new URL('/', location.href)).href; });
    await page.waitForFunction(() => customElements.get('fourdvt-viewer'), null, { timeout: kPatienceMs });
    await page.evaluate(() => { for (const viewer of document.querySelectorAll('fourdvt-viewer')) viewer.renderOptions = { samples: 0 }; }); // layout needs no smooth edges
    if (!options.live) assert.deepEqual(await look(page, name, 'poster', Object.keys(kWindows), options), []);
    const places = () => page.$$eval(options.steady ?? 'h1', (elements) => elements.map((element) => {
      const { left, top } = element.getBoundingClientRect();
      return `${element.id || element.textContent} at ${Math.round(left)}, ${Math.round(top)}`;
    }));
    await setWindow(page, kWindows.desktop);
    const before = await places();
    release();
    await viewersPlay(page);
    assert.deepEqual(await places(), before);
    const first = page.locator('fourdvt-viewer').first();
    await first.evaluate((viewer) => { if (viewer.paused) void viewer.play(); });
    const problems = await look(page, name, 'playing', ['desktop', 'tablet'], options);
    await page.evaluate(() => { for (const viewer of document.querySelectorAll('fourdvt-viewer')) viewer.pause(); });
    problems.push(...await look(page, name, 'paused', ['desktop', 'tablet'], options));
    // A page that has been touched cannot be given its mouse back: the phone comes last.
    await page.devtools.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 5 });
    problems.push(...await look(page, name, 'paused', ['phone'], options));
    await first.evaluate((viewer) => void viewer.play());
    problems.push(...await look(page, name, 'playing', ['phone'], options));
    assert.deepEqual([...problems, ...page.troubles], []);
    await page.close();
  });
}

test('the pages of documents and figures', async () => {
  const page = await openPage(browser);
  const texts = ['docs', 'measured'].flatMap((folder) => readdirSync(join(kSite, folder)).filter((file) => file.endsWith('.html')).map((file) => `${folder}/${file}`));
  const problems = [];
  for (const name of texts) {
    await page.goto(server.url + name);
    for (const [size, window] of Object.entries(kWindows)) {
      await setWindow(page, window);
      const found = await page.evaluate(layoutProblems, { state: 'text', window });
      problems.push(...found.map((text) => `${name} ${size}: ${text}`));
      if (!/(index)\.html$/.test(name)) continue;
      const file = `${name.replace(/\.html$/, '').replace(/\W+/g, '-')}-${size}.png`;
      await photograph(page, file);
      pictures.push({ file, name, size, state: 'text', found });
    }
  }
  assert.deepEqual(problems, []);
  await page.close();
});

// One page with all pictures, and a picture of it.
async function writeSheet() {
  const rows = [...new Set(pictures.map(({ name, state }) => `${name} ${state}`))].map((row) => {
    const cells = pictures.filter(({ name, state }) => `${name} ${state}` === row);
    return `<h2>${row}</h2><div>${cells.map(({ file, found }) => `<a href="${file}"><img src="${file}" alt="${file}"></a>${found.map((text) => `<p>${text.replaceAll('<', '&lt;')}</p>`).join('')}`).join('')}</div>`;
  });
  writeFileSync(join(kOut, 'index.html'), `<!doctype html><meta charset="utf-8"><title>pages</title><style>body{font:14px system-ui;background:#777;columns:2;margin:8px}h2{margin:4px 0;font-size:14px}div{break-inside:avoid}img{height:220px;margin:2px}p{color:#fd8}</style>${rows.join('')}`);
  const sheets = await serve(kOut);
  const page = await browser.newPage({ viewport: { width: 1700, height: 900 } });
  await page.goto(sheets.url);
  await page.screenshot({ path: join(kOut, 'index.png'), fullPage: true });
  await page.close();
  await sheets.close();
}
