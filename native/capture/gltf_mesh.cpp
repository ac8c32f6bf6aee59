// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 and GLB: the triangles of the default scene, moved by its nodes. Skins and morphs are refused, because the
// mesh without them is another one.
#include <algorithm>
#include <cstring>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>

#include "base/bytes.h"
#include "capture/gltf_bytes.h"
#include "capture/mesh_readers.h"

namespace fourdvt::capture {
namespace {

constexpr uint32_t kGlbVersion = 2, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
constexpr uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

class GltfParser {
 public:
  explicit GltfParser(GltfBytes bytes) : bytes_(std::move(bytes)), root_(bytes_.root()) {}

  Result<TriangleMesh> parse() {
    const Json& nodes = gltfMember(root_, "nodes");
    seen_.assign(nodes.is_array() ? nodes.size() : 0, false);
    FOURDVT_TRY(pushRoots());
    while (!todo_.empty()) {
      const Placed placed = todo_.back();
      todo_.pop_back();
      FOURDVT_TRY(visit(placed));
    }
    return std::move(mesh_);
  }

 private:
  struct Placed {
    uint64_t node;
    glm::dmat4 world_from_parent;
  };

  // The nodes of the default scene; without scenes, those that are nobody's child.
  Status pushRoots() {
    const Json& scenes = gltfMember(root_, "scenes");
    if (scenes.is_array() && !scenes.empty())
      return push(gltfEntry(root_, "scenes", gltfNumber(root_, "scene").value_or(0)), "nodes", glm::dmat4(1));
    std::vector<bool> is_child(seen_.size(), false);
    for (size_t i = 0; i < seen_.size(); ++i) {
      for (const Json& child : gltfMember(root_["nodes"][i], "children")) {
        if (child.is_number_unsigned() && child.get<uint64_t>() < is_child.size())
          is_child[child.get<uint64_t>()] = true;
      }
    }
    for (size_t i = seen_.size(); i-- > 0;)
      if (!is_child[i]) FOURDVT_TRY(pushNode(i, glm::dmat4(1)));
    return {};
  }

  // Backwards, so that the first of the list is the next to be visited.
  Status push(const Json& parent, const char* key, const glm::dmat4& world_from_parent) {
    const Json& list = gltfMember(parent, key);
    if (list.is_null()) return {};
    if (!list.is_array()) return bytes_.error("its nodes cannot be read");
    for (size_t i = list.size(); i-- > 0;) {
      if (!list[i].is_number_unsigned() || list[i].get<uint64_t>() >= seen_.size())
        return bytes_.error("a node is missing (damaged)");
      FOURDVT_TRY(pushNode(list[i].get<uint64_t>(), world_from_parent));
    }
    return {};
  }

  Status pushNode(uint64_t node, const glm::dmat4& world_from_parent) {
    if (seen_[node]) return bytes_.error("its nodes do not form a tree");
    seen_[node] = true;
    todo_.push_back({node, world_from_parent});
    return {};
  }

  Status visit(const Placed& placed) {
    const Json& node = root_["nodes"][placed.node];
    FOURDVT_ASSIGN(const auto parent_from_node, transformOf(node));
    const glm::dmat4 world_from_node = placed.world_from_parent * parent_from_node;
    FOURDVT_TRY(push(node, "children", world_from_node));
    const auto mesh = gltfNumber(node, "mesh");
    if (!mesh) return {};
    FOURDVT_TRY(bytes_.checkExtensions(node));
    if (!gltfMember(node, "skin").is_null())
      return bytes_.unsupported("is posed by a skeleton; export every frame with its pose applied");
    return addMesh(gltfEntry(root_, "meshes", mesh), gltfMember(node, "weights"), world_from_node);
  }

  Result<glm::dmat4> transformOf(const Json& node) const {
    glm::dmat4 matrix(1);
    const Json& given = gltfMember(node, "matrix");
    if (!given.is_null()) {
      if (!gltfNumbers(given, 16, &matrix[0][0])) return bytes_.error("a node's matrix cannot be read");
      return matrix;
    }
    glm::dvec3 translation(0), scale(1);
    glm::dvec4 rotation(0, 0, 0, 1);  // x, y, z, w
    const auto read = [&](const char* key, size_t count, double* out) {
      const Json& list = gltfMember(node, key);
      return list.is_null() || gltfNumbers(list, count, out);
    };
    if (!read("translation", 3, &translation[0]) || !read("rotation", 4, &rotation[0]) || !read("scale", 3, &scale[0]))
      return bytes_.error("a node's transform cannot be read");
    const glm::dquat turn(rotation.w, rotation.x, rotation.y, rotation.z);
    return glm::scale(glm::translate(matrix, translation) * glm::mat4_cast(turn), scale);
  }

