// SPDX-License-Identifier: Apache-2.0
// What is measured and shown, as data: commands, figures, and the tables of the page site/measured/index.html. A new
// figure is a line in `figures`; a table shows it as {id}. Contains no values: collect.mjs reads them from the runs.
//
// A figure: { id, what, unit, digits, scale, from, each, better, spread, clock }
//   value      taken by `from`, times `scale` (default 1), shown with `digits` decimals and `unit`
//   each       "sequence" or a key of the setting ("w", "view" …): one figure per value of it, named id.VALUE; `only`
//              lists the values that are wanted
//   better     "more" or "less": the page lists what moved the other way since an earlier run
//   spread     the standard error over views: { quantity }, rows of the study beside those of `from`, or { paired: [A, B],
//              quantity }, of the differences of two methods view by view
//   clock      "motion": seconds of a motion as it is played, the same on any machine. Other seconds carry their ratio to the yardstick
// `from` is one of
//   { study | fvvr | truth: table, method, setting, quantity, over }   rows of a study; "fvvr" is that of FVVR alone,
//              "truth" that of the virtual studio.
//              over: "mean" (default), "sum", "max", "min", "first"; a row over all sequences wins over those of one.
//              beyond: the quantity that is 1 or −1 where the value lies above or below the range that was measured
//              against, less: another quantity of the same row, by which the value is divided, or which is taken off it
//   { curve: quantity, method, setting, at, minus }     of the study's rate curve of this setting at the bitrates of the
//              curve `at`, interpolated in log bitrate and never beyond the range; less that of the curve `minus`
//   { character: take }                 take(report.json) → number, { key: number }, or null where it was not measured
//   { variant: name, take }             the same from the report of a variant of the character
//   { scores: VARIANT, quantity }       held-out scores of a variant of the character
//   { bench: name, match, over }        the first group of `match` in what the bench printed
//   { player: [PART …], quantity }      bytes of the built web package's parts, gzip; quantity: another number of
//              sizes.json. each "file": of their files
//   { ratio | percent | difference | percent_less | percent_more: [a, b] }   of two figures: a/b, 100 a/b, a − b,
//              100 (1 − a/b), 100 (a/b − 1)

const kSample = 'site/sample/actor_a', kTool = 'build/release/native/tools/fourdvt', kOut = 'build/measured', kBench = `${kOut}/bench`;

// The runs. `what` says on which capture and with which settings.
export const runs = {
  study: {
    what: 'the sample capture',
    command: `fourdvt-lab study ${kSample} -o ${kOut}/study/report --views 12 --steps reference,methods,labels,layers,rate,speed,pictures,motion`,
  },
  fvvr: { what: 'the sample capture', command: `fourdvt-lab study ${kSample} -o ${kOut}/fvvr/report --steps fvvr` },
  truth: {
    what: 'the virtual studio, where the appearance drifts by 12 mm over the mesh and the truth between the motions is known',
    command: `fourdvt-lab studio --actor procedural --drift-mm 12 -o ${kOut}/truth/studio && fourdvt-lab study ${kOut}/truth/studio -o ${kOut}/truth/report --steps labels,motion`,
  },
  character: { what: 'the sample capture, default settings', command: `fourdvt bake ${kSample} -o ${kBench}/character` },
  high: {
    what: 'the sample capture, --quality high, without the class',
    command: `fourdvt bake ${kSample} -o ${kBench}/high/character --quality high --no-classes && fourdvt-lab score ${kBench}/high/character --capture ${kSample} -o ${kBench}/high/scores`,
  },
  crf31: {
    what: 'the sample capture, default settings but --crf 31, without the class',
    command: `fourdvt bake ${kSample} -o ${kBench}/crf31/character --crf 31 --no-classes && fourdvt-lab score ${kBench}/crf31/character --capture ${kSample} -o ${kBench}/crf31/scores`,
  },
  player: { what: 'the built web package', command: 'bash site/measured/measure.sh player' },
  draw_ratio: { what: 'the sample character, software rasteriser', command: `build/release/tests/bench/bench_draw_ratio ${kBench}/character` },
  blend_ratio: { what: 'a made-up character of 8,000 faces and 3 layers, software rasteriser', command: 'build/release/tests/bench/bench_blend_ratio' },
  class_frame: {
    what: "the sample's class, wasm in node",
    command: `NODE_PATH=/usr/share/nodejs ninja -C build/wasm bench_class_frame && node build/wasm/tests/bench/wasm/bench_class_frame.js ${kBench}/character`,
  },
  bake_memory: {
    what: "the sample's walk once and five times in a row",
    command: `bash tests/bench/bake_memory.sh ${kTool} build/release/tests/package/repeat_capture ${kSample} 5`,
  },
  parity: { what: 'the same poses drawn natively and in Chromium', command: 'bash tests/run.sh -R web/parity' },
};

// Columns of the papers' table: one per method.
export const methods = [
  ['fvvr-tuned', 'FVVR at its best'], ['fvvr', 'FVVR'], ['fvvr-as-given', 'FVVR, mesh and cameras as given'], ['fvvr-closest', 'FVVR, M = 3'], ['naive', 'NO'], ['spatial', 'SO'], ['temporal-paper', 'TO (4DVT Eq. 5)'], ['per-texel', 'per texel'],
  ['joint', 'ours, 512²'], ['joint-default', 'ours, default'],
];
const perMethod = (make) => methods.map(([method, title]) => make(method, title));

const row = (table, method, quantity, more = {}) => ({ [method === 'fvvr-tuned' ? 'fvvr' : 'study']: table, method, quantity, ...more });
const seenRow = (method, quantity) => (method.startsWith('fvvr') ? { fvvr: 'held-out', method, quantity } : row('held-out', method, quantity));
const each = 'sequence';

