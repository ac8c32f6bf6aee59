// SPDX-License-Identifier: Apache-2.0
// What the browser tests share: environment, Chromium and Firefox, posing the viewer, reading its canvas, native stills.
import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { promisify } from 'node:util';

import { decodePng, encodePng } from './png.mjs';
import { serve } from './server.mjs';

/** npm packages live beside the player: web/node_modules. */
export const requireFromWeb = createRequire(new URL('../../web/package.json', import.meta.url));
const { chromium } = requireFromWeb('playwright-core');
const run = promisify(execFile);

export const kPatienceMs = Number(process.env.FOURDVT_PATIENCE_MS ?? 120_000);  // software GL on a busy machine
export const kFovDeg = 30;           // vertical, native and page

/** A name of this machine that is neither localhost nor https. */
export const kElsewhere = 'visitor.test';
const kFlags = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--autoplay-policy=no-user-gesture-required', `--host-resolver-rules=MAP ${kElsewhere} 127.0.0.1`];
const launchOptions = () => ({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: kFlags });

/** The value of FOURDVT_<name>; a test without its environment fails rather than skips. */
export function environment(name) {
  const value = process.env[`FOURDVT_${name}`];
  assert.ok(value, `FOURDVT_${name} is not set; run the browser tests through ctest (bash tests/run.sh)`);
  return value;
}

export function outputFolder(name) {
  const folder = join(environment('OUT'), name);
  mkdirSync(folder, { recursive: true });
  return folder;
}

/** A browser that other processes connect to; see browser.mjs. */
export const launchServer = () => chromium.launchServer(launchOptions());

/** A browser of its own that is silent until the visitor touches the page, as visitors' are. */
export const launchQuiet = () => chromium.launch({ ...launchOptions(), args: kFlags.filter((flag) => !flag.startsWith('--autoplay-policy')) });

/** The run's browser where FOURDVT_BROWSER names the file with its address, else one of its own. Closing the first only disconnects. */
export async function launch() {
  const file = process.env.FOURDVT_BROWSER;
  if (!file || !existsSync(file)) return chromium.launch(launchOptions());
  return chromium.connect(JSON.parse(readFileSync(file, 'utf8')).address);
}

