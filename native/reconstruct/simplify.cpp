// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/simplify.h"

#include <meshoptimizer.h>

#include "base/used_vertices.h"

namespace fourdvt::reconstruct {
namespace {

constexpr float kAnyError = 1;  // of the mesh's extent: the number of faces decides

}  // namespace

void simplify(TriangleMesh& mesh, size_t most_faces) {
  if (mesh.faces.size() <= most_faces) return;
  std::vector<glm::uvec3> kept(mesh.faces.size());
  const size_t indices =
      meshopt_simplify(&kept[0].x, &mesh.faces[0].x, 3 * mesh.faces.size(), &mesh.positions[0].x, mesh.positions.size(),
                       sizeof(glm::vec3), 3 * most_faces, kAnyError, 0, nullptr);
  kept.resize(indices / 3);
  mesh.faces = std::move(kept);
  dropUnusedVertices(mesh);
}

}  // namespace fourdvt::reconstruct
