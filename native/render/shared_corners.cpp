// SPDX-License-Identifier: Apache-2.0
#include "render/shared_corners.h"

#include <algorithm>

namespace fourdvt::render {

std::vector<uint32_t> cornersBefore(std::span<const glm::uvec3> uvs, size_t uv_count) {
  std::vector<uint32_t> before(3 * uvs.size()), last(uv_count, ~0u);
  for (uint32_t corner = 0; corner < before.size(); ++corner) {
    uint32_t& seen = last[uvs[corner / 3][int(corner % 3)]];
    before[corner] = seen == ~0u ? corner : seen;
    seen = corner;
  }
  return before;
}

void shareCorners(std::span<const uint32_t> before, std::span<const glm::uvec3> vertices,
                  std::span<const uint32_t> labels, std::vector<uint32_t>& shared) {
  const auto areAlike = [&](uint32_t a, uint32_t b) {
    if (vertices[a / 3][int(a % 3)] != vertices[b / 3][int(b % 3)]) return false;
    for (a /= 3, b /= 3; a < labels.size(); a += vertices.size(), b += vertices.size())
      if (labels[a] != labels[b]) return false;
    return true;
  };
  shared.resize(before.size());
  for (uint32_t corner = 0; corner < before.size(); ++corner) {
    shared[corner] = corner;
    for (uint32_t other = corner; before[other] != other;) {
      other = before[other];
      if (!areAlike(corner, other)) continue;
      shared[corner] = shared[other];
      break;
    }
  }
}

namespace {

// Lengths for a person. Contact shadows fade within 8 cm above the ground.
constexpr float kShadowCell_m = 0.06f, kFineShadow_m = 0.2f;
constexpr size_t kMinShadowFaces = 200;

uint32_t groupOf(std::vector<uint32_t>& groups, uint32_t vertex) {
  while (groups[vertex] != vertex) vertex = groups[vertex] = groups[groups[vertex]];
  return vertex;
}

}  // namespace

std::vector<uint32_t> coarseCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float cell_m, float fine_below_m) {
  std::vector<uint32_t> groups(positions.size()), corner_of(positions.size()), out;
  for (uint32_t vertex = 0; vertex < groups.size(); ++vertex) groups[vertex] = vertex;
  for (uint32_t corner = 0; corner < 3 * faces.size(); ++corner) {
    const glm::uvec3& face = faces[corner / 3];
    uint32_t a = face[int(corner % 3)], b = face[int((corner + 1) % 3)];
    corner_of[a] = corner;
    if (std::min(positions[a].y, positions[b].y) < fine_below_m) continue;
    if (glm::floor(positions[a] / cell_m) != glm::floor(positions[b] / cell_m)) continue;
    a = groupOf(groups, a);
    b = groupOf(groups, b);
    if (positions[a].y < positions[b].y)
      groups[b] = a;
    else
      groups[a] = b;
  }
  for (const glm::uvec3& face : faces) {
    const uint32_t a = groupOf(groups, face.x), b = groupOf(groups, face.y), c = groupOf(groups, face.z);
    if (a == b || b == c || c == a) continue;
    for (const uint32_t vertex : {a, b, c}) out.push_back(corner_of[vertex]);
  }
  return out;
}

std::vector<uint32_t> shadowCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float ground_y_m, float length_scale) {
  std::vector<uint32_t> coarse =
      coarseCorners(faces, positions, length_scale * kShadowCell_m, ground_y_m + length_scale * kFineShadow_m);
  // Small savings are not worth the loss of shape.
  if (2 * coarse.size() > 3 * faces.size() || coarse.size() < 3 * kMinShadowFaces) coarse.clear();
  return coarse;
}

}  // namespace fourdvt::render