const tableFigures = perMethod((method, title) => [
  { id: `loading.first.${method}`, what: `loading until the first picture, ${title}`, unit: 's', digits: 1, each, better: 'less', from: row('table1', method, 'loading_s') },
  { id: `loading.all.${method}`, what: `loading of the whole sequence, ${title}`, unit: 's', digits: 1, each, better: 'less', from: row('table1', method, 'loading_all_s') },
  { id: `storage.${method}`, what: `storage of all that is loaded, ${title}`, unit: 'kB', digits: 0, scale: 1e-3, each, better: 'less', from: row('table1', method, 'total_bytes') },
  { id: `percent_of_masked.${method}`, what: `storage against the masked PNG multi-view, ${title}`, unit: '%', digits: 1, each, better: 'less', from: row('table1', method, 'percent_of_masked') },
  { id: `equal_psnr.${method}`, what: `storage against H.264 videos of all cameras from which FVVR has the same PSNR-FG at the held-out cameras, ${title}`, unit: '%', digits: 0, each, better: 'less', from: row('table1', method, 'percent_at_equal_held_out_psnr', { beyond: 'beyond_range_at_held_out_psnr' }) },
  { id: `equal_ssim.${method}`, what: `storage against H.264 videos of all cameras from which FVVR has the same SSIM-FG at the held-out cameras, ${title}`, unit: '%', digits: 0, each, better: 'less', from: row('table1', method, 'percent_at_equal_held_out_ssim', { beyond: 'beyond_range_at_held_out_ssim' }) },
  { id: `equal_tuned_psnr.${method}`, what: `storage against H.264 videos of all cameras from which FVVR at its best has the same PSNR-FG at the held-out cameras, ${title}`, unit: '%', digits: 0, each, better: 'less', from: row('table1', method, 'percent_at_equal_tuned_psnr', { beyond: 'beyond_range_at_tuned_psnr' }) },
  { id: `equal_tuned_ssim.${method}`, what: `storage against H.264 videos of all cameras from which FVVR at its best has the same SSIM-FG at the held-out cameras, ${title}`, unit: '%', digits: 0, each, better: 'less', from: row('table1', method, 'percent_at_equal_tuned_ssim', { beyond: 'beyond_range_at_tuned_ssim' }) },
  { id: `ssim_against_fvvr.${method}`, what: `SSIM-FG against FVVR over the ring of views, ${title}`, unit: '', digits: 3, each, better: 'more', from: row('table1', method, 'ssim_fg'), spread: { quantity: 'ssim_fg_se' } },
  { id: `held_out.psnr.${method}`, what: `PSNR-FG at the held-out cameras, ${title}`, unit: 'dB', digits: 2, each, better: 'more', from: row('held-out', method, 'psnr_fg_db'), spread: { quantity: 'psnr_fg_se_db' } },
  { id: `held_out.ssim.${method}`, what: `SSIM-FG at the held-out cameras, ${title}`, unit: '', digits: 3, each, better: 'more', from: row('held-out', method, 'ssim_fg'), spread: { quantity: 'ssim_fg_se' } },
  { id: `seen.psnr.${method}`, what: `PSNR at the held-out cameras over pixels that an input camera sees, ${title}`, unit: 'dB', digits: 2, each, better: 'more', from: seenRow(method, 'psnr_seen_db') },
  { id: `seen.ssim.${method}`, what: `SSIM at the held-out cameras over pixels that an input camera sees, ${title}`, unit: '', digits: 3, each, better: 'more', from: seenRow(method, 'ssim_seen') },
  { id: `flips.${method}`, what: `faces whose layer-1 label changes per frame, ${title}`, unit: '%', digits: 1, each, better: 'less', from: row('labels', method, 'flip_percent', { setting: 'layer=1' }) },
  { id: `seams.${method}`, what: `edges between different layer-1 labels, ${title}`, unit: '%', digits: 1, each, better: 'less', from: row('labels', method, 'seam_percent', { setting: 'layer=1' }) },
  { id: `seen_flips.${method}`, what: `layer-1 label changes per frame on faces that a camera sees, ${title}`, unit: '%', digits: 1, each, better: 'less', from: row('labels', method, 'seen_flip_percent', { setting: 'layer=1' }) },
  { id: `seen_seams.${method}`, what: `edges between different layer-1 labels on faces that a camera sees, ${title}`, unit: '%', digits: 1, each, better: 'less', from: row('labels', method, 'seen_seam_percent', { setting: 'layer=1' }) },
  { id: `penalty.${method}`, what: `mean layer-1 penalty, ${title}`, unit: '', digits: 3, each, better: 'less', from: row('labels', method, 'mean_penalty', { setting: 'layer=1' }) },
]).flat();

// Variants of the joint labelling, with and without its liberties.
export const labelParts = [
  ['spatial', 'SO'], ['joint-neither', 'ours, neither liberty'], ['joint-no-unseen', 'ours, unseen faces stay empty'],
  ['joint-no-partial', 'ours, no cameras that see a face in part'], ['joint', 'ours'],
];
const partQuantities = [['flip_percent', 'flips'], ['seen_flip_percent', 'seen_flips'], ['seam_percent', 'seams'], ['seen_seam_percent', 'seen_seams']];
const partFigures = labelParts.flatMap(([method, title]) => partQuantities.map(([quantity, name]) => (
  { id: `parts.${name}.${method}`, what: `layer-1 ${name.replace('_', ' ')}, ${title}`, unit: '%', digits: 1, better: 'less', from: row('label-parts', method, quantity, { setting: 'layer=1' }) })));

const meanFigures = ['fvvr-tuned', 'fvvr', 'fvvr-as-given', 'spatial', 'joint', 'joint-default'].map((method) => [
  { id: `mean.psnr.${method}`, what: `PSNR-FG at the held-out cameras, mean over the motions, ${method}`, unit: 'dB', digits: 2, better: 'more', from: row('held-out', method, 'psnr_fg_db') },
  { id: `mean.ssim.${method}`, what: `SSIM-FG at the held-out cameras, mean over the motions, ${method}`, unit: '', digits: 3, better: 'more', from: row('held-out', method, 'ssim_fg') },
  { id: `mean.flips.${method}`, what: `layer-1 flips per frame, mean over the motions, ${method}`, unit: '%', digits: 1, better: 'less', from: row('labels', method, 'flip_percent', { setting: 'layer=1' }) },
  { id: `mean.seams.${method}`, what: `layer-1 seam edges, mean over the motions, ${method}`, unit: '%', digits: 1, better: 'less', from: row('labels', method, 'seam_percent', { setting: 'layer=1' }) },
  { id: `mean.seen_flips.${method}`, what: `layer-1 flips per frame on faces that a camera sees, mean over the motions, ${method}`, unit: '%', digits: 1, better: 'less', from: row('labels', method, 'seen_flip_percent', { setting: 'layer=1' }) },
  { id: `mean.seen_seams.${method}`, what: `layer-1 seam edges on faces that a camera sees, mean over the motions, ${method}`, unit: '%', digits: 1, better: 'less', from: row('labels', method, 'seen_seam_percent', { setting: 'layer=1' }) },
  { id: `sum.storage.${method}`, what: `storage of all motions, ${method}`, unit: 'MB', digits: 2, scale: 1e-6, better: 'less', from: row('table1', method, 'total_bytes', { over: 'sum' }) },
]).flat();

export const kLayerSizes = [256, 512, 1024, 2048];
const layerFigures = kLayerSizes.map((size) => (
  { id: `layers.ssim.${size}`, what: `SSIM-FG against FVVR before the codec, layers of ${size}²`, unit: '', digits: 3, each: 'layers', better: 'more', from: row('layers', 'joint', 'ssim_fg', { setting: `size=${size}` }) }));

