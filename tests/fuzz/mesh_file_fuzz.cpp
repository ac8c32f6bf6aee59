// SPDX-License-Identifier: Apache-2.0
// PLY, GLB, glTF and OBJ of free topology, told apart by their first bytes: whatever is accepted is consistent, finite
// and not much larger than the input.
#include <cmath>
#include <cstdlib>

#include "capture/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const char* path : {"fuzz.ply", "fuzz.glb", "fuzz.gltf", "fuzz.obj"}) {
    const auto mesh = fourdvt::capture::parseMesh(bytes, path);
    if (!mesh.ok()) {
      const std::string& message = mesh.error().message;
      if (message.rfind("fuzz.", 0) != 0 && message.find(path) == std::string::npos) std::abort();
      continue;
    }
    const auto& [positions, faces] = mesh.value();
    if (faces.empty() || positions.size() > size || faces.size() > size) std::abort();
    for (const glm::vec3& p : positions) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
    }
    for (const glm::uvec3& face : faces) {
      if (face.x >= positions.size() || face.y >= positions.size() || face.z >= positions.size()) std::abort();
    }
  }
  return 0;
}
