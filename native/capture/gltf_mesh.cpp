// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 and GLB: triangles of the default scene at one instant of its animation, moved by nodes, skins and morph
// targets.
#include <algorithm>
#include <deque>
#include <glm/glm.hpp>
#include <map>
#include <unordered_map>

#include "base/bytes.h"
#include "base/hash.h"
#include "capture/gltf.h"
#include "capture/mesh_readers.h"

namespace fourdvt::capture {
namespace {

constexpr uint32_t kGlbVersion = 2, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
constexpr uint64_t kTriangles = 4, kStrip = 5, kFan = 6;
constexpr uint32_t kNoVertex = 0xffffffff;

// Welds equal vertices of one node. glTF splits a vertex at seams of UVs and normals, but it moves as one.
class Welder {
 public:
  // Returns the number of a vertex that is the same at every instant, else adds and returns `number`. The shape is
  // borrowed.
  uint32_t add(const GltfShape& shape, uint64_t vertex, uint32_t number) {
    const glm::dvec3 rest = shape.rest(vertex);
    const uint64_t hash = fnv1a(std::span(reinterpret_cast<const uint8_t*>(&rest), sizeof rest));
    const auto [begin, end] = places_.equal_range(hash);
    for (auto it = begin; it != end; ++it)
      if (it->second.shape->isSame(it->second.vertex, shape, vertex)) return it->second.number;
    places_.emplace(hash, Place{&shape, vertex, number});
    return number;
  }

 private:
  struct Place {
    const GltfShape* shape;
    uint64_t vertex;
    uint32_t number;
  };
  std::unordered_multimap<uint64_t, Place> places_;
};

class GltfParser {
 public:
  GltfParser(GltfBytes bytes, bool with_uvs) : bytes_(std::move(bytes)), root_(bytes_.root()), with_uvs_(with_uvs) {}

  Result<GltfSurface> parse(const MeshInstant& instant) {
    FOURDVT_ASSIGN(poses_, gltfPoses(bytes_, instant));
    world_from_node_.resize(poses_.size());
    seen_.assign(poses_.size(), false);
    FOURDVT_TRY(pushRoots());
    std::vector<uint64_t> with_meshes;
    while (!todo_.empty()) {
      const uint64_t node = todo_.back();
      todo_.pop_back();
      const glm::dmat4 world = world_from_node_[node] * poses_[node].parentFromNode();
      world_from_node_[node] = world;
      FOURDVT_TRY(push(root_["nodes"][node], "children", world));
      if (gltfNumber(root_["nodes"][node], "mesh")) with_meshes.push_back(node);
    }
    for (const uint64_t node : with_meshes) FOURDVT_TRY(addMesh(node));
    return std::move(out_);
  }

 private:
  struct Group {  // vertices shared by primitives
    uint32_t first = 0;
    uint64_t count = 0;
  };

  // Pushes the nodes of the default scene; without scenes, the root nodes.
  Status pushRoots() {
    const Json& scenes = jsonMember(root_, "scenes");
    if (scenes.is_array() && !scenes.empty())
      return push(gltfEntry(root_, "scenes", gltfNumber(root_, "scene").value_or(0)), "nodes", glm::dmat4(1));
    std::vector<bool> is_child(seen_.size(), false);
    for (size_t i = 0; i < seen_.size(); ++i) {
      for (const Json& child : jsonMember(root_["nodes"][i], "children")) {
        if (child.is_number_unsigned() && child.get<uint64_t>() < is_child.size())
          is_child[child.get<uint64_t>()] = true;
      }
    }
    for (size_t i = seen_.size(); i-- > 0;)
      if (!is_child[i]) FOURDVT_TRY(pushNode(i, glm::dmat4(1)));
    return {};
  }

  // Pushes in reverse order, so that the first of the list is visited next.
  Status push(const Json& parent, const char* key, const glm::dmat4& world_from_parent) {
    const Json& list = jsonMember(parent, key);
    if (list.is_null()) return {};
    if (!list.is_array()) return bytes_.error("its nodes cannot be read");
    for (size_t i = list.size(); i-- > 0;) {
      if (!list[i].is_number_unsigned() || list[i].get<uint64_t>() >= seen_.size())
        return bytes_.error("a node is missing (damaged)");
      FOURDVT_TRY(pushNode(list[i].get<uint64_t>(), world_from_parent));
    }
    return {};
  }

  // Stores the parent's transform until the node is visited.
  Status pushNode(uint64_t node, const glm::dmat4& world_from_parent) {
    if (seen_[node]) return bytes_.error("its nodes do not form a tree");
    seen_[node] = true;
    world_from_node_[node] = world_from_parent;
    todo_.push_back(node);
    return {};
  }

