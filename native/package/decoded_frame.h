// SPDX-License-Identifier: Apache-2.0
// Decoded geometry of one frame as bytes, to decode a GOP's chunk in another address space (a worker): frames are
// written there and appended here to a chunk without a decoder of its own. Same-machine format: values in memory order,
// little-endian, no header.
#pragma once

#include "package/chunk_decoder.h"

namespace fourdvt::package {

// frame: one frame, as ChunkDecoder::take returns it. out: replaced by positions, offsets, alignment, root and labels,
// in this order.
void writeDecodedFrame(const ChunkFrames& frame, std::vector<uint8_t>& out);

// Makes a decoder fed by `append`; its decodeTo and step have no effect. begun: GOP whose first `frames` frames are
// already decoded; parts of a further one are dropped.
std::unique_ptr<ChunkDecoder> receivedChunk(const StreamIndex& index, uint32_t chunk);
std::unique_ptr<ChunkDecoder> receivedChunk(ChunkFrames begun, uint32_t frames);

}  // namespace fourdvt::package
