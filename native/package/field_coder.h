// SPDX-License-Identifier: Apache-2.0
// Encoder of the field parts of a GOP chunk (corrections of the mesh blend, alignment); chunk_decoder.cpp decodes.
// Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Counts and ranges must have been checked. coarse_scale: steps of the coded values over those of the given, with the
// dead zone of encodeCoarseChunk; 0: exactly the values.
std::vector<uint8_t> encodeOffsets(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t reference,
                                   double coarse_scale = 0);
std::vector<uint8_t> encodeAlignment(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t field,
                                     double coarse_scale = 0);

}  // namespace fourdvt::package
