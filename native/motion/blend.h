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

// ---- parameter values → weights, from the manifest's tables (package/character.h) ----

struct BlendWeights {
  std::vector<float> members;  // sum 1
  std::vector<float> offsets;  // coefficients of the mesh blend's references
};

// Gives one member the whole weight.
BlendWeights memberWeights(const package::Sequence& sequence, size_t member);
// Weights at the point of the space's simplices nearest to `at` (one value per parameter). A plain sequence has {1}.
BlendWeights weightsAt(const package::Sequence& sequence, std::span<const double> at);
struct Range {
  double min = 0, max = 0;
};
Range parameterRange(const package::Sequence& sequence, size_t parameter);
int findParameter(const package::Sequence& sequence, std::string_view name);  // -1: no parameter has that name
// Duration of one pass, seconds: members' durations mixed linearly by their weights.
double durationAt(const package::Sequence& sequence, std::span<const float> members);

// ---- one frame of a stream → positions by the hybrid blend (algorithms/motion.md): linear blend of the members plus
// precomputed corrections towards the non-linear blend; no solve at run time ----

// Blends frame `row` of a decoded chunk. `out` gets vertex_count points in metres.
void blendFrame(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                const BlendWeights& weights, Positions& out);
// Alignment along the vertex's tangents, metres: [member - 1][vertex]; empty if the stream has none.
void alignmentOf(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                 std::vector<glm::vec2>& out);
// Members' root motion since frame 0 of the sequence (ChunkFrames::root), mixed by weight.
glm::vec3 rootOf(const package::ChunkFrames& frames, uint32_t row, std::span<const float> members);
// a += share * (place(b) - a): cross-fades two meshes of one topology; place applies `a_from_b`.
void crossFade(Positions& a, std::span<const glm::vec3> b, const glm::mat4& a_from_b, float share);

}  // namespace fourdvt::motion
