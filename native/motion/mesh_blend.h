// SPDX-License-Identifier: Apache-2.0
// One frame of a stream → positions, by the hybrid blend (ALGORITHMS 4.4): the linear blend of the members plus
// precomputed corrections towards the non-linear blend. Nothing is solved at run time.
#pragma once

#include <span>

#include "base/mesh.h"
#include "motion/parameter_space.h"
#include "package/stream_file.h"

namespace fourdvt::motion {

// Blends frame number `row` of a chunk, which must be decoded. `out` gets vertex_count points in metres.
void blendFrame(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                const BlendWeights& weights, Positions& out);
// Alignment in metres along the vertex's tangents: [member - 1][vertex]; empty if the stream has none.
void alignmentOf(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                 std::vector<glm::vec2>& out);
// The members' root motion since frame 0 of the sequence (ChunkFrames::root), mixed by their weights.
glm::vec3 rootOf(const package::ChunkFrames& frames, uint32_t row, std::span<const float> members);
// out = a + share * (place(b) - a): cross-fade of two meshes of the same topology, b first moved by `a_from_b`.
void crossFade(Positions& a, std::span<const glm::vec3> b, const glm::mat4& a_from_b, float share);

}  // namespace fourdvt::motion
