// SPDX-License-Identifier: Apache-2.0
// Makes the texts of cameras.md, hulls.md and methods.md from their parts' tables (PART.json). Contains no values.
import { chosenAgainstTruth, regretSummary } from './regret.mjs';
import { machineNote, timed, timedTitle } from './yardstick.mjs';

const kUnits = { cameras: 'cameras', rotation: '° of rotation', translation: 'mm of position', focal: '% of focal length', gain: '% of gain', standoff: 'mm of surface', mixed: '' };
const kSurfaces = { given: 'tracked mesh', refined: 'refined hull', hull: 'hull' };

const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
const fixed = (value, digits) => (isNumber(value) ? value.toFixed(digits) : '–');
const withError = (value, error, digits) => fixed(value, digits) + (isNumber(error) && isNumber(value) ? ` ± ${error.toFixed(digits)}` : '');
const signed = (value, error, digits) => (isNumber(value) ? (value < 0 ? '−' : '+') + withError(Math.abs(value), error, digits) : '–');
const quality = (row) => (row ? `${withError(row.psnr_db, row.psnr_se_db, 2)} / ${withError(row.ssim, row.ssim_se, 3)}` : '–');
const plain = (row) => (row ? `${fixed(row.psnr_db, 2)} / ${fixed(row.ssim, 3)}` : '–');
const times = (value) => (isNumber(value) ? `${value.toFixed(2)} ×` : '–');
const table = (head, rows) => [head, head.map(() => '---'), ...rows].map((row) => `| ${row.join(' | ')} |`).join('\n');
const distinct = (list) => [...new Set(list)];
const found = (rows, name, where = {}) => rows.filter((row) => row.table === name && Object.entries(where).every(([key, value]) => row[key] === value));
const one = (rows, name, where) => found(rows, name, where)[0];

const provenance = ({ inputs, date, commit, isStale }) => `Measured on ${date}${commit ? `, commit ${commit}` : ''}; hash of the inputs: \`${inputs}\`${isStale ? ', which have changed since: **stale**' : ''}.`;
const timedProvenance = (record) => provenance(record).replace(/\.$/, `; ${machineNote(record.yardstick)}.`);

// Interpolates rows by SSIM in log bitrate: Mbit/s at this SSIM, NaN beyond the rows.
function bitrateAt(rows, ssim) {
  const sorted = rows.toSorted((a, b) => a.ssim - b.ssim), next = sorted.findIndex((row) => row.ssim >= ssim);
  if (next < 0 || (next === 0 && sorted[0].ssim !== ssim)) return NaN;
  if (sorted[next].ssim === ssim) return sorted[next].all_mbit_s;
  const [a, b] = sorted.slice(next - 1, next + 1), share = (ssim - a.ssim) / (b.ssim - a.ssim);
  return a.all_mbit_s * (b.all_mbit_s / a.all_mbit_s) ** share;
}

// Row of the bitrates of layers and cameras at the layers' SSIM. layers: one row; tiles: rows by rate.
function equalSsimRow(motion, layers, tiles) {
  const bitrate = layers ? bitrateAt(tiles, layers.ssim) : NaN;
  return [motion, fixed(layers?.ssim, 3), fixed(layers?.all_mbit_s, 2), fixed(bitrate, 2), Number.isFinite(bitrate) ? `${fixed(100 * layers.all_mbit_s / bitrate, 0)} %` : '–'];
}

