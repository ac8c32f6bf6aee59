// SPDX-License-Identifier: Apache-2.0
// Composites a character with a film from a moving camera. Tests which film picture, camera and character frame each
// output frame shows, where the character stands, and what occludes it. Chromium decodes the movies; this file computes
// the expected projections, poses and placements itself.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';

import { environment, kPatienceMs, launch, outputFolder, writePicture } from './harness.mjs';
import { decodePng, encodePng } from './png.mjs';
import { serve } from './server.mjs';

const run = promisify(execFile);

const kWidth = 320, kHeight = 240;
const kFps = 12.5;            // half of the walk's: frame n of a scene shows frame 2n of it
const kCameras = 12, kFilmed = 10;  // the film ends before the track
const kUnit_m = 0.1;          // of the track's COLMAP model
const kPlace = { x: 1.5, z: -0.5, heading_deg: 60 };
const kEdge = 12;             // columns at either side that the character never covers
const kBands = 4;             // of the film: the bits of the picture's number, the lowest above
const kBit = [[200, 40, 200], [40, 200, 60]];  // magenta and green: the performer wears neither
const kOther = 70;            // sum over the channels; compression stays below, the performer is above
const kOwnLevels = 0.75;      // of the difference to the walk's frame before or after
const kMovie_px = 3;          // compression blurs edges
const kSame = 6;              // sum over the channels, of pictures that are not compressed
const kEdge_px = 1.5;

const folder = () => outputFolder('compositing');
const tool = (...args) => run(environment('BIN'), ['render', ...args], { timeout: kPatienceMs });
const put = (name, content) => writeFileSync(join(folder(), name), content);
const putScene = (name, scene) => put(name, JSON.stringify(scene));
const numbers = (count) => Array.from({ length: count }, (_, n) => n);
const frameName = (n) => String(n).padStart(6, '0');

// --- cameras: COLMAP's frame, x right, y down, z forward ---

const sub = (a, b) => a.map((v, i) => v - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((v) => v / Math.hypot(...a));

// A pose: rows of the rotation to the camera and its translation.
function lookAt(eye, target) {
  const forward = unit(sub(target, eye)), right = unit(cross(forward, [0, 1, 0]));
  const rows = [right, cross(forward, right), forward];
  return { rows, t: rows.map((row) => -dot(row, eye)) };
}

// w x y z of a rotation: divided by the largest of the four, because some may be zero.
function quaternion([[a, b, c], [d, e, f], [g, h, i]]) {
  const products = [[1 + a + e + i, h - f, c - g, d - b], [h - f, 1 + a - e - i, b + d, c + g],
    [c - g, b + d, 1 - a + e - i, f + h], [d - b, c + g, f + h, 1 - a - e + i]];
  const largest = numbers(4).reduce((k, j) => (products[j][j] > products[k][k] ? j : k), 0);
  return unit(products[largest]);
}

// Pixels and depth.
function project({ pose, fx, fy, cx, cy }, point) {
  const [x, y, z] = pose.rows.map((row, i) => dot(row, point) + pose.t[i]);
  return [fx * x / z + cx, fy * y / z + cy, z];
}

// A point of the character as placed in the world: degrees from +z towards +x.
function placed([x, y, z]) {
  const turn = kPlace.heading_deg * Math.PI / 180, [c, s] = [Math.cos(turn), Math.sin(turn)];
  return [kPlace.x + c * x + s * z, y, kPlace.z - s * x + c * z];
}
// Returns the pose from which the unplaced character looks as the placed one does from `pose`.
function unplaced({ rows, t }) {
  const zero = placed([0, 0, 0]);
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => sub(placed(axis), zero));
  return { rows: rows.map((row) => axes.map((axis) => dot(row, axis))), t: rows.map((row, i) => dot(row, zero) + t[i]) };
}

// Three lenses, the third of them with twice the pixels. Values: for pictures of the output's size.
const kLenses = [
  { id: 7, line: `PINHOLE ${kWidth} ${kHeight} 300 290 150 126`, fx: 300, fy: 290, cx: 150, cy: 126 },
  { id: 2, line: `SIMPLE_PINHOLE ${kWidth} ${kHeight} 230 170 110`, fx: 230, fy: 230, cx: 170, cy: 110 },
  { id: 31, line: `PINHOLE ${2 * kWidth} ${2 * kHeight} 560 560 330 236`, fx: 280, fy: 280, cx: 165, cy: 118 },
];

