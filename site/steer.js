// SPDX-License-Identifier: Apache-2.0
// Performer in a scene (place.js), steered by keys or joystick; a button adds a companion.
import './fourdvt-viewer/fourdvt-viewer.js';
import { COURT_M, makePlace } from './place.js';
import { makeSoundButton } from './sound.js';

const byId = (id) => document.getElementById(id);
const viewer = byId('viewer');
viewer.scene = makePlace();

// Switches to the steerable class of motions after the first sequence, which loads faster.
viewer.addEventListener('canplay', () => {
  const motion = viewer.sequences.find((s) => s.parameters.length > 0);
  if (motion) viewer.goTo(motion.name);
  byId('company').disabled = false;
  viewer.focus({ preventScroll: true });
}, { once: true });

// Turns the performer back at the edge of the court.
viewer.addEventListener('timeupdate', () => {
  const { x, z, heading } = viewer.placement;
  if (Math.hypot(x, z) < COURT_M) return;
  const inwards = Math.atan2(-x, -z) * 180 / Math.PI;
  const turn = ((inwards - heading) % 360 + 540) % 360 - 180;
  if (Math.abs(turn) > 60) viewer.heading = heading + turn;
});

function showSpeed() {
  const [parameter] = viewer.parameters;
  byId('speed').value = parameter ? `${viewer.getParameter(parameter.name).toFixed(2)} m/s` : viewer.sequence;
}
for (const type of ['timeupdate', 'parameterchange', 'transitionend']) viewer.addEventListener(type, showSpeed);

makeSoundButton(viewer, byId('sound'));

byId('company').addEventListener('click', () => {
  const companion = document.createElement('fourdvt-character');
  const { x, z, heading } = viewer.placement;
  companion.setAttribute('src', viewer.getAttribute('src'));
  companion.setAttribute('sequence', viewer.sequences.find((s) => s.parameters.length > 0)?.name ?? viewer.sequence);
  companion.setAttribute('position', `${(x + 1.3).toFixed(2)} ${(z + 1).toFixed(2)}`);
  companion.setAttribute('heading', String(heading));
  companion.setAttribute('travel', '');
  viewer.append(companion);
  byId('company').disabled = true;
  // Lets the companion walk in a wide circle.
  const turning = setInterval(() => {
    if (companion.isConnected) companion.heading = companion.heading + 12;
    else clearInterval(turning);
  }, 400);
  viewer.focus();
});

viewer.addEventListener('error', (event) => {
  byId('notice').textContent = event.detail?.message ?? 'The character cannot be shown.';
  byId('notice').hidden = false;
});
for (const type of ['loadstart', 'canplay', 'playing', 'seeked', 'sequencechange']) {
  viewer.addEventListener(type, () => { byId('notice').hidden = true; });
}
