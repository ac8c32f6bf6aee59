// SPDX-License-Identifier: Apache-2.0
// Detects the kind of mesh files by their first bytes, checks what all kinds have in common, and writes meshes.
#include "capture/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "capture/mesh_readers.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 30;  // 1 GiB; a frame of 10 million triangles takes a fifth of it

struct Kind {
  const char* name;
  std::string_view extension;
  Result<TriangleMesh> (*parse)(std::string_view bytes, const std::string& path, const MeshInstant& instant);
};

template <auto parse>
Result<TriangleMesh> still(std::string_view bytes, const std::string& path, const MeshInstant&) {
  return parse(bytes, path);
}

template <auto parse>
Result<TriangleMesh> moving(std::string_view bytes, const std::string& path, const MeshInstant& instant) {
  FOURDVT_ASSIGN(auto surface, parse(bytes, path, instant, false));
  return std::move(surface.mesh);
}

constexpr Kind kObj{"OBJ", ".obj", still<parseObjSurface>};
constexpr Kind kPly{"PLY", ".ply", still<parsePly>};
constexpr Kind kGlb{"GLB", ".glb", moving<parseGlb>};
constexpr Kind kGltf{"glTF", ".gltf", moving<parseGltf>};
constexpr const Kind* kKinds[] = {&kObj, &kPly, &kGlb, &kGltf};

constexpr std::pair<std::string_view, const char*> kOtherKinds[] = {
    {".abc", "Alembic"}, {".usd", "USD"},       {".usda", "USD"}, {".usdc", "USD"}, {".usdz", "USD"},   {".fbx", "FBX"},
    {".stl", "STL"},     {".blend", "Blender"}, {".ma", "Maya"},  {".mb", "Maya"},  {".dae", "COLLADA"}};

// Kind by the first bytes; null if they are inconclusive. An OBJ has no fixed beginning.
const Kind* kindOfBytes(std::string_view bytes) {
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return &kPly;
  if (bytes.starts_with("glTF")) return &kGlb;
  const size_t text = bytes.find_first_not_of(" \t\r\n");
  return text != std::string_view::npos && bytes[text] == '{' ? &kGltf : nullptr;
}

Status checkMesh(const TriangleMesh& mesh, const std::string& path) {
  for (const glm::vec3& p : mesh.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return Error{ErrorId::MeshNotFinite, path + ": a vertex is not finite (NaN or infinity); repair this mesh"};
  }
  if (mesh.faces.empty())
    return Error{ErrorId::MeshIndex, path + ": no faces in it; export the mesh with its faces, not as points"};
  for (const glm::uvec3& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      if (face[k] >= mesh.positions.size())
        return Error{ErrorId::MeshIndex, path + ": a face index is out of range; export the mesh again"};
    }
  }
  return {};
}

// Kind by the path, unless the bytes contradict it.
Result<const Kind*> kindOf(std::string_view bytes, const std::string& path) {
  if (bytes.empty()) return Error{ErrorId::FileUnreadable, path + ": the file is empty; export the mesh again"};
  const std::string extension = lowerExtension(path);
  const auto named = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const Kind* kind) { return kind->extension == extension; });
  if (named == std::end(kKinds)) {
    const std::string other = otherMeshKind(path);
    return Error{ErrorId::Unsupported,
                 path + ": " +
                     (other.empty() ? "meshes are read from .obj, .ply, .glb and .gltf" : other + " is not read") +
                     "; " + kExportReadable};
  }
  const Kind* held = kindOfBytes(bytes);
  if (held && held != *named) {
    return Error{ErrorId::FileUnreadable, path + ": holds " + held->name + ", not " + (*named)->name +
                                              "; rename it to end in " + std::string(held->extension)};
  }
  if (!held && *named != &kObj) {
    return Error{ErrorId::FileUnreadable,
                 path + ": does not begin as " + (*named)->name + " does; export the mesh again, or correct its name"};
  }
  return *named;
}

Result<std::string> readBytes(const std::string& path) {
  std::error_code failed;
  const uint64_t size = std::filesystem::file_size(path, failed);
  if (!failed && size > kMaxFileBytes)
    return Error{ErrorId::Unsupported, path + ": larger than 1 GiB; reduce the mesh's triangles"};
  auto bytes = failed ? std::nullopt : readText(path);
  if (!bytes) return Error{ErrorId::FileMissing, path + ": mesh file cannot be read; check that it is there"};
  return std::move(*bytes);
}

}  // namespace