// The camera walks round the performer and looks past him, to one side and the other.
const kTrack = numbers(kCameras).map((n) => {
  const round = (-35 + 6 * n) * Math.PI / 180, away = 4.4 + 0.15 * n;
  const eye = [kPlace.x + away * Math.sin(round), 1.2 + 0.06 * n, kPlace.z + away * Math.cos(round)];
  const beside = [-0.75, 0.55, -0.55, 0.75][n % 4];
  const target = [kPlace.x + beside * Math.cos(round), 0.9, kPlace.z - beside * Math.sin(round)];
  return { ...kLenses[n % kLenses.length], name: frameName(n), pose: lookAt(eye, target) };
});

// The images stand in another order than their names.
function putCameras(name, cameras, unit_m) {
  mkdirSync(join(folder(), name), { recursive: true });
  const lenses = new Map(cameras.map(({ id, line }) => [id, `${id} ${line}\n`]));
  put(`${name}/cameras.txt`, [...lenses.values()].join(''));
  const order = cameras.map((_, n) => (n * 7 + 3) % cameras.length);
  assert.equal(new Set(order).size, cameras.length);
  put(`${name}/images.txt`, order.map((n, i) => {
    const { pose, id, name } = cameras[n];
    return `${i + 1} ${[...quaternion(pose.rows), ...pose.t.map((v) => v / unit_m)].join(' ')} ${id} ${name}.jpg\n\n`;
  }).join(''));
}

// --- the film: picture n has the bits of n + 1 as bands over its whole width ---

const bits = (number) => numbers(kBands).map((bit) => number >> bit & 1);

// Made by the tool itself: camera n stands before the board of picture n.
async function makeFilm() {
  const lens = { id: 1, line: `PINHOLE ${kWidth} ${kHeight} 320 320 160 120` };
  const vertices = [], faces = [];
  putCameras('boards', numbers(kFilmed).map((n) => {
    bits(n + 1).forEach((bit, band) => {
      const low = 3 - 1.5 * (band + 1), colour = kBit[bit].map((v) => (v / 255).toFixed(5)).join(' ');
      for (const [x, y] of [[-4, low], [4, low], [4, low + 1.5], [-4, low + 1.5]]) vertices.push(`v ${100 * n + x} ${y} 0 ${colour}`);
      faces.push(`f ${numbers(4).map((i) => vertices.length - 3 + i).join(' ')}`);
    });
    return { ...lens, name: frameName(n), pose: lookAt([100 * n, 0, 8], [100 * n, 0, 0]) };
  }), 1);
  put('boards.obj', [...vertices, ...faces, ''].join('\n'));
  putScene('boards.json', { camera: 'boards', meshes: ['boards.obj'], fps: 25, characters: [{ src: environment('CHARACTER'), position: [0, 30] }] });
  await tool('--scene', join(folder(), 'boards.json'), '--no-shadow', '-o', join(folder(), 'film.mp4'));
}

const difference = (data, at, colour) => Math.abs(data[at] - colour[0]) + Math.abs(data[at + 1] - colour[1]) + Math.abs(data[at + 2] - colour[2]);

// The number of the film's picture behind a frame, by its edges alone; fails where a band is of neither colour.
function numberBehind({ width, height, data }, what) {
  let number = 0;
  for (let band = 0; band < kBands; ++band) {
    for (const x0 of [0, width - kEdge]) {
      const far = [0, 0];
      let count = 0;
      for (let y = Math.ceil(height * band / kBands) + 4; y < height * (band + 1) / kBands - 4; ++y) {
        for (let x = x0; x < x0 + kEdge; ++x, ++count) kBit.forEach((colour, bit) => { far[bit] += difference(data, 4 * (y * width + x), colour); });
      }
      const bit = far[1] < far[0] ? 1 : 0;
      assert.ok(far[bit] / count < kOther / 2, `${what}: band ${band} is ${far.map((v) => (v / count).toFixed(0))} away from its colours`);
      if (x0 === 0) number |= bit << band;
      else assert.equal(number >> band & 1, bit, `${what}: the ends of band ${band} differ`);
    }
  }
  return number;
}

// Returns the mask of foreground in frame n of the track: 1 where the pixel differs from the film's picture.
function maskBefore(n) {
  const { data } = shown[n], behind = film[Math.min(n, kFilmed - 1)].data;
  return Uint8Array.from({ length: kWidth * kHeight }, (_, i) => (difference(data, 4 * i, behind.subarray(4 * i, 4 * i + 3)) > kOther ? 1 : 0));
}

