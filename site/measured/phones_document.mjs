// SPDX-License-Identifier: Apache-2.0
// The text of site/measured/phones.md from measured rows (tests/bench/phones/rows.mjs). Rows that are missing have no line.
import { machineText, machinesText, timed, timedTitle } from './yardstick.mjs';

const fixed = (value, digits = 0) => (typeof value === 'number' && Number.isFinite(value) ? value.toFixed(digits) : '–');
const mega = (bytes) => fixed(bytes / 1e6, 2);
const table = (head, rows) => [head, Array(head.length).fill('---'), ...rows].map((cells) => `| ${cells.join(' | ')} |`).join('\n');
const three = ({ median, most95, worst }, yardstick) => timed([median, most95, worst], 'ms', 0, yardstick);
const two = ({ median, worst }, yardstick, digits = 0) => timed([median, worst], 'ms', digits, yardstick);
const kScenes = [['start', 'until the first picture'], ['seek', 'first seek, to the last frames of a GOP of the class'], ['slider', 'first use of the slider'], ['play', 'playing'], ['motion', 'another motion'], ['rung', 'another rung']];

export function documentOf(measured, rows) {
  const of = (kind) => rows.filter((row) => row.kind === kind && measured[row.name]);
  const titled = (title, list) => timedTitle(title, ...list.map(({ name }) => measured[name].yardstick));
  const commits = [...new Set(Object.values(measured).map(({ commit, date }) => `${commit} (${date})`))].join(', ');
  const parts = [`# What playing costs a page

Measured at ${commits}; command: \`node site/measured/phones.mjs\`. Two cores, no GPU: Chromium and Firefox draw in software on the cores that also
decode, and no phone was at hand. Bytes and counts hold anywhere; times are for comparing rows. [Yardsticks](../docs/measured.md#yardsticks),
for the rows whose times have a ratio: ${machinesText(Object.values(measured).map(({ yardstick }) => yardstick))}.
`];
  const paths = of('path');
  if (paths.length) parts.push(`## The ways of a picture

The sample in a viewer of 160×220, ${fixed(Math.min(...paths.map(({ name }) => measured[name].frames)))} pictures or more each, over loops, seeks while it plays and while it is paused, two motions, the class's slider and
the lowest and highest rung. Every picture's number is read from its barcode, on the GPU but for planes; one that does not fit its presentation is refused and
never shown (the player's unit test compares 10,000 shown pictures with their meshes where pictures are misnamed, left out and offered too early: none differs).
Times in ms: from picture to picture and over the loop median / 95 % / worst, from a seek to its frame and the longest gap in the second after a rung was asked for
median / worst.

${table(['', 'pictures', 'refused', 'left out', ...['picture to picture', 'over a loop', 'seek', 'rung'].map((title) => titled(title, paths))], paths.map(({ name, title }) => {
    const r = measured[name];
    return [title, r.frames, r.mismatches, r.late, ...[r.play, r.loops].map((times) => three(times, r.yardstick)), ...[r.seeks, r.rungs].map((times) => two(times, r.yardstick))];
  }))}

A \`<video>\` element plays on from loop to loop on one timeline: a loop is no gap of its own. Left out: presentations that no picture was there for in time.
`);
  const tasks = of('tasks');
  if (tasks.length) parts.push(`## The main thread

CPU time of the longest task of the page's main thread in each scene, ms, median / worst over the scenes, from Chromium's trace. Draw calls are replaced by
nothing, which leaves the software rasteriser out; the time is the thread's own, which leaves other programs out.

${table(['scene', ...tasks.map((row) => titled(row.before ? `before (${measured[row.name].commit})` : row.title, [row]))],
    kScenes.map(([scene, title]) => [title, ...tasks.map(({ name }) => { const s = measured[name][scene]; return s ? two(s, measured[name].yardstick, 1) : '–'; })]))}
`);
  const portfolios = of('portfolio');
  if (portfolios.length) parts.push(`## Many viewers on a page

Viewers of 210×150 in three columns on a page of 640×480, each with an address of its own for the sample and without a cache: looked at for four seconds, scrolled to the
end screen by screen, and back to the top. A screen is done when every viewer on it has a picture (median / worst, s; “never” counts those that
were not after 40 s). Fetched unseen: kB for viewers that had not been on screen when the page had been looked at;
those within one screen load ahead. Decoders: the most at once, of at most 12 viewers, which hold a second one around changes. Back at the top: pictures of the first viewer in a second.
Megabytes held at once are of the whole page${portfolios.some(({ before }) => before) ? '; the earlier version counts those of one viewer only' : ''}.

${table(['', 'contexts', 'modules', 'decoders', 'errors', titled('top, s', portfolios), titled('a screen, s', portfolios), 'never', 'unseen, kB', 'loaded', 'GPU, MB', 'heap, MB', 'back'], portfolios.map(({ name, title, before }) => {
    const r = measured[name], steps = [...r.steps].sort((a, b) => a - b);
    const seconds = (...list) => timed(list.map((ms) => ms / 1000), 's', 1, r.yardstick);
    return [`${title}${before ? `, before (${r.commit})` : ''}`, r.contexts, r.modules, r.decoders, r.errors, seconds(r.firstMs),
      seconds(steps[steps.length >> 1], steps.at(-1)), r.failed, fixed(r.unseenBytes / 1000), r.peak.loaded, mega(r.peak.gpu), mega(r.peak.heap), r.back];
  }))}
`);
  for (const { name, title } of of('pressure')) {
    const r = measured[name];
    parts.push(`On a phone's screen of 390×1280 that shows all ${title} at once, each to show the class at its highest rung, ${r.loaded} hold it in the end, in ${mega(r.bytes)} MB
of the 160 MB that phones have for a page; at most ${r.most.loaded} held something, and ${mega(r.most.bytes)} MB, for the moment until what they turn out to hold is known. ${r.decoders} decoders at the most, ${r.errors} errors.
`);
  }
  const uploads = of('uploads');
  if (uploads.length) parts.push(`## Bytes for a picture

The class of the sample, whose picture has two motions, at the end of its slider (one motion has all the weight) and in the middle. Megabytes per picture that is decoded (earlier \`rgba\` pictures: that is
shown, because they were not counted): copied out of the decoder, copied again into the player's memory, uploaded with meshes and labels; and held: textures, the module's memory. Pictures of planes that come too late to be shown are decoded, but not uploaded any more, which on these
two cores is a part of what is saved. Pictures that wait are in the module's memory now; before they were in JavaScript's buffers, which no column counts.

${table(['', 'slider', 'copied', 'again', 'uploaded', 'textures', 'module'], uploads.flatMap(({ name, title, before }) => ['end', 'middle'].map((place) => {
    const r = measured[name][place];
    const each = (key) => mega((r[key] * r.shown) / Math.max(r.decoded || r.shown, r.shown));
    return [`${title}${before ? `, before (${measured[name].commit})` : ''}`, place, each('decoderCopies'), each('heapCopies'), each('uploads'), mega(r.textures), mega(r.wasm)];
  })))}
`);
  for (const { name, title } of of('bench')) parts.push(`## ${title}

\`${measured[name].command}\`, natively, with llvmpipe:

\`\`\`
${measured[name].text}${measured[name].yardstick ? `\nyardstick: ${machineText(measured[name].yardstick)}` : ''}
\`\`\`
`);
  const [decoding] = of('decoding');
  if (decoding) parts.push(`## Decoding geometry in a page

Ms a frame in Chromium, draw calls left out, of the first load / median of ${measured.decoding.motions.locomotion.page.later.count} later ones, when the browser has compiled the code well: in the worker, and in slices of
the main thread where there is no worker.

${table(['', ...['worker', 'main thread'].map((title) => titled(title, [decoding]))], [['pickup, a plain motion', 'pickup'], ['locomotion, a class of two', 'locomotion']].map(([title, name]) => {
    const { worker, page } = measured.decoding.motions[name];
    return [title, ...[worker, page].map(({ first, later }) => timed([first, later.median], 'ms', 1, measured.decoding.yardstick))];
  }))}
`);
  const [endurance] = of('endurance');
  if (endurance) parts.push(`## After long use

One page: 51 viewers one after the other, then one that plays every motion, changes motions 200 times, loses its context ten times, is hidden for two minutes and plays
for ten. Caches fill at first: the rows to compare are those after 10 and after 50 more viewers, and after 40 and after 200 changes. JavaScript's heap after a collection; the module's memory, and what its allocator has given out; WebGL objects that are alive.

${table(['', 'module, MB', 'in use, MB', 'heap, MB', 'textures', 'texture MB', 'buffers', 'programs', 'contexts', 'decoders', 'open frames', 'refused'], measured.endurance.rows.map((r) =>
    [r.title, fixed(r.wasm / 1e6, 1), r.in_use ? mega(r.in_use) : '–', mega(r.heap), r.textures, fixed(r.texture_bytes / 1e6, 1), r.buffers, r.programs, r.contexts, r.decoders, r.frames, r.mismatches]))}
`);
  return `${parts.join('\n').trimEnd()}\n`;
}
