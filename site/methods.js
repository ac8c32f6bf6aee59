// SPDX-License-Identifier: Apache-2.0
// Two methods on one view with a divider between them: method and surface of each side, position of the divider. Both
// viewers share one orbit and play the same moment.
import './fourdvt-viewer/fourdvt-viewer.js';
import { playTogether, turnTogether } from './together.js';

// Methods in the order of `fourdvt render --help`. group: heading in the menu.
const METHODS = {
  sweep: { title: 'Sweep', text: 'Each pixel at the depth where the cameras agree best' },
  fvvr: { title: 'FVVR', text: 'Cameras that see the point, weighted by angle' },
  lumigraph: { title: 'Lumigraph', text: 'Nearer cameras have larger weights, which fade in and out' },
  filtered: { title: 'Filtered', text: 'Blurred along the view ray by the uncertainty of the surface' },
  'band-limited': { title: 'Band-limited', text: 'Blurred everywhere by the spacing of the cameras' },
  linear: { title: 'Linear', text: 'As Floating Textures, without optical flow' },
  floating: { title: 'Floating Textures', text: 'Optical flow aligns the pictures before blending' },
  'floating-pairs': { title: 'Floating, all pairs', text: 'Optical flow between all pairs of pictures, as in the paper' },
  'floating-static': { title: 'Floating, kept flow', text: 'Optical flow once a frame, in the cameras’ views; turning costs a look-up' },
  holoportation: { title: 'Holoportation', text: 'Cameras that the surface faces, without outliers' },
  montage4d: { title: 'Montage4D', text: 'Weights that change smoothly over the surface and with time' },
  'montage4d-seams': { title: 'Montage4D’s seams', text: 'Distance of each point from the seams of each camera', group: 'Inspect' },
  'montage4d-weights': { title: 'Montage4D’s weights', text: 'Cameras at each point, one colour a camera', group: 'Inspect' },
  wireframe: { title: 'Wireframe', text: 'The triangles of this frame', group: 'Inspect' },
  silhouette: { title: 'Silhouette', text: 'Where the surface is', group: 'Inspect' },
};
// Initial pair of methods, and instructive pairs.
const FIRST = ['fvvr', 'montage4d'];
const PAIRS = [
  { title: 'Blur', methods: ['filtered', 'lumigraph'] },
  { title: 'Flow', methods: ['linear', 'floating'] },
  { title: 'Depth', methods: ['fvvr', 'sweep'] },
  { title: 'Seams', methods: ['montage4d-seams', 'montage4d'] },
  { title: 'Weights', methods: ['montage4d-weights', 'montage4d'] },
  { title: 'Triangles', methods: ['wireframe', 'sweep'] },
];
const KEY_STEPS = { ArrowLeft: -2, ArrowDown: -2, ArrowRight: 2, ArrowUp: 2, PageDown: -10, PageUp: 10, Home: -100, End: 100 };

const byId = (id) => document.getElementById(id);
const left = byId('left'), right = byId('right'), viewers = [left, right];
const handle = byId('handle'), wipe = byId('wipe'), scrub = byId('scrub'), transport = byId('transport');

// --- methods ---

function fill(select) {
  const groups = new Map();
  for (const [name, { title, group }] of Object.entries(METHODS)) {
    if (group && !groups.has(group)) {
      groups.set(group, document.createElement('optgroup'));
      groups.get(group).label = group;
      select.append(groups.get(group));
    }
    (groups.get(group) ?? select).append(new Option(title, name));
  }
}
function show(side, name) {
  notice('');
  byId(side).method = name;
  byId(`${side}-method`).value = name;
  byId(`${side}-title`).textContent = METHODS[name].title;
  byId(`${side}-text`).textContent = METHODS[name].text;
  describeLine();
}
for (const side of ['left', 'right']) {
  const select = byId(`${side}-method`);
  fill(select);
  select.addEventListener('change', () => show(side, select.value));
}
for (const { title, methods: [a, b] } of PAIRS) {
  const button = Object.assign(document.createElement('button'), { type: 'button', textContent: title });
  button.addEventListener('click', () => {
    show('left', a);
    show('right', b);
  });
  byId('pairs').append(button);
}

// --- divider ---

let line = 50; // percent of the width
function moveLine(percent) {
  line = Math.min(100, Math.max(0, percent));
  wipe.style.setProperty('--split', `${line}%`);
  describeLine();
}
function describeLine() {
  handle.setAttribute('aria-valuenow', String(Math.round(line)));
  handle.setAttribute('aria-valuetext', `${Math.round(line)} % ${byId('left-title').textContent}, the rest ${byId('right-title').textContent}`);
}
handle.addEventListener('pointerdown', (e) => {
  if (e.button !== 0) return;
  handle.setPointerCapture(e.pointerId);
  handle.focus({ preventScroll: true });
  e.preventDefault();
});
handle.addEventListener('pointermove', (e) => {
  if (!handle.hasPointerCapture(e.pointerId)) return;
  const { left: from, width } = wipe.getBoundingClientRect();
  moveLine((100 * (e.clientX - from)) / width);
});
handle.addEventListener('keydown', (e) => {
  const step = KEY_STEPS[e.key];
  if (!step || e.ctrlKey || e.metaKey || e.altKey) return;
  e.preventDefault();
  moveLine(line + step);
});

// --- surface, playing, messages ---

function notice(text) {
  byId('notice').textContent = text;
  byId('notice').hidden = !text;
}
function choose(surface) {
  notice('');
  for (const viewer of viewers) {
    viewer.poster = `cameras/${surface}/poster.webp`;
    viewer.src = `cameras/${surface}/character.gltf`;
  }
}
byId('surface').addEventListener('change', (e) => choose(e.target.value));

function showPlaying() {
  transport.classList.toggle('playing', !left.paused);
  byId('play').setAttribute('aria-label', left.paused ? 'Play' : 'Pause');
}
byId('play').addEventListener('click', () => {
  if (left.paused) void left.play().catch(() => {});
  else left.pause();
});
scrub.addEventListener('input', () => {
  left.pause();
  left.seekFrame(Number(scrub.value));
});
function showFrame() {
  requestAnimationFrame(showFrame);
  const frames = left.sequences.find(({ name }) => name === left.sequence)?.frames;
  if (!frames) return;
  scrub.max = String(frames - 1);
  if (!left.paused) scrub.value = String(left.frame);
  byId('frame').value = `frame ${left.frame} of ${frames}`;
}
for (const type of ['play', 'pause']) left.addEventListener(type, showPlaying);

for (const viewer of viewers) {
  viewer.addEventListener('error', (e) => notice(e.detail.message));
  viewer.addEventListener('methodfallback', (e) => notice(e.detail.message));
}
const playable = (viewer) => new Promise((done) => viewer.addEventListener('canplay', done, { once: true }));
void Promise.all(viewers.map(playable)).then(() => {
  turnTogether(left, right);
  playTogether(left, right);
  showPlaying();
  showFrame();
});
['left', 'right'].forEach((side, i) => show(side, FIRST[i]));
const { value } = byId('surface').querySelector(':checked'); // browsers restore the choice on reload
if (value !== 'hull') choose(value);
moveLine(50);
