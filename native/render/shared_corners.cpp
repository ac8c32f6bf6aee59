// SPDX-License-Identifier: Apache-2.0
#include "render/shared_corners.h"

namespace fourdvt::render {
namespace {

// The first corner on the way back that is alike; `corner` if none is.
template <class Alike>
uint32_t alikeBefore(std::span<const uint32_t> before, uint32_t corner, const Alike& alike) {
  for (uint32_t other = corner; before[other] != other;) {
    other = before[other];
    if (alike(other)) return other;
  }
  return corner;
}

}  // namespace

std::vector<uint32_t> cornersBefore(std::span<const glm::uvec3> vertices, std::span<const glm::uvec3> uvs,
                                    size_t vertex_count) {
  constexpr uint32_t kNone = ~0u;
  std::vector<uint32_t> last(vertex_count, kNone), before;
  for (const glm::uvec3& face : vertices)
    for (int k = 0; k < 3; ++k) {
      const uint32_t corner = uint32_t(before.size());
      before.push_back(last[face[k]] == kNone ? corner : last[face[k]]);
      last[face[k]] = corner;
    }
  if (uvs.empty()) return before;
  const auto uvOf = [&](uint32_t corner) { return uvs[corner / 3][int(corner % 3)]; };
  std::vector<uint32_t> out;
  for (uint32_t corner = 0; corner < before.size(); ++corner)
    out.push_back(alikeBefore(before, corner, [&](uint32_t other) { return uvOf(other) == uvOf(corner); }));
  return out;
}

std::vector<uint32_t> firstCorners(std::vector<uint32_t> before) {
  for (uint32_t& corner : before) corner = before[corner];
  return before;
}

void shareCorners(std::span<const uint32_t> before, std::span<const uint32_t> labels, std::vector<uint32_t>& shared) {
  const size_t face_count = before.size() / 3;
  shared.clear();
  for (uint32_t corner = 0; corner < before.size(); ++corner) {
    const uint32_t alike = alikeBefore(before, corner, [&](uint32_t other) {
      size_t a = corner / 3, b = other / 3;
      while (a < labels.size() && labels[a] == labels[b]) a += face_count, b += face_count;
      return a >= labels.size();
    });
    shared.push_back(alike == corner ? corner : shared[alike]);
  }
}

}  // namespace fourdvt::render
