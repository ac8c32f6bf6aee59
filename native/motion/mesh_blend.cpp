// SPDX-License-Identifier: Apache-2.0
#include "motion/mesh_blend.h"

namespace fourdvt::motion {
namespace {

// Runs over plain numbers, three per vertex: where compilers optimise for size, they do not inline vectors.
void add(const glm::ivec3* steps, float metres_per_step, Positions& out) {
  if (metres_per_step == 0) return;
  const int32_t* from = &steps->x;
  float* to = &out.data()->x;
  const size_t count = 3 * out.size();
  for (size_t i = 0; i < count; ++i) to[i] += metres_per_step * float(from[i]);
}

}  // namespace

void blendFrame(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                const BlendWeights& weights, Positions& out) {
  const std::vector<float>&members = weights.members, &offsets = weights.offsets;
  const size_t count = frames.vertex_count;
  const glm::ivec3* positions = frames.positions.data() + row * frames.member_count * count;
  const glm::ivec3* corrections = frames.offsets.data() + row * frames.reference_count * count;
  out.assign(count, index.position_origin);
  if (count == 0) return;
  for (size_t m = 0; m < members.size() && m < frames.member_count; ++m)
    add(positions + m * count, members[m] * index.position_step_m, out);
  for (size_t r = 0; r < offsets.size() && r < frames.reference_count; ++r)
    add(corrections + r * count, offsets[r] * index.position_step_m, out);
}

void alignmentOf(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                 std::vector<glm::vec2>& out) {
  const size_t count = size_t(frames.alignment_count) * frames.vertex_count;
  const glm::ivec2* steps = frames.alignment.data() + row * count;
  out.resize(count);
  for (size_t i = 0; i < count; ++i) out[i] = index.alignment_step_m * glm::vec2(steps[i]);
}

glm::vec3 rootOf(const package::ChunkFrames& frames, uint32_t row, std::span<const float> members) {
  glm::vec3 root(0);
  for (size_t m = 0; m < members.size() && m < frames.member_count; ++m)
    root += members[m] * frames.root[size_t(row) * frames.member_count + m];
  return root;
}

void crossFade(Positions& a, std::span<const glm::vec3> b, const glm::mat4& a_from_b, float share) {
  const glm::mat3 turn(a_from_b);
  const glm::vec3 shift(a_from_b[3]);
  for (size_t v = 0; v < a.size(); ++v) a[v] += share * (turn * b[v] + shift - a[v]);
}

}  // namespace fourdvt::motion
