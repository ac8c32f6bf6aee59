// SPDX-License-Identifier: Apache-2.0
// Synthesises the sounds of the sample capture: one step, and the steps of its two loops, at the frames of the footfalls
// that the bake finds.
//   node site/sample/sounds.mjs
import { writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const RATE = 24_000, FPS = 25;
const LEAD_S = 0.1; // time from the recordings' beginning to the first picture ("offset_ms" in capture.json)
const folder = fileURLToPath(new URL('actor_a/sounds/', import.meta.url));

// A pseudo-random number in -1..1, the same in every run.
let state = 1;
const noise = () => {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
  return state / 2 ** 31 - 1;
};

// A heel on a hard floor: a short tap, and a thud that decays.
function addStep(samples, atS, strength) {
  for (let i = 0; i < 0.14 * RATE; ++i) {
    const t = i / RATE, at = Math.round(atS * RATE) + i;
    if (at >= samples.length) return;
    samples[at] += strength * (0.5 * noise() * Math.exp(-t * 300) + 0.7 * Math.sin(2 * Math.PI * 95 * t) * Math.exp(-t * 38));
  }
}

function write(name, seconds, steps) {
  const samples = new Float64Array(Math.round(seconds * RATE));
  for (const { atS, strength } of steps) addStep(samples, atS, strength);
  const header = Buffer.alloc(44), data = Buffer.alloc(2 * samples.length);
  header.write('RIFF', 0);
  header.writeUInt32LE(36 + data.length, 4);
  header.write('WAVEfmt ', 8);
  for (const [at, value] of [[16, 16], [24, RATE], [28, 2 * RATE], [40, data.length]]) header.writeUInt32LE(value, at);
  for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) header.writeUInt16LE(value, at);
  header.write('data', 36);
  samples.forEach((value, i) => data.writeInt16LE(Math.round(32767 * Math.max(-1, Math.min(1, value))), 2 * i));
  writeFileSync(folder + name, Buffer.concat([header, data]));
}

const inLoop = (frames, strength) => frames.map((frame, i) => ({ atS: LEAD_S + frame / FPS, strength: strength * (i % 2 ? 0.9 : 1) }));
write('step.wav', 0.15, [{ atS: 0, strength: 0.8 }]);
write('walk.wav', LEAD_S + 28 / FPS, inLoop([2, 16], 0.5));
write('run.wav', LEAD_S + 19 / FPS, inLoop([6, 16], 0.8));