  Status addMesh(const Json& mesh, const Json& node_weights, const glm::dmat4& world_from_node) {
    if (!mesh.is_object()) return bytes_.error("a mesh is missing (damaged)");
    for (const Json* weights : {&node_weights, &gltfMember(mesh, "weights")}) {
      for (const Json& weight : *weights) {
        if (!weight.is_number() || weight.get<double>() != 0)
          return bytes_.unsupported("is shaped by morph targets; export every frame with them applied");
      }
    }
    std::map<uint64_t, uint32_t> first_vertex;  // of a position accessor: primitives may share one
    for (const Json& primitive : gltfMember(mesh, "primitives")) {
      FOURDVT_TRY(bytes_.checkExtensions(primitive));
      const Json& mode_given = gltfMember(primitive, "mode");
      const uint64_t mode = mode_given.is_null() ? kTriangles : gltfNumber(primitive, "mode").value_or(0);
      if (mode < kTriangles || mode > kFan) continue;  // points and lines
      const auto accessor = gltfNumber(gltfMember(primitive, "attributes"), "POSITION");
      FOURDVT_ASSIGN(const auto positions, bytes_.accessor(accessor, "VEC3", "its positions"));
      auto found = first_vertex.find(*accessor);
      if (found == first_vertex.end()) {
        found = first_vertex.emplace(*accessor, static_cast<uint32_t>(mesh_.positions.size())).first;
        FOURDVT_TRY(addPositions(positions, world_from_node));
      }
      FOURDVT_TRY(addFaces(primitive, mode, found->second, positions.count(), world_from_node));
    }
    return {};
  }

  // No single mesh has more vertices or faces than its file has bytes; a mesh that many nodes show might.
  Status checkSize(uint64_t vertices, uint64_t faces) const {
    if (vertices <= bytes_.size() && faces <= bytes_.size()) return {};
    return bytes_.unsupported("repeats its meshes too many times; export them as one mesh");
  }

  Status addPositions(const GltfNumbers& numbers, const glm::dmat4& world_from_node) {
    FOURDVT_TRY(checkSize(mesh_.positions.size() + numbers.count(), 0));
    mesh_.positions.reserve(mesh_.positions.size() + numbers.count());
    for (uint64_t i = 0; i < numbers.count(); ++i) {
      const glm::dvec4 point(numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2), 1);
      mesh_.positions.emplace_back(world_from_node * point);
    }
    return {};
  }

  Status addFaces(const Json& primitive, uint64_t mode, uint32_t first, uint64_t vertices,
                  const glm::dmat4& world_from_node) {
    const bool indexed = !gltfMember(primitive, "indices").is_null();
    GltfNumbers indices;
    if (indexed) {
      FOURDVT_ASSIGN(indices, bytes_.accessor(gltfNumber(primitive, "indices"), "SCALAR", "its indices"));
    }
    const uint64_t corners = indexed ? indices.count() : vertices, step = mode == kTriangles ? 3 : 1;
    if (corners < 3) return {};
    const uint64_t faces = (corners - 3) / step + 1;
    FOURDVT_TRY(checkSize(0, mesh_.faces.size() + faces));
    const bool mirrored = glm::determinant(glm::dmat3(world_from_node)) < 0;
    const auto vertex = [&](uint64_t corner) -> uint32_t {
      const double index = indexed ? indices.at(corner, 0) : static_cast<double>(corner);
      return index >= 0 && index < static_cast<double>(vertices) ? first + static_cast<uint32_t>(index) : 0xffffffffu;
    };
    for (uint64_t f = 0; f < faces; ++f) {
      const uint64_t a = f * step;
      glm::uvec3 face(vertex(mode == kFan ? 0 : a), vertex(a + 1), vertex(a + 2));
      if ((mode == kStrip && f % 2 == 1) != mirrored) std::swap(face.y, face.z);
      mesh_.faces.push_back(face);
    }
    return {};
  }

  GltfBytes bytes_;
  const Json& root_;
  std::vector<bool> seen_;
  std::vector<Placed> todo_;
  TriangleMesh mesh_;
};

Result<TriangleMesh> parseParts(std::string_view json, std::string_view buffer, const std::string& path) {
  FOURDVT_ASSIGN(auto bytes, GltfBytes::open(json, buffer, path));
  return GltfParser(std::move(bytes)).parse();
}

}  // namespace

Result<TriangleMesh> parseGltf(std::string_view json, const std::string& path) { return parseParts(json, {}, path); }

Result<TriangleMesh> parseGlb(std::string_view bytes, const std::string& path) {
  const Error truncated{ErrorId::FileUnreadable,
                        path + ": the GLB ends before all that it announces (truncated); export the mesh again"};
  ByteReader reader({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  reader.u32();  // "glTF"
  const uint32_t version = reader.u32();
  reader.u32();  // the file's length: the chunks have their own
  if (reader.ok() && version != kGlbVersion)
    return Error{ErrorId::Unsupported, path + ": is GLB version " + std::to_string(version) + "; export as glTF 2.0"};
  if (!reader.ok()) return truncated;
  std::string_view json, buffer;
  for (size_t chunk = 0; chunk < 2 && reader.remaining() >= 8; ++chunk) {
    const uint32_t size = reader.u32(), kind = reader.u32();
    const std::string_view body = bytes.substr(reader.position(), size);
    reader.bytes(size);
    if (!reader.ok()) return truncated;
    if (chunk == 0 && kind == kJsonChunk) json = body;
    if (chunk == 1 && kind == kBinChunk) buffer = body;
  }
  if (json.empty()) return truncated;
  return parseParts(json, buffer, path);
}

}  // namespace fourdvt::capture
