// SPDX-License-Identifier: Apache-2.0
// A small scene to steer through: paved ground, crates and columns that hide the performer; a button adds a companion.
import './fourdvt-viewer/fourdvt-viewer.js';
import { makeSoundButton } from './sound.js';

const byId = (id) => document.getElementById(id);
const viewer = byId('viewer');
const TILE_M = 1;
const HALF_TILES = 14;
const TURN_BACK_M = 11;

// Triangles as the viewer takes them: x, y, z, r, g, b per corner.
class Shape {
  #numbers = [];
  quad(a, b, c, d, color) {
    for (const corner of [a, b, c, a, c, d]) this.#numbers.push(...corner, ...color);
  }
  // An upright box on the ground; sides shaded as if lit from the upper left.
  box(x, z, width, height, depth, [r, g, b]) {
    const [x0, x1, z0, z1] = [x - width / 2, x + width / 2, z - depth / 2, z + depth / 2];
    const shade = (k) => [r * k, g * k, b * k];
    this.quad([x0, height, z1], [x1, height, z1], [x1, height, z0], [x0, height, z0], shade(1));
    this.quad([x0, 0, z1], [x1, 0, z1], [x1, height, z1], [x0, height, z1], shade(0.82));
    this.quad([x1, 0, z0], [x0, 0, z0], [x0, height, z0], [x1, height, z0], shade(0.66));
    this.quad([x1, 0, z1], [x1, 0, z0], [x1, height, z0], [x1, height, z1], shade(0.6));
    this.quad([x0, 0, z0], [x0, 0, z1], [x0, height, z1], [x0, height, z0], shade(0.74));
  }
  get corners() { return Float32Array.from(this.#numbers); }
}

function ground() {
  const shape = new Shape();
  for (let i = -HALF_TILES; i < HALF_TILES; ++i) {
    for (let j = -HALF_TILES; j < HALF_TILES; ++j) {
      const [x, z] = [i * TILE_M, j * TILE_M];
      const tone = ((i + j) & 1 ? 0.745 : 0.715) + 0.012 * (((i * 7 + j * 13) % 5) - 2);
      shape.quad([x, -0.004, z + TILE_M], [x + TILE_M, -0.004, z + TILE_M], [x + TILE_M, -0.004, z], [x, -0.004, z], [tone, tone * 0.985, tone * 0.95]);
    }
  }
  return shape.corners;
}

function props() {
  const shape = new Shape();
  const wood = [0.72, 0.55, 0.36];
  const stone = [0.66, 0.66, 0.68];
  shape.box(1.6, 3.2, 0.9, 0.9, 0.9, wood);
  shape.box(2.5, 3.6, 0.7, 0.7, 0.7, wood);
  shape.box(-2.4, 5, 1.4, 0.5, 0.8, wood);
  for (const [x, z] of [[-4, 2], [-4, 8], [4.5, 7], [4.5, -3], [-1, 10]]) shape.box(x, z, 0.45, 2.6, 0.45, stone);
  shape.box(0, -5, 5, 0.45, 0.5, stone);
  return shape.corners;
}

viewer.scene = [{ corners: ground() }, { corners: props() }];

// The first sequence is on screen sooner than the class that can be steered.
viewer.addEventListener('canplay', () => {
  const motion = viewer.sequences.find((s) => s.parameters.length > 0);
  if (motion) viewer.goTo(motion.name);
  byId('company').disabled = false;
  viewer.focus({ preventScroll: true });
}, { once: true });

// At the edge of the ground the performer turns back.
viewer.addEventListener('timeupdate', () => {
  const { x, z, heading } = viewer.placement;
  if (Math.hypot(x, z) < TURN_BACK_M) return;
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
  // The companion walks in a wide circle.
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
