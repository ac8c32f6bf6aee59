// SPDX-License-Identifier: Apache-2.0
// The label part of a GOP chunk. Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Counts and label values must have been checked.
std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh);
// Fills out.labels; the counts of `out` are set and agree with the mesh. False if the bytes are not a whole label part
// of these counts. Memory grows with the frames that the bytes really hold.
bool decodeLabels(std::span<const uint8_t> bytes, const ChunkMesh& mesh, ChunkFrames& out);

}  // namespace fourdvt::package