// What layers are worth where they cost as many bits: curves of one codec and preset, read at the bitrates of the one of
// three layers.
const curveSetting = (layers) => `preset=medium size=1024 layout=default layers=${layers} !chosen`;
const worthFigures = [['psnr', 'PSNR-FG', 'psnr_fg_db', 'dB', 2], ['ssim', 'SSIM-FG', 'ssim_fg', '', 3]].flatMap(([name, title, quantity, unit, digits]) => [
  ...[1, 2, 3].map((layers) => (
    { id: `worth.${name}.${layers}`, what: `${title} at the held-out cameras, ${layers} of 3 layers, at equal bitrate`, unit, digits, each: 'bitrate', better: 'more', from: { curve: quantity, method: 'h264', setting: curveSetting(layers), at: curveSetting(3) } })),
  { id: `worth.${name}.gain`, what: `${title} at the held-out cameras, three layers less one at equal bitrate`, unit, digits, each: 'bitrate', better: 'more', from: { curve: quantity, method: 'h264', setting: curveSetting(3), minus: curveSetting(1), at: curveSetting(3) } },
]);

// A character of this report: what streams while it plays.
const perSequence = (report, value) => Object.fromEntries(report.sequences.map((s) => [s.name, value(s)]));
const outline = (value) => (report) => (report.refinement ? Object.fromEntries(report.refinement.by_camera.map((c) => [c.name, value(c)])) : null);
const recorded = (report) => report.sequences.filter((s) => s.members <= 1);
const classes = (report) => report.sequences.filter((s) => s.members > 1);
const streamed = (s) => s.video_bytes + s.geometry_bytes + s.label_bytes + s.offset_bytes + s.alignment_bytes + s.index_bytes;
const total = (list, value) => list.reduce((sum, s) => sum + value(s), 0);

const characterFigures = [
  { id: 'sample.cameras', what: 'input cameras', unit: '', digits: 0, from: { character: (r) => r.cameras } },
  { id: 'sample.frames', what: 'recorded frames', unit: '', digits: 0, from: { character: (r) => total(recorded(r), (s) => s.frames) } },
  { id: 'sample.faces', what: 'faces of the mesh', unit: '', digits: 0, from: { character: (r) => r.faces } },
  { id: 'sample.layers', what: 'texture layers', unit: '', digits: 0, from: { character: (r) => r.options.layers } },
  { id: 'sample.texture', what: 'side of layer 1', unit: 'texels', digits: 0, from: { character: (r) => r.options.texture } },
  { id: 'sample.crf', what: 'CRF', unit: '', digits: 0, from: { character: (r) => r.options.crf } },
  { id: 'bitrate.all', what: 'bitrate while playing', unit: 'Mbit/s', digits: 1, each, better: 'less', from: { character: (r) => perSequence({ sequences: recorded(r) }, (s) => s.total_mbit_per_s) } },
  { id: 'bitrate.video', what: 'bitrate of the video while playing', unit: 'Mbit/s', digits: 1, each, better: 'less', from: { character: (r) => perSequence({ sequences: recorded(r) }, (s) => s.video_mbit_per_s) } },
  { id: 'bitrate.class', what: 'bitrate of the class while playing', unit: 'Mbit/s', digits: 1, each, better: 'less', from: { character: (r) => perSequence({ sequences: classes(r) }, (s) => s.total_mbit_per_s) } },
  { id: 'bitrate.labels', what: 'bitrate of the labels', unit: 'kbit/s', digits: 0, each, better: 'less', from: { character: (r) => perSequence({ sequences: recorded(r) }, (s) => s.label_bytes * 8e-3 * s.fps / s.frames) } },
  { id: 'character.all', what: 'size of the character', unit: 'MB', digits: 1, better: 'less', from: { character: (r) => r.bytes * 1e-6 } },
  { id: 'character.class', what: 'size of the class, fetched when it is shown', unit: 'MB', digits: 2, better: 'less', from: { character: (r) => (classes(r).length ? total(classes(r), streamed) * 1e-6 : null) } },
  { id: 'bake.frame', what: 'bake with the class, per frame', unit: 's', digits: 2, better: 'less', from: { character: (r) => (r.resumed || !classes(r).length ? null : r.wall_s_per_frame) } },
  { id: 'bake.frames', what: 'frames of the bake, those of the class included', unit: '', digits: 0, from: { character: (r) => (classes(r).length ? r.frames : null) } },
  { id: 'bake.stage', what: 'bake with the class, per frame and stage; stages overlap', unit: 's', digits: 2, each: 'stage', better: 'less', from: { character: (r) => (r.resumed ? null : r.seconds_per_frame_by_stage) } },
  { id: 'outline.before', what: 'median distance between the outlines of mesh and matte, mesh as given', unit: 'px', digits: 2, each: 'camera', better: 'less', from: { character: outline((c) => c.before.median_pixels) } },
  { id: 'outline.after', what: 'median distance between the outlines of mesh and matte, refined', unit: 'px', digits: 2, each: 'camera', better: 'less', from: { character: outline((c) => c.after.median_pixels) } },
  { id: 'outline.before95', what: '95 % of the distances between the outlines of mesh and matte lie below, mesh as given', unit: 'px', digits: 2, each: 'camera', better: 'less', from: { character: outline((c) => c.before.p95_pixels) } },
  { id: 'outline.after95', what: '95 % of the distances between the outlines of mesh and matte lie below, refined', unit: 'px', digits: 2, each: 'camera', better: 'less', from: { character: outline((c) => c.after.p95_pixels) } },
  { id: 'outline.camera', what: 'how far the camera that fits best is from the given one, in the picture', unit: 'px', digits: 2, each: 'camera', from: { character: outline((c) => c.shift_pixels ?? NaN) } },
  { id: 'bake.peak', what: 'peak memory of the bake', unit: 'MB', digits: 0, scale: 1e-6, better: 'less', from: { character: (r) => r.peak_rss_bytes } },
];

const variantFigures = ['high', 'crf31'].map((name) => [
  { id: `${name}.psnr`, what: `PSNR-FG at the held-out cameras, ${name}`, unit: 'dB', digits: 2, better: 'more', from: { scores: name, quantity: 'psnr_db' } },
  { id: `${name}.ssim`, what: `SSIM-FG at the held-out cameras, ${name}`, unit: '', digits: 3, better: 'more', from: { scores: name, quantity: 'ssim' } },
  { id: `${name}.bitrate`, what: `bitrate while playing, ${name}`, unit: 'Mbit/s', digits: 1, each, better: 'less', from: { variant: name, take: (r) => perSequence({ sequences: recorded(r) }, (s) => s.total_mbit_per_s) } },
  { id: `${name}.bake`, what: `bake without the class, per frame, ${name}`, unit: 's', digits: 2, better: 'less', from: { variant: name, take: (r) => (r.resumed ? null : r.wall_s_per_frame) } },
]).flat();