// --- what is on pictures ---

// Rows and columns with at least three pixels.
function extent(mask) {
  const rows = new Map(), columns = new Map();
  mask.forEach((set, i) => {
    if (!set) return;
    rows.set(Math.floor(i / kWidth), (rows.get(Math.floor(i / kWidth)) ?? 0) + 1);
    columns.set(i % kWidth, (columns.get(i % kWidth) ?? 0) + 1);
  });
  const ends = (counts) => {
    const good = [...counts].filter(([, count]) => count >= 3).map(([at]) => at);
    return [Math.min(...good), Math.max(...good) + 1];
  };
  const [left, right] = ends(columns), [top, bottom] = ends(rows);
  return { left, right, top, bottom };
}

function projectedBox(camera) {
  const { min, max } = JSON.parse(readFileSync(join(environment('CHARACTER'), 'character.gltf')))
    .extensions.FOURDVT_layered_video_texture.bounds;
  const corners = numbers(8).map((i) => project(camera, placed([i & 1 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 4 ? max[2] : min[2]])));
  const ends = (axis) => [Math.min(...corners.map((c) => c[axis])), Math.max(...corners.map((c) => c[axis]))];
  const [left, right] = ends(0), [top, bottom] = ends(1);
  return { left, right, top, bottom };
}
const holds = (outer, inner, by) => inner.left >= outer.left - by && inner.right <= outer.right + by &&
  inner.top >= outer.top - by && inner.bottom <= outer.bottom + by;
const text = ({ left, right, top, bottom }) => `x ${left.toFixed(0)} to ${right.toFixed(0)}, y ${top.toFixed(0)} to ${bottom.toFixed(0)}`;

// Pictures of a movie in the folder, by their time.
function moviePictures(page, name, fps) {
  return page.evaluate(async ({ name, fps, patience }) => {
    const video = document.createElement('video');
    video.muted = true;
    video.src = name;
    document.body.append(video);
    await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = () => fail(new Error(`${name}: ${video.error.message}`)); });
    const count = Math.round(video.duration * fps), pictures = [];
    const canvas = new OffscreenCanvas(video.videoWidth, video.videoHeight);
    const context = canvas.getContext('2d', { willReadFrequently: true });
    for (let n = 0; n < count; ++n) {
      // `seeked` may come before the picture is there to be drawn.
      await new Promise((done, fail) => {
        setTimeout(() => fail(new Error(`${name}: no picture at frame ${n}`)), patience);
        const look = (_, { mediaTime }) => (Math.abs(mediaTime * fps - n) < 0.25 ? done() : video.requestVideoFrameCallback(look));
        video.requestVideoFrameCallback(look);
        video.currentTime = (n + 0.5) / fps;
      });
      context.drawImage(video, 0, 0);
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      let bytes = '';
      for (let at = 0; at < data.length; at += 0x8000) bytes += String.fromCharCode(...data.subarray(at, at + 0x8000));
      pictures.push({ width: canvas.width, height: canvas.height, base64: btoa(bytes) });
    }
    return pictures;
  }, { name, fps, patience: kPatienceMs }).then((pictures) => pictures.map(({ width, height, base64 }) => ({ width, height, data: new Uint8Array(Buffer.from(base64, 'base64')) })));
}

async function still(name, ...args) {
  const file = join(folder(), `${name}.png`);
  await tool(...args, '--no-shadow', '-o', file);
  return decodePng(readFileSync(file));
}

let server, browser, film, shown;
const character = (more = {}) => ({ src: environment('CHARACTER'), state: 'walk', position: [kPlace.x, kPlace.z], heading_deg: kPlace.heading_deg, ...more });
const filmed = () => ({ background: 'film.mp4', camera: 'track', metres_per_unit: kUnit_m, fps: kFps, characters: [character()] });
before(async () => {
  putCameras('track', kTrack, kUnit_m);
  await makeFilm();
  putScene('filmed.json', filmed());
  await tool('--scene', join(folder(), 'filmed.json'), '--no-shadow', '-o', join(folder(), 'filmed.mp4'));
  put('index.html', '<!doctype html><title>movies</title><link rel="icon" href="data:,">');
  server = await serve(folder());
  browser = await launch();
  const page = await browser.newPage();
  await page.goto(server.url);
  film = await moviePictures(page, 'film.mp4', 25);
  shown = await moviePictures(page, 'filmed.mp4', kFps);
  shown.forEach((picture, n) => writePicture(join(folder(), `filmed-${n}.png`), picture));
});
after(async () => {
  await browser?.close();
  await server?.close();
});

