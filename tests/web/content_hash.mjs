// SPDX-License-Identifier: Apache-2.0
// Recomputes the content hashes of a character folder (native/package/FORMAT.md) after changes of its files, so that
// tests reach checks behind the hashes.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const kPrime = 1099511628211n, kStart = 14695981039346656037n, kMask = (1n << 64n) - 1n;
const kCountsEnd = 60; // of the stream header

/** FNV-1a of 64 bits. */
export function fnv1a(bytes) {
  let hash = kStart;
  for (const byte of bytes) hash = ((hash ^ BigInt(byte)) * kPrime) & kMask;
  return hash;
}
/** Formats a hash as in the manifest. */
export const digits = (hash) => hash.toString(16).padStart(16, '0');

function rehashStream(folder, { stream, renditions }) {
  const file = join(folder, stream.uri);
  const bytes = readFileSync(file);
  let at = kCountsEnd;
  const u32 = () => bytes.readUInt32LE((at += 4) - 4);
  const u64 = () => bytes.readBigUInt64LE((at += 8) - 8);
  const frames = [], coarse = bytes.readUInt16LE(4) === 9;
  const rehashChunk = () => {
    const length = u32(), offset = Number(u64());
    bytes.writeBigUInt64LE(fnv1a(bytes.subarray(offset, offset + length)), at);
    at += 8;
  };
  for (let gops = u32(); gops > 0; --gops) {
    frames.push(u32());
    rehashChunk();
  }
  u32(); // number of renditions: the manifest has it
  for (const { uri } of renditions) {
    const video = readFileSync(join(folder, uri));
    const description = u32();
    at += description;
    for (const count of frames) {
      const offset = Number(u64()), place = at;
      at += 8;
      let length = 0;
      for (let i = 0; i < count; ++i, at += 2) length += u32() & 0x7fffffff;
      bytes.writeBigUInt64LE(fnv1a(video.subarray(offset, offset + length)), place);
    }
  }
  for (let gop = 0; coarse && gop < frames.length; ++gop) rehashChunk();
  writeFileSync(file, bytes);
}

/** Writes all hashes into the streams' headers and into `extension`, which the caller writes back. */
export function rehash(folder, extension) {
  const part = (uri, from, to) => digits(fnv1a(readFileSync(join(folder, uri)).subarray(from, to)));
  const { mesh, graph } = extension;
  mesh.hash = part(mesh.uri, mesh.byteOffset, mesh.byteOffset + mesh.byteLength);
  if (graph) graph.hash = part(graph.uri, 0, graph.byteLength);
  for (const sequence of extension.sequences) {
    rehashStream(folder, sequence);
    sequence.stream.headerHash = part(sequence.stream.uri, 0, sequence.stream.headerLength);
  }
}
