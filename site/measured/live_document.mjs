// SPDX-License-Identifier: Apache-2.0
// The text of site/measured/live.md from measured rows (tests/bench/live/rows.mjs). Rows that are missing have no line.
import { inYardsticks, machinesText, timed, timedTitle } from './yardstick.mjs';

const fixed = (value, digits = 0) => (typeof value === 'number' && Number.isFinite(value) ? value.toFixed(digits) : '–');
const kilo = (bytesPerSecond) => fixed(bytesPerSecond / 1000);
const table = (head, rows) => [head, Array(head.length).fill('---'), ...rows].map((cells) => `| ${cells.join(' | ')} |`).join('\n');

const rateCells = (title, r) => [title, fixed(r.hulls_per_s, 1), fixed(r.triangles), fixed(r.tolerance_px, 1), timed([r.latency_ms, r.latency_95_ms, r.latency_worst_ms], 'ms', 0, r.yardstick),
  `${kilo(r.contours_bytes_per_s)} + ${kilo(r.jpeg_bytes_per_s)}`, `${kilo(r.surface_bytes_per_s)} + ${kilo(r.page_bytes_per_s - r.surface_bytes_per_s)}`,
  `${r.skipped} / ${r.incomplete} / ${r.late} of ${r.pictures}`, `${fixed(r.server_cpu, 2)} + ${fixed(r.cameras_cpu, 2)}`];
const stepCells = (title, r) => [title, ...[r.keyed_ms, r.hull_ms, r.picture_ms, r.encode_ms].map((ms) => timed([ms], 'ms', 1, r.yardstick)), fixed(r.cameras_shown, 1), `${fixed(100 * r.counted, 1)} %`, `${fixed(100 * r.counters_read)} %`, r.other_instants, r.unpaired, fixed(r.stamp_error_ms, 2)];
const toleranceCells = (row, r) => [row.size.replace('x', '×'), row.px, fixed(r.triangles), timed([r.hull_ms], 'ms', 1, r.yardstick), fixed(r.hulls_per_s, 1), timed([r.latency_ms], 'ms', 0, r.yardstick), `${kilo(r.contours_bytes_per_s)}`, fixed(r.iou, 4), fixed(r.psnr_db, 2), fixed(r.ssim, 3), fixed(r.to_given_mm, 1)];
const spanCells = (s, yardstick) => [s.title, `${fixed(s.hulls_per_s, 1)} (${fixed(s.lowest_hulls_per_s, 1)})`, fixed(s.tolerance_px, 1), fixed(s.triangles), timed([s.hull_ms], 'ms', 1, yardstick), timed([s.latency_ms], 'ms', 0, yardstick)];
const drawnCells = (title, r) => [title, fixed(r.arrived_per_s, 1), fixed(r.pictures_per_s, 1), fixed(r.shown_per_s, 1), ...[[r.latency_ms, r.latency_95_ms], [r.viewer_latency_ms, r.viewer_latency_95_ms]].map((list) => timed(list, 'ms', 0, r.yardstick)), r.barcode_mismatches];
const slopeCells = (title, s) => [title, fixed(s.first / 1e6, 1), fixed(s.last / 1e6, 1), `${fixed(s.slope / 1e3)} ± ${fixed(2 * s.error / 1e3)}`];

