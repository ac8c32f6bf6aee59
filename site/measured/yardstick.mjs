// SPDX-License-Identifier: Apache-2.0
// Seconds beside their ratio to the yardstick, as text: a fixed job whose runs before and after a measurement are put together
// to { cpu_s, min_s, max_s, others_cores, job }: median, least and most CPU seconds; cores that other programs kept busy in the
// worst run.
// Does NOT run it: tests/bench/yardstick.mjs does. Where no yardstick was recorded, seconds stand alone.

export const kSecondsOf = { s: 1, ms: 1e-3, min: 60 };

/** Summarises runs of the yardstick, each { cpu_s, wall_s, others_s, job }. */
export function summaryOf(runs) {
  const jobs = new Set(runs.map(({ job }) => job));
  if (jobs.size !== 1) throw new Error(`yardsticks of different jobs (${[...jobs].join('; ')}); measure anew, with one FFmpeg`);
  const cpu = runs.map((run) => run.cpu_s).sort((a, b) => a - b), others = runs.map((run) => run.others_s / run.wall_s).filter(Number.isFinite);
  const middle = (cpu[(cpu.length - 1) >> 1] + cpu[cpu.length >> 1]) / 2;
  return { cpu_s: Number(middle.toFixed(3)), min_s: cpu[0], max_s: cpu.at(-1), ...(others.length && { others_cores: Number(Math.max(...others).toFixed(2)) }), job: runs[0].job };
}

const known = (value) => typeof value === 'number' && Number.isFinite(value);

function ratioText(seconds, { cpu_s }) {
  const ratio = seconds / cpu_s;
  return ratio.toLocaleString('en', ratio < 9.95 ? { minimumSignificantDigits: 2, maximumSignificantDigits: 2 } : { maximumFractionDigits: 0 });
}

const ratios = (values, unit, yardstick) => values.map((value) => (known(value) ? ratioText(value * kSecondsOf[unit], yardstick) : '–')).join(' / ');

/** " (0.43 yardsticks)", " (0.43 / 186 yardsticks)" to put behind times of this unit; '' without a yardstick. */
export const inYardsticks = (values, unit, yardstick) => (yardstick && values.some(known) ? ` (${ratios(values, unit, yardstick)} yardsticks)` : '');

/** A cell with such times: "31 / 37", and with a yardstick "31 / 37 (0.029 / 0.035)". */
export function timed(values, unit, digits, yardstick) {
  const text = values.map((value) => (known(value) ? value.toFixed(digits) : '–')).join(' / ');
  return yardstick && values.some(known) ? `${text} (${ratios(values, unit, yardstick)})` : text;
}

/** Title of a column of cells by `timed`. yardsticks: of its rows. */
export const timedTitle = (title, ...yardsticks) => (yardsticks.some(Boolean) ? `${title} (yardsticks)` : title);

/** "1.07 s of CPU (1.05 to 1.23), other programs on up to 0.02 cores" */
export function machineText({ cpu_s, min_s, max_s, others_cores }) {
  const [middle, least, most, others] = [cpu_s, min_s, max_s, others_cores].map((value) => value?.toFixed(2));
  return `${middle} s of CPU (${least} to ${most})${others === undefined ? '' : `, other programs on up to ${others} cores`}`;
}

/** "1.05 to 1.23 s of CPU": of rows that have one each, or none. */
export function machinesText(yardsticks) {
  const seconds = yardsticks.filter(Boolean).map(({ cpu_s }) => cpu_s);
  return seconds.length ? `${Math.min(...seconds).toFixed(2)} to ${Math.max(...seconds).toFixed(2)} s of CPU` : 'not measured';
}

/** A yardstick as Markdown, for documents of site/measured/. */
export const machineNote = (yardstick) => `[yardstick](../docs/measured.md#yardsticks): ${yardstick ? machineText(yardstick) : 'not measured'}`;