// Alignments of two motions of a class.
export const alignments = [['none', 'plain blend'], ['flow-gpu', 'flow, GPU'], ['flow-gpu-detail', 'flow, GPU, contrast put back'], ['flow-dis', 'fast flow, GPU'], ['flow-opencv', 'flow, OpenCV'], ['baked-mean', 'baked, mean only'], ['baked', 'baked']];
const kBetween = ['0.20', '0.40', '0.50', '0.60', '0.80'];  // all that a study of the studio may have between the ends
const alignmentFigures = alignments.map(([method, title]) => [
  ...['truth', 'blend'].map((mesh) => [
    { id: `truth.psnr.${mesh}.${method}`, what: `PSNR-FG between two motions on the ${mesh === 'truth' ? 'true' : 'blended'} mesh, ${title}`, unit: 'dB', digits: 1, each: 'w', only: kBetween, better: 'more', from: { truth: 'motion-appearance', method, setting: `mesh=${mesh} region=common`, quantity: 'psnr_fg_db' } },
    { id: `truth.ssim.${mesh}.${method}`, what: `SSIM-FG between two motions on the ${mesh === 'truth' ? 'true' : 'blended'} mesh, ${title}`, unit: '', digits: 3, each: 'w', only: kBetween, better: 'more', from: { truth: 'motion-appearance', method, setting: `mesh=${mesh} region=common`, quantity: 'ssim_fg' } },
  ]).flat(),
  { id: `truth.mean.${method}`, what: `PSNR-FG between two motions, mean over the weights, true mesh, ${title}`, unit: 'dB', digits: 1, better: 'more', from: { truth: 'motion-appearance', method, setting: 'mesh=truth region=common', quantity: 'psnr_fg_db', over: 'mean' } },
  { id: `truth.endpoint.${method}`, what: `end-point error on the surface, ${title}`, unit: 'mm', digits: 1, better: 'less', from: { truth: 'motion-flow', method, setting: 'against=truth', quantity: 'difference_mean_mm' } },
  { id: `truth.sharpness.${method}`, what: `gradient energy half-way against the members, studio, ${title}`, unit: '', digits: 2, better: 'more', from: { truth: 'motion-sharpness', method, setting: 'w=0.5', quantity: 'gradient_ratio' } },
  { id: `sharpness.${method}`, what: `gradient energy half-way against the members, ${title}`, unit: '', digits: 2, better: 'more', from: row('motion-sharpness', method, 'gradient_ratio', { setting: 'w=0.5' }) },
  { id: `cost.${method}`, what: `drawing time against the plain blend of two, ${title}`, unit: '×', digits: 2, each: 'size', better: 'less', from: row('motion-cost', method, 'ratio_to_none') },
]).flat();

const motionFigures = [
  { id: 'truth.mesh', what: 'blended mesh from the true one, mean', unit: 'mm', digits: 1, each: 'w', only: kBetween, better: 'less', from: { truth: 'motion-appearance', method: '', quantity: 'mesh_mean_mm' } },
  { id: 'blend.linear', what: 'linear mesh blend from the non-linear one, largest', unit: 'mm', digits: 1, from: row('motion-blend', 'linear', 'error_max_mm', { over: 'max' }) },
  { id: 'blend.hybrid', what: 'mesh blend with corrections from the non-linear one, largest', unit: 'mm', digits: 1, each: 'references', better: 'less', from: row('motion-blend', 'hybrid', 'error_max_mm', { over: 'max' }) },
  { id: 'blend.baked', what: 'mesh blend as baked from the non-linear one, largest', unit: 'mm', digits: 1, better: 'less', from: row('motion-blend', 'hybrid', 'error_max_mm', { setting: 'baked=1', over: 'max' }) },
  { id: 'flow.difference', what: 'flow on the GPU from OpenCV’s Farnebäck, mean', unit: 'px', digits: 3, better: 'less', from: row('motion-flow', 'flow-gpu', 'difference_mean_px', { setting: 'against=opencv' }) },
  { id: 'cost.characters', what: 'characters with baked alignment in the frame time of one with flow on the GPU', unit: '', digits: 0, each: 'size', better: 'more', from: row('motion-cost', 'baked', 'characters_per_flow') },
  { id: 'transition.mean', what: 'from the request until the target is seen, as played, mean over all pairs', unit: 's', digits: 2, clock: 'motion', from: row('motion-transitions', undefined, 'latency_played_mean_s', { over: 'mean' }) },
  { id: 'transition.max', what: 'from the request until the target is seen, as played, longest', unit: 's', digits: 2, clock: 'motion', better: 'less', from: row('motion-transitions', undefined, 'latency_played_s', { over: 'max' }) },
  { id: 'transition.step', what: 'largest step of a vertex between two pictures of a transition, against the motions’ own, worst pair', unit: '×', digits: 3, better: 'less', from: row('motion-transitions', undefined, 'step_mm', { over: 'max', against: 'own_step_mm' }) },
  { id: 'transition.change', what: 'largest change of the picture in a transition, against the motions’ own, worst pair', unit: '×', digits: 4, better: 'less', from: row('motion-transitions', undefined, 'change_levels', { over: 'max', against: 'own_change_levels' }) },
  { id: 'skate.mean', what: 'feet sliding while travelling, mean of a contact', unit: 'mm', digits: 1, each: 'at', better: 'less', from: row('motion-skate', undefined, 'skate_mean_mm') },
  { id: 'skate.max', what: 'feet sliding while travelling, largest of a contact', unit: 'mm', digits: 1, each: 'at', better: 'less', from: row('motion-skate', undefined, 'skate_max_mm') },
];

