// SPDX-License-Identifier: Apache-2.0
// Console of `fourdvt live`: the performer, the cameras' pictures with their outlines, tolerance and quality. The token
// stands in the fragment (#) of the page's address, which browsers do not send, so that it stays out of the server's
// logs.
import '../fourdvt-viewer/fourdvt-viewer.js';

const PICTURES_MS = 250; // period of a camera's pictures
const LONGEST_PAUSE_MS = 4000;

const byId = (id) => document.getElementById(id);
const token = new URLSearchParams(location.hash.slice(1) || location.search).get('token') ?? '';
const address = (path) => {
  const url = new URL(path, location.origin.replace(/^http/, 'ws'));
  if (token) url.searchParams.set('token', token);
  return url.href;
};
const ask = (path) => fetch(path, { cache: 'no-store', headers: token ? { Authorization: `Bearer ${token}` } : {} });

// --- the performer ---

const viewer = byId('viewer');
const showState = (state) => {
  byId('state').textContent = state;
  byId('state').className = state;
};
viewer.addEventListener('livestatechange', (e) => showState(e.detail));
viewer.addEventListener('error', (e) => {
  byId('notice').textContent = e.detail.message;
  byId('notice').hidden = false;
});
viewer.addEventListener('canplay', () => (byId('notice').hidden = true));
viewer.src = address('/live');

// --- figures ---

const kilobits = (bytes) => `${Math.round(bytes / 125)} kbit/s`;
const milliseconds = (ms) => `${ms.toFixed(ms < 10 ? 1 : 0)} ms`;

function figuresOf(status) {
  const cameras = status.cameras.filter(({ connected, lost }) => connected && !lost);
  const sum = (field) => cameras.reduce((total, camera) => total + camera[field], 0);
  return [
    ['frames a second', status.frames_per_s.toFixed(1)],
    ['capture to frame', milliseconds(status.latency_ms)],
    ['capture to page', Number.isFinite(viewer.liveLatency) ? milliseconds(1000 * viewer.liveLatency) : '–'],
    ['triangles', Math.round(status.triangles).toLocaleString('en')],
    ['tolerance', `${status.tolerance_px.toFixed(1)} px`],
    ['hull, picture, coding', [status.hull_ms, status.picture_ms, status.encode_ms].map((ms) => ms.toFixed(1)).join(' + ') + ' ms'],
    ['from cameras', kilobits(sum('contour_bytes_per_s') + sum('picture_bytes_per_s'))],
    ['to each page', kilobits(status.surface_bytes_per_s + status.picture_bytes_per_s)],
    ['cameras', `${cameras.length} of ${status.cameras.length}`],
    ['late, left out', `${status.cameras.reduce((total, { late }) => total + late, 0)}, ${status.skipped + status.failed}`],
  ];
}

function showFigures(status) {
  byId('figures').replaceChildren(...figuresOf(status).map(([name, value]) => {
    const group = document.createElement('div'), term = document.createElement('dt'), text = document.createElement('dd');
    term.textContent = name;
    text.textContent = value;
    group.append(term, text);
    return group;
  }));
}

// --- cameras ---

const tiles = new Map(); // name → { item, canvas, text, number }

function tileOf(name) {
  if (tiles.has(name)) return tiles.get(name);
  const item = document.createElement('li'), canvas = document.createElement('canvas'), text = document.createElement('span');
  const title = document.createElement('b');
  title.textContent = name;
  item.append(canvas, title, ' ', text);
  byId('cameras').append(item);
  const tile = { item, canvas, text, number: -1 };
  tiles.set(name, tile);
  return tile;
}

function showCameras(status) {
  for (const camera of status.cameras) {
    const tile = tileOf(camera.name), there = camera.connected && !camera.lost;
    tile.item.classList.toggle('away', !there);
    tile.text.textContent = !camera.connected ? 'not connected' : camera.lost ? 'no pictures' :
      `${milliseconds(camera.keyed_ms)} · ${kilobits(camera.contour_bytes_per_s + camera.picture_bytes_per_s)}${camera.late ? ` · ${camera.late} late` : ''}`;
    tile.there = there;
  }
}

async function showPicture(name, tile) {
  const path = `/cameras/${encodeURIComponent(name)}`;
  const about = await (await ask(`${path}.json`)).json();
  if (about.number === tile.number) return;
  const answer = about.crop[2] ? await ask(`${path}.jpg`) : null;
  const picture = answer?.ok ? await createImageBitmap(await answer.blob()) : null;
  const { canvas } = tile, [width, height] = about.size, context = canvas.getContext('2d');
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  context.clearRect(0, 0, width, height);
  if (picture) context.drawImage(picture, about.crop[0], about.crop[1]);
  picture?.close();
  context.beginPath();
  for (const ring of about.rings) {
    ring.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.closePath();
  }
  context.lineWidth = Math.max(1, width / 240);
  context.strokeStyle = '#ff3d71';
  context.stroke();
  tile.number = about.number;
}

async function showPictures() {
  if (!document.hidden) {
    for (const [name, tile] of tiles) if (tile.there) await showPicture(name, tile).catch(() => undefined);
  }
  setTimeout(showPictures, PICTURES_MS);
}

// --- connection to the server, controls ---

let socket = null, pauseMs = 250;

function connect() {
  socket = new WebSocket(address('/console'));
  socket.addEventListener('open', () => (pauseMs = 250));
  socket.addEventListener('message', (e) => {
    const status = JSON.parse(e.data);
    showFigures(status);
    showCameras(status);
  });
  socket.addEventListener('close', ({ code, reason }) => {
    if (code === 4401 || code === 4403) {
      byId('notice').textContent = reason;
      byId('notice').hidden = false;
      return;
    }
    setTimeout(connect, pauseMs * (0.5 + Math.random() / 2));
    pauseMs = Math.min(2 * pauseMs, LONGEST_PAUSE_MS);
  });
}

const tell = (wish) => socket?.readyState === WebSocket.OPEN && socket.send(JSON.stringify(wish));
byId('tolerance').addEventListener('input', ({ target }) => {
  byId('tolerance-text').value = Number(target.value) ? `${target.value} px` : 'by control';
  tell({ tolerance_px: Number(target.value) });
});
byId('crf').addEventListener('input', ({ target }) => {
  byId('crf-text').value = `CRF ${-target.value}`;
  tell({ crf: -target.value });
});
byId('controls').addEventListener('submit', (e) => e.preventDefault());

connect();
void showPictures();
