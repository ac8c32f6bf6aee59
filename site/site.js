// SPDX-License-Identifier: Apache-2.0
// Connects the page's controls to its <fourdvt-viewer>. Figures about the character are read from its own files;
// unreadable ones are hidden.
import './fourdvt-viewer/fourdvt-viewer.js';
import { makeSoundButton } from './sound.js';

const byId = (id) => document.getElementById(id);
const viewer = byId('viewer');
const motions = byId('motions');
const playButton = byId('play');
const scrub = byId('scrub');
const time = byId('time');
const calm = matchMedia('(prefers-reduced-motion: reduce)');

const UNITS = { mps: 'm/s', m: 'm', deg: '°', dps: '°/s', s: 's' };
let scrubbing = false;
let resumeAfterScrub = false;
let chosen = false; // true once the visitor has chosen a motion

// Splits "speed_mps" into the label "Speed" and the unit "m/s".
function describeParameter(name) {
  const [, words, unit] = /^(.*?)(?:_([a-z]+))?$/.exec(name);
  return UNITS[unit] ? { label: capital(words), unit: UNITS[unit] } : { label: capital(name), unit: '' };
}

function capital(words) {
  const text = words.replaceAll('_', ' ');
  return text.charAt(0).toUpperCase() + text.slice(1);
}

function labelOf(name) {
  const words = { pickup: 'Pick up' };
  const members = viewer.sequences.find((s) => s.name === name)?.members ?? [];
  if (members.length > 1) return members.map((member, i) => (i ? member : capital(member))).join(' ↔ ');
  return words[name] ?? capital(name);
}

function currentSequence() {
  return viewer.sequences.find((s) => s.name === viewer.sequence) ?? viewer.sequences[0];
}

function showPlaying() {
  const playing = !viewer.paused || resumeAfterScrub;
  playButton.classList.toggle('playing', playing);
  playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
}

function showTime() {
  const sequence = currentSequence();
  if (!sequence) return;
  const seconds = (scrubbing ? Number(scrub.value) / sequence.fps : viewer.currentTime).toFixed(2);
  const total = (sequence.frames / sequence.fps).toFixed(2);
  if (!scrubbing) scrub.value = String(viewer.frame);
  scrub.setAttribute('aria-valuetext', `${seconds} of ${total} seconds`);
  time.value = `${seconds} / ${total} s`;
}

function showSequence() {
  const sequence = currentSequence();
  if (!sequence) return;
  scrub.max = String(Math.max(1, sequence.frames - 1));
  const radio = [...motions.querySelectorAll('input')].find((input) => input.value === viewer.state);
  if (radio) radio.checked = true;
  showParameter();
  showTime();
}

// Sets up the slider of the first class of motions, also while another motion plays.
function showParameter() {
  const [parameter] = viewer.sequences.flatMap((s) => s.parameters);
  if (!parameter) return;
  const { label, unit } = describeParameter(parameter.name);
  const slider = byId('parameter');
  const known = slider.dataset.name === parameter.name; // keeps the slider's value as set by the visitor
  slider.dataset.name = parameter.name;
  slider.dataset.unit = unit;
  slider.min = String(parameter.min);
  slider.max = String(parameter.max);
  slider.step = String((parameter.max - parameter.min) / 200);
  const value = viewer.getParameter(parameter.name);
  if (!known) slider.value = String(Number.isFinite(value) ? value : parameter.min);
  byId('parameter-name').textContent = label;
  byId('blend').hidden = byId('to-steer').hidden = false;
  writeParameter();
}

function writeParameter() {
  const slider = byId('parameter');
  const text = `${Number(slider.value).toFixed(2)} ${slider.dataset.unit ?? ''}`.trim();
  byId('parameter-value').value = text;
  slider.setAttribute('aria-valuetext', text);
}

function buildMotions() {
  for (const old of motions.querySelectorAll('label')) old.remove();
  const members = new Set(viewer.sequences.flatMap((s) => (s.members.length > 1 ? s.members : [])));
  for (const sequence of viewer.sequences) {
    if (members.has(sequence.name)) continue; // covered by the class's slider
    const label = document.createElement('label');
    const radio = document.createElement('input');
    radio.type = 'radio';
    radio.name = 'motion';
    radio.value = sequence.name;
    radio.addEventListener('change', () => chooseMotion(sequence.name));
    label.append(radio, labelOf(sequence.name));
    motions.append(label);
  }
  motions.disabled = playButton.disabled = scrub.disabled = false;
  showSequence();
}

// Plays the chosen motion if the previous one has ended, unless the visitor prefers reduced motion.
function chooseMotion(name) {
  chosen = true;
  const wasAtEnd = !currentSequence()?.loop && viewer.frame + 1 >= (currentSequence()?.frames ?? 0);
  viewer.goTo(name);
  if (wasAtEnd && !calm.matches) viewer.play();
}

function togglePlay() {
  if (!viewer.paused) return viewer.pause();
  const sequence = currentSequence();
  if (sequence && viewer.frame + 1 >= sequence.frames) viewer.seekFrame(0);
  viewer.play();
}

function startScrub() {
  if (scrubbing) return;
  scrubbing = true;
  resumeAfterScrub = !viewer.paused;
  viewer.pause();
}

function endScrub() {
  if (!scrubbing) return;
  scrubbing = false;
  if (resumeAfterScrub) viewer.play();
  resumeAfterScrub = false;
  showPlaying();
}

