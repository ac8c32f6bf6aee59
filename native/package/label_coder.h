// SPDX-License-Identifier: Apache-2.0
// Encoder of a member's label part of a GOP chunk; chunk_decoder.cpp decodes. Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Counts and label values must have been checked.
std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member);

}  // namespace fourdvt::package
