// SPDX-License-Identifier: Apache-2.0
// OBJ text: whatever is accepted is consistent.
#include <cstdlib>

#include "capture/capture.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto mesh = fourdvt::capture::parseObj(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.obj");
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
  return 0;
}
