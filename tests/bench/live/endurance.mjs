// SPDX-License-Identifier: Apache-2.0
// Runs a live system with a drawing page for ten minutes: slope of memory. Then bakes the recording into a character.
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';

import { slope } from './latency.mjs';
import { kTool, pause, residentBytes } from './processes.mjs';
import { Receiver } from './receiver.mjs';
import { stage } from './stages.mjs';
import { folderOf, withSystem } from './system.mjs';

const kMinutes = 10, kEveryMs = 2000, kSettle_s = 60;

const memory = {
  name: 'ten-minutes', title: 'ten minutes', kind: 'endurance',
  measure: (work) => withSystem(stage(work, '320x240', 25), {}, async ({ server, cameras, browser }) => {
    const receiver = await Receiver.open(browser, server, { viewer: { width: 160, height: 120 } });
    const began = Date.now(), samples = [];
    const before = await server.status();
    while (Date.now() - began < kMinutes * 60_000) {
      await pause(kEveryMs);
      const heap = await receiver.page.evaluate(() => {
        kept.frames.length = kept.pictures.length = kept.latencies.length = 0; // what the measurement holds
        return performance.memory?.usedJSHeapSize ?? NaN;
      });
      samples.push({ s: (Date.now() - began) / 1000, server: residentBytes(server.pid), camera: residentBytes(cameras[0].pid), heap });
    }
    const after = await server.status(), settled = samples.filter(({ s }) => s >= kSettle_s), x = settled.map(({ s }) => s / 60);
    const of = (field) => ({ ...slope(x, settled.map((sample) => sample[field])), first: settled[0][field], last: settled.at(-1)[field] });
    const states = (await receiver.times()).states;
    return { minutes: kMinutes, frames: after.frames - before.frames, skipped: after.skipped - before.skipped, states: states.map(({ state }) => state), server: of('server'), camera: of('camera'), heap: of('heap') };
  }),
};

const recording = {
  name: 'recording', title: 'a recording', kind: 'recording',
  measure: async (work) => {
    const folder = folderOf(work, 'recording');
    rmSync(folder, { recursive: true, force: true });
    const captured = join(folder, 'captured');
    const status = await withSystem(stage(work, '320x240', 25), { options: ['--record', captured] }, async ({ server }) => {
      await pause(4000);
      return server.status();
    });
    const timed = (...words) => {
      const began = Date.now();
      execFileSync(kTool, words, { stdio: ['ignore', 'pipe', 'inherit'] });
      return (Date.now() - began) / 1000;
    };
    const reconstruct_s = timed('reconstruct', captured, '-o', join(folder, 'hulls'), '--hull', 'polyhedral');
    const report = JSON.parse(readFileSync(join(folder, 'hulls/reconstruct.json'), 'utf8'));
    const bake_s = timed('bake', join(folder, 'hulls'), '-o', join(folder, 'character'), '--appearance', 'cameras');
    const capture = JSON.parse(readFileSync(join(captured, 'capture.json'), 'utf8'));
    return { frames: capture.sequences.reduce((sum, sequence) => sum + sequence.frames, 0), recorded: status.recorded, overlap_mean: report.mean_overlap, overlap_lowest: report.lowest_overlap, reconstruct_s, bake_s };
  },
};

export const endurance = [memory, recording];
