// SPDX-License-Identifier: Apache-2.0
// 8-bit PNG in and out as straight-alpha RGBA, top row first: { width, height, data: Uint8Array }.
// Does NOT read palettes, 16 bits, greyscale or interlaced files: fourdvt writes none of these.
import { deflateSync, inflateSync } from 'node:zlib';

const kSignature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function crc32(bytes) {
  let c = 0xffffffff;
  for (const b of bytes) c = crcTable[(c ^ b) & 255] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

function chunk(type, body) {
  const out = Buffer.alloc(12 + body.length);
  out.writeUInt32BE(body.length, 0);
  out.write(type, 4, 'latin1');
  body.copy(out, 8);
  out.writeUInt32BE(crc32(out.subarray(4, 8 + body.length)), 8 + body.length);
  return out;
}

export function encodePng({ width, height, data }) {
  const rows = Buffer.alloc(height * (1 + 4 * width));
  for (let y = 0; y < height; ++y) {
    Buffer.from(data.buffer, data.byteOffset + 4 * width * y, 4 * width).copy(rows, y * (1 + 4 * width) + 1);
  }
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 6, 0, 0, 0], 8);
  return Buffer.concat([kSignature, chunk('IHDR', header), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}

function paeth(a, b, c) {
  const p = a + b - c;
  const pa = Math.abs(p - a), pb = Math.abs(p - b), pc = Math.abs(p - c);
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// In place: `rows` holds a filter byte before every row of `stride` bytes.
function unfilter(rows, stride, height, pixelBytes) {
  const at = (y, x) => (y < 0 || x < 0 ? 0 : rows[y * (stride + 1) + 1 + x]);
  for (let y = 0; y < height; ++y) {
    const filter = rows[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const left = at(y, x - pixelBytes), up = at(y - 1, x);
      const guess = [0, left, up, (left + up) >> 1, filter === 4 ? paeth(left, up, at(y - 1, x - pixelBytes)) : 0][filter];
      rows[y * (stride + 1) + 1 + x] += guess;
    }
  }
}

export function decodePng(file) {
  if (!kSignature.equals(file.subarray(0, 8))) throw new Error('not a PNG file');
  let header = null;
  const parts = [];
  for (let at = 8; at + 12 <= file.length;) {
    const length = file.readUInt32BE(at);
    const type = file.toString('latin1', at + 4, at + 8);
    if (type === 'IHDR') header = file.subarray(at + 8, at + 8 + length);
    if (type === 'IDAT') parts.push(file.subarray(at + 8, at + 8 + length));
    at += 12 + length;
  }
  const width = header.readUInt32BE(0), height = header.readUInt32BE(4);
  const channels = { 2: 3, 6: 4 }[header[9]];
  if (header[8] !== 8 || !channels || header[12]) throw new Error('only 8-bit RGB and RGBA PNG files are read');
  const rows = inflateSync(Buffer.concat(parts));
  unfilter(rows, width * channels, height, channels);
  const data = new Uint8Array(width * height * 4).fill(255);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const from = y * (width * channels + 1) + 1 + x * channels;
      for (let c = 0; c < channels; ++c) data[4 * (y * width + x) + c] = rows[from + c];
    }
  }
  return { width, height, data };
}