bool isMeshName(const std::string& name) {
  const std::string extension = lowerExtension(name);
  return std::any_of(std::begin(kKinds), std::end(kKinds),
                     [&](const Kind* kind) { return kind->extension == extension; });
}

bool isGltfName(const std::string& name) {
  const std::string extension = lowerExtension(name);
  return extension == kGlb.extension || extension == kGltf.extension;
}

std::string otherMeshKind(const std::string& name) {
  const std::string extension = lowerExtension(name);
  for (const auto& [other, kind] : kOtherKinds)
    if (extension == other) return kind;
  return {};
}

std::optional<glm::vec2> inTile(const glm::dvec2& given) {
  constexpr float kSlack = 1e-4f;  // tolerates rounding by exporters; UVs this far outside are clamped
  const glm::vec2 uv(given), clamped = glm::clamp(uv, 0.0f, 1.0f);
  if (!glm::all(glm::lessThanEqual(glm::abs(uv - clamped), glm::vec2(kSlack)))) return std::nullopt;
  return clamped;
}

Result<TriangleMesh> parseMesh(std::string_view given, const std::string& path, const MeshInstant& instant) {
  const std::string_view bytes = skipByteOrderMark(given);
  FOURDVT_ASSIGN(const Kind* kind, kindOf(bytes, path));
  FOURDVT_ASSIGN(auto mesh, kind->parse(bytes, path, instant));
  FOURDVT_TRY(checkMesh(mesh, path));
  return mesh;
}

Result<TriangleMesh> readMeshFile(const std::string& path, const MeshInstant& instant) {
  FOURDVT_ASSIGN(const std::string bytes, readBytes(path));
  return parseMesh(bytes, path, instant);
}

Result<UvMesh> parseUvGltf(std::string_view bytes, const std::string& path, const MeshInstant& instant) {
  FOURDVT_ASSIGN(const Kind* kind, kindOf(bytes, path));
  FOURDVT_ASSIGN(auto surface,
                 kind == &kGlb ? parseGlb(bytes, path, instant, true) : parseGltf(bytes, path, instant, true));
  FOURDVT_TRY(checkMesh(surface.mesh, path));
  const auto vertices = static_cast<uint32_t>(surface.mesh.positions.size());
  return UvMesh{{vertices, std::move(surface.uvs), std::move(surface.mesh.faces), std::move(surface.face_uvs)},
                std::move(surface.mesh.positions)};
}

Result<UvMesh> readUvGltf(const std::string& path, const MeshInstant& instant) {
  FOURDVT_ASSIGN(const std::string bytes, readBytes(path));
  return parseUvGltf(bytes, path, instant);
}

std::string plyBytes(const TriangleMesh& mesh) {
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.positions.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                    std::to_string(mesh.faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  out.reserve(out.size() + mesh.positions.size() * 12 + mesh.faces.size() * 13);
  const auto add = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const glm::vec3& p : mesh.positions) add(p);
  for (const glm::uvec3& face : mesh.faces) {
    out.push_back(3);
    add(face);
  }
  return out;
}

std::string objText(const MeshTopology& topology, const Positions& positions, double scale) {
  const int digits = 4 + int(std::ceil(std::max(0.0, -std::log10(scale))));
  std::string out;
  char line[120];
  for (const glm::vec3& p : positions) {
    std::snprintf(line, sizeof line, "v %.*f %.*f %.*f\n", digits, scale * p.x, digits, scale * p.y, digits,
                  scale * p.z);
    out += line;
  }
  for (const glm::vec2& uv : topology.uvs) {
    std::snprintf(line, sizeof line, "vt %.6f %.6f\n", uv.x, 1 - uv.y);
    out += line;
  }
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    const glm::uvec3 v = topology.face_vertices[f] + 1u, t = topology.face_uvs[f] + 1u;
    std::snprintf(line, sizeof line, "f %u/%u %u/%u %u/%u\n", v.x, t.x, v.y, t.y, v.z, t.z);
    out += line;
  }
  return out;
}

void appendPacked(const Positions& positions, double units_per_metre, std::vector<uint8_t>& out) {
  for (const glm::vec3& p : positions)
    for (int k = 0; k < 3; ++k) {
      const auto bits = static_cast<uint16_t>(static_cast<int16_t>(std::lround(p[k] * units_per_metre)));
      out.push_back(static_cast<uint8_t>(bits & 0xff));
      out.push_back(static_cast<uint8_t>(bits >> 8));
    }
}

}  // namespace fourdvt::capture
