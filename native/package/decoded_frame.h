// SPDX-License-Identifier: Apache-2.0
// Decoded geometry of one frame as bytes, so that a GOP's chunk can be decoded in another address space, a worker's for
// example: there its decoder's frames are written, here they are appended to a chunk that decodes nothing itself.
// The bytes never leave the machine: little-endian values in memory order, without a header.
#pragma once

#include "package/chunk_decoder.h"

namespace fourdvt::package {

// frame: one frame's contents, as ChunkDecoder::take gives them after each frame. out: replaced by positions, offsets,
// alignment, root and labels, in this order.
void writeDecodedFrame(const ChunkFrames& frame, std::vector<uint8_t>& out);

// Makes a decoder whose frames come by `append`; its decodeTo and step do nothing. begun: a GOP whose first `frames`
// frames are decoded already; parts of a further one are dropped.
std::unique_ptr<ChunkDecoder> receivedChunk(const StreamIndex& index, uint32_t chunk);
std::unique_ptr<ChunkDecoder> receivedChunk(ChunkFrames begun, uint32_t frames);

}  // namespace fourdvt::package
