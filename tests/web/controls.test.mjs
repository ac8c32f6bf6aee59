// SPDX-License-Identifier: Apache-2.0
// The viewer's interface around the character: pause button and bar of `controls`, poster, prompt, limits of the view,
// sizes, languages, and announcements for screen readers.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, outputFolder } from './harness.mjs';
import { serve } from './server.mjs';

const kPage = (body, lang = 'en') => `<!doctype html><html lang="${lang}"><meta charset="utf-8"><title>viewer</title><link rel="icon" href="data:,">
<style>body { margin: 0 } main { width: 400px } fourdvt-viewer:not([style]) { width: 100% }</style>
<script type="module" src="/fourdvt-viewer/fourdvt-viewer.js"></script><main>${body}</main>`;
const kSource = 'src="/character/character.gltf" upload-path="i420" sequence="walk" alt="A man walks"';

let server, browser;
const pages = {};
before(async () => {
  server = await serve(environment('SITE'), 0, { pages });
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

// The page with this body, and helpers: until(condition), viewer(read), part(name): a locator in the shadow tree.
let number = 0;
async function open(body, { lang, prepare, waits = 'canplay' } = {}) {
  const path = `/page${++number}.html`;
  pages[path] = { html: kPage(body, lang), headers: {} };
  const page = await openPage(browser, { viewport: { width: 420, height: 620 } });
  await prepare?.(page);
  await page.goto(server.url + path.slice(1));
  const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 30 });
  if (waits) await until((type) => globalThis.viewerEvents.some((e) => e.type === type), waits);
  const viewer = (read, argument) => page.evaluate(`(${read})(document.querySelector('fourdvt-viewer'), ${JSON.stringify(argument)})`);
  const part = (name) => page.locator(`fourdvt-viewer [part=${name}]`);
  return { page, until, viewer, part };
}
const settled = ({ part }) => part('play-toggle').waitFor({ state: 'visible', timeout: kPatienceMs });

test('what plays by itself has a button that pauses it, and another press plays on', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} autoplay loop></fourdvt-viewer>`);
  await settled(at);
  assert.equal(await at.part('play-toggle').getAttribute('aria-label'), 'Pause');
  await at.part('play-toggle').click();
  await at.until(() => document.querySelector('fourdvt-viewer').paused);
  assert.equal(await at.part('play-toggle').getAttribute('aria-label'), 'Play');
  await at.page.screenshot({ path: join(outputFolder('controls'), 'paused.png') });
  await at.part('play-toggle').click();
  await at.until(() => !document.querySelector('fourdvt-viewer').paused);
  await at.viewer((v) => v.setAttribute('controls', 'none'));
  assert.equal(await at.part('controls').isVisible(), false);
  await at.viewer((v) => v.pause());
  assert.equal(await at.part('play').isVisible(), false, 'no button at all');
  assert.deepEqual(at.page.troubles, []);
  await at.page.close();
});

test('controls: play, time, full screen; after the end it plays again', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} controls loop="false"></fourdvt-viewer>`);
  await settled(at);
  assert.equal(await at.part('clock').textContent(), '0:00 / 0:01');
  await at.page.screenshot({ path: join(outputFolder('controls'), 'controls.png') });
  await at.part('play-toggle').click();
  await at.until(() => globalThis.viewerEvents.some(({ type }) => type === 'ended'));
  assert.equal(await at.part('clock').textContent(), '0:01 / 0:01');
  await at.part('play').click();
  await at.until(() => globalThis.viewerEvents.filter(({ type }) => type === 'ended').length === 2);
  await at.part('time').fill('0.4');
  await at.until(() => { const v = document.querySelector('fourdvt-viewer'); return !v.seeking && Math.abs(v.currentTime - 0.4) < 0.05; });
  assert.equal(await at.part('time').getAttribute('aria-valuetext'), '0:00 of 0:01');
  await at.part('fullscreen').click();
  await at.until(() => document.fullscreenElement?.localName === 'fourdvt-viewer');
  await at.until(() => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('[part=fullscreen]').ariaLabel === 'Leave full screen');
  const { width, height } = await at.part('canvas').evaluate((canvas) => canvas.getBoundingClientRect());
  assert.deepEqual([width, height], [420, 620]);
  await at.part('fullscreen').click();
  await at.until(() => !document.fullscreenElement);
  assert.deepEqual(at.page.troubles, []);
  await at.page.close();
});

