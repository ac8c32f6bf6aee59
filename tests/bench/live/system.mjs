// SPDX-License-Identifier: Apache-2.0
// Runs a whole live system on this machine (server, six cameras and a browser) while `use` runs, and measures it.
import { rmSync } from 'node:fs';
import { join } from 'node:path';

import { launch } from '../../web/harness.mjs';
import { mean, median, quantile, rowsOf } from './latency.mjs';
import { LiveCamera, LiveServer, cpuSeconds, pause, until, watch } from './processes.mjs';
import { Receiver } from './receiver.mjs';
import { kCameras, readStream } from './stages.mjs';

const kWarmMs = 8000;

/** Runs `use(system)`; system: {stage, server, cameras, browser, add}. Stops or closes objects passed to `add`. */
export async function withSystem(stage, { options = [], cameras: names = kCameras } = {}, use) {
  const ends = [], add = (thing) => (ends.push(thing), thing);
  try {
    const server = add(await new LiveServer(stage.folder, { options }).listening());
    const cameras = names.map((name) => add(new LiveCamera(server, name)));
    const browser = add(await launch());
    const system = { stage, server, cameras, browser, add };
    if (!await until(async () => (await system.server.status()).cameras.filter(({ connected, pictures }) => connected && pictures > 0).length === names.length)) throw new Error(`cameras do not come: ${server.text}`);
    return await use(system);
  } finally {
    for (const end of ends.reverse()) await (end.stop ? end.stop() : end.close()).catch?.(() => undefined);
  }
}

const sum = (values) => values.reduce((total, v) => total + v, 0);

/** Measurements of a system over `seconds`, after it has settled. viewer: see Receiver. folder: for the recording. */
export async function figuresOf(system, folder, { seconds = 30, viewer, surfaces } = {}) {
  const { server, cameras, browser, stage } = system;
  const receiver = await Receiver.open(browser, server, { viewer });
  await until(async () => (await receiver.count()) > 0);
  await pause(kWarmMs);
  const cpu = () => [cpuSeconds(server.pid), sum(cameras.map(({ pid }) => cpuSeconds(pid)))];
  const before = await server.status(), cpuBefore = cpu(), beganMs = Date.now();
  await receiver.clear();
  const { stats: statsBefore } = await receiver.times();
  const watching = watch(server, 1000);
  await pause(1000 * seconds);
  const times = await receiver.times(), wall_s = (Date.now() - beganMs) / 1000, cpuAfter = cpu(), after = await server.status();
  const seen = (await watching.stop()).map(({ status }) => status);
  rmSync(folder, { recursive: true, force: true });
  const arrivals = await receiver.write(folder);
  await receiver.close();
  const recorded = readStream(folder, stage, surfaces);
  // Excludes frames that arrived after the measurement.
  const rows = rowsOf(recorded, arrivals, stage).filter(({ ms }) => ms <= beganMs + 1000 * wall_s);
  const lost = (field) => after[field] - before[field];
  const ofCameras = (field) => sum(after.cameras.map((camera) => camera[field])) - sum(before.cameras.map((camera) => camera[field]));
  const shown = sum(rows.map((row) => row.shown));
  return {
    seconds: wall_s,
    hulls_per_s: lost('frames') / wall_s,
    arrived_per_s: times.frames.length / wall_s,
    pictures_per_s: times.pictures.length / wall_s,
    shown_per_s: viewer ? (times.stats.framesShown - statsBefore.framesShown) / wall_s : null,
    viewer_latency_ms: viewer ? median(times.latencies) : null,
    viewer_latency_95_ms: viewer ? quantile(times.latencies, 0.95) : null,
    barcode_mismatches: times.stats?.barcodeMismatches ?? null,
    latency_ms: median(rows.map((row) => row.latency)),
    latency_95_ms: quantile(rows.map((row) => row.latency), 0.95),
    latency_worst_ms: Math.max(...rows.map((row) => row.latency)),
    stamp_error_ms: median(rows.map((row) => row.stampError)),
    counted: rows.length / Math.max(1, recorded.frames.length),
    counters_read: sum(rows.map((row) => row.read)) / shown,
    other_instants: rows.filter((row) => row.others > 0).length,
    unpaired: rows.filter((row) => !row.paired).length,
    triangles: median(rows.map((row) => row.triangles)),
    cameras_shown: shown / rows.length,
    tolerance_px: median(seen.map((status) => status.tolerance_px)),
    hull_ms: median(seen.map((status) => status.hull_ms)),
    picture_ms: median(seen.map((status) => status.picture_ms)),
    encode_ms: median(seen.map((status) => status.encode_ms)),
    keyed_ms: median(seen.flatMap((status) => status.cameras.map((camera) => camera.keyed_ms))),
    contours_bytes_per_s: mean(seen.map((status) => sum(status.cameras.map((camera) => camera.contour_bytes_per_s)))),
    jpeg_bytes_per_s: mean(seen.map((status) => sum(status.cameras.map((camera) => camera.picture_bytes_per_s)))),
    page_bytes_per_s: sum(times.frames.map((frame) => frame.bytes)) / wall_s,
    surface_bytes_per_s: sum(rows.map((row) => row.surface)) / wall_s,
    skipped: lost('skipped'), incomplete: lost('incomplete'), failed: lost('failed'), late: ofCameras('late'), pictures: ofCameras('pictures'),
    server_cpu: (cpuAfter[0] - cpuBefore[0]) / wall_s, cameras_cpu: (cpuAfter[1] - cpuBefore[1]) / wall_s,
  };
}

/** Folder for a row's files. */
export const folderOf = (work, name) => join(work, 'files', name);
