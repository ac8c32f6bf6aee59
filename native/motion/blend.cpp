// SPDX-License-Identifier: Apache-2.0
#include "motion/blend.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fourdvt::motion {
namespace {

using package::ParameterSample;
using package::Sequence;
using Corners = std::array<glm::dvec2, 3>;  // simplex corners, in shares of the parameter ranges

glm::dvec2 pointOf(std::span<const double> at, std::span<const Range> ranges) {
  glm::dvec2 point(0);
  for (size_t p = 0; p < ranges.size() && p < at.size(); ++p) {
    const double length = ranges[p].max - ranges[p].min;
    if (length > 0) point[int(p)] = (at[p] - ranges[p].min) / length;
  }
  return point;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

struct Nearest {
  double distance = 1e300;  // squared
  uint32_t simplex = 0;
  glm::dvec3 shares{1, 0, 0};  // barycentric weights of the simplex's corners
  void offer(double d, uint32_t s, const glm::dvec3& corner_shares) {
    if (d < distance) *this = {d, s, corner_shares};
  }
};

void offerSimplex(const Corners& c, const glm::dvec2& point, uint32_t simplex, Nearest& best) {
  const double area = cross(c[1] - c[0], c[2] - c[0]);
  if (std::abs(area) > 1e-12) {
    const double y = cross(point - c[0], c[2] - c[0]) / area, z = cross(c[1] - c[0], point - c[0]) / area;
    if (y >= 0 && z >= 0 && y + z <= 1) best.offer(0, simplex, {1 - y - z, y, z});
  }
  for (int i = 0; i < 3; ++i) {
    const glm::dvec2 edge = c[(i + 1) % 3] - c[i], to_point = point - c[i];
    const double length = glm::dot(edge, edge);
    const double t = length > 0 ? std::clamp(glm::dot(to_point, edge) / length, 0.0, 1.0) : 0;
    const glm::dvec2 away = to_point - t * edge;
    glm::dvec3 shares(0);
    shares[i] = 1 - t;
    shares[(i + 1) % 3] += t;
    best.offer(glm::dot(away, away), simplex, shares);
  }
}

void addScaled(const std::vector<float>& from, double share, std::vector<float>& to) {
  for (size_t i = 0; i < from.size() && i < to.size(); ++i) to[i] += float(share) * from[i];
}

}  // namespace

BlendWeights memberWeights(const Sequence& sequence, size_t member) {
  BlendWeights weights{std::vector<float>(sequence.members.size()), std::vector<float>(sequence.reference_count)};
  if (member < weights.members.size()) weights.members[member] = 1;
  return weights;
}

BlendWeights weightsAt(const Sequence& sequence, std::span<const double> at) {
  const package::ParameterSpace& space = sequence.space;
  if (space.simplices.empty()) return memberWeights(sequence, 0);
  std::vector<Range> ranges;
  for (size_t p = 0; p < space.names.size(); ++p) ranges.push_back(parameterRange(sequence, p));
  const glm::dvec2 point = pointOf(at, ranges);
  Nearest nearest;
  for (uint32_t s = 0; s < space.simplices.size(); ++s) {
    Corners corners;
    for (int i = 0; i < 3; ++i) corners[i] = pointOf(space.samples[space.simplices[s][i]].at, ranges);
    offerSimplex(corners, point, s, nearest);
  }
  BlendWeights weights{std::vector<float>(sequence.members.size()), std::vector<float>(sequence.reference_count)};
  for (int i = 0; i < 3; ++i) {
    const ParameterSample& corner = space.samples[space.simplices[nearest.simplex][i]];
    addScaled(corner.weights, nearest.shares[i], weights.members);
    addScaled(corner.offsets, nearest.shares[i], weights.offsets);
  }
  return weights;
}

Range parameterRange(const Sequence& sequence, size_t parameter) {
  Range range{1e300, -1e300};
  for (const ParameterSample& sample : sequence.space.samples) {
    if (parameter >= sample.at.size()) continue;
    range.min = std::min(range.min, sample.at[parameter]);
    range.max = std::max(range.max, sample.at[parameter]);
  }
  return range.min > range.max ? Range{} : range;
}

int findParameter(const Sequence& sequence, std::string_view name) {
  for (size_t p = 0; p < sequence.space.names.size(); ++p)
    if (sequence.space.names[p] == name) return int(p);
  return -1;
}

double durationAt(const Sequence& sequence, std::span<const float> members) {
  double duration_s = 0;
  for (size_t m = 0; m < members.size() && m < sequence.members.size(); ++m)
    duration_s += members[m] * sequence.members[m].duration_s;
  return duration_s;
}

namespace {

// Loops over plain numbers, three per vertex: compilers that optimise for size do not inline vector operations.
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