test('the film has the numbers of its pictures', () => {
  assert.deepEqual(film.map((picture, n) => numberBehind(picture, `picture ${n}`)), numbers(kFilmed).map((n) => n + 1));
});

test('every frame of a track has the film\'s picture of the same number; the last one stays', () => {
  assert.deepEqual([shown[0].width, shown[0].height], [kWidth, kHeight], 'the size of the camera that comes first');
  assert.deepEqual(shown.map((picture, n) => numberBehind(picture, `frame ${n}`)),
    numbers(kCameras).map((n) => Math.min(n + 1, kFilmed)));
});

test('a still of a frame of the track has the film\'s picture of that number', async () => {
  const frames = [0, 5, 11];
  const stills = await Promise.all(frames.map((n) => still(`filmed-still-${n}`, '--scene', join(folder(), 'filmed.json'), '--frame', String(n))));
  assert.deepEqual(stills.map((picture, i) => numberBehind(picture, `still ${frames[i]}`)), [1, 6, kFilmed]);
});

// Where the box of all motions falls: the walk fills it almost from top to bottom.
test('the character is where each camera of the track sees it, and not where the one before or after does', () => {
  shown.forEach((_, n) => {
    const seen = extent(maskBefore(n)), box = projectedBox(kTrack[n]);
    const what = `frame ${n}: seen at ${text(seen)}, its camera's box is ${text(box)}`;
    const height = box.bottom - box.top;
    assert.ok(holds(box, seen, kMovie_px), what);
    assert.ok(seen.bottom - seen.top > 0.83 * height, what);
    for (const [low, high] of [['left', 'right'], ['top', 'bottom']])
      assert.ok(Math.abs(seen[low] + seen[high] - box[low] - box[high]) / 2 < 0.08 * height, what);
    for (const other of [kTrack[n - 1], kTrack[n + 1]].filter(Boolean)) {
      assert.ok(!holds(projectedBox(other), seen, kMovie_px), `${what}, and that of ${other.name} is no other`);
    }
  });
});

// Compares two masks: intersection over union, and mean difference of brightness in the intersection.
function likeness(mask, data, other) {
  let both = 0, either = 0, sum = 0;
  const luma = (from, i) => 0.299 * from[4 * i] + 0.587 * from[4 * i + 1] + 0.114 * from[4 * i + 2];
  mask.forEach((set, i) => {
    const solid = other.data[4 * i + 3] > 127;
    either += set || solid;
    if (!set || !solid) return;
    ++both;
    sum += Math.abs(luma(data, i) - luma(other.data, i));
  });
  return { overlap: both / either, levels: sum / both };
}

// Compares with plain stills of the walk, which have no scene, placement or time.
test('every frame of a track has the character\'s frame of its time, turned and placed', async () => {
  putCameras('unplaced', kTrack.map((camera) => ({ ...camera, pose: unplaced(camera.pose) })), 1);
  putScene('alone.json', { ...filmed(), background: undefined });
  for (const n of [1, 6, 11]) {
    const walk = (frame) => still(`walk-${n}-${frame}`, environment('CHARACTER'), '--sequence', 'walk', '--frame', String(frame),
      '--cameras', join(folder(), 'unplaced'), '--camera', kTrack[n].name, '--size', `${kWidth}x${kHeight}`);
    const [alone, ...walks] = await Promise.all([still(`alone-${n}`, '--scene', join(folder(), 'alone.json'), '--frame', String(n)),
      ...[2 * n, 2 * n - 1, 2 * n + 1].map(walk)]);
    const solid = Uint8Array.from({ length: kWidth * kHeight }, (_, i) => (alone.data[4 * i + 3] > 127 ? 1 : 0));
    const exact = likeness(solid, alone.data, walks[0]);
    const [own, earlier, later] = walks.map((plain) => likeness(maskBefore(n), shown[n].data, plain));
    const told = ({ overlap, levels }) => `${(100 * overlap).toFixed(1)} % and ${levels.toFixed(1)} levels`;
    const what = `frame ${n}: still ${told(exact)}; movie ${told(own)}, to the walk's frame before ${told(earlier)}, after ${told(later)}`;
    assert.ok(exact.overlap > 0.99 && exact.levels < 1, what);
    assert.ok(own.overlap > 0.8, what);
    for (const other of [earlier, later]) assert.ok(own.levels < kOwnLevels * other.levels, what);
  }
});