// A Firefox page with those calls of Playwright's that the tests make.
class FirefoxPage {
  #page;
  constructor(page) {
    this.#page = page;
  }
  on(type, listener) { this.#page.on(type, listener); }
  setDefaultTimeout(ms) { this.#page.setDefaultTimeout(ms); }
  addInitScript(script, argument) { return this.#page.evaluateOnNewDocument(script, argument); }
  goto(url) { return this.#page.goto(url); }
  evaluate(script, argument) { return this.#page.evaluate(script, argument); }
  waitForFunction(script, argument, options) { return this.#page.waitForFunction(script, options, argument); }
  close() { return this.#page.close(); }
}

/** Firefox on a screen of its own, because it has no WebGL without one. Pages are FirefoxPages. */
export async function launchFirefox(preferences = {}) {
  const screen = spawn('Xvfb', ['-displayfd', '1', '-screen', '0', '1024x768x24', '-nolisten', 'tcp'],
    { stdio: ['ignore', 'pipe', 'ignore'] });
  const display = await new Promise((done, fail) => {
    screen.once('error', fail);
    screen.once('exit', (code) => fail(new Error(`Xvfb ended with ${code}`)));
    screen.stdout.once('data', (number) => done(`:${String(number).trim()}`));
  });
  const firefox = await requireFromWeb('puppeteer-core').launch({
    browser: 'firefox', executablePath: process.env.FIREFOX ?? '/usr/bin/firefox-esr', headless: false,
    env: { ...process.env, DISPLAY: display },
    extraPrefsFirefox: { 'webgl.force-enabled': true, 'media.autoplay.default': 0, ...preferences },
  });
  return {
    async newPage({ viewport }) {
      const page = await firefox.newPage({ type: 'window' }); // a tab behind another one is hidden
      await page.setViewport(viewport);
      return new FirefoxPage(page);
    },
    async close() {
      await firefox.close();
      screen.kill();
    },
  };
}

/** The site in a browser, its first picture shown: {server, browser, page}; close with closeSite. */
export async function openSite(viewport) {
  const site = {};
  try {
    site.server = await serve(environment('SITE'));
    site.browser = await launch();
    site.page = await openPage(site.browser, { viewport });
    await site.page.goto(site.server.url);
    await waitForEvent(site.page, 'canplay');
    return site;
  } catch (error) {
    await closeSite(site);
    throw error;
  }
}

export async function closeSite(site) {
  await site?.browser?.close();
  await site?.server?.close();
}

/**
 * A page that keeps everything that went wrong in `page.troubles`, and the viewer's own lines in `page.reported`. Canvases keep their last picture for reading back.
 * options: playwright's newPage options. uploadPath: 'i420' (native's own path: same colours, barcode checked), 'rgba',
 * or 'auto' for what a visitor gets: measured, so it may differ from run to run.
 */
export async function openPage(browser, options = {}, uploadPath = 'i420') {
  const page = await browser.newPage({ deviceScaleFactor: 1, viewport: { width: 720, height: 1100 }, ...options });
  page.setDefaultTimeout(kPatienceMs);
  page.troubles = [];
  page.reported = [];
  page.on('pageerror', (error) => page.troubles.push(`uncaught: ${error.message}`));
  page.on('console', (line) => {
    if (line.type() !== 'error') return;
    if (line.text().startsWith('fourdvt-viewer: ')) page.reported.push(line.text());
    else page.troubles.push(`console: ${line.text()}`);
  });
  if (uploadPath !== 'auto') {
    await page.addInitScript((path) => {
      try { sessionStorage.setItem('fourdvt-upload-path', path); } catch { /* a page without an origin */ }
    }, uploadPath);
  }
  await page.addInitScript(() => {
    const original = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, options) {
      return original.call(this, kind, kind.startsWith('webgl') ? { ...options, preserveDrawingBuffer: true } : options);
    };
    addEventListener('unhandledrejection', (event) => console.error(`unhandled rejection: ${event.reason}`));
    // Events of the first viewer, with the time since navigation in ms.
    const seen = (globalThis.viewerEvents = []);
    for (const type of ['loadstart', 'loadedmetadata', 'canplay', 'playing', 'waiting', 'ended', 'error']) {
      addEventListener(type, (event) => {
        if (event.target.localName !== 'fourdvt-viewer') return;
        seen.push({ type, ms: performance.now(), detail: event.detail ?? null });
      }, true);
    }
  });
  return page;
}

/**
 * The front page with the viewer alone, on another character: { page, outcome }. Waits for its first picture, or for its
 * error: outcome is 'canplay' or the error's detail. prepare: given the page before it loads anything.
 */
export async function openCharacter(browser, url, src, { width = 720, height = 960, prepare } = {}) {
  const page = await openPage(browser);
  await prepare?.(page);
  await page.goto(url);
  await waitForEvent(page, 'canplay');
  const outcome = await page.evaluate(async ({ src, width, height }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    Object.assign(viewer.style, { position: 'fixed', inset: 'auto', left: '0', top: '0', width: `${width}px`, height: `${height}px` });
    viewer.removeAttribute('sequence');
    const end = new Promise((done) => {
      viewer.addEventListener('canplay', () => done('canplay'), { once: true });
      viewer.addEventListener('error', (e) => done(e.detail), { once: true });
    });
    viewer.src = src;
    return end;
  }, { src, width, height });
  return { page, outcome };
}

/** Milliseconds from navigation to the event of the first viewer; fails at once if an error event came before. */
export async function waitForEvent(page, type) {
  const handle = await page.waitForFunction((wanted) => {
    const seen = globalThis.viewerEvents ?? [];
    return seen.find((e) => e.type === wanted) ?? seen.find((e) => e.type === 'error');
  }, type, { timeout: kPatienceMs, polling: 50 });
  const event = await handle.jsonValue();
  assert.equal(event.type, type, `the viewer reports an error instead of ${type}: ${JSON.stringify(event.detail)}`);
  return event.ms;
}

/** Shows one frame from one side, at once, in the highest rendition, without shadow, paused. pose: { sequence, frame, azimuth, elevation, distance }. */
export async function showPose(page, pose) {
  await page.evaluate(async ({ sequence, frame, azimuth, elevation, distance, fov }) => {
    const viewer = document.querySelector('fourdvt-viewer');
    const event = (type) => new Promise((done) => viewer.addEventListener(type, done, { once: true }));
    viewer.pause();
    viewer.quality = 'highest';
    viewer.renderOptions = { groundShadow: false };
    viewer.setAttribute('field-of-view', `${fov}deg`);
    viewer.setAttribute('camera-orbit', `${azimuth}deg ${elevation}deg ${distance}m`);
    viewer.jumpCameraToGoal();
    // No event tells of the sequence that is still on screen while another one was wanted.
    if (viewer.sequence !== sequence) viewer.sequence = sequence;
    const seeked = event('seeked');
    viewer.seekFrame(frame);
    await seeked;
    // Three turns of the frame loop later the canvas shows it.
    for (let i = 0; i < 3; ++i) await new Promise((next) => requestAnimationFrame(next));
    if (viewer.frame !== frame) throw new Error(`frame ${viewer.frame} is shown, ${frame} wanted`);
  }, { fov: kFovDeg, ...pose });
}

/** The viewer's canvas as a straight-alpha picture. */
export async function readCanvas(page) {
  const { width, height, base64 } = await page.evaluate(() => {
    const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let text = '';
    for (let at = 0; at < data.length; at += 0x8000) text += String.fromCharCode(...data.subarray(at, at + 0x8000));
    return { width: copy.width, height: copy.height, base64: btoa(text) };
  });
  return { width, height, data: new Uint8Array(Buffer.from(base64, 'base64')) };
}

export function writePicture(file, picture) {
  writeFileSync(file, encodePng(picture));
}

/** The same pose by `fourdvt render`, without shadow. `more`: further options. */
export async function renderNative(binary, character, pose, width, height, file, more = []) {
  const { sequence, frame, azimuth, elevation, distance } = pose;
  await run(binary, ['render', character, '--sequence', sequence, '--frame', String(frame), '--azimuth', String(azimuth),
    '--elevation', String(elevation), '--distance', String(distance), '--size', `${width}x${height}`, '--no-shadow',
    ...more, '-o', file], { timeout: kPatienceMs });
  return decodePng(readFileSync(file));
}
