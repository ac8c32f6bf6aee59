// SPDX-License-Identifier: Apache-2.0
// character.gltf is plain, valid glTF: the Khronos validator has no errors, three.js draws the still in its colours, for characters from layers and from cameras.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { environment, kFovDeg, kPatienceMs, launch, openPage, outputFolder, renderNative, requireFromWeb, writePicture } from './harness.mjs';
import { serve } from './server.mjs';
import { coverage, textureContrast } from './ssim.mjs';

const kPose = { azimuth: 25, elevation: 8, distance: 4.2 };
const kWidth = 480, kHeight = 640;

// Colours of vertices are coarser than a texture.
const kCharacters = [
  { name: 'layers', from: environment('CHARACTER'), minContrast: 0.5 },
  { name: 'cameras', from: join(environment('SITE'), 'cameras/hull'), minContrast: 0.4 },
];

let folder, server, browser;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'fourdvt-gltf-'));
  const web = dirname(requireFromWeb.resolve('./package.json'));
  const three = join(web, 'node_modules/three');
  mkdirSync(join(folder, 'draco'));
  cpSync(join(three, 'examples/jsm/libs/draco/gltf'), join(folder, 'draco'), { recursive: true });
  for (const { name, from } of kCharacters) cpSync(from, join(folder, name), { recursive: true });
  await requireFromWeb('esbuild').build({
    entryPoints: [fileURLToPath(new URL('three-still.js', import.meta.url))],
    outfile: join(folder, 'three-still.js'),
    bundle: true, format: 'esm', nodePaths: [join(web, 'node_modules')], logLevel: 'error',
  });
  writeFileSync(join(folder, 'index.html'),
    '<!doctype html><title>three</title><link rel="icon" href="data:,"><script type="module" src="three-still.js"></script>');
  server = await serve(folder);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

for (const { name, from } of kCharacters) {
  test(`${name}: the Khronos validator reports no errors`, async () => {
    const { validateBytes } = requireFromWeb('gltf-validator');
    const report = await validateBytes(new Uint8Array(readFileSync(join(from, 'character.gltf'))), {
      uri: 'character.gltf',
      maxIssues: 0,
      externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(from, decodeURIComponent(uri)))),
    });
    writeFileSync(join(outputFolder('gltf'), `${name}-validator.json`), JSON.stringify(report, null, 1));
    const { numErrors, numWarnings, messages } = report.issues;
    console.log(`${name}: glTF validator ${report.validatorVersion}: ${numErrors} errors, ${numWarnings} warnings, ` +
      `${report.info.totalTriangleCount} triangles`);
    assert.equal(numErrors, 0, JSON.stringify(messages, null, 1));
    assert.ok(report.info.extensionsUsed.includes('KHR_draco_mesh_compression'));
    assert.ok(report.info.resources.every((r) => (r.byteLength ?? r.image?.width) > 0), 'every resource was read');
  });
}

// Mean colour of what is covered.
function meanColour({ data }) {
  const sum = [0, 0, 0];
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 255) continue;
    ++count;
    for (let c = 0; c < 3; ++c) sum[c] += data[i + c];
  }
  return sum.map((v) => v / count);
}

for (const { name, from, minContrast } of kCharacters) {
  test(`${name}: three.js loads and draws the still in its colours`, async () => {
    const page = await openPage(browser, { viewport: { width: kWidth, height: kHeight } });
    await page.goto(server.url);
    await page.waitForFunction(() => globalThis.drawStill, null, { timeout: kPatienceMs });
    const { base64, center } = await page.evaluate(([url, options]) => globalThis.drawStill(url, options),
      [`${name}/character.gltf`, { ...kPose, width: kWidth, height: kHeight, fov: kFovDeg }]);
    const picture = { width: kWidth, height: kHeight, data: new Uint8Array(Buffer.from(base64, 'base64')) };
    const out = outputFolder('gltf');
    writePicture(join(out, `${name}-three.png`), picture);
    assert.deepEqual(page.troubles, []);

    const extension = JSON.parse(readFileSync(join(from, 'character.gltf'), 'utf8')).extensions.FOURDVT_layered_video_texture;
    const native = await renderNative(environment('BIN'), from,
      { sequence: extension.sequences[0].name, frame: 0, ...kPose }, kWidth, kHeight, join(out, `${name}-native.png`));
    const [theirs, ours] = [coverage(picture), coverage(native)];
    const contrast = textureContrast(picture), mean = meanColour(picture), expected = meanColour(native);
    console.log(`${name}: three.js covers ${(100 * theirs).toFixed(2)} % (ours ${(100 * ours).toFixed(2)} %), luma deviation ` +
      `${contrast.toFixed(1)} (ours ${textureContrast(native).toFixed(1)}), centre ${center.map((v) => v.toFixed(3))}, mean colour ` +
      `${mean.map((v) => v.toFixed(0))} (ours ${expected.map((v) => v.toFixed(0))})`);
    assert.ok(Math.abs(theirs - ours) <= 0.15 * ours, `covers ${theirs}, ours ${ours}`);
    assert.ok(contrast > minContrast * textureContrast(native), `the figure is nearly of one colour: luma deviation ${contrast}`);
    for (let c = 0; c < 3; ++c) assert.ok(Math.abs(mean[c] - expected[c]) < 12, `mean colour ${mean}, ours ${expected}`);
    await page.close();
  });
}
