// SPDX-License-Identifier: Apache-2.0
// One frame of a stream → positions: hybrid blend (ALGORITHMS 4.4): linear blend of the members plus precomputed
// corrections towards the non-linear one. No solver at run time.
#pragma once

#include <span>

#include "base/mesh.h"
#include "package/stream_file.h"

namespace fourdvt::motion {

// frames: decoded up to `row`. members, offsets: as BlendWeights. out gets vertex_count points in metres.
void blendFrame(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                std::span<const float> members, std::span<const float> offsets, Positions& out);
// alignment in metres along the vertex's tangents: [member - 1][vertex]; empty if the stream has none.
void alignmentOf(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                 std::vector<glm::vec2>& out);
// Metres and radians since frame 0 of the sequence (ChunkFrames::root), mixed.
glm::vec3 rootOf(const package::ChunkFrames& frames, uint32_t row, std::span<const float> members);
// out = a + share * (place(b) - a): cross-fade of two meshes of the same topology, b first moved by `a_from_b`.
void crossFade(Positions& a, std::span<const glm::vec3> b, const glm::mat4& a_from_b, float share);

}  // namespace fourdvt::motion
