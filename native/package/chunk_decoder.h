// SPDX-License-Identifier: Apache-2.0
// Decodes a GOP's chunk frame by frame, so that a page never waits for a whole GOP at once. Frames are predicted from
// the ones before, so the first call for frame n decodes 0..n.
#pragma once

#include <memory>

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

class ChunkDecoder {
 public:
  // `bytes` and `mesh` are borrowed for the decoder's life. Errors: StreamInvalid, as of decodeChunk.
  static Result<std::unique_ptr<ChunkDecoder>> open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                    uint32_t chunk, const ChunkMesh& mesh);
  virtual ~ChunkDecoder() = default;
  // Decodes until frames 0..frame of the chunk are there, or all of them. Errors: StreamInvalid, from then on always.
  virtual Status decodeTo(uint32_t frame) = 0;
  // Decodes a part of the next frame: one member's positions, for example. Nothing once all frames are there. Errors:
  // as of decodeTo.
  virtual Status step() = 0;
  virtual uint32_t decodedCount() const = 0;
  // Counts are the whole chunk's; the contents are those of the decoded frames, and of parts of the next one.
  virtual const ChunkFrames& frames() const = 0;
  // The frames decoded since the last call; `frames` is empty of them afterwards.
  virtual ChunkFrames take() = 0;
  // The next frame, decoded elsewhere (decoded_frame.h). False: not one of this chunk's size, or this decoder decodes
  // itself.
  virtual bool append(std::span<const uint8_t>) { return false; }
};

}  // namespace fourdvt::package