const speedFigures = [
  ...[['', '!closest', 'FVVR from all cameras'], ['_m3', 'closest=3', 'FVVR from the three cameras nearest to the view']].map(([suffix, closest, title]) => [
    { id: `speed.frame${suffix}`, what: `frame rate against ${title}`, unit: '×', digits: 1, each: 'view', better: 'more', from: row('speed', 'layered', 'ratio_to_fvvr', { setting: `!pass ${closest}`, over: 'first' }) },
    { id: `speed.draw${suffix}`, what: `draws only, depth maps included, against ${title}`, unit: '×', digits: 1, each: 'view', better: 'more', from: row('speed', 'layered', 'draw_ratio_to_fvvr', { setting: `!pass ${closest}`, over: 'first' }) },
  ]).flat(),
  { id: 'speed.plain', what: 'layered drawing against one plain texture', unit: '×', digits: 1, better: 'less', from: { bench: 'draw_ratio', match: /ratio ([\d.]+)/ } },
  { id: 'speed.blend', what: 'baked alignment against the plain blend of two, made-up character', unit: '×', digits: 2, better: 'less', from: { bench: 'blend_ratio', match: /baked +[\d.]+ ms +([\d.]+)/g, over: 'max' } },
  { id: 'speed.wasm', what: 'mesh blend of the class with its corrections at run time, slowest weight', unit: 'ms', digits: 2, better: 'less', from: { bench: 'class_frame', match: /hybrid ([\d.]+) ms/g, over: 'max' } },
  { id: 'speed.wasm_ratio', what: 'mesh blend with corrections against the linear blend, slowest weight', unit: '×', digits: 1, better: 'less', from: { bench: 'class_frame', match: /: x ([\d.]+)/g, over: 'max' } },
];

// A part is what a page loads at the same time: parts of web/build.mjs, with their limits.
export const playerParts = [['first', 'before the first picture'], ['more', 'after it'], ['demand', 'where optical flow by OpenCV is chosen']];
const kilobytes = { unit: 'kB', digits: 1, scale: 1e-3 };
const playerFigures = [
  ...playerParts.map(([part, title]) => [
    { id: `player.${part}`, what: `player ${title}, gzip`, ...kilobytes, better: 'less', from: { player: [part] } },
    { id: `player.${part}.limit`, what: `limit of the player ${title}, gzip`, ...kilobytes, from: { player: [part], quantity: 'limit_gzip_bytes' } },
    { id: `player.${part}.left`, what: `left of the limit of the player ${title}, gzip`, unit: 'kB', digits: 1, from: { difference: [`player.${part}.limit`, `player.${part}`] } },
    { id: `player.${part}.files`, what: `files of the player ${title}, gzip`, ...kilobytes, each: 'file', from: { player: [part] } },
    { id: `player.${part}.plain`, what: `files of the player ${title}`, ...kilobytes, each: 'file', from: { player: [part], quantity: 'bytes' } },
  ]).flat().filter(({ id }) => !/demand\.l/.test(id)),  // parts on demand have no limit
  { id: 'player.both', what: 'player before and after the first picture, gzip', ...kilobytes, better: 'less', from: { player: ['first', 'more'] } },
];

const otherFigures = [
  { id: 'labels.time', what: 'labelling, per frame', unit: 'ms', digits: 0, each, better: 'less', from: row('labels', 'joint', 'label_ms_frame', { setting: '!layer !solve' }) },
  { id: 'labels.global', what: 'energy of one solve over the whole sequence', unit: '', digits: 0, from: row('labels', 'joint', 'energy', { setting: 'solve=global' }) },
  { id: 'labels.windowed', what: 'energy of the windowed solve', unit: '', digits: 0, from: row('labels', 'joint', 'energy', { setting: 'solve=windowed' }) },
  { id: 'seam.ours', what: 'seam contrast above the surface beside it, grazing views, ours', unit: 'levels', digits: 1, better: 'less', from: row('seams', 'joint-default', 'seam_contrast', { setting: 'view=grazing', less: 'seam_control' }) },
  { id: 'seam.fvvr', what: 'seam contrast above the surface beside it, grazing views, FVVR', unit: 'levels', digits: 1, from: row('seams', 'fvvr', 'seam_contrast', { setting: 'view=grazing', less: 'seam_control' }) },
  { id: 'bake.memory', what: 'peak memory of the bake, five times the frames against once', unit: '×', digits: 2, better: 'less', from: { bench: 'bake_memory', match: /ratio ([\d.]+)/ } },
  { id: 'parity', what: 'SSIM on the silhouettes, native against browser, lowest pose', unit: '', digits: 3, better: 'more', from: { bench: 'parity', match: /whole picture, ([\d.]+) on the silhouettes/g, over: 'min' } },
];

const derivedFigures = [
  { id: 'gap.tuned', what: 'PSNR-FG at the held-out cameras, ours by default less FVVR at its best, mean over the motions', unit: 'dB', digits: 2, better: 'more', from: { difference: ['mean.psnr.joint-default', 'mean.psnr.fvvr-tuned'] } },
  { id: 'gap.tuned_motion', what: 'PSNR-FG at the held-out cameras, ours by default less FVVR at its best', unit: 'dB', digits: 2, each: 'sequence', better: 'more', from: { difference: ['held_out.psnr.joint-default', 'held_out.psnr.fvvr-tuned'] } },
  { id: 'gap.default', what: 'PSNR-FG at the held-out cameras, ours by default less FVVR, mean over the motions', unit: 'dB', digits: 2, better: 'more', from: { difference: ['mean.psnr.joint-default', 'mean.psnr.fvvr'] }, spread: { paired: ['joint-default', 'fvvr'], quantity: 'psnr_fg_db' } },
  { id: 'gap.motion', what: 'PSNR-FG at the held-out cameras, ours by default less FVVR', unit: 'dB', digits: 2, each: 'sequence', better: 'more', from: { difference: ['held_out.psnr.joint-default', 'held_out.psnr.fvvr'] }, spread: { paired: ['joint-default', 'fvvr'], quantity: 'psnr_fg_db' } },
  { id: 'gap.high', what: 'PSNR-FG at the held-out cameras, --quality high less FVVR at its best', unit: 'dB', digits: 2, better: 'more', from: { difference: ['high.psnr', 'mean.psnr.fvvr-tuned'] } },
  { id: 'storage.percent', what: 'storage of all motions against the masked PNG multi-view, ours by default', unit: '%', digits: 1, better: 'less', from: { percent: ['sum.storage.joint-default', 'sum.storage.fvvr'] } },
  { id: 'storage.percent_512', what: 'storage of all motions against the masked PNG multi-view, ours at 512²', unit: '%', digits: 1, better: 'less', from: { percent: ['sum.storage.joint', 'sum.storage.fvvr'] } },
  { id: 'flips.fewer', what: 'fewer layer-1 flips than SO, ours', unit: '%', digits: 0, better: 'more', from: { percent_less: ['mean.flips.joint', 'mean.flips.spatial'] } },
  { id: 'seams.fewer', what: 'fewer layer-1 seam edges than SO, ours', unit: '%', digits: 0, better: 'more', from: { percent_less: ['mean.seams.joint', 'mean.seams.spatial'] } },
  { id: 'seen_flips.fewer', what: 'fewer layer-1 flips than SO on faces that a camera sees, ours', unit: '%', digits: 0, better: 'more', from: { percent_less: ['mean.seen_flips.joint', 'mean.seen_flips.spatial'] } },
  { id: 'seen_seams.fewer', what: 'fewer layer-1 seam edges than SO on faces that a camera sees, ours', unit: '%', digits: 0, better: 'more', from: { percent_less: ['mean.seen_seams.joint', 'mean.seen_seams.spatial'] } },
  { id: 'truth.mean.gain', what: 'PSNR-FG between two motions, mean over the weights, true mesh, baked less flow on the GPU', unit: 'dB', digits: 1, better: 'more', from: { difference: ['truth.mean.baked', 'truth.mean.flow-gpu'] } },
  { id: 'labels.excess', what: 'energy of the windowed solve above that of one solve', unit: '%', digits: 2, better: 'less', from: { percent_more: ['labels.windowed', 'labels.global'] } },
];

