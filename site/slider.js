// SPDX-License-Identifier: Apache-2.0
// A character on a mesh tracked from cameras alone beside one on the capture's mesh: one slider sets the speed of both.
// Both viewers share one orbit and play the same phase.
import './fourdvt-viewer/fourdvt-viewer.js';
import { playTogether, turnTogether } from './together.js';

const PARAMETER = 'speed_mps';
const SLIDER_STEPS = 200;

const byId = (id) => document.getElementById(id);
const found = byId('found'), given = byId('given'), viewers = [found, given];
const slider = byId('speed');

function setSpeed() {
  const text = `${Number(slider.value).toFixed(2)} m/s`;
  byId('speed-text').value = text;
  slider.setAttribute('aria-valuetext', text);
  for (const viewer of viewers) viewer.setParameter(PARAMETER, Number(slider.value));
}

// Sets the slider's range to the speeds that both characters have, and starts at the lowest.
function offerSpeeds() {
  const ranges = viewers.map((viewer) => viewer.parameters.find(({ name }) => name === PARAMETER));
  if (!ranges.every(Boolean)) return;
  slider.min = String(Math.max(...ranges.map(({ min }) => min)));
  slider.max = String(Math.min(...ranges.map(({ max }) => max)));
  slider.step = String((slider.max - slider.min) / SLIDER_STEPS);
  slider.value = slider.min;
  slider.disabled = false;
  setSpeed();
}
slider.addEventListener('input', setSpeed);

for (const viewer of viewers) {
  viewer.addEventListener('error', (e) => {
    byId('notice').textContent = e.detail.message;
    byId('notice').hidden = false;
  });
}
const playable = (viewer) => new Promise((done) => viewer.addEventListener('canplay', done, { once: true }));
void Promise.all(viewers.map(playable)).then(() => {
  byId('notice').hidden = true;
  offerSpeeds();
  turnTogether(given, found);
  playTogether(given, found);
});
