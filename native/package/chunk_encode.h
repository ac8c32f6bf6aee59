// SPDX-License-Identifier: Apache-2.0
// Encodes a member's parts of a GOP chunk; chunk_decoder.cpp decodes. Requires checked counts, ranges and label values.
// Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member);
// residual_step: 1 is lossless.
std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     uint32_t residual_step);
// Encodes the first frame of a chunk alone, with exactly the values that the chunk gives. chunk: its intact bytes;
// first: its first frame, decoded.
Result<std::vector<uint8_t>> encodeFirstFrame(std::span<const uint8_t> chunk, const ChunkFrames& first,
                                              const ChunkMesh& mesh);

}  // namespace fourdvt::package