export const figures = [tableFigures, partFigures, meanFigures, layerFigures, worthFigures, characterFigures, variantFigures, alignmentFigures,
  motionFigures, speedFigures, playerFigures, otherFigures, derivedFigures].flat();

// Tables, or quantities of a table, that are only in a study's own report. All other rows that no figure above uses are
// listed at the end of the page, so that nothing measured is left out silently.
export const leftToTheReport = {
  about: '*', bake: '*', 'held-out-views': '*', layers: '*', multiview: '*', 'multiview-codec': '*', pictures: '*', rate: '*',
  table1: ['video_bytes', 'geometry_bytes', 'label_bytes', 'other_bytes', 'video_bps', 'multiview_codec_bytes', 'ssim_full', 'ssim_box', 'psnr_fg_db', 'psnr_fg_se_db', 'psnr_full_db', 'psnr_box_db', 'psnr_common_db'],
  'held-out': ['ssim_full', 'ssim_box', 'psnr_full_db', 'psnr_box_db', 'psnr_common_db'],
  labels: ['empty_percent', 'label_bps', 'energy', 'label_ms_frame'],
  speed: ['frames_per_s', 'frame_ms', 'gpu_bytes', 'shading_ratio_to_fvvr'],
  seams: '*', 'motion-blend': ['error_rms_mm', 'blend_ms', 'ratio_to_nonlinear'],
  'motion-flow': ['difference_tail_px', 'difference_tail_mm', 'difference_mean_px'],
  'motion-appearance': ['mesh_tail_mm'], 'motion-sharpness': ['gradient_ratio_least', 'gradient_ratio_min', 'detail_ratio'], 'motion-cost': ['frame_ms'],
  'motion-transitions': ['latency_mean_s', 'latency_max_s', 'fit_mean_mm', 'fit_max_mm'], 'motion-skate': ['contacts', 'skate_tail_mm'],
};

// The page. A text holds figures as {id} (all of id.KEY joined by " / ") and their keys as {keys:id}. A row is met when
// every figure of its `goal.of` is at most `max` and at least `min`. `headline`: also in README.
const perMethodRow = (what, prefix) => [what, ...methods.map(([method]) => `{${prefix}.${method}}`)];
const perAlignmentRow = (what, prefix) => [what, ...alignments.map(([method]) => `{${prefix}.${method}}`)];