function cameras({ record, facts, rows }) {
  const surfaces = distinct(found(rows, 'quality').map((row) => row.surface));
  const counts = distinct(found(rows, 'quality').map((row) => row.closest));
  const sources = distinct(found(rows, 'quality').map((row) => `${row.from} ${row.method}`)).map((text) => text.split(' '));
  const title = { raw: 'raw videos', baked: 'baked' };
  const drawn = sources.at(-1)[1];
  return `# Characters from cameras

${provenance(record)} Command: \`bash site/measured/measure.sh cameras\`.

The sample's ${facts.sequence} at its held-out cameras. Cells: PSNR-FG in dB / SSIM-FG, mean over the views, ± the standard error where it was
measured. M: number of cameras that a view is blended from. Baked with the defaults: CRF ${facts.crf}, vertices on a grid of 1 mm, at most
10,000 triangles where every frame has a mesh of its own. Raw videos are cut at the matte's edge; baked tiles continue the performer's
colours beyond it. The given mesh is unchanged with raw videos, and refined (outlines, cameras) where it is baked.

${table(['surface', 'textured from', ...counts.map((m) => `M = ${m}`)], surfaces.flatMap((surface) => sources.map(([from, method]) => (
    [surface, `${title[from]}, ${method}`, ...counts.map((closest) => quality(one(rows, 'quality', { surface, from, method, closest })))]))))}

## Bitrate

${table(['surface', 'pictures, Mbit/s', 'surfaces, Mbit/s', 'all, Mbit/s'], found(rows, 'bytes').map((row) => (
    [row.surface, ...['pictures_mbit_s', 'surfaces_mbit_s', 'all_mbit_s'].map((key) => fixed(row[key], 2))])))}

## Layers against cameras

Three layers against cameras (M = 4, drawn by ${drawn}, the default) by rate factor, both on the given mesh, refined. Layer size and tile
scale are the defaults.

${table(['CRF', 'layers, Mbit/s', 'dB / SSIM', 'cameras, Mbit/s', 'dB / SSIM'], distinct(found(rows, 'rate').map((row) => row.crf)).map((crf) => (
    [crf, ...['layers', 'cameras'].map((appearance) => one(rows, 'rate', { crf, appearance })).flatMap((row) => [fixed(row?.all_mbit_s, 2), quality(row)])])))}

At equal SSIM, interpolated in log bitrate; layers at their default on the walk, at CRF ${facts.crf} on the ${facts.sequence}:

${table(['motion', 'SSIM', 'layers, Mbit/s', 'cameras, Mbit/s', 'layers against cameras'], [
    equalSsimRow('walk', one(rows, 'walk', { appearance: 'layers' }), found(rows, 'walk', { appearance: 'cameras' })),
    equalSsimRow(facts.sequence, one(rows, 'rate', { appearance: 'layers', crf: facts.crf }), found(rows, 'rate', { appearance: 'cameras' }))])}
`;
}

const kHullColumns = [
  ['surface', 'surface'], ['setting', 'setting'], ['overlap', 'overlap_mean', 4], ['lowest', 'overlap_lowest', 4],
  ['triangles', 'triangles', 0], ['silhouettes, ms', 'silhouettes_ms', 0], ['hull, ms', 'hull_ms', 0],
  ['stereo, ms', 'stereo_ms', 0], ['fallbacks', 'fallbacks', 0], ['to given, mm', 'to_given_mean_mm', 2],
  ['95 %', 'to_given_p95_mm', 1], ['from given, mm', 'from_given_mean_mm', 2], ['95 %', 'from_given_p95_mm', 1],
  ['still change, mm', 'still_change_mm', 2], ['held-out dB', 'psnr_db', 2], ['SSIM', 'ssim', 3],
];

function hullCell(row, [title, key, digits], { yardstick }) {
  if (digits === undefined) return row[key];
  return title.endsWith(', ms') ? timed([row[key]], 'ms', digits, yardstick) : fixed(row[key], digits);
}

