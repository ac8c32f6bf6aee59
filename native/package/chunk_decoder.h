// SPDX-License-Identifier: Apache-2.0
// Decodes a GOP's chunk frame by frame, so that a page never blocks for a whole GOP. Frames are predicted from their
// predecessors: the first call for frame n decodes 0..n.
#pragma once

#include <memory>

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

class ChunkDecoder {
 public:
  // `bytes` and `mesh` are borrowed for the decoder's life. Errors: StreamInvalid, as decodeChunk.
  static Result<std::unique_ptr<ChunkDecoder>> open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                    uint32_t chunk, const ChunkMesh& mesh);
  virtual ~ChunkDecoder() = default;
  // Decodes until frames 0..frame of the chunk, or all of them, are present. Errors: StreamInvalid, from then on
  // always.
  virtual Status decodeTo(uint32_t frame) = 0;
  // Decodes one part of the next frame, e.g. one member's positions. No effect after the last frame. Errors: as
  // decodeTo.
  virtual Status step() = 0;
  virtual uint32_t decodedCount() const = 0;
  // Counts of the whole chunk; contents of the decoded frames and of parts of the next one.
  virtual const ChunkFrames& frames() const = 0;
  // Moves out the frames decoded since the last call; `frames` then lacks them.
  virtual ChunkFrames take() = 0;
  // Appends the next frame, decoded elsewhere (writeDecodedFrame). Returns false if its size does not fit the chunk,
  // and in all decoders but receivedChunk's.
  virtual bool append(std::span<const uint8_t>) { return false; }
};

// Writes decoded geometry of one frame as bytes, so that a worker in another address space can decode a GOP's chunk: it
// writes each frame, and receivedChunk's decoder appends it here. Same-machine format: values in memory order,
// little-endian, no header. frame: one frame, as ChunkDecoder::take returns it. out: replaced by positions, offsets,
// alignment, root and labels, in this order.
void writeDecodedFrame(const ChunkFrames& frame, std::vector<uint8_t>& out);

// Makes a decoder fed by `append`; its decodeTo and step have no effect. begun: GOP whose first `frames` frames are
// already decoded; a partly decoded frame after them is dropped.
std::unique_ptr<ChunkDecoder> receivedChunk(const StreamIndex& index, uint32_t chunk);
std::unique_ptr<ChunkDecoder> receivedChunk(ChunkFrames begun, uint32_t frames);

}  // namespace fourdvt::package
