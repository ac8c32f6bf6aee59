// SPDX-License-Identifier: Apache-2.0
// Every figure of README.md and the site comes from site/measured/figures.json, and figures.json from the runs' rows.
import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { constants, figures as catalogue, runs, sections } from '../../site/measured/catalogue.mjs';
import { collect, withBefore } from '../../site/measured/collect.mjs';
import { fillText, run, unmarked } from '../../site/measured/fill.mjs';
import { Shown, fixed } from '../../site/measured/shown.mjs';
import { SourceError, Study, parseCsv } from '../../site/measured/sources.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kFiles = ['README.md', 'site/docs/README.md', 'site/docs/measured.md', 'site/index.html', 'site/steer.html', 'site/measured/figures.json', 'site/measured/index.html'];

const scratch = mkdtempSync(join(tmpdir(), 'figures-'));
after(() => rmSync(scratch, { recursive: true }));

// A copy of the files, one of them changed.
function changed(path, change) {
  for (const file of kFiles) {
    mkdirSync(dirname(join(scratch, file)), { recursive: true });
    copyFileSync(join(kRoot, file), join(scratch, file));
  }
  const before = readFileSync(join(scratch, path), 'utf8'), text = change(before);
  assert.notEqual(text, before, `the test changes ${path}`);
  writeFileSync(join(scratch, path), text);
  return run(scratch, true);
}

test('README and the site say what figures.json says', () => assert.deepEqual(run(kRoot, true), []));

test('a figure that is not the one of figures.json is found', () => {
  assert.match(changed('README.md', (text) => text.replace(/(\| \| fourdvt \| compared with \|\n.*\n\|[^|]*\|)[^|]*/, '$1 99.99 dB '))[0], /README\.md is not what/);
  assert.match(changed('site/docs/measured.md', (text) => text.replace(/(\| what \| measured \| goal \|\n.*\n\|[^|]*\|)[^|]*/, '$1 99.99 dB '))[0], /measured\.md is not what/);
  assert.match(changed('site/index.html', (text) => text.replace(/(figure:mean\.psnr\.fvvr -->)[^<]*/, '$199.99&nbsp;dB'))[0], /site\/index\.html is not what/);
  assert.match(changed('site/measured/index.html', (text) => text.replace(/\d\.\d/, '9.9'))[0], /measured\/index\.html is not what/);
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
  const names = catalogue.map(({ from }) => from).filter((from) => from.study || from.truth || from.curve)
    .flatMap((from) => [from.study ?? from.truth, from.curve, from.method, from.quantity, from.against, from.less, from.beyond]).filter(Boolean);
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