function hulls({ record, facts, rows }) {
  return `# Surfaces from cameras alone

${timedProvenance(record)} Command: \`bash site/measured/measure.sh hulls\`.

${facts.frames} frames (${facts.sequences}) of the sample capture. The capture's own meshes serve as reference only.

- overlap: intersection over union of surface and silhouette, mean and lowest over all cameras and frames
- ms: milliseconds per frame; hulls on one core, stereo on all cores with software rendering. Polyhedral hulls include a coarse
  carving for their bounds and the mesh checks
- to given, from given: distances to and from the capture's meshes, mean and 95th percentile. Those meshes lie about 2 mm outside the
  performer
- still change: motion of the surface between frames where the capture's mesh moves by less than half a millimetre
- held-out: projective texturing of the surface from the videos at the held-out cameras, PSNR-FG and SSIM-FG

${table(kHullColumns.map(([title]) => (title.endsWith(', ms') ? timedTitle(title, record.yardstick) : title)), found(rows, 'surfaces').map((row) => kHullColumns.map((column) => hullCell(row, column, record))))}
`;
}

function choice(rows, proxy, methods) {
  const remark = (method) => {
    const row = one(rows, 'choice', { proxy, method });
    return row?.taken ? '**take this**' : row?.refused ?? '';
  };
  const body = methods.map((method) => [method, one(rows, 'condition', { axis: 'proxy', at: proxy, method })]).filter(([, row]) => row)
    .map(([method, row]) => [method, quality(row), `${signed(row.gain_db, row.gain_se_db, 2)} / ${signed(row.gain_ssim, row.gain_se_ssim, 3)}`,
      fixed(row.flicker_levels, 2), times(row.frame_ratio), times(row.view_ratio), remark(method)]);
  return `On a ${kSurfaces[proxy]}:\n\n${table(['method', 'dB / SSIM', 'above linear, dB / SSIM', 'flicker, levels', 'new frame against FVVR', 'new view against FVVR', ''], body)}`;
}

function crossTable(rows) {
  const keys = distinct(found(rows, 'cross').map((row) => `${row.sequence}|${row.proxy}|${row.method}`)).map((text) => text.split('|'));
  return table(['motion, surface', 'method', 'left out: RMSE, %', 'dB / SSIM', 'with its own picture: RMSE, %', 'dB / SSIM'], keys.map(([sequence, proxy, method]) => (
    [`${sequence}, ${proxy}`, method, ...[0, 1].map((own) => one(rows, 'cross', { sequence, proxy, method, own })).flatMap((row) => [fixed(row?.rmse_percent, 2), plain(row)])])));
}

function chosenSection(rows) {
  const list = chosenAgainstTruth(rows);
  if (!list.length) return '';
  const name = ({ axis, at }) => (axis === 'proxy' ? at : axis === 'mixed' ? 'mixed' : `${at} ${kUnits[axis]}`.replace(' °', '°'));
  return `## What the bake chooses

From the input cameras alone, left out in turn, on the frames of the other tables; the scores of the choice and of the best method within
2.5 of FVVR's frames are those at the held-out cameras. Pixels off: how far what is drawn for a camera lies from its picture, as a whole.
${regretSummary(list)}.

${table(['condition', 'pixels off', 'chosen', 'dB', 'best', 'dB', 'regret, dB', 'above linear, dB'], list.map((row) => (
    [name(row), fixed(row.shift_px, 1), row.chosen, fixed(row.db, 2), row.best, fixed(row.best_db, 2), fixed(row.regret_db, 2), signed(row.above_linear_db, undefined, 2)])))}

`;
}

function streamedSection(rows, methods) {
  const characters = distinct(found(rows, 'streamed').map((row) => row.character));
  if (!characters.length) return '';
  return `## After the codec

The demo's characters from cameras (\`site/cameras.sh\`: H.264, CRF 30, the refined hull coarser than by default) at all held-out views of
the run. \`tracked\`: the capture's mesh with refined outlines, the default of the bake, and cameras as given; the tables above have the
mesh as given, too.

${table(['method', ...characters], methods.map((method) => [method, ...characters.map((character) => plain(one(rows, 'streamed', { character, method })))]))}

`;
}

