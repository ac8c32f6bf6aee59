// SPDX-License-Identifier: Apache-2.0
// Rates, delays and bandwidths of a live system; its tolerance against rate and quality; a machine that loses a core.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, readdirSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { median } from './latency.mjs';
import { pause, watch } from './processes.mjs';
import { Receiver } from './receiver.mjs';
import { kLab, kSample, stage } from './stages.mjs';
import { figuresOf, folderOf, withSystem } from './system.mjs';

const kViewer = { width: 320, height: 240 };
const kTolerances_px = [0.5, 1, 2, 4, 8, 16];
const kSizes = [{ size: '320x240', fps: 25 }, { size: '640x480', fps: 12 }];

const rate = (name, title, size, fps, more = {}, options = []) => ({
  name, title, kind: 'rate', size, fps, drawn: !!more.viewer,
  measure: (work) => withSystem(stage(work, size, fps), { options }, (system) => figuresOf(system, folderOf(work, name), more)),
});

// Replaces the capture's surfaces by the received ones, and scores them at its held-out cameras.
function quality(work, name, surfaces) {
  const folder = folderOf(work, `${name}-capture`);
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(join(folder, 'run'), { recursive: true });
  for (const entry of ['background', 'cameras', 'cameras_test']) symlinkSync(join(kSample, entry), join(folder, entry));
  for (const entry of readdirSync(join(kSample, 'run'))) if (entry !== 'mesh') symlinkSync(join(kSample, 'run', entry), join(folder, 'run', entry));
  symlinkSync(surfaces, join(folder, 'run/mesh'));
  const { classes, mesh, ...capture } = JSON.parse(readFileSync(join(kSample, 'capture.json'), 'utf8'));
  const { mesh: given, ...run } = capture.sequences.find((sequence) => sequence.name === 'run');
  writeFileSync(join(folder, 'capture.json'), JSON.stringify({ ...capture, topology: 'per-frame', sequences: [run] }));
  const columns = execFileSync(kLab, ['surfaces', folder, '--reference', kSample], { encoding: 'utf8' }).trim().split('\n').at(-1).trim().split(/\s+/).slice(1).map(Number);
  return { views: columns[0], psnr_db: columns[1], ssim: columns[2], to_given_mm: columns[4], iou: columns[10] };
}

const tolerance = ({ size, fps }, px) => {
  const name = `tolerance-${size}-${px}`;
  return {
    name, title: `${size}, ${px} px`, kind: 'tolerance', size, px,
    measure: (work) => withSystem(stage(work, size, fps), { options: ['--tolerance', String(px)] }, async (system) => {
      const surfaces = folderOf(work, `${name}-surfaces`);
      rmSync(surfaces, { recursive: true, force: true });
      const figures = await figuresOf(system, folderOf(work, name), { seconds: 10, surfaces });
      return { ...figures, ...quality(work, name, surfaces) };
    }),
  };
};

const kLosses = 5;

// Runs all programs of the system on one core for ten seconds. Returns time spans and their medians.
const loseCore = (work) => withSystem(stage(work, '640x480', 12), {}, async (system) => {
  const receiver = await Receiver.open(system.browser, system.server);
  await pause(10_000);
  await receiver.clear();
  const watching = watch(system.server, 500), beganMs = Date.now();
  const all = [process.pid, system.server.pid, ...system.cameras.map(({ pid }) => pid), ...browsers()];
  const allow = (cores) => { for (const pid of all) try { execFileSync('taskset', ['-a', '-cp', cores, String(pid)], { stdio: 'ignore' }); } catch { /* it has ended */ } };
  await pause(10_000);
  allow('0');
  const lostMs = Date.now();
  await pause(10_000);
  allow('0,1');
  const backMs = Date.now();
  await pause(15_000);
  const seen = await watching.stop(), { frames } = await receiver.times();
  const during = (from, to) => {
    const status = seen.filter(({ ms }) => ms >= from && ms < to).map((one) => one.status);
    return { hulls_per_s: frames.filter(({ ms }) => ms >= from && ms < to).length / ((to - from) / 1000), tolerance_px: median(status.map((s) => s.tolerance_px)), triangles: median(status.map((s) => s.triangles)), latency_ms: median(status.map((s) => s.latency_ms)), hull_ms: median(status.map((s) => s.hull_ms)) };
  };
  return [
    { title: 'before, 10 s', ...during(beganMs, lostMs) },
    { title: 'on one core, first 3 s', ...during(lostMs, lostMs + 3000) },
    { title: 'on one core, the rest', ...during(lostMs + 3000, backMs) },
    { title: 'both again, first 5 s', ...during(backMs, backMs + 5000) },
    { title: 'both again, after', ...during(backMs + 5000, backMs + 15_000) },
  ];
});

const loss = {
  name: 'core-lost', title: 'a core is taken away for ten seconds', kind: 'loss', size: '640x480', fps: 12,
  async measure(work) {
    const runs = [];
    for (let i = 0; i < kLosses; ++i) runs.push(await loseCore(work));
    const of = (span, field) => runs.map((run) => run[span][field]);
    return { runs: kLosses, spans: runs[0].map(({ title }, span) => ({ title, lowest_hulls_per_s: Math.min(...of(span, 'hulls_per_s')),
      ...Object.fromEntries(['hulls_per_s', 'tolerance_px', 'triangles', 'hull_ms', 'latency_ms'].map((field) => [field, median(of(span, field))])) })) };
  },
};

// Chromium's processes, to which Playwright gives no handle.
function browsers() {
  return readdirSync('/proc').filter((name) => /^\d+$/.test(name)).filter((pid) => {
    try {
      return /chrom/.test(readFileSync(`/proc/${pid}/comm`, 'utf8'));
    } catch {
      return false;
    }
  });
}

export const rates = [
  rate('small', '320×240', '320x240', 25),
  rate('small-thousand', '320×240, tolerance 1.5 px', '320x240', 25, {}, ['--tolerance', '1.5']),
  rate('small-drawn', '320×240, drawn by the page', '320x240', 25, { viewer: kViewer }),
  rate('large', '640×480', '640x480', 12),
  rate('large-fast', '640×480, 25 wanted', '640x480', 25),
  rate('large-drawn', '640×480, drawn by the page', '640x480', 12, { viewer: kViewer }),
  ...kSizes.flatMap((one) => kTolerances_px.map((px) => tolerance(one, px))),
  loss,
];
