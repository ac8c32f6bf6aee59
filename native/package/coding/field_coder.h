// SPDX-License-Identifier: Apache-2.0
// Encoder of the field parts of a GOP chunk (corrections of the mesh blend, alignment); chunk_decoder.cpp decodes.
// Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Counts and ranges must have been checked.
std::vector<uint8_t> encodeOffsets(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t reference);
std::vector<uint8_t> encodeAlignment(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t field);

}  // namespace fourdvt::package
