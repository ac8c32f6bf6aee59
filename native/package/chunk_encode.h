// SPDX-License-Identifier: Apache-2.0
// Encodes a member's parts of a GOP chunk; chunk_decoder.cpp decodes. Requires checked counts, ranges and label values.
// Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member);
// coarse_scale: ratio of coded to given step, with the dead zone of encodeCoarseChunk; 0: lossless.
std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     double coarse_scale = 0);

}  // namespace fourdvt::package
