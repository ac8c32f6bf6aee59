// SPDX-License-Identifier: Apache-2.0
#include "render/shared_corners.h"

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

}  // namespace fourdvt::render
