// SPDX-License-Identifier: Apache-2.0
// Meshes as the texts and bytes of OBJ, PLY and glTF files.
#pragma once

#include <cstdio>
#include <cstring>
#include <string>

#include "base/mesh.h"

namespace fourdvt::capture {

// Two triangles of a unit square at z = 1, and a vertex that no face uses.
inline TriangleMesh squareMesh() {
  return {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5f, 0.25f, 3}}, {{0, 1, 2}, {0, 2, 3}}};
}

inline std::string objText(const TriangleMesh& mesh) {
  std::string text = "# a comment\no body\n";
  char line[96];
  for (const glm::vec3& p : mesh.positions) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", double(p.x), double(p.y), double(p.z));
    text += line;
  }
  for (const glm::uvec3& f : mesh.faces) {
    std::snprintf(line, sizeof line, "f %u %u %u\n", f.x + 1, f.y + 1, f.z + 1);
    text += line;
  }
  return text;
}

template <class T>
std::string rawBytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

inline std::string glb(std::string json, std::string buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  const auto u32 = [](size_t value) { return rawBytes(std::vector<uint32_t>{static_cast<uint32_t>(value)}); };
  return "glTF" + u32(2) + u32(28 + json.size() + buffer.size()) + u32(json.size()) + "JSON" + json +
         u32(buffer.size()) + std::string("BIN\0", 4) + buffer;
}

// Buffer that gltfJson describes: positions, then faces.
inline std::string gltfBuffer(const TriangleMesh& mesh) { return rawBytes(mesh.positions) + rawBytes(mesh.faces); }

// glTF with one mesh. `nodes`: the scene, whose first node is the root; `primitives` replace those of mesh 0.
inline std::string gltfJson(const TriangleMesh& mesh, const std::string& nodes = R"([{"mesh": 0}])",
                            const std::string& primitives = R"([{"attributes": {"POSITION": 0}, "indices": 1}])",
                            const std::string& uri = "") {
  const size_t positions = mesh.positions.size() * 12, faces = mesh.faces.size() * 12;
  const auto text = [](size_t value) { return std::to_string(value); };
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + nodes +
         R"(, "meshes": [{"primitives": )" + primitives + R"(}], "buffers": [{)" +
         (uri.empty() ? "" : "\"uri\": \"" + uri + "\", ") + R"("byteLength": )" + text(positions + faces) +
         R"(}], "bufferViews": [{"buffer": 0, "byteLength": )" + text(positions) +
         R"(}, {"buffer": 0, "byteOffset": )" + text(positions) + R"(, "byteLength": )" + text(faces) +
         R"(}], "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": )" +
         text(mesh.positions.size()) + R"(}, {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": )" +
         text(mesh.faces.size() * 3) + "}]}";
}

inline std::string glbBytes(const TriangleMesh& mesh) { return glb(gltfJson(mesh), gltfBuffer(mesh)); }

}  // namespace fourdvt::capture