  Status addMesh(uint64_t index) {
    const Json& node = root_["nodes"][index];
    FOURDVT_TRY(bytes_.checkExtensions(node));
    const Json& mesh = gltfEntry(root_, "meshes", gltfNumber(node, "mesh"));
    if (!mesh.is_object()) return bytes_.error("a mesh is missing (damaged)");
    FOURDVT_ASSIGN(const auto weights, weightsOf(mesh, poses_[index]));
    FOURDVT_ASSIGN(const auto joints, jointsOf(node));  // empty: moved by the node
    std::map<std::string, Group> groups;
    std::deque<GltfShape> shapes;
    Welder welder;
    for (const Json& primitive : jsonMember(mesh, "primitives")) {
      FOURDVT_TRY(bytes_.checkExtensions(primitive));
      const Json& mode_given = jsonMember(primitive, "mode");
      const uint64_t mode = mode_given.is_null() ? kTriangles : gltfNumber(primitive, "mode").value_or(0);
      if (mode < kTriangles || mode > kFan) continue;  // skips points and lines
      const auto [group, is_new] =
          groups.try_emplace(jsonMember(primitive, "attributes").dump() + jsonMember(primitive, "targets").dump());
      if (is_new) {
        FOURDVT_ASSIGN(auto shape, GltfShape::open(bytes_, primitive, weights, !joints.empty()));
        shapes.push_back(std::move(shape));
        FOURDVT_ASSIGN(group->second, addVertices(shapes.back(), joints, world_from_node_[index], welder));
        if (with_uvs_) FOURDVT_TRY(addUvs(primitive, shapes.back().count()));
      }
      const glm::dmat4& moved_by = joints.empty() ? world_from_node_[index] : joints[0];
      FOURDVT_TRY(addFaces(primitive, mode, group->second, glm::determinant(glm::dmat3(moved_by)) < 0));
    }
    return {};
  }

  Result<std::vector<double>> weightsOf(const Json& mesh, const GltfPose& pose) const {
    if (pose.weights) return *pose.weights;
    const Json& given = jsonMember(mesh, "weights");
    std::vector<double> weights(given.size());
    if (!weights.empty() && !jsonNumbers(given, weights.size(), weights.data()))
      return bytes_.error("a mesh's morph weights cannot be read");
    return weights;
  }

  // Transforms of a skin's joints, from the bind pose to the world; empty without a skin.
  Result<std::vector<glm::dmat4>> jointsOf(const Json& node) {
    std::vector<glm::dmat4> out;
    if (jsonMember(node, "skin").is_null()) return out;
    const Json& skin = gltfEntry(root_, "skins", gltfNumber(node, "skin"));
    const Json& joints = jsonMember(skin, "joints");
    if (!joints.is_array() || joints.empty()) return bytes_.error("a skin is missing, or has no joints (damaged)");
    const bool bound = !jsonMember(skin, "inverseBindMatrices").is_null();
    GltfNumbers binds;
    if (bound) {
      FOURDVT_ASSIGN(binds,
                     bytes_.accessor(gltfNumber(skin, "inverseBindMatrices"), "MAT4", "its inverse bind matrices"));
      if (binds.count() < joints.size()) return bytes_.error("a skin has fewer bind matrices than joints");
    }
    for (const Json& joint : joints) {
      const uint64_t j = joint.is_number_unsigned() ? joint.get<uint64_t>() : seen_.size();
      if (j >= seen_.size() || !seen_[j]) return bytes_.error("a skin's joint is not in the scene");
      glm::dmat4 joint_from_rest(1);
      for (int c = 0; bound && c < 16; ++c) joint_from_rest[c / 4][c % 4] = binds.at(out.size(), c);
      out.push_back(world_from_node_[j] * joint_from_rest);
    }
    return out;
  }

  // Limits vertices and faces to the file's bytes, which any single mesh meets; a mesh that many nodes instance may
  // not.
  Status checkSize(uint64_t vertices, uint64_t faces) const {
    if (vertices <= bytes_.size() && faces <= bytes_.size()) return {};
    return bytes_.unsupported("repeats its meshes too many times; export them as one mesh");
  }

