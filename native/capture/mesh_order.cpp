// SPDX-License-Identifier: Apache-2.0
#include "capture/mesh_order.h"

#include <algorithm>

namespace fourdvt::capture {
namespace {

constexpr float kGrowth = 5, kSpan = 0.05f, kShortest = 1e-6f;  // ratio; shares of the mesh's size: span, and edge
                                                                // length below which a degenerate edge may open

// Diagonal of the bounding box.
float sizeOf(const Positions& positions) {
  if (positions.empty()) return 0;
  glm::vec3 min = positions[0], max = positions[0];
  for (const glm::vec3& p : positions) min = glm::min(min, p), max = glm::max(max, p);
  return glm::distance(min, max);
}

}  // namespace

EdgeLengths::EdgeLengths(const std::vector<glm::uvec3>& faces, const Positions& positions) {
  const float size = sizeOf(positions);
  if (!(size > 0)) return;
  for (const glm::uvec3& face : faces) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = face[k], b = face[(k + 1) % 3];
      const float length = glm::distance(positions[a], positions[b]) / size;
      if (length > kShortest) edges_.push_back({a, b, length});
    }
  }
}

double EdgeLengths::grown(const Positions& positions) const {
  const float size = sizeOf(positions);
  if (edges_.empty() || !(size > 0)) return 0;
  const auto grown = std::count_if(edges_.begin(), edges_.end(), [&](const Edge& edge) {
    const float length = glm::distance(positions[edge.a], positions[edge.b]) / size;
    return length > kSpan && length > kGrowth * edge.length;
  });
  return static_cast<double>(grown) / static_cast<double>(edges_.size());
}

}  // namespace fourdvt::capture
