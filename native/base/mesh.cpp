// SPDX-License-Identifier: Apache-2.0
#include "base/mesh.h"

namespace fourdvt {

void computeVertexNormals(const std::vector<glm::uvec3>& face_vertices, const glm::vec3* positions, size_t vertex_count,
                          std::vector<glm::vec3>& normals) {
  normals.assign(vertex_count, glm::vec3(0));
  for (const glm::uvec3& f : face_vertices) {
    const glm::vec3 area_normal = glm::cross(positions[f.y] - positions[f.x], positions[f.z] - positions[f.x]);
    normals[f.x] += area_normal;
    normals[f.y] += area_normal;
    normals[f.z] += area_normal;
  }
  for (glm::vec3& n : normals) {
    const float length = glm::length(n);
    n = length > 1e-20f ? n / length : glm::vec3(0, 1, 0);
  }
}

}  // namespace fourdvt
