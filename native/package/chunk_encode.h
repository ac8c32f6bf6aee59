// SPDX-License-Identifier: Apache-2.0
// Encoders of the parts that a member has in a GOP chunk; chunk_decoder.cpp decodes. Counts, ranges and label values
// must have been checked. Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member);
// coarse_scale: steps of the coded values over those of the given, with the dead zone of encodeCoarseChunk; 0: exactly
// the positions.
std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     double coarse_scale = 0);

}  // namespace fourdvt::package
