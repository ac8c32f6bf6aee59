// SPDX-License-Identifier: Apache-2.0
// A page with many viewers, each with its own character (the same bytes under other addresses, uncached): measured at
// rest, while scrolled to its end, and back at its top.
import { launch } from '../../web/harness.mjs';
import { fill, holdings, openPortfolio, pressPhone, scrollTo, servePortfolio } from '../../web/portfolio.mjs';

const kLookMs = 4000;
const kPatienceMs = 40_000;

/**
 * { contexts, modules, errors, decoders, firstMs, steps: ms until all on screen have a picture, failed: steps that never
 * reach this, unseenBytes: fetched for viewers never on screen, peak: { loaded, gpu, heap }, back: pictures that the
 * first viewer shows in a second once it is on screen again }.
 */
export async function measurePortfolio(site, count) {
  const server = await servePortfolio(site), browser = await launch();
  try {
    const page = await openPortfolio(browser, server.url, { width: 640, height: 480 });
    const bytes = new Map();
    await page.route(/\/c\/\d+\//, async (route) => {
      const url = route.request().url(), [, number] = /\/c\/(\d+)\//.exec(url);
      const answer = await route.fetch({ url: url.replace(/\/c\/\d+\//, '/character/') });
      bytes.set(number, (bytes.get(number) ?? 0) + (await answer.body()).length);
      await route.fulfill({ response: answer });
    });
    const peak = { loaded: 0, gpu: 0, heap: 0 };
    const note = async () => {
      const now = await holdings(page);
      peak.loaded = Math.max(peak.loaded, now.loaded);
      peak.gpu = Math.max(peak.gpu, now.textureBytes + now.targetBytes);
      peak.heap = Math.max(peak.heap, now.heapBytes);
      return now;
    };
    await fill(page, count, Array.from({ length: count }, (_, i) => `/c/${i}/character.gltf`));
    const steps = [], step = (y) => scrollTo(page, y, kPatienceMs).then((ms) => steps.push(ms), () => { ++failed; });
    let failed = 0;
    await step(0);
    await page.waitForTimeout(kLookMs);
    await note();
    const seen = await page.evaluate(() => globalThis.viewers.map((viewer) => viewer.getBoundingClientRect().top < innerHeight));
    const unseenBytes = [...bytes].reduce((sum, [number, size]) => sum + (seen[number] ? 0 : size), 0);
    const height = await page.evaluate(() => document.documentElement.scrollHeight);
    for (let y = 480; y < height; y += 480) {
      await step(y);
      await note();
    }
    await step(0);
    const shown = () => page.evaluate(() => globalThis.viewers[0].stats?.framesShown ?? 0);
    const before = await shown();
    await page.waitForTimeout(1000);
    const back = (await shown()) - before;
    const { contexts, modules, errors, maxDecoders: decoders } = await note();
    const [firstMs, ...others] = steps;
    return { contexts, modules, decoders, errors: errors.length, firstMs, steps: others, failed, unseenBytes, peak, back };
  } finally {
    await browser.close();
    await server.close();
  }
}

/** { loaded, pictures, bytes, most: { loaded, bytes }, decoders, errors } of pressPhone (tests/web/portfolio.mjs). */
export async function measurePressure(site, count) {
  const server = await servePortfolio(site), browser = await launch();
  try {
    const { page, ...seen } = await pressPhone(browser, server.url, count);
    const { maxDecoders: decoders, errors } = await holdings(page);
    return { ...seen, decoders, errors: errors.length };
  } finally {
    await browser.close();
    await server.close();
  }
}
