// SPDX-License-Identifier: Apache-2.0
// Every figure of README.md and the site comes from site/measured/figures.json, and figures.json from the runs' rows.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { constants, figures as catalogue, runs, sections } from '../../site/measured/catalogue.mjs';
import { collect, withBefore } from '../../site/measured/collect.mjs';
import { documentParts, makeDocument } from '../../site/measured/documents.mjs';
import { fillText, run, unmarked } from '../../site/measured/fill.mjs';
import { fileOf, inputHash, isInput, partOfRun, parts, recordOf, staleParts, stateOf } from '../../site/measured/parts.mjs';
import { Shown, fixed } from '../../site/measured/shown.mjs';
import { SourceError, Study, parseCsv, readSizes } from '../../site/measured/sources.mjs';
import { inYardsticks, machineText, machinesText, summaryOf, timed, timedTitle } from '../../site/measured/yardstick.mjs';
import { documentOf as liveDocument } from '../../site/measured/live_document.mjs';
import { documentOf as phonesDocument } from '../../site/measured/phones_document.mjs';
import { makePage } from '../../site/measured/page.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kFiles = ['README.md', 'site/docs/README.md', 'site/docs/measured.md', 'site/index.html', 'site/steer.html', 'site/measured/figures.json', 'site/measured/index.html',
  ...documentParts.flatMap((part) => [`site/measured/${part}.json`, `site/measured/${part}.md`])];

const scratch = mkdtempSync(join(tmpdir(), 'figures-'));
after(() => rmSync(scratch, { recursive: true }));

const kStaleNow = staleParts(kRoot);

// A copy of the files, one of them changed.
function changed(path, change) {
  for (const file of kFiles) {
    mkdirSync(dirname(join(scratch, file)), { recursive: true });
    copyFileSync(join(kRoot, file), join(scratch, file));
  }
  const before = readFileSync(join(scratch, path), 'utf8'), text = change(before);
  assert.notEqual(text, before, `the test changes ${path}`);
  writeFileSync(join(scratch, path), text);
  return run(scratch, true, kStaleNow);
}

test('README and the site say what figures.json says', () => assert.deepEqual(run(kRoot, true), []));

