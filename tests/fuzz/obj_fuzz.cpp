// SPDX-License-Identifier: Apache-2.0
// OBJ text: accepted meshes are consistent, and have the same faces if their polygons are triangulated as before.
#include <cstdlib>

#include "capture/capture.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto mesh = fourdvt::capture::parseObj(text, "fuzz.obj");
  if (!mesh.ok()) {
    if (mesh.error().message.rfind("fuzz.obj", 0) != 0) std::abort();
    return 0;
  }
  const fourdvt::MeshTopology& t = mesh.value().topology;
  if (t.vertex_count != mesh.value().positions.size() || t.face_uvs.size() != t.face_vertices.size()) std::abort();
  for (uint32_t f = 0; f < t.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (t.face_vertices[f][k] >= t.vertex_count || t.face_uvs[f][k] >= t.uvs.size()) std::abort();
    }
  }
  const auto again = fourdvt::capture::parseObj(text, "fuzz.obj", &t);
  if (!again.ok() || again.value().topology.face_vertices != t.face_vertices ||
      again.value().topology.face_uvs != t.face_uvs)
    std::abort();
  return 0;
}
