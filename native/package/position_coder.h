// SPDX-License-Identifier: Apache-2.0
// Encoder of a member's position part of a GOP chunk; chunk_decoder.cpp decodes. Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Counts and ranges must have been checked. coarse_scale: see encodeCoarseChunk; 0: exactly the positions.
std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     double coarse_scale = 0);

}  // namespace fourdvt::package