export function documentOf(measured, rows, { date, commit }) {
  const of = (kind) => rows.filter((row) => row.kind === kind && measured[row.name]);
  const titled = (title, ...list) => timedTitle(title, ...list.map((row) => measured[row.name].yardstick));
  const parts = [`# Live: rates, delays, faults

Measured on ${date}, commit ${commit}. Command: \`node site/measured/live.mjs\`. On two cores, without a GPU, everything on one machine: six processes
\`fourdvt live-camera\`, which play six of the sample's cameras (the motion "run") in real time, one \`fourdvt live\`, and a page in Chromium, over loopback, with tokens.
[Yardsticks](../docs/measured.md#yardsticks), of the rows whose times have a ratio: ${machinesText(Object.values(measured).map(({ yardstick }) => yardstick))}.

How delays are measured: \`fourdvt-lab stage --counter\` paints each picture's number on the performer, black and white, so that it is keyed, cropped, packed
and coded like the rest of him. Sources play by the wall clock, so that a number says when its picture was taken. The page notes when each message comes;
\`fourdvt-lab stream\` decodes what came and reads the numbers. No time that a message carries is used. A camera's own delay (exposure, cable, decoding of its video) is not in it.
`];
  const plain = of('rate').filter((row) => !row.drawn);
  if (plain.length) {
    parts.push(`## Rates and delays

The page takes the messages and does not draw: with a software rasteriser on the same two cores it would be measured instead of the system. The next table draws.
Goals: 25 hulls a second at 320×240 with 1,000 triangles, 12 at 640×480, at most 200 ms. Skipped: instants that came while the one before was still worked on;
incomplete: hulls without a camera that was there; late: pictures that came after their hull was made. Over 30 s, after 8 s.

${table(['cameras', 'hulls a second', 'triangles', 'tolerance, px', titled('capture to page, ms: median / 95 % / worst', ...plain), 'cameras → server, kB/s: outlines + pictures', 'server → page, kB/s: surface + pictures', 'skipped / incomplete / late', 'cores busy: server + cameras'],
    plain.map((row) => rateCells(row.title, measured[row.name])))}

Medians of the steps; and the checks: frames whose number reads, tiles on which it reads, frames with pictures of different instants, frames whose picture
belongs to another surface, and the server's own time of capture less the one that is read.

${table(['cameras', ...['keying, ms', 'hull, ms', 'packing, ms', 'coding, ms'].map((title) => titled(title, ...plain)), 'cameras shown', 'frames read', 'tiles read', 'other instants', 'unpaired', 'time stamps off, ms'], plain.map((row) => stepCells(row.title, measured[row.name])))}
`);
  }
  const drawn = of('rate').filter((row) => row.drawn);
  if (drawn.length) {
    parts.push(`The same with a \`<fourdvt-viewer>\` of 320×240 in the page, which decodes and draws on the same two cores (SwiftShader). Shown: from capture to what is on the canvas, as \`liveLatency\` says.

${table(['cameras', 'frames that come a second', 'decoded a second', 'shown a second', titled('capture to page, ms: median / 95 %', ...drawn), titled('shown, ms: median / 95 %', ...drawn), 'barcode mismatches'], drawn.map((row) => drawnCells(row.title, measured[row.name])))}
`);
  }
  parts.push(`## Beside the paper

Online visual hulls (2003, section 6), with four computers of its time; ours with all on two cores of one.

${table(['', 'paper', 'here'], [
    ['cameras, pictures', '6, 320×240', '6, 320×240; 640×480'],
    ['machines', 'a server with two processors of 1.7 GHz and a GPU; clients of 1.1 GHz', 'two cores for server, six cameras and page; no GPU'],
    ['threads', 'several: to receive, to reconstruct, to draw', 'cameras: two each, reading and keying; server: network, and one for hull, packing and coding; page: its own'],
    ['hulls a second', '15, as fast as its cameras', [measured.small, measured.large].map((r) => fixed(r?.hulls_per_s, 1)).join('; ')],
    ['triangles', '400 to 500', [measured.small, measured.large].map((r) => fixed(r?.triangles)).join('; ')],
    ['drawn a second', '23, on a GPU beside', `${[measured['small-drawn'], measured['large-drawn']].map((r) => fixed(r?.shown_per_s, 1)).join('; ')} by a software rasteriser on the same two cores`],
    ['packing of textures', '63 instead of 46 frames a second with six pictures', 'always: one picture a frame has all regions'],
    ['delay', 'not said', [measured.small, measured.large].map((r) => `${fixed(r?.latency_ms)} ms${inYardsticks([r?.latency_ms], 'ms', r?.yardstick)}`).join('; ')],
    ['who sees it', 'the server\'s screen', 'any number of web pages'],
  ])}
`);
  if (of('tolerance').length) {
    parts.push(`## Tolerance, rate, quality

The tolerance of outlines held fixed. Quality is that of the surfaces that came to the page, put in place of the sample's meshes: silhouettes and plain projective texturing
against the pictures of the held-out cameras (\`fourdvt-lab surfaces\`), from the six cameras' and two more cameras' full pictures. A hull has what concave parts hide: the
distance to the given mesh (mean) is not the tolerance's alone.

${table(['cameras', 'tolerance, px', 'triangles', titled('hull, ms', ...of('tolerance')), 'hulls a second', titled('capture to page, ms', ...of('tolerance')), 'outlines, kB/s', 'IoU', 'PSNR-FG, dB', 'SSIM-FG', 'to the mesh, mm'], of('tolerance').map((row) => toleranceCells(row, measured[row.name])))}
`);
  }
  if (measured['core-lost']) {
    parts.push(`## The control when a core is taken away

640×480, 12 a second wanted, tolerance by control. All programs, browser included, are held to one core for ten seconds. Medians of ${measured['core-lost'].runs} runs; in brackets the lowest rate of any.

${table(['', 'hulls a second', 'tolerance, px', 'triangles', ...['hull, ms', 'capture to frame, ms'].map((title) => titled(title, { name: 'core-lost' }))], measured['core-lost'].spans.map((span) => spanCells(span, measured['core-lost'].yardstick)))}
`);
  }
  if (of('fault').length) {
    parts.push(`## Faults

Six cameras of 320×240 at 25 a second; each fault on a system of its own.

${table(['fault', 'what is seen', titled('recovery, s', ...of('fault')), ''], of('fault').map((row) => [row.title, measured[row.name].seen, timed([measured[row.name].recovery_s], 's', 2, measured[row.name].yardstick), measured[row.name].recovery]))}
`);
  }
  const endurance = measured['ten-minutes'], recording = measured.recording;
  if (endurance) {
    parts.push(`## Ten minutes

320×240, with a viewer of 160×120 that draws: ${endurance.frames} frames, ${endurance.skipped} skipped${endurance.skipped > 0.01 * endurance.frames ? ' (the machine had other work beside)' : ''}; states of the page: ${endurance.states.join(', ')}. Resident memory (the page: its JavaScript heap) after the first minute and at the end, and the slope between by least squares with two standard errors.

${table(['', 'MB after a minute', 'MB at the end', 'slope, kB a minute'], [['server', endurance.server], ['a camera', endurance.camera], ['page', endurance.heap]].map(([title, s]) => slopeCells(title, s)))}
`);
  }
  if (recording) {
    parts.push(`## A recording

\`fourdvt live --record\` for some seconds, then \`fourdvt reconstruct --hull polyhedral\` and \`fourdvt bake --appearance cameras\` of it: ${recording.frames} frames; overlap of the hulls with the recorded mattes ${fixed(recording.overlap_mean, 4)} (lowest ${fixed(recording.overlap_lowest, 4)});
${[recording.reconstruct_s, recording.bake_s].map((s) => `${fixed(s)} s${inYardsticks([s], 's', recording.yardstick)}`).join(' and ')}.
`);
  }
  return `${parts.join('\n').trim()}\n`;
}
