// SPDX-License-Identifier: Apache-2.0
// Composes parts of pictures into one labelled picture, in a browser's canvas.
//   montage(browser, { rows, height }, path, look)   writes the picture to `path` as WebP and to `look` as PNG
// rows: lists of { file, label, cell | crop }; every part is `height` pixels high.
//   cell: [camera, "picture" | "shape"]   of a contact sheet of reconstruct
//   crop: [x, y, width, height]           any rectangle; without either, the whole picture
//   over: a file with transparency that is drawn over it, of the size of the crop or to be scaled to it
//   paintStrokes(browser, matte, path)   writes a hint as PNG: a broad white stroke down the middle of the matte's
//                                        upper part, and a thin black one at each side of it
import { readFileSync, writeFileSync } from 'node:fs';
import { extname } from 'node:path';

const kTypes = { '.png': 'image/png', '.jpg': 'image/jpeg', '.webp': 'image/webp' };

// Runs in the page.
async function draw({ rows, height }) {
  const kDark = 25, kGap = 6, kBar = 24;
  const decoded = async (data) => {
    const image = new Image();
    image.src = data;
    await image.decode();
    return image;
  };
  const load = async ({ data, cell, crop, label, overData }) => {
    const image = await decoded(data);
    return { image, label, over: overData && await decoded(overData), crop: cell ? cellOf(image, cell) : crop ?? [0, 0, image.naturalWidth, image.naturalHeight] };
  };
  // Cells of a sheet of reconstruct: 60 pixels of titles, then pictures of one height, then as many of the shape; gaps have
  // the colour of the ground.
  const cellOf = (image, [camera, part]) => {
    const canvas = new OffscreenCanvas(image.naturalWidth, image.naturalHeight), context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    const tall = (canvas.height - 72) / 2, gap = (x) => {
      const { data } = context.getImageData(x, 60, 1, tall - 1);
      const other = data.filter((level, i) => i % 4 !== 3 && Math.abs(level - kDark) > 14).length;
      return other < data.length / 40;
    };
    const cells = [];
    for (let x = 0, from = -1; x <= canvas.width; ++x) {
      const between = x === canvas.width || gap(x);
      if (!between && from < 0) from = x;
      if (between && from >= 0) {
        if (x - from > 20) cells.push([from, x - from]);
        from = -1;
      }
    }
    const [x, wide] = cells[camera];
    return [x, part === 'picture' ? 60 : 66 + tall, wide, tall];
  };
  const parts = await Promise.all(rows.map((row) => Promise.all(row.map(load))));
  const sized = parts.map((row) => row.map((part) => ({ ...part, width: Math.round(part.crop[2] * height / part.crop[3]) })));
  const columns = sized[0].map((_, i) => Math.max(...sized.map((row) => row[i]?.width ?? 0)));
  const bars = sized.map((row) => (row.some(({ label }) => label) ? kBar : 0));
  const canvas = new OffscreenCanvas(columns.reduce((sum, wide) => sum + wide + kGap, kGap), bars.reduce((sum, bar) => sum + bar + height + kGap, kGap));
  const context = canvas.getContext('2d');
  context.fillStyle = `rgb(${kDark},${kDark},${kDark})`;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.font = '14px "DejaVu Sans", sans-serif';
  context.imageSmoothingQuality = 'high';
  let y = kGap;
  sized.forEach((row, r) => {
    let x = kGap;
    row.forEach(({ image, over, crop, width, label }, i) => {
      context.fillStyle = '#e8e8e8';
      if (label) context.fillText(label, x, y + 16, columns[i]);
      const target = [x + (columns[i] - width) / 2, y + bars[r], width, height];
      context.drawImage(image, ...crop, ...target);
      if (over) context.drawImage(over, ...target);
      x += columns[i] + kGap;
    });
    y += bars[r] + height + kGap;
  });
  const url = async (type, quality) => new Promise(async (done) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result);
    reader.readAsDataURL(await canvas.convertToBlob({ type, quality }));
  });
  return [await url('image/webp', .8), await url('image/png')];
}

// Runs in the page.
async function strokes(data) {
  const image = new Image();
  image.src = data;
  await image.decode();
  const { naturalWidth: wide, naturalHeight: tall } = image, canvas = new OffscreenCanvas(wide, tall), context = canvas.getContext('2d');
  context.drawImage(image, 0, 0);
  const levels = context.getImageData(0, 0, wide, tall).data, runs = [];
  for (let y = 0; y < tall; ++y) {
    const xs = [...Array(wide).keys()].filter((x) => levels[4 * (y * wide + x)] > 127);
    if (xs.length) runs.push([y, xs]);
  }
  const upper = runs.slice(Math.round(runs.length * .03), Math.round(runs.length * .5)), far = Math.round(wide * .05);
  const stroke = (colour, thick, xOf) => {
    context.strokeStyle = colour;
    context.lineWidth = thick;
    context.lineCap = 'round';
    context.beginPath();
    for (const [y, xs] of upper) context.lineTo(xOf(xs), y);
    context.stroke();
  };
  context.clearRect(0, 0, wide, tall);
  stroke('#fff', wide / 16, (xs) => xs[xs.length >> 1]);
  stroke('#000', wide / 60, (xs) => xs[0] - far);
  stroke('#000', wide / 60, (xs) => xs.at(-1) + far);
  const painted = context.getImageData(0, 0, wide, tall);  // alpha 0 or 255: hints have no intermediate values
  for (let i = 0; i < painted.data.length; i += 4) painted.data[i + 3] = painted.data[i + 3] > 127 ? 255 : 0;
  context.putImageData(painted, 0, 0);
  const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: 'image/png' })).arrayBuffer());
  return btoa(String.fromCharCode(...bytes));
}

const inline = (file) => `data:${kTypes[extname(file)]};base64,${readFileSync(file, 'base64')}`;

export async function paintStrokes(browser, matte, path) {
  const page = await browser.newPage();
  writeFileSync(path, Buffer.from(await page.evaluate(strokes, inline(matte)), 'base64'));
  await page.close();
}

export async function montage(browser, { rows, height }, path, look) {
  const page = await browser.newPage();
  const withData = rows.map((row) => row.map((part) => ({ ...part, data: inline(part.file), overData: part.over && inline(part.over) })));
  const [webp, png] = await page.evaluate(draw, { rows: withData, height });
  for (const [file, data] of [[path, webp], [look, png]]) writeFileSync(file, Buffer.from(data.split(',')[1], 'base64'));
  await page.close();
}
