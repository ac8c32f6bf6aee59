// SPDX-License-Identifier: Apache-2.0
// One reader per kind of mesh file. parseMesh calls them and checks their results: indices may be out of range, and
// positions not finite. `path` is for messages.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "capture/mesh_file.h"

namespace fourdvt::capture {

inline constexpr const char* kNoUvs =
    "the mesh has no texture coordinates; unwrap it and export with UVs, or give capture.json "
    "\"topology\": \"per-frame\" and bake with --appearance cameras";
inline constexpr const char* kUvsOutside = "texture coordinates must lie in [0,1]; pack the UVs into one tile";

// Clamps a texture coordinate that lies in [0,1] up to rounding; else nullopt.
std::optional<glm::vec2> inTile(const glm::dvec2& uv);

Result<TriangleMesh> parsePly(std::string_view bytes, const std::string& path);

// Surface of a glTF file at an instant. With UVs, vertices split at seams of UVs alone are merged.
struct GltfSurface {
  TriangleMesh mesh;
  std::vector<glm::vec2> uvs;        // empty without UVs, as is face_uvs
  std::vector<glm::uvec3> face_uvs;  // one per face; indices into uvs if the face's vertex indices are in range
};
Result<GltfSurface> parseGlb(std::string_view bytes, const std::string& path, const MeshInstant& instant,
                             bool with_uvs);
// Parses glTF JSON. Buffers named by the JSON are read from the folder of `path` only.
Result<GltfSurface> parseGltf(std::string_view json, const std::string& path, const MeshInstant& instant,
                              bool with_uvs);

}  // namespace fourdvt::capture
