// SPDX-License-Identifier: Apache-2.0
// Blending of a class's members: parameter values ("2.1 m/s") → weights → positions of one frame.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "base/mesh.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::motion {

// --- parameter values → what to blend: pure logic on the manifest's tables (package/character.h) ---

struct BlendWeights {
  std::vector<float> members;  // sum 1
  std::vector<float> offsets;  // coefficients of the references
};

// Gives one member the whole weight.
BlendWeights memberWeights(const package::Sequence& sequence, size_t member);
// The weights at the point of the space's simplices that lies nearest to `at`. A plain sequence has {1}. `at`: one
// value per parameter.
BlendWeights weightsAt(const package::Sequence& sequence, std::span<const double> at);
struct Range {
  double min = 0, max = 0;
};
Range parameterRange(const package::Sequence& sequence, size_t parameter);
int findParameter(const package::Sequence& sequence, std::string_view name);  // -1: no parameter has that name
// Duration of one pass at these weights of the members; durations mix linearly.
double durationAt(const package::Sequence& sequence, std::span<const float> members);

// --- one frame of a stream → positions, by the hybrid blend (algorithms/motion.md): the linear blend of the members
// plus precomputed corrections towards the non-linear blend. Nothing is solved at run time. ---

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