scrub.addEventListener('pointerdown', startScrub);
for (const type of ['pointerup', 'pointercancel', 'blur']) scrub.addEventListener(type, endScrub);
scrub.addEventListener('input', () => {
  const sequence = currentSequence();
  if (!sequence) return;
  viewer.seekFrame(Number(scrub.value));
  showTime();
});
playButton.addEventListener('click', togglePlay);

byId('parameter').addEventListener('input', () => {
  const slider = byId('parameter');
  writeParameter();
  viewer.setParameter(slider.dataset.name, Number(slider.value));
});
viewer.addEventListener('parameterchange', ({ detail }) => {
  const slider = byId('parameter');
  if (detail.name !== slider.dataset.name || Number(slider.value) === detail.value) return;
  slider.value = String(detail.value);
  writeParameter();
});
byId('align').addEventListener('change', () => { viewer.align = byId('align').value; });

viewer.addEventListener('loadedmetadata', buildMotions);
// Continues with a class of motions if there is one, because it has a slider; the first sequence starts faster.
viewer.addEventListener('canplay', () => {
  const motion = viewer.sequences.find((s) => s.parameters.length > 0);
  if (motion && !viewer.hasAttribute('sequence') && !chosen) viewer.goTo(motion.name);
}, { once: true });
// Loads pictures below the fold when they are near; native lazy loading counts thousands of pixels as near.
const late = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (!isIntersecting) continue;
    late.unobserve(target);
    target.src = target.dataset.late;
  }
}, { rootMargin: '50%' });
for (const image of document.querySelectorAll('img[data-late]')) late.observe(image);
for (const type of ['transitionstart', 'transitionend']) viewer.addEventListener(type, showSequence);
viewer.addEventListener('sequencechange', showSequence);
for (const type of ['timeupdate', 'seeked', 'ended']) viewer.addEventListener(type, showTime);
for (const type of ['play', 'playing', 'pause', 'ended']) viewer.addEventListener(type, showPlaying);
makeSoundButton(viewer, byId('sound'));
// Shows an error's details in the notice until it is resolved; the viewer's own panel shows only that one occurred.
viewer.addEventListener('error', (event) => {
  const { id, message } = event.detail ?? {};
  const notice = byId('notice');
  notice.textContent = `The viewer reports: ${message ?? 'unknown reason'}${id ? ` (${id})` : ''}`;
  notice.hidden = false;
});
for (const type of ['loadstart', 'canplay', 'playing', 'seeked', 'sequencechange']) {
  viewer.addEventListener(type, () => { byId('notice').hidden = true; });
}
// Sets the look by attribute; the viewer fetches its data when it is first selected.
for (const radio of byId('looks').querySelectorAll('input')) {
  radio.addEventListener('change', () => {
    byId('look-dials').hidden = !radio.value;
    byId('light-dial').hidden = radio.value !== 'relit';
    if (radio.value) viewer.setAttribute('look', radio.value);
    else viewer.removeAttribute('look');
  });
}
for (const [name, textOf] of [['look-strength', (v) => `${Math.round(100 * v)} %`], ['light-turn', (v) => `${v}°`]]) {
  const slider = byId(name);
  slider.addEventListener('input', () => {
    const text = textOf(Number(slider.value));
    byId(`${name}-value`).value = text;
    slider.setAttribute('aria-valuetext', text);
    viewer.setAttribute(name, slider.value);
  });
}

if (viewer.sequences.length) buildMotions();
showPlaying();

const copy = byId('copy');
copy.hidden = !navigator.clipboard;
copy.addEventListener('click', async () => {
  try {
    await navigator.clipboard.writeText(byId('snippet').textContent);
    copy.textContent = 'Copied';
  } catch {
    getSelection().selectAllChildren(byId('snippet'));
    copy.textContent = 'Selected';
  }
  setTimeout(() => { copy.textContent = 'Copy'; }, 2000);
});

function showFigures(report) {
  const megabits = report.sequences.map((s) => s.total_mbit_per_s);
  const figures = [
    [report.cameras, 'cameras'],
    [report.options.layers, 'texture layers'],
    [report.faces.toLocaleString('en'), 'triangles'],
    [`${(report.bytes / 1e6).toFixed(1)} MB`, `for ${report.sequences.map((s) => labelOf(s.name).toLowerCase()).join(', ')}`],
    [`${Math.max(...megabits).toFixed(1)} Mbit/s`, 'highest stream rate'],
  ];
  byId('figures').replaceChildren(...figures.map(([value, meaning]) => {
    const group = document.createElement('div');
    group.append(document.createElement('dt'), document.createElement('dd'));
    group.children[0].textContent = meaning;
    group.children[1].textContent = value;
    return group;
  }));
  for (const [name, value] of Object.entries({ cameras: report.cameras, layers: report.options.layers })) {
    document.querySelector(`[data-figure="${name}"]`).textContent = String(value);
  }
  byId('figures').hidden = byId('figures-text').hidden = false;
}

// Hides text about the sample capture if another capture is shown.
function showCapture({ name, credit }) {
  if (name === 'actor_a') return;
  for (const words of document.querySelectorAll('.sample')) words.hidden = true;
  byId('credit').textContent = credit;
  viewer.setAttribute('alt', name);
}

try {
  const answer = await fetch('character.report/report.json');
  if (answer.ok) {
    const report = await answer.json();
    showCapture(report.capture);
    showFigures(report);
  }
} catch {
  // Shows no figures without a readable report.
}
