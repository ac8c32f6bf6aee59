// SPDX-License-Identifier: Apache-2.0
// PLY, GLB, glTF and OBJ of any topology, selected by their first bytes, and animated glTF with UVs: accepted meshes
// are consistent, finite and not much larger than the input.
#include <cmath>
#include <cstdlib>

#include "capture/mesh_file.h"

namespace {

using fourdvt::capture::MeshInstant;

template <class T>
bool accepted(const fourdvt::Result<T>& mesh, const std::string& path) {
  if (mesh.ok()) return true;
  const std::string& message = mesh.error().message;
  if (message.rfind("fuzz.", 0) != 0 && message.find(path) == std::string::npos) std::abort();
  return false;
}

void check(const fourdvt::Positions& positions, const std::vector<glm::uvec3>& faces, size_t size) {
  if (faces.empty() || positions.size() > size || faces.size() > size) std::abort();
  for (const glm::vec3& p : positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
  }
  for (const glm::uvec3& face : faces) {
    if (face.x >= positions.size() || face.y >= positions.size() || face.z >= positions.size()) std::abort();
  }
}

void checkUvs(const fourdvt::MeshTopology& topology, size_t size) {
  if (topology.face_uvs.size() != topology.face_vertices.size() || topology.uvs.size() > size) std::abort();
  for (const glm::uvec3& face : topology.face_uvs) {
    for (int k = 0; k < 3; ++k) {
      if (face[k] >= topology.uvs.size()) std::abort();
      const glm::vec2 uv = topology.uvs[face[k]];
      if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const char* path : {"fuzz.ply", "fuzz.glb", "fuzz.gltf", "fuzz.obj"}) {
    const auto mesh = fourdvt::capture::parseMesh(bytes, path);
    if (accepted(mesh, path)) check(mesh.value().positions, mesh.value().faces, size);
  }
  for (const char* path : {"fuzz.glb", "fuzz.gltf"}) {
    const auto mesh = fourdvt::capture::parseUvGltf(bytes, path, {"walk", 0.03, 0.04, true});
    if (!accepted(mesh, path)) continue;
    check(mesh.value().positions, mesh.value().topology.face_vertices, size);
    checkUvs(mesh.value().topology, size);
  }
  return 0;
}
