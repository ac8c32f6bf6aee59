// SPDX-License-Identifier: Apache-2.0
// The joystick of touch screens, with touches emulated by Chromium: it steers, it stops on release, and touches beside
// it turn the camera instead.
import assert from 'node:assert/strict';
import { after, before, beforeEach, test } from 'node:test';

import { environment, kPatienceMs, launch, openPage, waitForEvent } from './harness.mjs';
import { serve } from './server.mjs';

const kViewport = { width: 400, height: 380 };  // small, because it is drawn in software
const kDegPerHeight = 240;                    // of a drag
const kReach = 0.6;                           // of the knob, in radii
const kBeside = [200, 100];
const kAhead_deg = 60;                        // what is steered to is this far ahead

let server, browser, page, devtools, stick, speed, degPerPixel;
before(async () => {
  server = await serve(environment('SITE'));
  browser = await launch();
  page = await openPage(browser, { viewport: kViewport, hasTouch: true });
  await page.goto(`${server.url}steer.html`);
  await waitForEvent(page, 'canplay');
  await until(() => document.querySelector('fourdvt-viewer').parameters.length > 0);
  devtools = await page.context().newCDPSession(page);
  const known = await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.removeAttribute('camera-follow'); // the heading would turn the orbit
    for (const over of document.querySelectorAll('.hud, .keys')) over.style.visibility = 'hidden'; // lies over the viewer
    viewer.scene = [];
    viewer.renderOptions = { groundShadow: false, samples: 1 };
    globalThis.heard = { values: [], cameraChanges: 0, liftedAt: NaN };
    viewer.addEventListener('parameterchange', (e) => globalThis.heard.values.push(e.detail.value));
    viewer.addEventListener('camera-change', () => { ++globalThis.heard.cameraChanges; });
    viewer.shadowRoot.addEventListener('pointerup', () => { globalThis.heard.liftedAt = viewer.heading; }, { capture: true });
    const { x, y, width } = viewer.shadowRoot.querySelector('[part=joystick]').getBoundingClientRect();
    return { stick: { x: x + width / 2, y: y + width / 2, radius: width / 2 }, speed: viewer.parameters[0], height: viewer.clientHeight };
  });
  ({ stick, speed } = known);
  degPerPixel = kDegPerHeight / known.height;
});
after(async () => {
  await browser?.close();
  await server?.close();
});
// Slow and straight on from the middle, seen from the front.
beforeEach(async () => {
  await page.evaluate((low) => {
    const viewer = document.querySelector('fourdvt-viewer');
    viewer.placement = { x: 0, z: 0, heading: 0 };
    viewer.heading = 0;
    viewer.setParameter('speed_mps', low, true);
    viewer.setAttribute('camera-orbit', '0deg 14deg 5.2m');
    viewer.setAttribute('camera-target', '0m 0.9m 0m'); // sets the orbit again even if its text is the same
    viewer.removeAttribute('camera-target');
    viewer.jumpCameraToGoal();
    Object.assign(globalThis.heard, { values: [], cameraChanges: 0, liftedAt: NaN });
  }, speed.min);
  await pictures(2);
});

const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: kPatienceMs, polling: 20 });
const pictures = (count) => page.evaluate(async (count) => {
  for (let i = 0; i < count; ++i) await new Promise((next) => requestAnimationFrame(next));
}, count);
// What the viewer says of itself.
const state = () => page.evaluate(() => {
  const viewer = document.querySelector('fourdvt-viewer');
  const { transform } = viewer.shadowRoot.querySelector('[part=knob]').style;
  return { heading: viewer.heading, speed: viewer.getParameter('speed_mps'), state: viewer.state, orbit: viewer.getCameraOrbit(),
    knob: /^translate\((.+)px, (.+)px\)$/.exec(transform)?.slice(1).map(Number) ?? null, ...globalThis.heard };
});

// Fingers: { id, x, y } in pixels of the page; an end or a cancel names those that it concerns.
const touch = (type, ...fingers) => devtools.send('Input.dispatchTouchEvent', { type, touchPoints: fingers });
// A finger on the joystick, in radii from its middle: right and down.
const onStick = (x, y, id = 0) => ({ id, x: stick.x + x * stick.radius, y: stick.y + y * stick.radius });
const beside = (dx, id) => ({ id, x: kBeside[0] + dx, y: kBeside[1] });
const near = (seen, wanted, by, what) => assert.ok(Math.abs(seen - wanted) <= by, `${what}: ${seen}, not ${wanted}`);
const at = (share) => speed.min + share * (speed.max - speed.min);