test('its own controls, poster, progress bar and prompt take the places of those of the page', async () => {
  let go;
  const held = new Promise((done) => { go = done; });
  const prepare = (page) => page.route('**/character.gltf', async (route) => { await held; await route.continue(); });
  const at = await open(`<fourdvt-viewer ${kSource} reveal="manual"><button slot="controls" id="mine">Mine</button>
    <div slot="poster" id="cover">Cover</div><progress slot="progress-bar" id="bar"></progress></fourdvt-viewer>`, { waits: 'loadstart', prepare });
  await at.until(() => document.getElementById('bar').checkVisibility());
  go();
  await at.until(() => globalThis.viewerEvents.some(({ type }) => type === 'canplay'));
  await at.page.locator('#mine').waitFor({ state: 'visible' });
  assert.equal(await at.part('play-toggle').isVisible(), false);
  const under = (x, y) => at.page.evaluate(([x, y]) => document.elementFromPoint(x, y).id, [x, y]);
  const { y } = await at.page.locator('#cover').boundingBox();
  assert.equal(await under(5, y + 5), 'cover', 'what is in the slot can be pressed');
  const opacity = () => at.part('poster').evaluate((slot) => getComputedStyle(slot).opacity);
  assert.equal(await opacity(), '1', 'it waits for dismissPoster');
  await at.viewer((v) => v.dismissPoster());
  await at.until(() => getComputedStyle(document.querySelector('fourdvt-viewer').shadowRoot.querySelector('.poster')).opacity === '0');
  await at.until(() => !document.getElementById('bar').checkVisibility());
  await at.page.close();
});

test('a poster that is missing leaves no broken picture', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} poster="/nowhere.webp" preload="none"></fourdvt-viewer>`, { waits: '' });
  await at.until(() => document.querySelector('fourdvt-viewer')?.shadowRoot?.querySelector('.picture').hidden);
  assert.equal(await at.part('play').isVisible(), true);
  await at.page.close();
});

test('it has the size that the page gives it, and three to four by default', async () => {
  const sizes = async (style) => {
    const at = await open(`<fourdvt-viewer style="${style}"></fourdvt-viewer>`, { waits: '' });
    await at.until(() => document.querySelector('fourdvt-viewer').shadowRoot);
    const size = await at.viewer((v) => [v.offsetWidth, v.offsetHeight]);
    await at.page.close();
    return size;
  };
  assert.deepEqual(await sizes('width: 100%; aspect-ratio: 16/9'), [400, 225]);
  assert.deepEqual(await sizes('color: red'), [300, 400]);
  assert.deepEqual(await sizes('width: 200px; height: 100px'), [200, 100]);
  assert.deepEqual(await sizes('height: 100%; width: 150px'), [150, 200]);
});

test('the view keeps to its limits, zooms no more than asked for, and a double click brings it back', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} camera-controls camera-orbit="0deg 10deg auto" min-camera-orbit="-30deg 0deg auto"
    max-camera-orbit="30deg 20deg auto" disable-zoom orbit-sensitivity="4"></fourdvt-viewer>`);
  const orbit = () => at.viewer((v) => { v.jumpCameraToGoal(); return v.getCameraOrbit(); });
  const before = await orbit();
  const drag = async (dx, dy) => {
    await at.page.mouse.move(200, 200);
    await at.page.mouse.down();
    await at.page.mouse.move(200 + dx, 200 + dy, { steps: 4 });
    await at.page.mouse.up();
  };
  await drag(-300, 200);
  assert.deepEqual(Object.values(await orbit()).slice(0, 2).map(Math.round), [30, 20]);
  await drag(300, -200);
  assert.deepEqual(Object.values(await orbit()).slice(0, 2).map(Math.round), [-30, 0]);
  await at.page.keyboard.press('+');
  assert.equal((await orbit()).distance, before.distance);
  await at.page.mouse.dblclick(200, 200);
  assert.deepEqual(await orbit(), before);
  await at.viewer((v) => v.removeAttribute('disable-zoom'));
  await at.page.keyboard.press('+');
  const step = before.distance / (await orbit()).distance;
  assert.ok(step > 1.01);
  await at.viewer((v) => v.setAttribute('zoom-sensitivity', '2'));
  await at.page.keyboard.press('-');
  assert.ok(Math.abs((await orbit()).distance / before.distance - step) < 1e-6, 'twice as far out as it came in');
  await at.viewer((v) => v.setAttribute('touch-action', 'none'));
  assert.equal(await at.part('stage').evaluate((stage) => getComputedStyle(stage).touchAction), 'none');
  await at.page.close();
});

