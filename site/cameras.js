// SPDX-License-Identifier: Apache-2.0
// Characters from cameras beside the layered one: surface, rendering method, number of cameras. Both viewers share one
// orbit and play the same moment.
import './fourdvt-viewer/fourdvt-viewer.js';
import { playTogether, turnTogether } from './together.js';

const byId = (id) => document.getElementById(id);
const cameras = byId('cameras');
const layers = byId('layers');
const TEXTS = {
  hull: 'Visual hull: the intersection of the silhouettes',
  refined: 'Hull refined by stereo matching',
  tracked: 'Mesh of the layered character',
};

function choose(surface) {
  byId('cameras-text').textContent = TEXTS[surface];
  const folder = `cameras/${surface}`;
  if (cameras.getAttribute('src') === `${folder}/character.gltf`) return;
  cameras.poster = `${folder}/poster.webp`;
  cameras.src = `${folder}/character.gltf`;
}

byId('surface').addEventListener('change', (e) => choose(e.target.value));
byId('method').addEventListener('change', (e) => { cameras.method = e.target.value; });
byId('count').addEventListener('input', (e) => {
  byId('count-text').value = e.target.value;
  cameras.setAttribute('cameras', e.target.value);
});
choose(byId('surface').querySelector(':checked').value);

let ready = 0;
for (const viewer of [cameras, layers]) {
  viewer.addEventListener('canplay', () => {
    byId('notice').hidden = true;
    if (++ready < 2) return;
    turnTogether(cameras, layers);
    playTogether(layers, cameras);
  }, { once: true });
  viewer.addEventListener('error', (e) => {
    byId('notice').textContent = e.detail.message;
    byId('notice').hidden = false;
  });
}