export const sections = [
  {
    title: 'Against the papers',
    text: `NO, SO, TO and “ours, 512²” have three layers of 512², as in the papers, at CRF 23 (the papers give no codec settings); TO changes little against SO because
      4DVT Eq. 5 divides its temporal term by the number of faces. FVVR is the papers’ reference renderer; it reads all videos at once. At its best it has powers, limit of the angle, filter and fill as ours, chosen on the walk. “Above” and “below all rates”: FVVR from these videos scores less, or more, at every rate that was measured. Per motion: {keys:storage.joint}.`,
    run: 'study',
    columns: ['', ...methods.map(([, title]) => title)],
    matrix: [
      perMethodRow('loading until the first picture', 'loading.first'),
      perMethodRow('loading of the whole sequence, as the papers measure it', 'loading.all'),
      perMethodRow('storage (FVVR: masked PNG pictures)', 'storage'),
      perMethodRow('storage against the masked PNG pictures', 'percent_of_masked'),
      perMethodRow('storage against H.264 videos of all cameras, FVVR from them at equal held-out PSNR-FG', 'equal_psnr'),
      perMethodRow('the same at equal held-out SSIM-FG', 'equal_ssim'),
      perMethodRow('storage against the same videos, FVVR at its best from them at equal held-out PSNR-FG', 'equal_tuned_psnr'),
      perMethodRow('the same at equal held-out SSIM-FG', 'equal_tuned_ssim'),
      perMethodRow('SSIM-FG against FVVR, ring of views', 'ssim_against_fvvr'),
      perMethodRow('PSNR-FG at the held-out cameras', 'held_out.psnr'),
      perMethodRow('SSIM-FG at the held-out cameras', 'held_out.ssim'),
      perMethodRow('PSNR at the held-out cameras, pixels that an input camera sees', 'seen.psnr'),
      perMethodRow('SSIM at the held-out cameras, pixels that an input camera sees', 'seen.ssim'),
      perMethodRow('faces that change their camera per frame, layer 1', 'flips'),
      perMethodRow('the same, faces that a camera sees', 'seen_flips'),
      perMethodRow('edges between different cameras, layer 1', 'seams'),
      perMethodRow('the same, faces that a camera sees', 'seen_seams'),
      perMethodRow('mean penalty, layer 1', 'penalty'),
    ],
  },
  {
    title: 'How many layers',
    text: 'SSIM-FG against FVVR before any codec, for L = {keys:layers.ssim.512}.',
    run: 'study',
    columns: ['side of a layer', 'SSIM-FG'],
    matrix: kLayerSizes.map((size) => [`${size}²`, `{layers.ssim.${size}}`]),
  },
  {
    title: 'What view dependence is worth',
    text: 'One layer looks the same from everywhere. Quality at the held-out cameras where the video costs as many bits: {keys:worth.psnr.3} Mbit/s. “–”: no such bitrate was measured.',
    run: 'study',
    columns: ['layers', 'PSNR-FG', 'SSIM-FG'],
    matrix: [...[1, 2, 3].map((layers) => [`${layers}`, `{worth.psnr.${layers}}`, `{worth.ssim.${layers}}`]), ['three less one', '{worth.psnr.gain}', '{worth.ssim.gain}']],
  },
  {
    title: 'Mesh and cameras against the pictures',
    text: `Distances between the mesh's outline and the matte's, median and the value below which 95 % lie. A camera changes only if what
      fits best is clearly further away than it can be by chance; here none did. Cameras: {keys:outline.before}.`,
    run: 'character',
    columns: ['', 'median', '95 %'],
    matrix: [
      ['mesh as given', '{outline.before}', '{outline.before95}'],
      ['refined', '{outline.after}', '{outline.after95}'],
      ['camera that fits best', '{outline.camera}', ''],
    ],
  },
  {
    title: 'What each liberty of the labels adds',
    text: `The joint labelling may fill faces that no camera sees, and may take cameras that see a face in part. Layer 1, one motion’s
      first frames, from the same costs. The fill alone removes seams where nobody looks; the columns on seen faces tell what is gained there.`,
    run: 'study',
    columns: ['', 'flips', 'flips, seen faces', 'seams', 'seams, seen faces'],
    matrix: labelParts.map(([method, title]) => [title, ...partQuantities.map(([, name]) => `{parts.${name}.${method}}`)]),
  },
  {
    title: 'Quality, speed and size',
    text: `Speeds are ratios of one run on one machine, or stand beside their goal. The worst held-out views of the sample look down from
      above: no ring camera sees the crown of the head, which FVVR leaves dark and ours fills from the hair around it; thin double
      lines of the plaid merge in both; and folds, fingers and the collar are finer than 8,000 faces, which costs both.`,
    rows: [
      { what: 'PSNR-FG and SSIM-FG at held-out cameras, against FVVR', measured: '{mean.psnr.joint-default}, {mean.ssim.joint-default}; FVVR at its best {mean.psnr.fvvr-tuned}, {mean.ssim.fvvr-tuned}, the papers’ form {mean.psnr.fvvr}, {mean.ssim.fvvr}, that on mesh and cameras as given {mean.psnr.fvvr-as-given}, {mean.ssim.fvvr-as-given}', goal: { text: 'mean PSNR at most 0.1 dB below FVVR at its best', of: 'gap.tuned', min: -0.1 }, run: 'study', headline: true },
      { what: 'PSNR-FG at held-out cameras, ours less FVVR at its best, {keys:gap.tuned_motion}; less the papers’ form', measured: '{gap.tuned_motion}; {gap.motion}', goal: { text: '≥ −0.1 dB for each', of: 'gap.tuned_motion', min: -0.1 }, run: 'study', headline: true },
      { what: 'the same as the first row with --quality high', measured: '{high.psnr}, {high.ssim}', goal: { text: 'PSNR at most 0.1 dB below FVVR at its best', of: 'gap.high', min: -0.1 }, run: 'high' },
      { what: 'SSIM-FG against FVVR at the default', measured: '{ssim_against_fvvr.joint-default}', goal: { text: '≥ 0.93', of: 'ssim_against_fvvr.joint-default', min: 0.93 }, run: 'study' },
      { what: 'storage against the masked pictures of all cameras', measured: '{storage.percent}, with layers of 512² {storage.percent_512}', goal: { text: '≤ 3 %, 512²', of: 'storage.percent_512', max: 3 }, run: 'study', headline: true },
      { what: 'storage as a share of the H.264 camera videos from which FVVR at its best reaches the same PSNR-FG at held-out cameras, {keys:equal_psnr.joint-default}; the same SSIM-FG', measured: '{equal_tuned_psnr.joint-default}; {equal_tuned_ssim.joint-default}', run: 'study', headline: true },
      { what: 'the same with the papers’ form of FVVR', measured: '{equal_psnr.joint-default}; {equal_ssim.joint-default}', run: 'study', headline: true },
      { what: 'frame rate against FVVR from all cameras, at {keys:speed.frame}; from the three nearest to the view', measured: '{speed.frame}; {speed.frame_m3}', goal: { text: '≥ × 4', of: 'speed.frame', min: 4 }, run: 'study', headline: true },
      { what: 'the same, draws and depth maps only', measured: '{speed.draw}; {speed.draw_m3}', run: 'study' },
      { what: 'three view-dependent layers above one at equal bitrate, held-out cameras, at {keys:worth.psnr.gain} Mbit/s', measured: '{worth.psnr.gain}; SSIM {worth.ssim.gain}', run: 'study', headline: true },
      { what: 'bitrate while playing, {keys:bitrate.all}', measured: '{bitrate.all}, of which video {bitrate.video}', goal: { text: '≤ 4 Mbit/s', of: 'bitrate.all', max: 4 }, run: 'character', headline: true },
      { what: 'the same with --crf 31', measured: '{crf31.bitrate}, {crf31.psnr}, {crf31.ssim}', goal: { text: '≤ 4 Mbit/s', of: 'crf31.bitrate', max: 4 }, run: 'crf31' },
      { what: 'bitrate of the labels', measured: '{bitrate.labels}', goal: { text: '≤ 120 kbit/s', of: 'bitrate.labels', max: 120 }, run: 'character' },
      { what: 'layer-1 label flips per frame, against SO', measured: '{flips.fewer} fewer; on faces that a camera sees {seen_flips.fewer}', goal: { text: '≥ 50 % fewer on all faces', of: 'flips.fewer', min: 50 }, run: 'study', headline: true },
      { what: 'layer-1 seam edges, against SO', measured: '{seams.fewer} fewer; on faces that a camera sees {seen_seams.fewer}', goal: { text: '≥ 30 % fewer on all faces', of: 'seams.fewer', min: 30 }, run: 'study', headline: true },
      { what: 'energy of the windowed labelling above that of one solve', measured: '{labels.excess}', goal: { text: '≤ 1 %', of: 'labels.excess', max: 1 }, run: 'study' },
      { what: 'labelling, per frame', measured: '{labels.time}', goal: { text: '≤ 100 ms', of: 'labels.time', max: 100 }, run: 'study' },
      { what: 'contrast of seams above the surface beside them, grazing views', measured: '{seam.ours}, FVVR {seam.fvvr}', run: 'study' },
      { what: 'bake with the class, per frame', measured: '{bake.frame} ({bake.frames} frames)', goal: { text: '≤ 1 s', of: 'bake.frame', max: 1 }, run: 'character', headline: true },
      { what: 'stages of it (they overlap): {keys:bake.stage}', measured: '{bake.stage}', run: 'character' },
      { what: 'bake without the class, per frame, --crf 31; --quality high', measured: '{crf31.bake}; {high.bake}', run: 'crf31' },
      { what: 'peak memory of the bake', measured: '{bake.peak}', run: 'character' },
      { what: 'peak memory of the bake, five times the frames', measured: '{bake.memory}', goal: { text: '< × 1.15', of: 'bake.memory', max: 1.15 }, run: 'bake_memory' },
      { what: 'size of the character; of its class, fetched when shown', measured: '{character.all}; {character.class}', run: 'character', headline: true },
      { what: 'player before the first picture, gzip', measured: '{player.first} of {player.first.limit}', goal: { text: 'the limit of its build', of: 'player.first.left', min: 0 }, run: 'player', headline: true },
      { what: 'player after the first picture, gzip', measured: '{player.more} of {player.more.limit}', goal: { text: 'the limit of its build', of: 'player.more.left', min: 0 }, run: 'player', headline: true },
      { what: 'layered drawing against one plain texture', measured: '{speed.plain}', run: 'draw_ratio' },
      { what: 'native against browser, SSIM on the silhouettes, lowest pose', measured: '{parity}', goal: { text: '≥ 0.99', of: 'parity', min: 0.99 }, run: 'parity' },
    ],
  },
  {
    title: 'The player’s bytes',
    text: 'What a page loads of the player, as its build lists it. Gzip: as a server sends it.',
    run: 'player',
    columns: ['', 'files', 'bytes', 'gzip', 'together', 'limit'],
    matrix: playerParts.map(([part, title]) => [title, `{keys:player.${part}.files}`, `{player.${part}.plain}`, `{player.${part}.files}`, `{player.${part}}`, part === 'demand' ? '' : `{player.${part}.limit}`]),
  },
  {
    title: 'Between two recordings',
    text: `The virtual studio knows what was between two motions. Weights of the second motion: w = {keys:truth.psnr.truth.baked}.
      “Baked, mean only” is the aligned mean without the contrast that averaging takes. Decibels reward blur where the mesh is off.`,
    run: 'truth',
    columns: ['', ...alignments.map(([, title]) => title)],
    matrix: [
      perAlignmentRow('PSNR-FG, true mesh', 'truth.psnr.truth'),
      perAlignmentRow('SSIM-FG, true mesh', 'truth.ssim.truth'),
      perAlignmentRow('PSNR-FG, blended mesh', 'truth.psnr.blend'),
      perAlignmentRow('SSIM-FG, blended mesh', 'truth.ssim.blend'),
      perAlignmentRow('end-point error on the surface', 'truth.endpoint'),
      perAlignmentRow('gradient energy half-way against the members', 'truth.sharpness'),
    ],
  },
  {
    title: 'Motion',
    rows: [
      { what: 'between two motions, studio truth on the true mesh: PSNR-FG of the plain blend, flow, baked alignment', measured: '{truth.mean.none}, {truth.mean.flow-gpu}, {truth.mean.baked}', goal: { text: 'baked ≥ flow', of: 'truth.mean.gain', min: 0 }, run: 'truth', headline: true },
      { what: 'the same on the mesh that the character has, second motion’s weight {keys:truth.psnr.blend.baked}: PSNR-FG; SSIM-FG', measured: 'plain {truth.psnr.blend.none}, flow {truth.psnr.blend.flow-gpu}, baked {truth.psnr.blend.baked}; {truth.ssim.blend.none}, {truth.ssim.blend.flow-gpu}, {truth.ssim.blend.baked}', run: 'truth', headline: true },
      { what: 'how far the blended mesh is from the true one', measured: '{truth.mesh}', run: 'truth' },
      { what: 'sharpness half-way on the sample: plain, flow, aligned mean, baked', measured: '{sharpness.none}, {sharpness.flow-gpu}, {sharpness.baked-mean}, {sharpness.baked}', goal: { text: 'baked ≥ 0.95', of: 'sharpness.baked', min: 0.95 }, run: 'study' },
      { what: 'drawing time of the baked alignment against the plain blend, {keys:cost.baked}', measured: '{cost.baked}; flow on the GPU {cost.flow-gpu}', goal: { text: '≤ × 1.3', of: 'cost.baked', max: 1.3 }, run: 'study', headline: true },
      { what: 'the same on a made-up character', measured: '{speed.blend}', goal: { text: '≤ × 1.3', of: 'speed.blend', max: 1.3 }, run: 'blend_ratio' },
      { what: 'characters with baked alignment in the frame time of one with flow', measured: '{cost.characters}', goal: { text: '> 1', of: 'cost.characters', min: 1.001 }, run: 'study' },
      { what: 'flow on the GPU against OpenCV’s, mean difference', measured: '{flow.difference}', goal: { text: '≤ 0.3 px', of: 'flow.difference', max: 0.3 }, run: 'study' },
      { what: 'mesh blend against the non-linear one, largest error: linear; with {keys:blend.hybrid} corrections', measured: '{blend.linear}; {blend.hybrid}', run: 'study' },
      { what: 'the same, as baked', measured: '{blend.baked}', goal: { text: '≤ 1 mm', of: 'blend.baked', max: 1 }, run: 'study' },
      { what: 'the same at run time, wasm, per frame', measured: '{speed.wasm}, {speed.wasm_ratio} the linear blend', goal: { text: '≤ 0.5 ms', of: 'speed.wasm', max: 0.5 }, run: 'class_frame' },
      { what: 'transitions: from the request until the target is seen', measured: 'mean {transition.mean}, longest {transition.max}', goal: { text: '≤ 0.4 s', of: 'transition.max', max: 0.4 }, run: 'study', headline: true },
      { what: 'transitions: largest step of a vertex and change of the picture, against the motions’ own', measured: '{transition.step}, {transition.change}', goal: { text: 'step ≤ × 1', of: 'transition.step', max: 1.000001 }, run: 'study' },
      { what: 'feet sliding while the class travels at {keys:skate.mean} (its parameter), mean; largest', measured: '{skate.mean}; {skate.max}', run: 'study' },
    ],
  },
];