const wished = (value) => until((value) => Math.abs(globalThis.heard.values.at(-1) - value) < 1e-3, value);
const headingBelow = (degrees) => until((degrees) => document.querySelector('fourdvt-viewer').heading < degrees, degrees);
const headingAbove = (degrees) => until((degrees) => document.querySelector('fourdvt-viewer').heading > degrees, degrees);

const knobBack = () => until(() => !document.querySelector('fourdvt-viewer').shadowRoot.querySelector('[part=knob]').style.transform);

// The knob is back; another speed stays as it is set; the heading comes to rest. Returns the heading.
async function assertLetGo() {
  await knobBack();
  await page.evaluate((value) => document.querySelector('fourdvt-viewer').setParameter('speed_mps', value, true), at(0.3));
  const { values } = await state();
  await until(() => {
    const { heading } = document.querySelector('fourdvt-viewer');
    const now = performance.now();
    if (globalThis.rest?.heading !== heading) globalThis.rest = { heading, since: now };
    return now - globalThis.rest.since > 250;
  });
  const rest = await state();
  assert.deepEqual(rest.values, values, 'nothing sets the speed any more');
  near(rest.speed, at(0.3), 1e-3, 'speed');
  return rest.heading;
}

// It comes with the player's second part.
const stickIsThere = (on) => on.waitForFunction(() => document.querySelector('fourdvt-viewer').shadowRoot?.querySelector('[part=joystick]'), null, { timeout: kPatienceMs });

test('touch screens have the joystick, where motion is steered; a mouse has none', async () => {
  const display = (on) => on.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    const shown = () => getComputedStyle(viewer.shadowRoot.querySelector('[part=joystick]')).display;
    const steered = shown();
    viewer.removeAttribute('motion-controls');
    const watched = shown();
    viewer.setAttribute('motion-controls', '');
    return [steered, watched];
  });
  assert.deepEqual(await display(page), ['block', 'none']);
  const desk = await openPage(browser, { viewport: kViewport });
  await desk.goto(`${server.url}steer.html`);
  await stickIsThere(desk);
  assert.deepEqual(await display(desk), ['none', 'none']);
  await desk.close();
});

test('up and down are the speed, from one end of its range to the other', async () => {
  await touch('touchStart', onStick(0, 0));
  await pictures(4);
  const down = await state();
  assert.deepEqual([down.knob, down.values], [[0, 0], []], 'a finger that rests changes nothing');
  for (const [y, share, knob] of [[-1, 1, -1], [-3, 1, -1], [-0.5, 0.75, -0.5], [1, 0, 1], [0.2, 0.4, 0.2]]) {
    await touch('touchMove', onStick(0.1, y)); // hardly to the right: straight on
    await wished(at(Math.abs(y) > 1 ? share : (1 - y / Math.max(1, Math.hypot(0.1, y))) / 2));
    near((await state()).knob[1], kReach * stick.radius * knob, 1, `knob at ${y}`);
  }
  await until((value) => Math.abs(document.querySelector('fourdvt-viewer').getParameter('speed_mps') - value) < 0.01, at(0.4));
  near((await state()).heading, 0, 0.5, 'heading');
  await touch('touchEnd', onStick(0.1, 0.2));
  await assertLetGo();
});

test('right and left turn, until the finger is lifted', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(1, 0));
  await until(() => Math.abs(document.querySelector('fourdvt-viewer').heading) > 20);
  assert.ok((await state()).heading < 0, 'to the right');
  await headingBelow(-70);
  await touch('touchMove', onStick(-1, 0));
  await headingAbove(20);
  await touch('touchEnd', onStick(-1, 0));
  await until(() => !Number.isNaN(globalThis.heard.liftedAt));
  const { liftedAt } = await state(), rest = await assertLetGo();
  console.log(`lifted at ${liftedAt.toFixed(1)} degrees, comes to rest at ${rest.toFixed(1)}`);
  assert.ok(rest >= liftedAt && rest < liftedAt + kAhead_deg + 1, `lifted at ${liftedAt}, comes to rest at ${rest}`);
});

test('a cancelled touch lets go as well', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(0.6, -0.8));
  await wished(at(0.9));
  await headingBelow(-10);
  await touch('touchCancel');
  await knobBack();
  const cancelled = await state();
  assert.ok((await assertLetGo()) > cancelled.heading - kAhead_deg - 1);
  assert.equal(cancelled.state, 'locomotion');
});

test('a drag beside it turns the camera and steers nothing', async () => {
  await touch('touchStart', beside(0, 3));
  for (const dx of [40, 80, 120]) await touch('touchMove', beside(dx, 3));
  await touch('touchEnd', beside(120, 3));
  await until((wanted) => Math.abs(document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth - wanted) < 0.1, -120 * degPerPixel);
  const seen = await state();
  assert.ok(seen.cameraChanges >= 2, `${seen.cameraChanges} camera changes`);
  assert.deepEqual([seen.values, seen.knob, seen.heading], [[], null, 0]);
});

