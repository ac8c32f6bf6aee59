// SPDX-License-Identifier: Apache-2.0
// Base meshes in the start file's coding: accepted ones have indices in range and finite values, and can be encoded
// again.
#include <cmath>
#include <cstdlib>

#include "package/mesh_code.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto mesh = fourdvt::package::decodeMeshCode({data, size}, 20000, 20000);
  if (!mesh.ok()) return 0;
  const fourdvt::MeshTopology& t = mesh.value().topology;
  if (t.vertex_count != mesh.value().positions.size() || t.face_uvs.size() != t.face_vertices.size()) std::abort();
  for (uint32_t f = 0; f < t.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (t.face_vertices[f][k] >= t.vertex_count || t.face_uvs[f][k] >= t.uvs.size()) std::abort();
    }
  }
  for (const glm::vec3& p : mesh.value().positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
  }
  if (!fourdvt::package::encodeMeshCode(mesh.value()).ok()) std::abort();
  return 0;
}
