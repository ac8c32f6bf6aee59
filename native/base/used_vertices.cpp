// SPDX-License-Identifier: Apache-2.0
#include "base/used_vertices.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace fourdvt {

void dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<uint32_t> renumbered(mesh.positions.size(), UINT32_MAX);
  Positions used;
  for (glm::uvec3& face : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      uint32_t& number = renumbered[face[k]];
      if (number == UINT32_MAX) {
        number = static_cast<uint32_t>(used.size());
        used.push_back(mesh.positions[face[k]]);
      }
      face[k] = number;
    }
  mesh.positions = std::move(used);
}

}  // namespace fourdvt