test('it turns by itself as fast and as soon as asked for', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} camera-controls auto-rotate rotation-per-second="90deg" auto-rotate-delay="1000000"></fourdvt-viewer>`);
  const azimuth = () => at.viewer((v) => v.getCameraOrbit().azimuth);
  await at.until(() => document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth > 20);
  await at.page.mouse.click(200, 200);
  await at.page.waitForTimeout(800);
  const stopped = await azimuth();
  await at.page.waitForTimeout(400);
  assert.ok(Math.abs((await azimuth()) - stopped) < 0.1);
  await at.page.close();
});

test('the prompt comes when nothing is done, and goes with the first touch', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} camera-controls interaction-prompt="auto"></fourdvt-viewer>`);
  await at.viewer((v) => v.play()); // by the page, not by the visitor
  await at.viewer((v) => v.pause());
  await at.part('prompt').waitFor({ state: 'visible', timeout: kPatienceMs });
  assert.match(await at.part('prompt').textContent(), /Drag/);
  await at.page.screenshot({ path: join(outputFolder('controls'), 'prompt.png') });
  await at.page.mouse.click(200, 200);
  await at.part('prompt').waitFor({ state: 'hidden' });
  await at.page.waitForTimeout(3500);
  assert.equal(await at.part('prompt').isVisible(), false);
  await at.page.close();
});

