// SPDX-License-Identifier: Apache-2.0
// Shared by seeking.mjs and ladder.mjs: a page with one viewer, DevTools' throttling, and the network traffic by the
// page's clock.
import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';

/** Parses "2000/150": kbit/s and latency in ms. */
export const rateOf = (text) => {
  const [kbps, latencyMs = 50] = text.split('/').map(Number);
  return { kbps, latencyMs };
};

export const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

export const table = (head, rows) => [head, head.map(() => '---'), ...rows].map((row) => `| ${row.join(' | ')} |`).join('\n');

/** Commit of this tree, with + if files differ from it. */
export function commitOfTree() {
  const git = (...words) => execFileSync('git', ['-C', fileURLToPath(new URL('../..', import.meta.url)), ...words], { encoding: 'utf8' }).trim();
  return git('rev-parse', '--short', 'HEAD') + (git('status', '--porcelain', '--untracked-files=no') ? '+' : '');
}

/** A page of one tag for serve()'s option `pages`. */
export function pageWithTag(src, attributes) {
  const html = `<!doctype html><meta charset="utf-8"><title>one viewer</title><link rel="icon" href="data:,">
<script type="module" src="fourdvt-viewer/fourdvt-viewer.js"></script>
<fourdvt-viewer src="${src}" autoplay ${attributes}></fourdvt-viewer>`;
  return { html, headers: { 'Content-Type': 'text/html' } };
}

/** Records the requests of a page. */
class Traffic {
  #requests = new Map();
  #wallS = 0; // by DevTools' clock

  constructor(cdp) {
    cdp.on('Network.requestWillBeSent', (event) => this.#begin(event));
    cdp.on('Network.dataReceived', ({ requestId, encodedDataLength, timestamp }) => {
      if (encodedDataLength > 0) this.#requests.get(requestId)?.parts.push({ bytes: encodedDataLength, timestamp });
    });
    cdp.on('Network.loadingFinished', ({ requestId, timestamp }) => this.#end(requestId, timestamp, false));
    cdp.on('Network.loadingFailed', ({ requestId, timestamp, canceled }) => this.#end(requestId, timestamp, canceled));
  }

  #begin({ requestId, request, timestamp, wallTime }) {
    this.#wallS = wallTime - timestamp;
    const name = new URL(request.url).pathname.slice(1) || 'index.html';
    this.#requests.set(requestId, { name, range: request.headers.Range, timestamp, parts: [] });
  }
  #end(requestId, timestamp, cancelled) {
    const request = this.#requests.get(requestId);
    if (request) Object.assign(request, { end: timestamp, cancelled });
  }

  /** All so far: { name, range, atMs, parts: [{ atMs, bytes }], endMs, cancelled }, times in ms since `originMs`. */
  requestsSince(originMs) {
    const ms = (timestamp) => (timestamp + this.#wallS) * 1000 - originMs;
    const timed = ({ timestamp, ...rest }) => ({ ...rest, atMs: ms(timestamp) });
    return [...this.#requests.values()].map(({ parts, end, ...request }) => (
      { ...timed(request), parts: parts.map(timed), endMs: end === undefined ? Infinity : ms(end) }));
  }
}

/** Opens `url` with a cold cache: { page, traffic, setRate, close }. Selects the upload path that reads barcodes. */
export async function openThrottled(browser, url, rate, { viewport, deviceScaleFactor = 1, prepare }) {
  const context = await browser.newContext({ viewport, deviceScaleFactor });
  const page = await context.newPage(), cdp = await context.newCDPSession(page);
  const traffic = new Traffic(cdp);
  const setRate = ({ kbps, latencyMs }) => cdp.send('Network.emulateNetworkConditions',
    { offline: false, latency: latencyMs, downloadThroughput: kbps * 125, uploadThroughput: kbps * 125 });
  await cdp.send('Network.enable');
  await cdp.send('Network.setCacheDisabled', { cacheDisabled: true });
  await setRate(rate);
  await page.addInitScript(() => sessionStorage.setItem('fourdvt-upload-path', 'i420'));
  await prepare?.(page);
  await page.goto(url, { waitUntil: 'commit' });
  return { page, traffic, setRate, close: () => context.close() };
}
