// SPDX-License-Identifier: Apache-2.0
// Rows of site/measured/phones.mjs: { name, kind, title, measure({ root, site, before }) }. before: site of an earlier
// version; rows that compare with it are skipped without it.
import { execFile } from 'node:child_process';
import { mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';

import { launch, launchFirefox, openPage } from '../../web/harness.mjs';
import { kNoWebCodecs, openOnPath, playOnPath, servePlain } from '../../web/play_path.mjs';
import { measureDecoding } from './decoding.mjs';
import { measurePortfolio, measurePressure } from './portfolio.mjs';
import { measureTasks } from './tasks.mjs';
import { measureUploads } from './uploads.mjs';

const kFrames = 2000;
const viewport = { width: 240, height: 280 };

const spread = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const at = (share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? null;
  return { count: sorted.length, median: at(0.5), most95: at(0.95), worst: at(1) };
};

async function measurePath(site, path, preferences) {
  const server = await servePlain(site);
  const browser = preferences ? await launchFirefox(preferences) : await launch();
  try {
    const page = preferences ? await browser.newPage({ viewport }) : await openPage(browser, { viewport }, 'auto');
    await openOnPath(page, server, path);
    const { errors, frames, checked, mismatches, late, path: used, ...times } = await playOnPath(page, kFrames);
    if (errors.length) throw new Error(JSON.stringify(errors));
    return { frames, checked, mismatches, late, path: used, ...Object.fromEntries(Object.entries(times).map(([name, list]) => [name, spread(list)])) };
  } finally {
    await browser.close();
    await server.close();
  }
}

const pathRow = (name, title, path, preferences = null) => ({ name: `path-${name}`, kind: 'path', title, measure: ({ site }) => measurePath(site, path, preferences) });
const spreads = async (site, worker) => Object.fromEntries(Object.entries(await measureTasks(site, 8, worker)).map(([scene, list]) => [scene, spread(list)]));
const uploadRow = (path, quality) => ({ name: `uploads-${path}-${quality}`, kind: 'uploads', title: `${path}, ${quality === '0' ? 'lowest' : quality} rung`,
  measure: ({ site }) => measureUploads(site, path, quality) });

const after = [
  pathRow('chromium-i420', 'Chromium, VideoDecoder, planes', 'i420'),
  pathRow('chromium-rgba', 'Chromium, VideoDecoder, `texImage2D`', 'rgba'),
  pathRow('chromium-rgba-sub', 'Chromium, VideoDecoder, `texSubImage2D`', 'rgba-sub'),
  pathRow('chromium-video', 'Chromium, `<video>`', 'video'),
  pathRow('firefox-rgba', 'Firefox, VideoDecoder, `texImage2D`', 'rgba', {}),
  pathRow('firefox-video', 'Firefox without WebCodecs, `<video>`', '', kNoWebCodecs),
  { name: 'tasks', kind: 'tasks', title: 'now', measure: ({ site }) => spreads(site, true) },
  { name: 'tasks-page', kind: 'tasks', title: 'now, without the worker', measure: ({ site }) => spreads(site, false) },
  ...[24, 100].map((count) => ({ name: `portfolio-${count}`, kind: 'portfolio', title: `${count} viewers`, measure: ({ site }) => measurePortfolio(site, count) })),
  { name: 'portfolio-phone', kind: 'pressure', title: '24 viewers', measure: ({ site }) => measurePressure(site, 24) },
  ...['i420', 'rgba', 'video'].flatMap((path) => ['0', 'highest'].map((quality) => uploadRow(path, quality))),
];

// Rows of the earlier version, measured by the same programs.
const before = after.filter(({ name }) => name === 'tasks' || name === 'portfolio-24' || /^uploads-(i420|rgba)-/.test(name)).map((row) => ({
  ...row, name: `${row.name}-before`, before: true, measure: ({ before: site }) => row.measure({ site }),
}));

const endurance = { name: 'endurance', kind: 'endurance', title: 'after long use',
  async measure({ site }) {
    const out = join(mkdtempSync(join(tmpdir(), 'fourdvt-')), 'rows.json');
    await promisify(execFile)(process.execPath, [fileURLToPath(new URL('../endurance.mjs', import.meta.url)), site, '--out', out], { maxBuffer: 1 << 24 });
    return { rows: JSON.parse(readFileSync(out, 'utf8')) };
  } };

const decoding = { name: 'decoding', kind: 'decoding', title: 'decoding in a page',
  async measure({ site }) {
    const motions = await measureDecoding(site);
    for (const places of Object.values(motions)) for (const place of Object.values(places)) place.later = spread(place.later);
    return { motions };
  } };

// Benches of the release build, with their output.
const bench = (name, title, words) => ({ name: `bench-${name}`, kind: 'bench', title, async measure({ root }) {
  const program = join(root, 'build/release/tests/bench', `bench_${name}`);
  const { stdout } = await promisify(execFile)(program, words.map((word) => word.replace('ROOT', root)), { maxBuffer: 1 << 24 });
  return { command: [`bench_${name}`, ...words.map((word) => word.replace('ROOT/', ''))].join(' '), text: stdout.trimEnd() };
} });

export const rows = [...after, ...before, endurance, decoding,
  bench('frame_cost', 'Targets, vertices and draw times', ['ROOT/build/character', '40']), bench('class_frame', 'Decoding geometry', ['ROOT/build/character'])];
