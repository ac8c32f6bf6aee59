// SPDX-License-Identifier: Apache-2.0
// Counted stages of the sample: six of its cameras, pictures in two sizes.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const kRoot = fileURLToPath(new URL('../../..', import.meta.url));
export const kLab = process.env.FOURDVT_LAB_BIN ?? join(kRoot, 'build/release/native/lab/tools/fourdvt-lab');
export const kSample = join(kRoot, 'site/sample/actor_a');
export const kCameras = ['cam00', 'cam01', 'cam02', 'cam04', 'cam05', 'cam07'];
const kBounds = { min: [-0.9, 0, -0.9], max: [0.9, 2.1, 0.9] };

/** {folder, fps, pictures, frames, name} of the stage of this size, played at fps; created if missing. */
export function stage(folder, size, fps, sequence = 'run') {
  const made = join(folder, `stage-${size}-${fps}`);
  if (!existsSync(join(made, 'RIG.json'))) {
    rmSync(`${made}.part`, { recursive: true, force: true });
    execFileSync(kLab, ['stage', kSample, '-o', `${made}.part`, '--sequence', sequence, '--size', size, '--cameras', kCameras.join(','), '--counter'], { stdio: ['ignore', 'ignore', 'inherit'] });
    const rig = JSON.parse(readFileSync(join(`${made}.part`, 'RIG.json'), 'utf8'));
    writeFileSync(join(`${made}.part`, 'RIG.json'), JSON.stringify({ ...rig, fps, bounds: kBounds }, null, 1));
    renameSync(`${made}.part`, made);
  }
  const { pictures, frames } = JSON.parse(readFileSync(join(made, 'counter.json'), 'utf8'));
  return { folder: made, fps, pictures, frames, sequence, size };
}

/** Output of `fourdvt-lab stream` for a recording. */
export function readStream(recorded, theStage, surfaces) {
  return JSON.parse(execFileSync(kLab, ['stream', recorded, '--stage', theStage.folder, ...(surfaces ? ['--surfaces', surfaces] : [])], { encoding: 'utf8', maxBuffer: 1 << 28 }));
}