test('a second finger turns the camera while the first steers; each is lifted alone', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(0, -0.5));
  await wished(at(0.75));
  assert.equal((await state()).cameraChanges, 0, 'steering does not turn the camera');
  await touch('touchStart', onStick(0, -0.5), beside(0, 5));
  for (const dx of [50, 100]) await touch('touchMove', onStick(0, -0.5), beside(dx, 5));
  await until((wanted) => Math.abs(document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth - wanted) < 0.1, -100 * degPerPixel);
  const both = await state();
  near(both.values.at(-1), at(0.75), 1e-3, 'speed wished');
  near(both.heading, 0, 0.5, 'heading');
  near(both.knob[1], -0.5 * kReach * stick.radius, 1, 'knob');
  near(both.orbit.distance, 5.2, 0.01, 'distance: no pinch with the finger on the joystick');
  await touch('touchEnd', beside(100, 5));
  await touch('touchMove', onStick(0, 0.5));
  await wished(at(0.25));
  await touch('touchStart', onStick(0, 0.5), beside(0, 6));
  await touch('touchEnd', onStick(0, 0.5));
  await knobBack();
  await touch('touchMove', beside(-100, 6));
  await until(() => Math.abs(document.querySelector('fourdvt-viewer').getCameraOrbit().azimuth) < 0.1);
  await touch('touchEnd', beside(-100, 6));
  near(await assertLetGo(), 0, 0.5, 'heading');
});

test('a second finger on the joystick neither takes it over nor lets it go', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(0, -0.5));
  await wished(at(0.75));
  await touch('touchStart', onStick(0, -0.5), onStick(0, 0.5, 8));
  await touch('touchMove', onStick(0, -0.5), onStick(0.9, 0.3, 8));
  await pictures(4);
  const seen = await state();
  near(seen.knob[1], -0.5 * kReach * stick.radius, 1, 'knob');
  near(seen.values.at(-1), at(0.75), 1e-3, 'speed wished');
  await touch('touchEnd', onStick(0.9, 0.3, 8));
  await touch('touchMove', onStick(0, -0.9));
  await wished(at(0.95));
  near((await state()).heading, 0, 0.5, 'heading');
  await touch('touchEnd', onStick(0, -0.9));
  await assertLetGo();
});

test('a tap acts; one that is cancelled or moved does not', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchCancel');
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(0, -0.5));
  await touch('touchMove', onStick(0, 0));
  await touch('touchEnd', onStick(0, 0));
  await pictures(4);
  assert.equal((await state()).state, 'locomotion');
  await touch('touchStart', onStick(0, 0));
  await touch('touchEnd', onStick(0, 0));
  await until(() => document.querySelector('fourdvt-viewer').state === 'pickup');
  assert.equal((await state()).knob, null);
});

test('the character does not turn on when the finger is lifted', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(1, 0));
  await headingBelow(-30);
  await touch('touchEnd', onStick(1, 0));
  await until(() => !Number.isNaN(globalThis.heard.liftedAt));
  near(await assertLetGo(), (await state()).liftedAt, 15, 'heading at rest');
});

test('in a scaled viewer the knob goes to the edge of the joystick, too', async () => {
  const centre = await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    Object.assign(viewer.style, { transform: 'scale(.5)', transformOrigin: '0 0' });
    const { x, y, width } = viewer.shadowRoot.querySelector('[part=joystick]').getBoundingClientRect();
    return { id: 0, x: x + width / 2, y: y + width / 2 };
  });
  await touch('touchStart', centre);
  await touch('touchMove', { ...centre, y: centre.y - stick.radius / 2 });
  await wished(speed.max);
  near((await state()).knob[1], -kReach * stick.radius, 1, 'knob');
  await touch('touchEnd', { ...centre, y: centre.y - stick.radius / 2 });
  await page.evaluate(() => { document.querySelector('fourdvt-viewer').style.transform = ''; });
  await assertLetGo();
});

test('a viewer that is taken out and put back while the joystick is held has its knob in the middle', async () => {
  await touch('touchStart', onStick(0, 0));
  await touch('touchMove', onStick(0, -0.8));
  await wished(at(0.9));
  await page.evaluate(async () => {
    const viewer = document.querySelector('fourdvt-viewer'), parent = viewer.parentElement;
    viewer.remove();
    await Promise.resolve(); // it might be a move
    parent.prepend(viewer);
  });
  await touch('touchEnd', onStick(0, -0.8));
  await stickIsThere(page);
  assert.equal((await state()).knob, null);
});

test('no console errors, no unhandled rejections', () => assert.deepEqual(page.troubles, []));