// --- occluders ---

// A background that differs from pixel to pixel and from the character.
const kStreet = new Uint8Array(4 * kWidth * kHeight).map((_, at) => {
  const i = at >> 2, x = i % kWidth, y = Math.floor(i / kWidth);
  return [x * 255 / kWidth, y * 255 / kHeight, 255 * ((x >> 4) + (y >> 4) & 1), 255][at & 3];
});

// Pixels inside of the convex polygon, from its edges; negative outside.
function depthInside(polygon, x, y) {
  const edges = polygon.map((a, i) => {
    const b = polygon[(i + 1) % polygon.length], along = [b[0] - a[0], b[1] - a[1]];
    return (along[0] * (y - a[1]) - along[1] * (x - a[0])) / Math.hypot(...along);
  });
  const area = polygon.reduce((sum, a, i) => {
    const b = polygon[(i + 1) % polygon.length];
    return sum + a[0] * b[1] - a[1] * b[0];
  }, 0);
  return Math.min(...edges.map((edge) => edge * Math.sign(area)));
}

// A board facing the middle of the track, `ahead` metres before the performer; its triangles wind both ways.
function putBoard(name, ahead, wide) {
  const corners = [[-0.7, 0.45], [0.4, 0.6], [0.5, 1.3], [-0.55, 1.1]].map(([x, y]) => [kPlace.x + wide * x, y, kPlace.z + ahead]);
  put(name, `${corners.map((corner) => `v ${corner.join(' ')}\n`).join('')}f 1 2 3\nf 4 3 1\n`);
  return corners;
}

test('an occluder hides the character exactly where the track\'s cameras see it, and shows the background there', async () => {
  put('street.png', encodePng({ width: kWidth, height: kHeight, data: kStreet }));
  const boards = { before: putBoard('before.obj', 0.9, 1), behind: putBoard('behind.obj', -0.9, 2) };
  for (const [name, occluders] of Object.entries({ open: [], before: ['before.obj'], behind: ['behind.obj'] }))
    putScene(`${name}.json`, { ...filmed(), background: 'street.png', occluders });
  for (const n of [0, 5, 11]) {
    const [open, before, behind] = await Promise.all(['open', 'before', 'behind'].map((name) =>
      still(`${name}-${n}`, '--scene', join(folder(), `${name}.json`), '--frame', String(n))));
    const polygons = { before: [], behind: [] };
    for (const name of ['before', 'behind']) polygons[name] = boards[name].map((corner) => project(kTrack[n], corner));
    const same = (a, b, i) => difference(a, 4 * i, b.subarray(4 * i, 4 * i + 3)) <= kSame;
    // Pixels: of the character within and outside of the board before it, before the board behind it; and what is wrong.
    const count = { hidden: 0, left: 0, before: 0, notBackground: 0, notCharacter: 0, notBefore: 0 };
    for (let i = 0; i < kWidth * kHeight; ++i) {
      const inside = (name) => depthInside(polygons[name], i % kWidth + 0.5, Math.floor(i / kWidth) + 0.5);
      const depth = inside('before'), isCharacter = !same(open.data, kStreet, i);
      count.before += isCharacter && inside('behind') > 0;
      count.notBefore += !same(behind.data, open.data, i);
      if (depth > kEdge_px) {
        count.hidden += isCharacter;
        count.notBackground += !same(before.data, kStreet, i);
      } else if (depth < -kEdge_px) {
        count.left += isCharacter;
        count.notCharacter += !same(before.data, open.data, i);
      }
    }
    const what = `frame ${n}: ${JSON.stringify(count)}`;
    assert.ok(Math.min(count.hidden, count.left, count.before) >= 100, `${what}: there is something to see`);
    assert.equal(count.notBackground + count.notCharacter + count.notBefore, 0, what);
  }
});

test('a track is not longer than its cameras', async () => {
  const refused = still('refused', '--scene', join(folder(), 'filmed.json'), '--frame', String(kCameras));
  await assert.rejects(refused, ({ code, stderr }) => code === 1 && stderr.includes(`${kCameras + 1} frames, but only ${kCameras} cameras`));
});