test('pictures of what is shown: at its size, at another, from another side', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} camera-orbit="0deg 10deg 4m"></fourdvt-viewer>`);
  const seen = await at.viewer(async (v) => {
    const read = async (snapshot) => {
      const bitmap = await createImageBitmap(await v.toBlob(snapshot));
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext('2d');
      context.drawImage(bitmap, 0, 0);
      const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
      return { size: [bitmap.width, bitmap.height], sum: data.reduce((sum, value, i) => (sum + value * (i % 251)) % 1e9, 0) };
    };
    const own = await read({}), plain = await read(), turned = await read({ pose: '120deg 10deg 4m' }), parts = await read({ pose: { azimuth: 120 } });
    const url = await v.toDataURL({ width: 10, height: 20 });
    const refused = await v.toBlob({ pose: { azimuth: 'left' } }).catch((reason) => reason.name);
    return { own, plain, turned, parts, url: url.slice(0, 22), refused, box: v.getDimensions() };
  });
  assert.deepEqual(seen.own, seen.plain);
  assert.deepEqual(seen.own.size, [400, 533]);
  assert.deepEqual(seen.turned, seen.parts);
  assert.notEqual(seen.turned.sum, seen.plain.sum);
  assert.equal(seen.url, 'data:image/png;base64,');
  assert.equal(seen.refused, 'TypeError');
  assert.ok(seen.box.y > 1.4 && seen.box.y < 2.2, `${seen.box.y} m high`);
  await at.page.close();
});

test('keyboard alone: focus, play, turn, time; screen readers hear it', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} autoplay loop controls camera-controls></fourdvt-viewer>`);
  await settled(at);
  const focused = () => at.viewer((v) => v.shadowRoot.activeElement?.getAttribute('part'));
  const heard = (text) => at.until((text) => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('.live').textContent === text, text).catch(async (problem) => {
    const state = await at.viewer((v) => [v.shadowRoot.querySelector('.live').textContent, v.paused, v.heading, v.getCameraOrbit(), v.matches(':focus-within')]);
    throw new Error(`"${text}" is not heard but ${JSON.stringify(state)}`, { cause: problem });
  });
  await at.page.keyboard.press('Tab');
  assert.equal(await focused(), 'stage');
  assert.deepEqual(await at.viewer((v) => { const { role, ariaLabel } = v.shadowRoot.activeElement; return [role, ariaLabel]; }), ['application', 'A man walks']);
  await at.page.keyboard.press('Space');
  await heard('Paused');
  for (let i = 0; i < 9; ++i) await at.page.keyboard.press('ArrowRight');
  await heard('Seen from the left');
  for (let i = 0; i < 3; ++i) await at.page.keyboard.press('ArrowUp');
  await heard('Seen from the left, from above');
  await at.page.screenshot({ path: join(outputFolder('controls'), 'focus.png') });
  await at.page.keyboard.press('Tab');
  assert.equal(await focused(), 'play-toggle');
  await at.page.keyboard.press('Enter');
  await heard('Playing walk');
  await at.page.keyboard.press('Space');
  await heard('Paused');
  await at.page.keyboard.press('Tab');
  assert.equal(await focused(), 'time');
  await at.viewer((v) => { v.currentTime = v.duration / 2; }); // from the first place of the slider Home would change nothing
  await at.until(() => Number(document.querySelector('fourdvt-viewer').shadowRoot.querySelector('[part=time]').value) > 0);
  await at.page.keyboard.press('Home');
  const shown = (frame) => at.until((frame) => { const v = document.querySelector('fourdvt-viewer'); return v.frame === frame && !v.seeking; }, frame);
  await shown(0);
  for (const frame of [1, 2, 1]) {
    await at.page.keyboard.press(frame === 1 && (await at.viewer((v) => v.frame)) === 2 ? 'ArrowLeft' : 'ArrowRight');
    await shown(frame);
  }
  await at.page.keyboard.press('Tab');
  assert.equal(await focused(), 'mute');
  await at.page.keyboard.press('Enter');
  assert.deepEqual(await at.viewer((v) => [v.muted, v.shadowRoot.activeElement.ariaLabel]), [true, 'Unmute']);
  await at.page.keyboard.press('Tab');
  assert.equal(await focused(), 'fullscreen');
  await at.page.keyboard.press('Tab');
  assert.equal(await at.page.evaluate(() => document.activeElement === document.body), true, 'the focus is not caught');
  await at.page.close();
});