test('a figure that is not the one of figures.json is found', () => {
  assert.match(changed('README.md', (text) => text.replace(/(\| \| fourdvt \| compared with \|\n.*\n\|[^|]*\|)[^|]*/, '$1 99.99 dB '))[0], /README\.md is not what/);
  assert.match(changed('site/docs/measured.md', (text) => text.replace(/(\| what \| measured \| goal \|\n.*\n\|[^|]*\|)[^|]*/, '$1 99.99 dB '))[0], /measured\.md is not what/);
  assert.match(changed('site/index.html', (text) => text.replace(/(figure:mean\.psnr\.fvvr -->)[^<]*/, '$199.99&nbsp;dB'))[0], /site\/index\.html is not what/);
  assert.match(changed('site/measured/index.html', (text) => text.replace(/\d\.\d/, '9.9'))[0], /measured\/index\.html is not what/);
  assert.match(changed('site/measured/cameras.json', (text) => text.replace(/"psnr_db":[\d.]+/, '"psnr_db":99.99'))[0], /cameras\.md is not what/);
  assert.match(changed('site/measured/hulls.md', (text) => text.replace(/\d\.\d/, '9.9'))[0], /hulls\.md is not what/);
  assert.match(changed('site/measured/methods.json', (text) => text.replace(/"date":"[^"]*"/, '"date":"1999-01-01"')).join(), /methods\.md is not what.*index\.html is not what/);
  assert.ok(changed('site/measured/figures.json', (text) => text.replace(/"mean\.psnr\.fvvr","value":[\d.]+/, '"mean.psnr.fvvr","value":31.4159')).length >= 3);
});

test('a number that is typed by hand is found', () => {
  const typed = (path, number) => changed(path, (text) => text.replace(/<\/main>|## Licence/, (end) => `${number}\n${end}`));
  for (const number of ['22.4 dB', '4.4&nbsp;MB', '0.25 s', '2&nbsp;%', 'eight times as fast', '× 7.9', 'SSIM .749', '0.749', '5 to 6 Mbit/s', '149.9 kB', '12 mm', 'half an hour, 90 minutes'])
    for (const path of ['README.md', 'site/index.html', 'site/steer.html'])
      assert.match(typed(path, number).join('\n'), new RegExp(`${path}: ".*" is typed by hand`), `${number} in ${path}`);
  assert.deepEqual(unmarked('L = 3 layers of 512², 8 cameras, H.264, Eq. 3, version 1.0, Debian 12', 'README.md'), []);
  assert.deepEqual(unmarked('waits 3 s', 'a.html', [{ file: 'a.html', text: '3 s', reason: 'test' }]), []);
});

test('every text of the page names figures and runs that exist', () => {
  const shown = new Shown({ figures: [] });
  for (const section of sections) {
    for (const text of [section.text ?? '', ...(section.matrix ?? []).flat()]) shown.fill(text);
    for (const row of section.rows ?? []) {
      shown.fill(row.what), shown.fill(row.measured);
      if (row.goal) shown.met(row.goal);
      assert.ok(runs[row.run], `run ${row.run}`);
    }
  }
  for (const [, file] of constants) assert.ok(existsSync(join(kRoot, file)), file);
  assert.equal(new Set(catalogue.map((figure) => figure.id)).size, catalogue.length, 'ids differ');
  assert.throws(() => fillText('<!-- figure:no.such -->1<!-- /figure -->', shown, 'README.md'), /no figure is named no\.such/);
});

test('the study writes every table, method and quantity that figures are taken from', () => {
  const sources = readdirSync(join(kRoot, 'native/lab/study'), { recursive: true }).filter((file) => /\.(h|cpp)$/.test(file));
  const study = sources.map((file) => readFileSync(join(kRoot, 'native/lab/study', file), 'utf8')).join('');
  const names = catalogue.map(({ from }) => from).filter((from) => from.study || from.fvvr || from.truth || from.curve)
    .flatMap((from) => [from.study ?? from.fvvr ?? from.truth, from.curve, from.method, from.quantity, from.against, from.less, from.beyond]).filter(Boolean);
  assert.ok(names.length > 100);
  assert.deepEqual([...new Set(names)].filter((name) => !study.includes(`"${name}"`)), []);
});

const kCsv = `table,sequence,method,setting,quantity,value,unit
held-out,walk,joint-default,views=9,psnr_fg_db,22,dB
held-out,run,joint-default,views=9,psnr_fg_db,24,dB
held-out,walk,fvvr,views=9,psnr_fg_db,23.5,dB
held-out,run,fvvr,views=9,psnr_fg_db,23.7,dB
table1,walk,joint-default,layers=3,total_bytes,1000000,bytes
table1,run,joint-default,layers=3,total_bytes,2000000,bytes
motion-transitions,,,from=a to=b,step_mm,4,mm
motion-transitions,,,from=a to=b,own_step_mm,8,mm
motion-transitions,,,from=b to=a,step_mm,9,mm
motion-transitions,,,from=b to=a,own_step_mm,10,mm
speed,walk,layered,size=1024 view=512x512 pass=512x512 upload,ratio_to_fvvr,99,ratio
speed,walk,layered,size=1024 view=512x512,ratio_to_fvvr,8,ratio
table1,run,joint,,percent_at_equal_held_out_psnr,54.4,percent
table1,walk,joint,,beyond_range_at_held_out_psnr,-1,
rate,walk,h264,preset=medium crf=20 size=1024 layers=3 layout=default,video_bps,4000000,bit/s
rate,walk,h264,preset=medium crf=20 size=1024 layers=3 layout=default,psnr_fg_db,22.1,dB
rate,walk,h264,preset=medium crf=30 size=1024 layers=3 layout=default,video_bps,500000,bit/s
rate,walk,h264,preset=medium crf=30 size=1024 layers=3 layout=default,psnr_fg_db,21,dB
rate,walk,h264,preset=medium crf=14 size=1024 layers=1 layout=default,video_bps,8000000,bit/s
rate,walk,h264,preset=medium crf=14 size=1024 layers=1 layout=default,psnr_fg_db,22,dB
rate,walk,h264,preset=medium crf=24 size=1024 layers=1 layout=default,video_bps,2000000,bit/s
rate,walk,h264,preset=medium crf=24 size=1024 layers=1 layout=default,psnr_fg_db,21,dB
new-table,walk,joint,"a=1 text=one, ""two""",thing,3,dB
about,,,text=fourdvt evaluate X --quick,command,0,
`;
const sources = (more) => ({ study: new Study(parseCsv(kCsv).map((row) => ({ ...row, value: Number(row.value) }))), variants: {}, ...more });

test('figures are taken from the rows of a study', () => {
  const byId = new Map(collect(sources()).map((figure) => [figure.id, figure]));
  assert.equal(byId.get('held_out.psnr.joint-default.run').value, 24);
  assert.equal(byId.get('mean.psnr.joint-default').value, 23);
  assert.equal(byId.get('gap.default').value, -0.6);
  assert.equal(byId.get('sum.storage.joint-default').value, 3);
  assert.equal(byId.get('transition.step').value, 0.9, 'the worst ratio of a row to its own partner');
  assert.equal(byId.get('speed.frame.512x512').value, 8, 'a pass is no frame');
  assert.equal(byId.get('study:new-table/walk/joint/a=1+text=one,+"two"/thing').value, 3, 'a table that the catalogue does not know is kept');
  assert.equal(byId.get('worth.psnr.1.4.00').value, 21.5, 'half-way in log bitrate');
  assert.equal(byId.get('worth.psnr.gain.4.00').value, 0.6);
  assert.equal(byId.get('worth.psnr.1.0.50').text, '–', 'beyond the curve nothing is said');
  assert.ok(!byId.has('bitrate.all.walk'), 'what has no source is left out');
});

test('figures are taken from a report and from what benches print', () => {
  const folder = join(scratch, 'bench');
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, 'draw_ratio.txt'), 'layered 8.20 ms, plain 4.00 ms, ratio 2.05\n');
  const sequence = { name: 'walk', frames: 25, fps: 25, members: 1, total_mbit_per_s: 5, video_mbit_per_s: 4, label_bytes: 12500 };
  const character = { cameras: 8, faces: 10, frames: 25, bytes: 2e6, options: { layers: 3, texture: 1024, crf: 28 }, resumed: false, peak_rss_bytes: 1e9, seconds_per_frame_by_stage: { fill: 0.5 }, sequences: [sequence] };
  const found = collect(sources({ character, bench: folder }));
  const valueOf = (id) => found.find((figure) => figure.id === id)?.value;
  assert.equal(valueOf('bitrate.labels.walk'), 100);
  assert.equal(valueOf('character.all'), 2);
  assert.equal(valueOf('bake.stage.fill'), 0.5);
  assert.equal(valueOf('speed.plain'), 2.05);
  assert.throws(() => collect(sources({ character: { ...character, faces: undefined } })), SourceError);
  writeFileSync(join(folder, 'draw_ratio.txt'), 'Segmentation fault\n');
  assert.throws(() => collect(sources({ bench: folder })), SourceError);
});

test('figures are taken from the sizes that the player\'s build lists', () => {
  const files = (...sizes) => sizes.map(([name, bytes, gzip_bytes]) => ({ name, bytes, gzip_bytes }));
  const player = {
    first: { files: files(['a.js', 3000, 1000], ['a.wasm', 5000, 2000]), gzip_bytes: 3000, limit_gzip_bytes: 2500 },
    more: { files: files(['b.js', 700, 500]), gzip_bytes: 500, limit_gzip_bytes: 9000 },
  };
  const shown = new Shown({ figures: collect(sources({ player })) });
  assert.deepEqual(['player.first', 'player.more', 'player.both', 'player.first.files', 'player.more.plain'].map((id) => shown.text(id)),
    ['3.0\u00a0kB', '0.5\u00a0kB', '3.5\u00a0kB', '1.0 / 2.0\u00a0kB', '0.7\u00a0kB']);
  assert.equal(shown.keys('player.first.files'), 'a.js / a.wasm');
  assert.equal(shown.text('player.demand'), null, 'a build without OpenCV');
  assert.deepEqual(['first', 'more'].map((part) => shown.met({ of: `player.${part}.left`, min: 0 })), [false, true]);
  const folder = join(scratch, 'player');
  mkdirSync(folder, { recursive: true });
  assert.throws(() => readSizes(folder), /sizes\.json is missing; build the web package first/);
  writeFileSync(join(folder, 'sizes.json'), '{}');
  assert.throws(() => readSizes(folder), /holds no part "first"; build the web package again/);
});

test('figures are shown with unit, rounding, goal and change', () => {
  assert.deepEqual([fixed(41361.4, 0), fixed(-0.004, 2), fixed(-0.07, 2), fixed(8000, 0)], ['41,361', '0.00', '−0.07', '8000']);
  const data = { figures: withBefore(collect(sources()), { figures: [{ id: 'mean.psnr.joint-default', value: 23.4 }, { id: 'mean.psnr.fvvr', value: 23 }] }) };
  const shown = new Shown(data);
  assert.equal(shown.text('held_out.psnr.joint-default'), '22.00 / 24.00\u00a0dB');
  assert.equal(shown.text('speed.frame'), '×\u00a08.0');
  assert.equal(shown.text('equal_psnr.joint'), 'below all rates / 54\u00a0%');
  assert.equal(shown.met({ of: 'equal_psnr.joint', max: 60 }), false, 'what is beyond the range meets no goal');
  assert.equal(shown.keys('speed.frame'), '512×512');
  assert.equal(shown.text('parity'), null);
  assert.equal(fillText('<!-- figure:parity --><!-- /figure -->', shown, 'a.html'), '<!-- figure:parity -->not measured in this run<!-- /figure -->');
  assert.deepEqual([shown.met({ of: 'gap.default', min: -0.1 }), shown.met({ of: 'gap.default', max: 0 }), shown.met({ of: 'parity', min: 0.99 })], [false, true, null]);
  assert.equal(new Shown({ figures: [], runs: { study: { quick: true } } }).scope('study'), ' on the one motion of a quick run');
  assert.equal(shown.scope('study'), '', 'a whole run speaks for all motions');
  assert.deepEqual(shown.worse().map((figure) => figure.id), ['mean.psnr.joint-default']);
});

const kRuns = [1.3, 1.1, 1, 1.2, 1.1, 1.1].map((cpu_s, i) => ({ cpu_s, wall_s: 2, others_s: i === 3 ? 1 : 0.1, job: '56 frames' }));

test('a figure whose inputs have changed is marked where it is shown', () => {
  const figures = collect(sources()), record = { inputs: 'aaaa', date: '2026-01-02' };
  const fresh = new Shown({ figures, stale: ['bench'] }), stale = new Shown({ figures, stale: ['study'] });
  assert.equal(fresh.text('mean.psnr.joint-default'), '23.00\u00a0dB');
  assert.equal(stale.text('mean.psnr.joint-default'), '23.00\u00a0dB†');
  assert.equal(stale.text('gap.default'), '−0.60\u00a0dB†', 'derived from stale ones');
  assert.deepEqual([stale.text('parity'), stale.met({ of: 'gap.default', min: -0.1 })], [null, false]);
  const block = '<!-- figures:headlines -->x<!-- /figures --><!-- figures:stale -->x<!-- /figures -->';
  assert.match(fillText(block, stale, 'a.md'), /motions\. † stale:[\s\S]*† stale:/);
  assert.doesNotMatch(fillText(block, new Shown({ figures }), 'a.md'), /stale: /);
  assert.match(makePage(stale, { study: record }), /† stale:[\s\S]*<td>† stale<\/td><td>2026-01-02/);
  assert.match(makePage(new Shown({ figures }), { study: record }), /<td><\/td><td>2026-01-02/);
  const hulls = { parts: { hulls: record }, facts: {}, rows: [] };
  assert.match(makeDocument('hulls', hulls, true), /`aaaa`, which have changed since: \*\*stale\*\*/);
  assert.doesNotMatch(makeDocument('hulls', hulls), /stale/);
});

test('seconds carry their ratio to the yardstick that was measured with them', () => {
  const yardstick = summaryOf(kRuns);
  assert.deepEqual(yardstick, { cpu_s: 1.1, min_s: 1, max_s: 1.3, others_cores: 0.5, job: '56 frames' });
  assert.equal(machineText(yardstick), '1.10 s of CPU (1.00 to 1.30), other programs on up to 0.50 cores');
  assert.equal(machineText(summaryOf(kRuns.map(({ others_s, ...run }) => run))), '1.10 s of CPU (1.00 to 1.30)', 'a system without /proc/stat');
  assert.throws(() => summaryOf([...kRuns, { ...kRuns[0], job: '55 frames' }]), /different jobs \(56 frames; 55 frames\); measure anew/);
  assert.equal(inYardsticks([205, 11, 0.55], 's', yardstick), ' (186 / 10 / 0.50 yardsticks)');
  assert.equal(inYardsticks([0.0058, 31], 'ms', yardstick), ' (0.0000053 / 0.028 yardsticks)');
  assert.equal(inYardsticks([200], 'min', yardstick), ' (10,909 yardsticks)');
  assert.deepEqual([inYardsticks([1], 's', undefined), inYardsticks([NaN], 's', yardstick)], ['', '']);
  assert.equal(timed([31, NaN, 70.7], 'ms', 0, yardstick), '31 / – / 71 (0.028 / – / 0.064)');
  assert.deepEqual([timed([31.46], 'ms', 1), timed([undefined], 'ms', 1, yardstick)], ['31.5', '–']);
  assert.deepEqual([timedTitle('hull, ms', undefined, yardstick), timedTitle('hull, ms', undefined)], ['hull, ms (yardsticks)', 'hull, ms']);
  assert.deepEqual([machinesText([undefined, yardstick, { cpu_s: 2 }]), machinesText([undefined])], ['1.10 to 2.00 s of CPU', 'not measured']);
});

test('figures in seconds have a ratio, seconds of a motion and old figures none', () => {
  const of = (id, value, unit, part, more) => ({ id, value, unit, digits: 2, what: id, run: 'study', row: '', parts: [part], ...more });
  const figures = [of('bake.frame', 1.1, 's', 'bench'), of('speed.wasm', 0.22, 'ms', 'bench'), of('bake.stage.fill', 0.55, 's', 'bench', { of: 'bake.stage', key: 'fill' }),
    of('bake.stage.encode', 0.44, 's', 'bench', { of: 'bake.stage', key: 'encode' }), of('transition.mean', 0.25, 's', 'study'), of('labels.time.walk', 40, 'ms', 'study', { of: 'labels.time', key: 'walk' }),
    of('bake.peak', 110, 'MB', 'bench'), of('study:t/a///q', 2.2, 'ms', 'study', { cells: { sequence: 'a', method: '', setting: '' } })];
  const yardstick = summaryOf(kRuns), parts = { bench: { inputs: 'a', date: '2026-01-02', minutes: 11, yardstick }, study: { inputs: 'b', date: '2026-01-02', minutes: 11 } };
  const before = new Shown({ figures, parts }), now = new Shown({ figures, parts: { ...parts, study: { ...parts.study, yardstick } } });
  const shown = (from, ...ids) => ids.map((id) => from.text(id));
  assert.deepEqual(shown(before, 'bake.frame', 'bake.stage', 'speed.wasm', 'bake.peak'),
    ['1.10\u00a0s (1.0 yardsticks)', '0.55 / 0.44\u00a0s (0.50 / 0.40 yardsticks)', '0.22\u00a0ms (0.00020 yardsticks)', '110.00\u00a0MB']);
  assert.deepEqual(shown(before, 'transition.mean', 'labels.time'), ['0.25\u00a0s', '40.00\u00a0ms'], 'the machine was not measured');
  assert.deepEqual(shown(now, 'transition.mean', 'labels.time'), ['0.25\u00a0s', '40.00\u00a0ms (0.036 yardsticks)'], 'a motion takes as long on any machine');
  assert.equal(before.met({ of: 'bake.frame', max: 1.2 }), true);
  assert.deepEqual(unmarked(fillText('<!-- figure:bake.frame --><!-- /figure -->', now, 'README.md'), 'README.md'), []);
  const page = makePage(now, now.parts);
  assert.match(page, /11\.0&nbsp;min \(600 yardsticks\)<\/td><td>1\.10 s of CPU \(1\.00 to 1\.30\), other programs on up to 0\.50 cores/);
  assert.match(page, /2\.2&nbsp;ms \(0\.0020 yardsticks\)/, 'a table that the catalogue does not know');
  assert.match(makePage(before, before.parts), /11\.0&nbsp;min<\/td><td>not measured<\/td>/);
});

// Holds for every document: rows without a yardstick look as they always did.
function checkDocument(make, measured, expected) {
  const plain = make(measured), yardstick = summaryOf(kRuns);
  assert.match(plain, /ratio: not measured\./);
  assert.ok(!/yardsticks\)/.test(plain.replaceAll('#yardsticks)', '')), 'no ratio is made up');
  const text = make(Object.fromEntries(Object.entries(measured).map(([name, row]) => [name, { ...row, yardstick }])));
  assert.match(text, /ratio: 1\.10 to 1\.10 s of CPU\./);
  for (const part of expected) assert.ok(text.includes(part), `${part} in\n${text}`);
  assert.ok(!text.includes('NaN'));
}

test('documents of rows show each row beside its own yardstick', () => {
  const times = { count: 5, median: 50, most95: 83, worst: 133 };
  checkDocument((measured) => phonesDocument(measured, [['p', 'path', 'planes'], ['t', 'tasks', 'now'], ['m', 'portfolio', '24 viewers'], ['b', 'bench', 'Drawing'], ['decoding', 'decoding', '']].map(([name, kind, title]) => ({ name, kind, title }))), {
    p: { frames: 9, mismatches: 0, late: 0, play: times, loops: times, seeks: times, rungs: times }, t: { start: times }, b: { command: 'bench_x', text: 'x 3 ms' },
    m: { contexts: 1, modules: 1, decoders: 1, errors: 0, firstMs: 2500, steps: [2900, 4900], failed: 0, unseenBytes: 1e3, peak: { loaded: 1, gpu: 1e6, heap: 1e6 }, back: 2 },
    decoding: { motions: Object.fromEntries(['pickup', 'locomotion'].map((name) => [name, Object.fromEntries(['worker', 'page'].map((place) => [place, { first: 5.7, later: times }]))])) },
  }, ['| picture to picture (yardsticks) |', '| 50 / 83 / 133 (0.045 / 0.075 / 0.12) |', '| 50 / 133 (0.045 / 0.12) |', '| now (yardsticks) |', '| 50.0 / 133.0 (0.045 / 0.12) |',
    '| 2.5 (2.3) | 4.9 / 4.9 (4.5 / 4.5) |', 'x 3 ms\nyardstick: 1.10 s of CPU', '| 5.7 / 50.0 (0.0052 / 0.045) |']);
  checkDocument((measured) => liveDocument(measured, [['small', 'rate'], ['k', 'fault'], ['core-lost', 'loss'], ['recording', 'recording']].map(([name, kind]) => ({ name, kind, title: name })), { date: '2026-01-02', commit: 'abc' }), {
    small: { latency_ms: 31, latency_95_ms: 37, latency_worst_ms: 71, hull_ms: 14.1 }, k: { seen: 'a pause', recovery_s: 0.47, recovery: '' },
    'core-lost': { runs: 5, spans: [{ title: 'before', hull_ms: 21.2, latency_ms: 55 }] }, recording: { frames: 9, reconstruct_s: 29, bake_s: 15 },
  }, ['capture to page, ms: median / 95 % / worst (yardsticks) |', '| 31 / 37 / 71 (0.028 / 0.034 / 0.065) |', '| 14.1 (0.013) |', '| delay | not said | 31 ms (0.028 yardsticks); ', '| recovery, s (yardsticks) |', '| 0.47 (0.43) |',
    '| 21.2 (0.019) | 55 (0.050) |', '29 s (26 yardsticks) and 15 s (14 yardsticks).']);
});

test('the yardstick runs before and after a bench', async () => {
  const program = join(scratch, 'bench_yardstick');
  writeFileSync(program, kYardstick, { mode: 0o755 });
  const bench = (...words) => spawnSync('node', [join(kRoot, 'tests/bench/yardstick.mjs'), ...words], { env: { ...process.env, FOURDVT_YARDSTICK_BIN: program }, encoding: 'utf8' });
  const { status, stdout } = bench('bash', '-c', 'echo 3 ms; exit 4');
  assert.deepEqual([status, stdout], [4, '3 ms\nyardstick: 1.10 s of CPU (1.00 to 1.30), other programs on up to 0.50 cores\n']);
  const file = join(scratch, 'yardstick');
  bench('--keep', file);
  assert.equal(readFileSync(file, 'utf8').split('\n').length, 4);
  rmSync(program);
  assert.match(bench('true').stderr, /bench_yardstick is missing; build it: cmake --preset release/);
});

test('a part that was not measured keeps its figures, its hash and its date', () => {
  const old = collect(sources()).concat({ id: 'truth:t/a///q', value: 1, run: 'truth', row: 't', parts: ['truth'], cells: {} });
  const rows = parseCsv(kCsv.replace('joint-default,views=9,psnr_fg_db,24', 'joint-default,views=9,psnr_fg_db,25')).map((row) => ({ ...row, value: Number(row.value) }));
  const character = { cameras: 8, faces: 10, frames: 25, bytes: 3e6, options: {}, resumed: false, peak_rss_bytes: 1e9, seconds_per_frame_by_stage: {}, sequences: [] };
  const byId = (list) => new Map(list.map((figure) => [figure.id, figure]));

  const bench = byId(collect({ variants: {}, character: { ...character, options: { layers: 3, texture: 1, crf: 2 } } }, { old, measured: ['bench'] }));
  assert.equal(bench.get('character.all').value, 3, 'the part that was measured');
  assert.deepEqual(bench.get('held_out.psnr.joint-default.run'), byId(old).get('held_out.psnr.joint-default.run'), 'another part');
  assert.deepEqual(bench.get('gap.default'), byId(old).get('gap.default'), 'derived from another part');
  assert.equal(bench.get('study:new-table/walk/joint/a=1+text=one,+"two"/thing').value, 3, 'a table that the catalogue does not know');
  assert.equal(bench.get('truth:t/a///q').value, 1);

  const study = byId(collect({ variants: {}, study: new Study(rows) }, { old: [...bench.values()], measured: ['study'] }));
  assert.equal(study.get('character.all').value, 3);
  assert.equal(study.get('held_out.psnr.joint-default.run').value, 25);
  assert.equal(study.get('gap.default').value, -0.1, 'derived anew');
  const withHigh = old.concat({ id: 'high.psnr', value: 24.2, run: 'high', parts: ['bench'] });
  const tuned = new Study([{ table: 'held-out', sequence: 'walk', method: 'fvvr-tuned', quantity: 'psnr_fg_db', value: 23.6 }]);
  const mixed = byId(collect({ variants: {}, fvvr: tuned }, { old: withHigh, measured: ['fvvr'] })).get('gap.high');
  assert.equal(mixed.value, 0.6, 'a new figure and a kept one');
  assert.deepEqual(mixed.parts, ['bench', 'fvvr']);

  const fewer = rows.filter((row) => row.table !== 'speed');
  assert.ok(!byId(collect({ variants: {}, study: new Study(fewer) }, { old, measured: ['study'] })).has('speed.frame.512x512'), 'what a part no longer has goes');
});

test('collect.mjs merges the parts that ran into the files', () => {
  const from = join(scratch, 'from'), to = join(scratch, 'to');
  const collectParts = (...names) => execFileSync('node', [join(kRoot, 'site/measured/collect.mjs'), '--from', from, '--to', to, ...names], { encoding: 'utf8', stdio: 'pipe' });
  const read = (name) => JSON.parse(readFileSync(join(to, name), 'utf8'));
  const write = (path, text) => { mkdirSync(dirname(join(from, path)), { recursive: true }); writeFileSync(join(from, path), text); };
  mkdirSync(to, { recursive: true });
  write('study/report/evaluate.csv', kCsv);
  write('study/part.json', '{"inputs":"aaaa","date":"2026-01-02","minutes":3}');
  collectParts('study');
  write('truth/report/evaluate.csv', 'table,sequence,method,setting,quantity,value,unit\nmotion-appearance,both,baked,w=0.50 mesh=truth region=common,psnr_fg_db,28,dB\n');
  write('truth/part.json', '{"inputs":"bbbb","date":"2026-03-04","minutes":5}');
  collectParts('truth');
  const { parts: records, figures } = read('figures.json');
  assert.deepEqual(records, { study: { inputs: 'aaaa', date: '2026-01-02', minutes: 3 }, truth: { inputs: 'bbbb', date: '2026-03-04', minutes: 5 } });
  assert.equal(figures.find(({ id }) => id === 'mean.psnr.joint-default').value, 23);
  assert.equal(figures.find(({ id }) => id === 'truth.mean.baked').value, 28);
  write('study/report/evaluate.csv', kCsv.replaceAll(',22,dB', ',20,dB'));
  collectParts('study');
  const again = read('figures.json').figures;
  assert.deepEqual([again.find(({ id }) => id === 'mean.psnr.joint-default')].map(({ value, before }) => [value, before])[0], [22, 23], 'what was replaced');
  assert.equal(again.find(({ id }) => id === 'truth.mean.baked').before, undefined);
  write('hulls/rows.json', '{"facts":{"frames":19},"rows":[{"table":"surfaces","surface":"stereo","setting":"5 mm","psnr_db":22.66}]}');
  assert.throws(() => collectParts('hulls'), /part\.json is missing/);
  write('hulls/part.json', '{"inputs":"cccc","date":"2026-05-06"}');
  collectParts('hulls');
  assert.match(makeDocument('hulls', read('hulls.json')), /2026-05-06.*`cccc`[\s\S]*\| stereo \| 5 mm \|.* 22\.66 \|/);
  assert.throws(() => collectParts('nonsense'), /no part is named "nonsense"/);
});

test('every figure has the hash of its inputs and a date', () => {
  for (const [name, { runs: own }] of Object.entries(parts)) {
    const record = recordOf(name);
    assert.match(record.inputs, /^[0-9a-f]{16}$/, name);
    assert.match(record.date, /^20\d\d-\d\d-\d\d$/, name);
    assert.equal(own.length > 0, fileOf(name).endsWith('figures.json'));
  }
  const { figures, parts: records } = JSON.parse(readFileSync(join(kRoot, 'site/measured/figures.json'), 'utf8'));
  for (const figure of figures) assert.ok(figure.parts.length && figure.parts.every((part) => records[part]), figure.id);
  assert.deepEqual(Object.keys(runs).filter((run) => !partOfRun[run]), [], 'every run belongs to a part');
});

test('a part is out of date when one of its inputs changes, and only then', () => {
  const root = join(scratch, 'tree');
  const git = (...words) => execFileSync('git', ['-C', root, '-c', 'user.name=t', '-c', 'user.email=t@example.org', ...words], { stdio: 'pipe' });
  const write = (path, text) => { mkdirSync(dirname(join(root, path)), { recursive: true }); writeFileSync(join(root, path), text); };
  mkdirSync(root, { recursive: true });
  git('init', '-q');
  for (const path of ['native/bake/bake.cpp', 'native/reconstruct/hull.cpp', 'native/base/mesh.h', 'tests/bench/hulls.mjs', 'web/viewer.ts', 'README.md', 'site/sample/actor_a/README.md']) write(path, path);
  git('add', '-A');
  git('commit', '-q', '-m', 'tree');
  const hashes = () => Object.fromEntries(Object.keys(parts).map((part) => [part, inputHash(part, { root })]));
  const before = hashes();
  assert.equal(inputHash('hulls', { root, commit: 'HEAD' }), before.hulls, 'a clean tree is its commit');
  const touched = (path, text) => {
    write(path, text);
    const now = hashes();
    const out = Object.keys(parts).filter((part) => stateOf({ inputs: before[part] }, now[part]) === 'out of date');
    git('checkout', '-q', '--', '.');
    git('clean', '-q', '-f', '-d');
    return out;
  };
  assert.deepEqual(touched('native/base/mesh.h', 'new'), Object.keys(parts));
  assert.deepEqual(touched('native/reconstruct/hull.cpp', 'new'), ['cameras', 'hulls', 'methods']);
  assert.deepEqual(touched('tests/bench/hulls.mjs', 'new'), ['hulls']);
  assert.deepEqual(touched('web/viewer.ts', 'new'), ['bench', 'player']);
  assert.deepEqual(touched('native/bake/added.cpp', 'a new file'), Object.keys(parts).filter((part) => part !== 'player'));
  for (const path of ['README.md', 'site/sample/actor_a/README.md', 'site/index.html']) assert.deepEqual(touched(path, 'new'), [], path);
  assert.equal(stateOf(null, before.study), 'never');
  assert.deepEqual(staleParts(root), Object.keys(parts), 'never measured');
  rmSync(join(root, 'native/bake/bake.cpp'));
  assert.notEqual(inputHash('study', { root }), before.study, 'a file that goes');
  git('checkout', '-q', '--', '.');
  write('native/base/mesh.h', 'committed');
  const changedHash = inputHash('study', { root });
  git('commit', '-q', '-a', '-m', 'change');
  assert.equal(inputHash('study', { root, commit: 'HEAD' }), changedHash, 'a changed tree has the hash that its commit will have');
});

// Folders of the CMake targets that a target links, itself included.
function linkedFolders(target) {
  const folders = new Map(), links = new Map();
  const lists = readdirSync(join(kRoot, 'native'), { recursive: true }).filter((file) => file.endsWith('CMakeLists.txt')).map((file) => join('native', file));
  for (const list of lists) {
    const text = readFileSync(join(kRoot, list), 'utf8').replace(/#.*/g, '');
    for (const [, name] of text.matchAll(/add_library\(\s*(\w+)/g)) folders.set(name, dirname(list));
    for (const [, name, rest] of text.matchAll(/target_link_libraries\(\s*(\w+)([^)]*)\)/g)) links.set(name, [...(links.get(name) ?? []), ...rest.split(/\s+/)]);
  }
  assert.ok(folders.has(target), `a part names the target ${target}, which native/ lacks`);
  const seen = new Set();
  for (const queue = [target]; queue.length;) {
    const name = queue.pop();
    if (!folders.has(name) || seen.has(name)) continue;
    seen.add(name);
    queue.push(...(links.get(name) ?? []));
  }
  return [...seen].map((name) => folders.get(name));
}

test('the inputs of a part hold every folder that its programs link', () => {
  for (const [name, { targets, inputs }] of Object.entries(parts)) {
    for (const target of targets) {
      const folders = linkedFolders(target);
      assert.ok(folders.length > 5, target);
      assert.deepEqual(folders.filter((folder) => !isInput(name, `${folder}/file.cpp`)), [], `${name}, ${target}`);
    }
    assert.ok(inputs.includes(`site/measured/parts/${name}.sh`) && existsSync(join(kRoot, `site/measured/parts/${name}.sh`)), name);
    for (const input of inputs.filter((path) => /\.(mjs|sh|cpp|h|txt)$/.test(path))) assert.ok(existsSync(join(kRoot, input)), input);
  }
});

test('a figure has the standard error of its mean', () => {
  const text = `table,sequence,method,setting,quantity,value,unit
held-out,walk,joint-default,views=3,psnr_fg_db,23,dB
held-out,walk,joint-default,views=3,psnr_fg_se_db,0.4,dB
held-out,run,joint-default,views=3,psnr_fg_db,25,dB
held-out,run,joint-default,views=3,psnr_fg_se_db,0.3,dB
held-out,walk,fvvr,views=3,psnr_fg_db,22,dB
held-out,run,fvvr,views=3,psnr_fg_db,24,dB
${[['walk', [20, 23, 26], [19, 22, 25.3]], ['run', [21, 25, 29], [20, 23.7, 28]]].flatMap(([sequence, ours, theirs]) => ours.map((value, i) => `held-out-views,${sequence},joint-default,view=v frame=${i},psnr_fg_db,${value},dB\nheld-out-views,${sequence},fvvr,view=v frame=${i},psnr_fg_db,${theirs[i]},dB`)).join('\n')}
`;
  const found = collect({ variants: {}, study: new Study(parseCsv(text).map((row) => ({ ...row, value: Number(row.value) }))) });
  const shown = new Shown({ figures: found });
  assert.equal(shown.text('held_out.psnr.joint-default'), '23.00 ± 0.40 / 25.00 ± 0.30\u00a0dB');
  const { se } = found.find(({ id }) => id === 'gap.default');
  assert.ok(Math.abs(se - 0.0707) < 1e-3, `differences of 1, 1, 0.7 and 1, 1.3, 1 vary far less than the views: ${se}`);
  assert.ok(found.every(({ row }) => !row.includes('_se')), 'errors are no figures of their own');
});

// Runs as bench_yardstick prints them, without any work.
const kYardstick = `#!/usr/bin/env bash
printf '{"cpu_s":%s,"wall_s":2,"others_s":%s,"job":"56 frames"}\\n' 1.3 0.1 1.1 1 1 0.1
`;

// A tree with what measure.sh and the part hulls need, and programs that only write what the part's script reads.
// `reconstruct` notes its output folder in calls.txt, and waits for a minute where `block` is its number of calls.
function measuringTree() {
  const root = join(scratch, 'measured');
  const write = (path, text, mode) => { mkdirSync(dirname(join(root, path)), { recursive: true }); writeFileSync(join(root, path), text, { mode }); };
  for (const path of ['site/measured', 'site/steps.sh', 'site/index.html', 'site/steer.html', 'site/docs/README.md', 'site/docs/measured.md', 'README.md', 'tests/bench/hulls.mjs', 'tests/bench/kept.mjs', 'tests/bench/yardstick.mjs'])
    cpSync(join(kRoot, path), join(root, path), { recursive: true });
  write('.gitignore', 'build/\nprograms/\n');
  write('site/sample/actor_a/capture.json', '{}');
  write('programs/fourdvt', `#!/usr/bin/env bash
root=$(dirname "$0")/..
echo "$4" >>"$root/programs/calls.txt"
if [ "$(wc -l <"$root/programs/calls.txt")" = "$(cat "$root/programs/block" 2>/dev/null)" ]; then sleep 60; fi
mkdir -p "$root/$4"
echo '{"mean_overlap": 0.5, "lowest_overlap": 0.4, "sequences": {"run": [{"triangles": 9, "silhouettes_ms": 1, "hull_ms": 2, "stereo_ms": 3}]}}' >"$root/$4/reconstruct.json"
`, 0o755);
  write('programs/fourdvt-lab', '#!/usr/bin/env bash\necho "sequence views"\necho "run 3 21.25 0.75 9 1 1 1 1 1 1"\n', 0o755);
  write('programs/bench_yardstick', kYardstick, 0o755);
  const git = (...words) => execFileSync('git', ['-C', root, '-c', 'user.name=t', '-c', 'user.email=t@example.org', ...words], { encoding: 'utf8', stdio: 'pipe' });
  git('init', '-q');
  git('add', '-A');
  git('commit', '-q', '-m', 'tree');
  const env = { ...process.env, FOURDVT_YARDSTICK_BIN: join(root, 'programs/bench_yardstick'), FOURDVT_BIN: join(root, 'programs/fourdvt'), FOURDVT_LAB_BIN: join(root, 'programs/fourdvt-lab') };
  const words = [join(root, 'site/measured/measure.sh')];
  return {
    root, write,
    measure: (...more) => execFileSync('bash', [...words, ...more], { env, encoding: 'utf8', stdio: 'pipe' }),
    start: (...more) => spawn('bash', [...words, ...more], { env, stdio: 'ignore', detached: true }),
    calls: () => (existsSync(join(root, 'programs/calls.txt')) ? readFileSync(join(root, 'programs/calls.txt'), 'utf8').trim().split('\n') : []),
  };
}

test('a part that is killed in the middle goes on after its finished steps', async () => {
  const tree = measuringTree();
  const state = () => /^hulls +(up to date|out of date|never)/m.exec(tree.measure('--list'))[1];
  assert.equal(state(), 'out of date');
  tree.write('programs/block', '3');
  const measuring = tree.start('--no-build', 'hulls');
  const ended = new Promise((resolve) => { measuring.on('exit', resolve); });
  for (let i = 0; tree.calls().length < 3 && i < 300; ++i) await new Promise((resolve) => { setTimeout(resolve, 100); });
  process.kill(-measuring.pid, 'SIGKILL');
  await ended;
  assert.equal(tree.calls().length, 3);
  assert.equal(state(), 'out of date');
  rmSync(join(tree.root, 'programs/block'));
  tree.measure('--no-build', 'hulls');
  const calls = tree.calls(), cases = new Set(calls);
  assert.equal(calls.length, cases.size + 1, 'only the case that was killed ran twice');
  assert.equal(calls[3], calls[2]);
  assert.equal(state(), 'up to date');
  const { parts: records, rows } = JSON.parse(readFileSync(join(tree.root, 'site/measured/hulls.json'), 'utf8'));
  assert.equal(rows.length, cases.size + 1, 'and the given mesh');
  assert.equal(records.hulls.inputs, inputHash('hulls', { root: tree.root }));
  assert.ok(records.hulls.minutes >= 0);
  assert.deepEqual(records.hulls.yardstick, { cpu_s: 1.1, min_s: 1, max_s: 1.3, others_cores: 0.5, job: '56 frames' });
  assert.match(readFileSync(join(tree.root, 'site/measured/hulls.md'), 'utf8'), /yardstick\]\(.*\): 1\.10 s of CPU[\s\S]*\| hull, ms \(yardsticks\) \|[\s\S]*\| 2 \(0\.0018\) \|/);
  assert.equal(readFileSync(join(tree.root, 'build/measured/hulls/yardstick'), 'utf8').trim().split('\n').length, 9, 'before, before what was killed goes on, after');
  assert.match(readFileSync(join(tree.root, 'site/measured/hulls.md'), 'utf8'), /21\.25 \| 0\.750/);
  assert.match(readFileSync(join(tree.root, 'site/measured/index.html'), 'utf8'), new RegExp(records.hulls.inputs));
  assert.match(tree.measure('--no-build', 'hulls'), /hulls: up to date/);
  assert.equal(tree.calls().length, calls.length, 'what is up to date is not measured again');
  tree.write('site/sample/actor_a/capture.json', '{"fps": 30}');
  assert.equal(state(), 'out of date');
  tree.measure('--no-build', 'hulls');
  assert.equal(tree.calls().length, calls.length + cases.size, 'with other inputs it begins anew');
});

// A program that answers like fourdvt and fourdvt-lab, from rows that are given.
function answering(name, projective) {
  const path = join(scratch, name);
  writeFileSync(path, `#!/usr/bin/env node
const { mkdirSync, writeFileSync } = require('node:fs');
const words = process.argv.slice(2), of = (option) => words[words.indexOf(option) + 1];
const csv = 'kind,sequence,camera,frame,psnr_db,ssim\\nheld-out,run,a,0,20,0.5\\nheld-out,run,b,0,24,0.7\\ninput,run,c,0,99,0.9\\n';
if (words.includes('-o')) mkdirSync(of('-o'), { recursive: true });
if (words[0] === 'reconstruct') writeFileSync(of('-o') + '/reconstruct.json', '{}');
if (words[0] === 'bake') {
  mkdirSync(of('-o') + '.report', { recursive: true });
  for (const file of ['/character.gltf', '.report/report.json']) writeFileSync(of('-o') + file, '{"options":{"crf":29}}');
}
if (words[0] === 'inspect') for (const name of ['run', 'walk']) console.log(name + '  1 2 3  7.15 (6.48 + 0.68)');
if (words[0] === 'surfaces') console.log('sequence views\\nrun 9 18.50 0.627 1 2 3 4 5 6 7');
if (words[0] === 'score') writeFileSync(of('-o') + '/evaluate.csv', csv);
if (words[0] === 'methods') writeFileSync(of('-o') + '/projective.json', JSON.stringify({ rows: ${JSON.stringify(projective)}.filter((row) => words[words.indexOf('--sequences') + 1].split(',').includes(row.sequence || 'run')) }));
`, { mode: 0o755 });
  return path;
}

const documentOf = (part, folder) => makeDocument(part, { parts: { [part]: { inputs: 'dddd', date: '2026-07-08' } }, ...JSON.parse(readFileSync(join(folder, 'rows.json'), 'utf8')) });

test('cameras.md shows what its script measured', () => {
  const program = answering('program', []), out = join(scratch, 'cameras');
  execFileSync('node', [join(kRoot, 'tests/bench/cameras.mjs'), program, program, 'capture', out], { stdio: 'pipe' });
  const text = documentOf('cameras', out);
  assert.match(text, /\| hull \| raw videos, fvvr \| 18\.50 \/ 0\.627 \|/);
  assert.match(text, /\| given mesh \| baked, sweep \|( 22\.00 ± 2\.00 \/ 0\.600 ± 0\.100 \|){5}/, 'held-out views only');
  assert.match(text, /\| hull \| 6\.48 \| 0\.68 \| 7\.15 \|/);
  assert.match(text, /\| 40 \| 7\.15 \| 22\.00/);
  assert.match(text, /CRF 29/);
  assert.match(text, /\| walk \| 0\.600 \| 7\.15 \| 7\.15 \| 100 % \|/);
  const walk = (appearance, all_mbit_s, ssim) => ({ table: 'walk', appearance, all_mbit_s, ssim });
  const between = (ssim) => makeDocument('cameras', { parts: { cameras: {} }, facts: {}, rows: [{ table: 'quality', from: 'raw', method: 'fvvr' }, walk('layers', 3, ssim), walk('cameras', 8, 0.82), walk('cameras', 2, 0.8)] });
  assert.match(between(0.81), /\| walk \| 0\.810 \| 3\.00 \| 4\.00 \| 75 % \|/, 'half-way in log bitrate');
  assert.match(between(0.83), /\| walk \| 0\.830 \| 3\.00 \| – \| – \|/, 'nothing is said beyond the rates');
  assert.ok(!text.includes('NaN') && !text.includes('undefined'));
});

test('methods.md shows means over views and differences view by view', () => {
  const row = (table, sequence, method, setting, quantity, value) => ({ table, sequence, method, setting, quantity, value, unit: '' });
  const view = (sequence, method, frame, db) => row('view', sequence, method, `axis=proxy at=given view=t frame=${frame}`, 'psnr_fg_db', db);
  const rows = [
    ...[['run', 0, 20, 20.5], ['run', 8, 24, 24.6], ['pickup', 0, 22, 22.4]].flatMap(([sequence, frame, linear, sweep]) => [view(sequence, 'linear', frame, linear), view(sequence, 'fvvr', frame, linear), view(sequence, 'sweep', frame, sweep)]),
    ...['run', 'pickup'].flatMap((sequence) => ['linear', 'fvvr', 'sweep'].map((method) => row('condition', sequence, method, 'axis=proxy at=given proxy=given closest=4 views=2', 'view_s', method === 'sweep' ? 0.3 : 0.2))),
    row('choice', '', 'sweep', 'proxy=given', 'taken', 1), row('choice', '', 'linear', 'proxy=given text=costs 4 × FVVR', 'refused', 1),
    row('promise', '', '', 'text=Montage4D: 6 rows', 'holds', 0), row('about', '', '', 'text=run 0 8; pickup 0', 'test frames', 0),
    ...['run', 'walk'].map((sequence) => row('cross', sequence, 'montage4d', 'proxy=given own=0', 'rmse', sequence === 'run' ? 0.081 : 0.072)),
    row('stage', 'run', 'sweep', 'proxy=given pass=sweep: costs', 'frame_ms', 21.8),
  ];
  const capture = join(scratch, 'capture'), characters = join(scratch, 'characters'), out = join(scratch, 'methods');
  for (const [name, appearance] of [['tracked', 'cameras'], ['steered', undefined]]) {
    mkdirSync(join(characters, name), { recursive: true });
    writeFileSync(join(characters, name, 'character.gltf'), JSON.stringify({ extensions: { FOURDVT_layered_video_texture: { appearance } } }));
  }
  mkdirSync(capture, { recursive: true });
  writeFileSync(join(capture, 'capture.json'), '{"sequences":[{"name":"walk"},{"name":"run"},{"name":"pickup"}]}');
  execFileSync('node', [join(kRoot, 'tests/bench/methods.mjs'), answering('lab', rows), capture, out, 'run,pickup', '2', '1', characters], { stdio: 'pipe' });
  const text = documentOf('methods', out);
  assert.match(text, /\| linear \| 22\.00 ± 1\.15 \/ – \| \+0\.00 ± 0\.00 \/ – \| – \| – \| 1\.00 × \| costs 4 × FVVR \|/);
  assert.match(text, /\| sweep \| 22\.50 ± 1\.18 \/ – \| \+0\.50 ± 0\.06 \/ – \| – \| – \| 1\.50 × \| \*\*take this\*\* \|/);
  assert.match(text, /mean\nover 3 views/);
  assert.match(text, /- test frames: run 0 8; pickup 0/);
  assert.match(text, /- holds: Montage4D: 6 rows/);
  assert.match(text, /\| walk, given \| montage4d \| 7\.20 \|/, 'the motion that constants were chosen on, cross-validated');
  assert.match(text, /\| sweep: costs \| 21\.8 \|/);
  assert.match(text, /\| sweep \| 22\.00 \/ 0\.600 \|\n/, 'after the codec, without layered characters');
  assert.ok(!text.includes('NaN') && !text.includes('undefined'));
});
