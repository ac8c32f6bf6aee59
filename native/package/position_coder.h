// SPDX-License-Identifier: Apache-2.0
// The position part of a GOP chunk. Internal to package/.
#pragma once

#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Counts and ranges must have been checked.
std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh);
// Fills out.positions; the counts of `out` are set and agree with the mesh. False if the bytes are not a whole position
// part of these counts. Memory grows with the frames that the bytes really hold.
bool decodePositions(std::span<const uint8_t> bytes, const ChunkMesh& mesh, ChunkFrames& out);

}  // namespace fourdvt::package