test('the side that the view turns to is announced, however slowly pictures come', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} camera-controls></fourdvt-viewer>`);
  await at.viewer((v) => v.play());
  await settled(at);
  await at.page.keyboard.press('Tab');
  await at.page.evaluate(() => { globalThis.requestAnimationFrame = () => 0; }); // no further picture
  for (let i = 0; i < 9; ++i) await at.page.keyboard.press('ArrowRight');
  await at.until(() => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('.live').textContent.startsWith('Seen'));
  const texts = await at.viewer((v) => [v.shadowRoot.querySelector('.live').textContent, Math.round(v.getCameraOrbit().azimuth)]);
  assert.equal(texts[0], 'Seen from the left');
  assert.ok(texts[1] < 90, `${texts[1]}°: the view has not arrived`);
  await at.page.close();
});

test('a ring frames the viewer where Tab brought the focus, not where a script or a pointer did', async () => {
  const at = await open(`<button>before</button><fourdvt-viewer ${kSource} camera-controls motion-controls></fourdvt-viewer>`);
  const hasRing = () => at.viewer((v) => v.matches(':focus') && getComputedStyle(v.shadowRoot.querySelector('.stage'), '::after').boxShadow !== 'none');
  await at.viewer((v) => v.focus());
  assert.equal(await hasRing(), false, 'a script, before any key');
  await at.page.keyboard.press('ArrowUp');
  assert.equal(await hasRing(), false, 'keys that steer');
  await at.page.keyboard.press('Shift+Tab');
  await at.page.keyboard.press('Tab');
  assert.equal(await at.viewer((v) => v.shadowRoot.activeElement?.getAttribute('part')), 'stage');
  assert.equal(await hasRing(), true, 'Tab');
  await at.page.click('button');
  await at.viewer((v) => v.focus());
  assert.equal(await hasRing(), false, 'a script, after a click');
  await at.page.close();
});

test('the button of a viewer lies in its corner, inside of the edges, and large enough for a finger', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} autoplay loop></fourdvt-viewer>`);
  await settled(at);
  const [button, viewer] = [await at.part('play-toggle').boundingBox(), await at.page.locator('fourdvt-viewer').boundingBox()];
  assert.ok(Math.min(button.width, button.height) >= 44, JSON.stringify(button));
  const margins = [viewer.x + viewer.width - button.x - button.width, viewer.y + viewer.height - button.y - button.height];
  assert.ok(margins.every((margin) => margin >= 8 && margin <= 20), `${margins} px from the edges`);
  await at.page.close();
});

test('a viewer that nothing can be done with takes no focus', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} controls="none"></fourdvt-viewer><button>next</button>`);
  assert.equal(await at.viewer((v) => v.shadowRoot.querySelector('.stage').role), 'img');
  await at.viewer((v) => v.play()); // else there is a play button
  await at.until(() => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('.play').hidden);
  await at.page.keyboard.press('Tab');
  assert.equal(await at.page.evaluate(() => document.activeElement.textContent), 'next');
  await at.page.close();
});

test('texts are in the language of the page, of the element, or as the page has them', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} autoplay loop controls></fourdvt-viewer>`, { lang: 'de-CH' });
  await settled(at);
  assert.equal(await at.part('play-toggle').getAttribute('aria-label'), 'Anhalten');
  assert.equal(await at.part('play').getAttribute('aria-label'), 'Abspielen');
  await at.viewer((v) => v.setAttribute('lang', 'en'));
  assert.equal(await at.part('play-toggle').getAttribute('aria-label'), 'Pause');
  await at.viewer((v) => {
    v.constructor.strings.eo = { pause: 'Paŭzi' };
    v.setAttribute('lang', 'eo');
  });
  assert.equal(await at.part('play-toggle').getAttribute('aria-label'), 'Paŭzi');
  assert.equal(await at.part('time').getAttribute('aria-label'), 'Time', 'English where there is no other text');
  await at.page.close();
});

