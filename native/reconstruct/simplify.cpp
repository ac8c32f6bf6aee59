// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/simplify.h"

#include <meshoptimizer.h>

namespace fourdvt::reconstruct {
namespace {

constexpr float kAnyError = 1;  // of the mesh's extent: the number of faces decides

void dropUnused(TriangleMesh& mesh) {
  std::vector<uint32_t> index(mesh.positions.size(), UINT32_MAX);
  Positions used;
  for (glm::uvec3& face : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      uint32_t& at = index[face[k]];
      if (at == UINT32_MAX) {
        at = uint32_t(used.size());
        used.push_back(mesh.positions[face[k]]);
      }
      face[k] = at;
    }
  mesh.positions = std::move(used);
}

}  // namespace

void simplify(TriangleMesh& mesh, size_t most_faces) {
  if (mesh.faces.size() <= most_faces) return;
  std::vector<glm::uvec3> kept(mesh.faces.size());
  const size_t indices =
      meshopt_simplify(&kept[0].x, &mesh.faces[0].x, 3 * mesh.faces.size(), &mesh.positions[0].x, mesh.positions.size(),
                       sizeof(glm::vec3), 3 * most_faces, kAnyError, 0, nullptr);
  kept.resize(indices / 3);
  mesh.faces = std::move(kept);
  dropUnused(mesh);
}

}  // namespace fourdvt::reconstruct