  Result<Group> addVertices(const GltfShape& shape, const std::vector<glm::dmat4>& joints,
                            const glm::dmat4& world_from_node, Welder& welder) {
    const Group group{static_cast<uint32_t>(vertex_of_.size()), shape.count()};
    FOURDVT_TRY(checkSize(vertex_of_.size() + shape.count(), 0));
    Positions& positions = out_.mesh.positions;
    for (uint64_t i = 0; i < shape.count(); ++i) {
      const auto number = static_cast<uint32_t>(positions.size());
      vertex_of_.push_back(with_uvs_ ? welder.add(shape, i, number) : number);
      if (vertex_of_.back() != number) continue;
      glm::dvec3 point = world_from_node * glm::dvec4(joints.empty() ? shape.morphed(i) : glm::dvec3(0), 1);
      if (!joints.empty() && !shape.skinned(i, joints, point))
        return Error{ErrorId::MeshIndex, bytes_.path() + ": a vertex's joint is out of range; export the mesh again"};
      positions.emplace_back(point);
    }
    return group;
  }

  Status addUvs(const Json& primitive, uint64_t vertices) {
    const auto accessor = gltfNumber(jsonMember(primitive, "attributes"), "TEXCOORD_0");
    if (!accessor) return Error{ErrorId::MeshNoUvs, bytes_.path() + ": " + kNoUvs};
    FOURDVT_ASSIGN(const auto uvs, bytes_.accessor(accessor, "VEC2", "its texture coordinates"));
    if (uvs.count() != vertices) return bytes_.error("its texture coordinates are not as many as its vertices");
    for (uint64_t i = 0; i < vertices; ++i) {
      const auto uv = inTile({uvs.at(i, 0), uvs.at(i, 1)});
      if (!uv) return Error{ErrorId::MeshUvRange, bytes_.path() + ": " + kUvsOutside};
      out_.uvs.push_back(*uv);
    }
    return {};
  }

  Status addFaces(const Json& primitive, uint64_t mode, const Group& group, bool mirrored) {
    const bool indexed = !jsonMember(primitive, "indices").is_null();
    GltfNumbers indices;
    if (indexed) {
      FOURDVT_ASSIGN(indices, bytes_.accessor(gltfNumber(primitive, "indices"), "SCALAR", "its indices"));
    }
    const uint64_t corners = indexed ? indices.count() : group.count, step = mode == kTriangles ? 3 : 1;
    if (corners < 3) return {};
    const uint64_t faces = (corners - 3) / step + 1;
    FOURDVT_TRY(checkSize(0, out_.mesh.faces.size() + faces));
    const auto vertex = [&](uint64_t corner) -> uint32_t {
      const double index = indexed ? indices.at(corner, 0) : static_cast<double>(corner);
      const bool inside = index >= 0 && index < static_cast<double>(group.count);
      return inside ? group.first + static_cast<uint32_t>(index) : kNoVertex;
    };
    for (uint64_t f = 0; f < faces; ++f) {
      const uint64_t a = f * step;
      glm::uvec3 face(vertex(mode == kFan ? 0 : a), vertex(a + 1), vertex(a + 2));
      if ((mode == kStrip && f % 2 == 1) != mirrored) std::swap(face.y, face.z);
      if (with_uvs_) out_.face_uvs.push_back(face);
      for (int k = 0; k < 3; ++k) face[k] = face[k] == kNoVertex ? kNoVertex : vertex_of_[face[k]];
      out_.mesh.faces.push_back(face);
    }
    return {};
  }

  GltfBytes bytes_;
  const Json& root_;
  const bool with_uvs_;
  std::vector<GltfPose> poses_;
  std::vector<bool> seen_;
  std::vector<uint64_t> todo_;
  std::vector<glm::dmat4> world_from_node_;  // nodes of the scene
  std::vector<uint32_t> vertex_of_;          // vertex of the mesh, by vertex of the file
  GltfSurface out_;
};

}  // namespace

Result<GltfSurface> parseGltf(std::string_view json, const std::string& path, const MeshInstant& instant,
                              bool with_uvs) {
  FOURDVT_ASSIGN(auto bytes, GltfBytes::open(json, {}, path));
  return GltfParser(std::move(bytes), with_uvs).parse(instant);
}

Result<GltfSurface> parseGlb(std::string_view bytes, const std::string& path, const MeshInstant& instant,
                             bool with_uvs) {
  const Error truncated{ErrorId::FileUnreadable,
                        path + ": the GLB ends before all that it announces (truncated); export the mesh again"};
  ByteReader reader(bytesOf(bytes));
  reader.u32();  // "glTF"
  const uint32_t version = reader.u32();
  reader.u32();  // length of the file; the chunks have their own
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
  FOURDVT_ASSIGN(auto parts, GltfBytes::open(json, buffer, path));
  return GltfParser(std::move(parts), with_uvs).parse(instant);
}

}  // namespace fourdvt::capture
