// SPDX-License-Identifier: Apache-2.0
// Native against browser: same character, frame, camera and size give the same picture.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { environment, launch, openPage, outputFolder, readCanvas, renderNative, showPose, waitForEvent, writePicture } from './harness.mjs';
import { serve } from './server.mjs';
import { ssim } from './ssim.mjs';

const kPoses = [
  { sequence: 'walk', frame: 7, azimuth: 30, elevation: 10, distance: 4.2 },
  { sequence: 'walk', frame: 20, azimuth: -110, elevation: 0, distance: 3.6 },
  { sequence: 'run', frame: 12, azimuth: 165, elevation: 25, distance: 4.2 },
  { sequence: 'pickup', frame: 18, azimuth: 75, elevation: 5, distance: 4.8 },
];
const kSsim = 0.99;

let server, browser, page;
before(async () => {
  server = await serve(environment('SITE'));
  browser = await launch();
  page = await openPage(browser);
  await page.goto(server.url);
  await waitForEvent(page, 'canplay');
  await page.addStyleTag({ url: `${server.url}site.css` });
  await page.evaluate(() => {
    const viewer = document.querySelector('fourdvt-viewer');
    Object.assign(viewer.style, { position: 'fixed', inset: 'auto', left: '0', top: '0', width: '720px', height: '960px' });
  });
  await page.waitForFunction(() => {
    const canvas = document.querySelector('fourdvt-viewer').shadowRoot.querySelector('canvas');
    return canvas.width === 720 && canvas.height === 960;
  });
});
after(async () => {
  await browser?.close();
  await server?.close();
});

for (const pose of kPoses) {
  const name = `${pose.sequence}-${pose.frame}-${pose.azimuth}`;
  test(`native and browser agree: ${name}`, async () => {
    const out = outputFolder('parity');
    await showPose(page, pose);
    const shown = await readCanvas(page);
    writePicture(join(out, `${name}-browser.png`), shown);
    const native = await renderNative(environment('BIN'), environment('CHARACTER'), pose, shown.width, shown.height,
      join(out, `${name}-native.png`));
    const { all, foreground } = ssim(shown, native);
    console.log(`${name}: SSIM ${all.toFixed(4)} whole picture, ${foreground.toFixed(4)} on the silhouettes`);
    assert.ok(foreground >= kSsim, `SSIM ${foreground.toFixed(4)} on the silhouettes is below ${kSsim}; pictures in ${out}`);
  });
}