// What the constants were chosen on: figures of that motion flatter them.
export const constants = [
  ['quality presets: CRF and encoder preset', 'native/bake/quality.cpp', 'all motions of the sample; of VP9 and AV1: its run', 'rate and held-out quality of rendered views'],
  ['encoder parameters', 'native/encode/encoder.cpp', 'deblocking and qcomp: all motions of the sample; the others: not recorded', 'bitrate and SSIM of rendered views'],
  ['resampling: filter', 'native/bake/texels/resample.h', 'all motions of the sample', 'held-out SSIM and PSNR, and bitrate'],
  ['resampling: distances to mattes and contours', 'native/bake/texels/resample.h', 'walk and run of the sample', 'held-out SSIM and PSNR, no codec'],
  ['powers of the blend', 'native/render/recipe.h', 'all motions of the sample', 'held-out SSIM and PSNR, seams of a synthetic cylinder, change on an orbit'],
  ['root motion: how steady contacts are', 'native/bake/motion/root_track.cpp', 'walk and run of the sample', 'feet sliding, and the declared speed'],
  ['weights of the joint labels', 'native/bake/labels/labelling.h', 'not recorded', 'flips and seams of one sequence at a penalty near naive’s'],
  ['detail put back in aligned blends', 'native/render/layered_pass.cpp', 'nothing: the bake measures it per class', 'correlation of the members’ detail'],
];
