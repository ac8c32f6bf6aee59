// SPDX-License-Identifier: Apache-2.0
// node makespan.mjs PLAN MEASURED FRAMES [TAKES [PLANNING_S]]: simulated duration of a plan on 1, 2, 4 … 256 workers,
// with times of pieces measured on another capture.
//   PLAN       plan.json of a long capture: the graph
//   MEASURED   job folder of a capture with the same cameras, with all pieces finished
//   FRAMES     frames of MEASURED: times grow in proportion to frames, process start included
//   TAKES      number of captures like PLAN's in one, as separate sequences (1)
//   PLANNING_S seconds of planning, before any piece starts (0)
// List scheduling in the plan's order, on whole workers; a piece's dependants can start `latency` seconds after its
// end, as Snakemake polls. Prints a table as Markdown.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const kLatency_s = 12, kWorkers = [1, 2, 4, 8, 16, 32, 64, 128, 256];
// Kinds whose pieces have a fixed number of frames; times of other kinds grow with the frames of the whole capture.
const kFixed = { survey: 32, gop: 20, align: 20, frames: 32, labels: 96 };
// Measured on the sample: share of a labels' solve that joining its windows takes; seconds per frame of the last piece,
// besides its constant part.
const kJoining = 0.02, kFinish_s = 0.03;
const kWhole = new Set(['colours', 'graph', 'room', 'finish']);
const kOfASequence = new Set(['method', 'room', 'first']);  // same for any length; once for several takes
const kColourFrames = 32, kColourEvery = 4;  // colours are matched on every fourth of a take's first 32 frames

/** Seconds of a piece of each kind, per frame or in total. */
export function measuredSeconds(folder) {
  const plan = JSON.parse(readFileSync(join(folder, 'plan.json'), 'utf8'));
  const sums = {};
  for (const piece of plan.pieces) {
    const path = join(folder, piece.done);
    if (!existsSync(path)) throw new Error(`${path}: not done; run all pieces first`);
    const record = JSON.parse(readFileSync(path, 'utf8'));
    const kind = (sums[piece.kind] ??= { pieces: 0, seconds: 0, read_mb: 0, peak_mb: 0 });
    kind.pieces++;
    kind.seconds += record.seconds;
    kind.read_mb += record.read_mb;
    kind.peak_mb = Math.max(kind.peak_mb, record.peak_mb);
  }
  if (sums.label && !sums.labels) sums.labels = Object.assign(sums.label, { solves: true });
  return sums;
}

/** Seconds of every piece of a plan of `takes` takes. `frames`: number in the measured capture. */
export function scaled(plan, sums, frames, takes = 1) {
  return plan.pieces.map((piece) => {
    const kind = sums[piece.kind];
    if (!kind) throw new Error(`no piece of kind ${piece.kind} was measured`);
    if (kOfASequence.has(piece.kind)) return kind.seconds / kind.pieces;
    if (piece.kind === 'colours')
      return kind.seconds * takes * kColourFrames / kColourEvery / Math.ceil(Math.min(kColourFrames, frames) / kColourEvery);
    // Labels of a short capture are one window: the piece that joins windows also solves it.
    if (piece.kind === 'finish') return kind.seconds + kFinish_s * plan.frames;
    const perFrame = kind.seconds / frames * (kind.solves && piece.kind === 'label' ? kJoining : 1);
    if (kFixed[piece.kind]) return perFrame * Math.min(kFixed[piece.kind], plan.frames);
    const same = plan.pieces.filter((p) => p.kind === piece.kind).length;
    return perFrame * plan.frames / same;
  });
}

/** Plan of several takes: all pieces once per take, those of the whole capture (kWhole) once. */
export function repeated(plan, takes) {
  const nameOf = (id, take) => (kWhole.has(id) ? id : `${id}@${take}`);
  const out = new Map();
  for (let take = 0; take < takes; take++)
    for (const piece of plan.pieces) {
      const id = nameOf(piece.id, take), needs = piece.needs.map((need) => nameOf(need, take)), known = out.get(id);
      if (known) known.needs.push(...needs.filter((need) => !known.needs.includes(need)));
      else out.set(id, { ...piece, id, needs });
    }
  // Sorts topologically.
  const pieces = [], done = new Set();
  for (let left = [...out.values()]; left.length;) {
    const [now, later] = [left.filter((p) => p.needs.every((need) => done.has(need))), left.filter((p) => !p.needs.every((need) => done.has(need)))];
    if (!now.length) throw new Error('the plan has a circle');
    pieces.push(...now);
    for (const piece of now) done.add(piece.id);
    left = later;
  }
  return { ...plan, frames: plan.frames * takes, pieces };
}