function methodsDocument({ record, facts, rows }) {
  const conditions = found(rows, 'condition'), methods = distinct(conditions.map((row) => row.method));
  const proxies = distinct(conditions.filter((row) => row.axis === 'proxy').map((row) => row.at));
  const at = (method, axis, place) => one(rows, 'condition', { axis, at: place, method });
  const axisMethods = distinct(conditions.filter((row) => row.axis !== 'proxy').map((row) => row.method));
  const judged = (row) => row.axis === 'proxy' && row.at in kSurfaces;
  const views = (list) => distinct(list.map((row) => row.views)).join(' or ') || 'no';
  const passMethods = distinct(found(rows, 'pass').map((row) => row.method));
  return `# Methods of texturing from cameras

${timedProvenance(record)} Command: \`bash site/measured/measure.sh methods\`.

Drawn from the raw videos before any codec unless stated otherwise, at the sample's held-out cameras. Cells: PSNR-FG in dB / SSIM-FG, mean
over ${views(conditions.filter(judged))} views where a method is chosen and ${views(conditions.filter((row) => !judged(row)))} elsewhere, ± its standard error where it was measured. Differences to linear blending
are taken view by view, so that their error is smaller than that of the means.

${Object.entries(facts).map(([name, text]) => `- ${name}: ${text}`).join('\n')}

## Which method to take

Refused: more than .05 dB below linear blending, more than twice the time of FVVR's frame, or more than a tenth more flicker than FVVR.
Taken: the best SSIM-FG of the rest; within .002 of it, the cheapest. All methods draw from the same files. Times are of a new frame in
software rendering; only their ratios count.

${Object.keys(kSurfaces).filter((proxy) => proxies.includes(proxy)).map((proxy) => choice(rows, proxy, methods)).join('\n\n')}

${chosenSection(rows)}## What the papers promise

${found(rows, 'promise').map(({ verdict, text }) => `- ${verdict}: ${text}`).join('\n')}

## Surfaces

${table(['method', ...proxies], methods.map((method) => [method, ...proxies.map((place) => plain(at(method, 'proxy', place)))]))}

Gradient energy against the truth's (below 1: blurred) / shift-tolerant PSNR in dB (blocks of 16 × 16 pixels, ±3 pixels):

${table(['method', ...proxies], methods.map((method) => [method, ...proxies.map((place) => at(method, 'proxy', place)).map((row) => `${fixed(row?.gradient_ratio, 2)} / ${fixed(row?.shift_tolerant_db, 2)}`)]))}

${streamedSection(rows, methods)}## Cameras and calibration, on the given mesh

${table(['error', ...axisMethods], [
    ['none, 4 cameras', ...axisMethods.map((method) => plain(at(method, 'proxy', 'given')))],
    ...Object.keys(kUnits).flatMap((axis) => distinct(conditions.filter((row) => row.axis === axis).map((row) => row.at)).map((place) => (
      [axis === 'mixed' ? 'mixed' : `${place} ${kUnits[axis]}`.replace(' °', '°'), ...axisMethods.map((method) => plain(at(method, axis, place)))])))])}

## Montage4D Table 2

Each input camera's picture against what is drawn for it, at test frames. Constants were chosen on the walk.

${crossTable(rows)}

## Montage4D Table 3

Passes of a new frame, the GPU drained after each.

${table([timedTitle('pass, ms', record.yardstick), ...passMethods], distinct(found(rows, 'pass').map((row) => row.pass)).map((pass) => [pass, ...passMethods.map((method) => timed([one(rows, 'pass', { pass, method })?.frame_ms], 'ms', 1, record.yardstick))]))}
`;
}

const kDocuments = { cameras, hulls, methods: methodsDocument };

export const documentParts = Object.keys(kDocuments);

// Markdown of a part's tables: `data` is what PART.json holds. isStale: the part's inputs have changed.
export const makeDocument = (part, data, isStale = false) => kDocuments[part]({ record: { ...data.parts[part], isStale }, facts: data.facts, rows: data.rows });
