// SPDX-License-Identifier: Apache-2.0
// Wires the page's controls to the one <fourdvt-viewer>. Everything the page says in figures is read from the
// character's own files; what cannot be read is not said.
import './fourdvt-viewer/fourdvt-viewer.js';

const byId = (id) => document.getElementById(id);
const viewer = byId('viewer');
const motions = byId('motions');
const playButton = byId('play');
const scrub = byId('scrub');
const time = byId('time');
const calm = matchMedia('(prefers-reduced-motion: reduce)');

let scrubbing = false;
let resumeAfterScrub = false;

function labelOf(name) {
  const words = { pickup: 'Pick up' };
  return words[name] ?? name.charAt(0).toUpperCase() + name.slice(1).replaceAll('_', ' ');
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
  const total = (sequence.frameCount / sequence.fps).toFixed(2);
  if (!scrubbing) scrub.value = String(viewer.frame);
  scrub.setAttribute('aria-valuetext', `${seconds} of ${total} seconds`);
  time.value = `${seconds} / ${total} s`;
}

function showSequence() {
  const sequence = currentSequence();
  if (!sequence) return;
  scrub.max = String(Math.max(1, sequence.frameCount - 1));
  const radio = [...motions.querySelectorAll('input')].find((input) => input.value === sequence.name);
  if (radio) radio.checked = true;
  showTime();
}

function buildMotions() {
  for (const old of motions.querySelectorAll('label')) old.remove();
  for (const sequence of viewer.sequences) {
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

// A new motion starts moving at once, unless the visitor paused or asked for little motion.
function chooseMotion(name) {
  const wasAtEnd = !currentSequence()?.loop && viewer.frame + 1 >= (currentSequence()?.frameCount ?? 0);
  viewer.sequence = name;
  if (wasAtEnd && !calm.matches) viewer.play();
}

function togglePlay() {
  if (!viewer.paused) return viewer.pause();
  const sequence = currentSequence();
  if (sequence && viewer.frame + 1 >= sequence.frameCount) viewer.currentTime = 0;
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
  viewer.currentTime = Number(scrub.value) / sequence.fps;
  showTime();
});
playButton.addEventListener('click', togglePlay);
viewer.addEventListener('keydown', (event) => {
  if (event.key !== ' ' || event.defaultPrevented) return;
  event.preventDefault();
  togglePlay();
});

viewer.addEventListener('loadedmetadata', buildMotions);
viewer.addEventListener('sequencechange', showSequence);
for (const type of ['timeupdate', 'seeked', 'ended']) viewer.addEventListener(type, showTime);
for (const type of ['play', 'playing', 'pause', 'ended']) viewer.addEventListener(type, showPlaying);
viewer.addEventListener('canplay', () => { if (!calm.matches) viewer.play(); }, { once: true });
viewer.addEventListener('error', (event) => {
  const { id, message } = event.detail ?? {};
  const notice = byId('notice');
  notice.textContent = `The character cannot be shown: ${message ?? 'unknown reason'}${id ? ` (${id})` : ''}`;
  notice.hidden = false;
});
if (viewer.sequences?.length) buildMotions();

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

// Figures: [value, meaning] pairs from report.json.
function showFigures(report) {
  const numbers = { cameras: report.cameras, layers: report.layers };
  if (Object.values(numbers).every((n) => Number.isInteger(n) && n > 0)) {
    for (const [name, value] of Object.entries(numbers)) {
      document.querySelector(`[data-figure="${name}"]`).textContent = String(value);
    }
    byId('figures-text').hidden = false;
  }
}

try {
  const answer = await fetch('character/report.json');
  if (answer.ok) showFigures(await answer.json());
} catch {
  // Without a report the page simply says less.
}