/** { makespan_s, busy_s }: list scheduling in the plan's order. */
export function schedule(pieces, seconds, workers, latency_s = kLatency_s) {
  const number = new Map(pieces.map((piece, i) => [piece.id, i]));
  const waiting = pieces.map((piece) => piece.needs.length);
  const unlocks = pieces.map(() => []);
  pieces.forEach((piece, i) => piece.needs.forEach((need) => unlocks[number.get(need)].push(i)));
  const ready = waiting.flatMap((n, i) => (n === 0 ? [i] : []));
  const events = [];  // [time, piece, frees a worker], a heap by time
  const push = (event) => {
    events.push(event);
    for (let i = events.length - 1; i > 0;) {
      const up = (i - 1) >> 1;
      if (events[up][0] <= events[i][0]) break;
      [events[up], events[i]] = [events[i], events[up]];
      i = up;
    }
  };
  const pop = () => {
    const first = events[0], last = events.pop();
    if (events.length) {
      events[0] = last;
      for (let i = 0;;) {
        let least = i;
        for (const child of [2 * i + 1, 2 * i + 2]) if (child < events.length && events[child][0] < events[least][0]) least = child;
        if (least === i) break;
        [events[least], events[i]] = [events[i], events[least]];
        i = least;
      }
    }
    return first;
  };
  let free = workers, now = 0, busy_s = 0, end = 0, at = 0;
  for (;;) {
    while (free > 0 && at < ready.length) {
      const piece = ready[at++];
      free--;
      busy_s += seconds[piece];
      push([now + seconds[piece], piece, true]);
    }
    if (!events.length) break;
    const [time, piece, frees] = pop();
    now = time;
    if (frees) {
      free++;
      end = Math.max(end, time);
      push([time + latency_s, piece, false]);
      continue;
    }
    for (const next of unlocks[piece]) if (--waiting[next] === 0) ready.push(next);
  }
  if (at !== pieces.length) throw new Error('the plan has a circle');
  return { makespan_s: end, busy_s };
}

/** Seconds of the longest chain of pieces that wait for each other. */
export function longestChain(pieces, seconds) {
  const ends = new Map();
  for (const [i, piece] of pieces.entries())
    ends.set(piece.id, seconds[i] + Math.max(0, ...piece.needs.map((need) => ends.get(need))));
  return Math.max(...ends.values());
}

if (process.argv[1].endsWith('makespan.mjs')) {
  const [planPath, folder, framesText, takes = '1', planningText = '0'] = process.argv.slice(2);
  if (!(Number(framesText) > 0)) {
    console.error('usage: makespan.mjs PLAN.json MEASURED_JOB FRAMES [TAKES [PLANNING_S]]');
    process.exit(2);
  }
  const plan = repeated(JSON.parse(readFileSync(planPath, 'utf8')), Number(takes)), sums = measuredSeconds(folder);
  const seconds = scaled(plan, sums, Number(framesText), Number(takes));
  const planning = Number(planningText), work = planning + seconds.reduce((a, b) => a + b, 0), chain = longestChain(plan.pieces, seconds);
  const time = (s) => (s < 3600 ? `${(s / 60).toFixed(1)} min` : `${(s / 3600).toFixed(2)} h`);
  console.log(`${plan.pieces.length} pieces of ${plan.frames} frames; ${time(work)} of work, of it ${time(planning)} planning; the longest chain ${time(chain)}.\n`);
  console.log('| kind | pieces | seconds of one | share of the work | read by one, measured | memory, measured |\n|---|---|---|---|---|---|');
  for (const [kind, sum] of Object.entries(sums)) {
    const own = plan.pieces.flatMap((piece, i) => (piece.kind === kind ? [seconds[i]] : []));
    if (!own.length) continue;
    const total = own.reduce((a, b) => a + b, 0);
    console.log(`| \`${kind}\` | ${own.length} | ${(total / own.length).toFixed(1)} | ${(100 * total / work).toFixed(1)} % | `
      + `${(sum.read_mb / sum.pieces).toFixed(0)} MB | ${sum.peak_mb.toFixed(0)} MB |`);
  }
  console.log('\n| workers | time | efficiency |\n|---|---|---|');
  for (const workers of kWorkers) {
    const { makespan_s } = schedule(plan.pieces, seconds, workers);
    const all = planning + makespan_s;
    console.log(`| ${workers} | ${time(all)} | ${(100 * work / workers / all).toFixed(0)} % |`);
  }
}