test('a hotspot stays on its vertex, and knows when the surface turns away', async () => {
  const at = await open(`<fourdvt-viewer ${kSource} camera-orbit="0deg 10deg 4m"><button slot="hotspot-1" id="spot">!</button></fourdvt-viewer>`);
  await at.part('controls').waitFor({ state: 'attached', timeout: kPatienceMs });
  const centre = () => at.page.evaluate(() => { const { left, top, width, height } = document.getElementById('spot').getBoundingClientRect(); return [left + width / 2, top + height / 2]; });
  const vertex = await at.viewer((v) => v.vertexFromPoint(200, 200));
  assert.ok(Number.isInteger(vertex));
  assert.equal(await at.viewer((v) => v.vertexFromPoint(2, 2)), null, 'beside the character');
  assert.equal(await at.page.locator('#spot').isVisible(), false, 'it has no vertex yet');
  await at.page.evaluate((vertex) => { document.getElementById('spot').dataset.vertex = vertex; }, vertex);
  await at.page.locator('#spot').waitFor({ state: 'visible' });
  const [x, y] = await centre();
  assert.ok(Math.hypot(x - 200, y - 200) < 12, `it is at ${x}, ${y}`);
  assert.equal(await at.page.locator('#spot').getAttribute('data-visible'), '');
  await at.page.screenshot({ path: join(outputFolder('controls'), 'hotspot.png') });
  await at.viewer((v) => { v.setAttribute('camera-orbit', '180deg 10deg 4m'); v.jumpCameraToGoal(); });
  await at.until(() => !document.getElementById('spot').hasAttribute('data-visible'));
  await at.viewer((v) => { v.setAttribute('camera-orbit', '0deg 10deg 4m'); v.jumpCameraToGoal(); v.seekFrame(10); });
  await at.until(() => document.querySelector('fourdvt-viewer').frame === 10 && document.getElementById('spot').hasAttribute('data-visible'));
  const moved = await centre(), again = await at.viewer((v, p) => v.vertexFromPoint(p[0], p[1]), moved);
  assert.ok(again !== null, 'it is on the surface of the frame that is shown');
  await at.page.close();
});

test('chapters are marked, named and in textTracks; those of another motion are not; a file that is missing is named', async () => {
  const warnings = [];
  const at = await open(`<fourdvt-viewer ${kSource} controls><track kind="chapters" src="walk.vtt" data-sequence="walk" srclang="en" label="Chapters">
    <track kind="chapters" src="pickup.vtt" data-sequence="pickup"><track kind="chapters" src="none.vtt"></fourdvt-viewer>`, {
    prepare: async (page) => {
      page.on('console', (message) => warnings.push(message.text()));
      const files = { walk: '00:00.000 --> 00:00.500\nLeft foot\n\n00:00.500 --> 00:01.120\nRight foot', pickup: '00:00.000 --> 00:01.600\nBends down' };
      await page.route('**/*.vtt', (route) => {
        const cues = files[/(\w+)\.vtt/.exec(route.request().url())[1]];
        return cues ? route.fulfill({ contentType: 'text/vtt', body: `WEBVTT\n\n${cues}\n` }) : route.fulfill({ status: 404 });
      });
    },
  });
  await settled(at);
  const text = (wanted) => at.until((wanted) => document.querySelector('fourdvt-viewer').shadowRoot.querySelector('[part=chapter]').textContent === wanted, wanted);
  await text('Left foot');
  assert.deepEqual(await at.page.evaluate(() => [...document.querySelector('fourdvt-viewer').shadowRoot.querySelectorAll('datalist option')].map(({ value, label }) => [value, label])),
    [['0', 'Left foot'], ['0.5', 'Right foot']]);
  assert.equal(await at.part('time').getAttribute('aria-valuetext'), '0:00 of 0:01, Left foot');
  await at.viewer((v) => { v.currentTime = 0.8; });
  await text('Right foot');
  await at.page.screenshot({ path: join(outputFolder('controls'), 'chapters.png') });
  assert.deepEqual(await at.viewer((v) => [...v.textTracks].map(({ kind, label, cues }) => [kind, label, cues?.length ?? 0])),
    [['chapters', 'Chapters', 2], ['chapters', '', 1], ['chapters', '', 0]]);
  await at.viewer((v) => { v.sequence = 'pickup'; });
  await text('Bends down');
  await at.viewer((v) => v.querySelector('[data-sequence=pickup]').remove());
  await text('');
  assert.ok(warnings.some((line) => /none\.vtt: the chapters cannot be loaded/.test(line)), warnings.join('\n'));
  await at.page.close();
});
