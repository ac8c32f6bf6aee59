// SPDX-License-Identifier: Apache-2.0
// Parts of a glTF 2.0 file: its JSON, buffers and accessors, all bounds checked (gltf_bytes.cpp); poses of its nodes at
// an instant (gltf_animation.cpp); vertices under morph targets and a skin (gltf_shape.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "capture/mesh_file.h"
#include "capture/text.h"

namespace fourdvt::capture {

using Json = nlohmann::json;

// Entry `index` of the list root[key]; null if missing.
const Json& gltfEntry(const Json& root, const char* key, std::optional<uint64_t> index);
// Non-negative integer that is exact as a double; nullopt for anything else.
std::optional<uint64_t> gltfNumber(const Json& node, const char* key);

// View of numbers in a buffer, borrowed from the GltfBytes.
class GltfNumbers {
 public:
  uint64_t count() const { return count_; }
  // Component `c` of element `i`; a normalised integer lies in [-1,1].
  double at(uint64_t i, int c) const;

 private:
  friend class GltfBytes;
  struct Elements {
    const uint8_t* data = nullptr;
    uint64_t stride = 0, type = 0;  // component type by its glTF number
    double at(uint64_t i, int c, bool normalized) const;
  };
  Elements elements_;  // null data: zeros
  uint64_t count_ = 0, sparse_count_ = 0;
  Elements sparse_indices_, sparse_values_;  // indices, ascending, and values of the sparse elements
  bool normalized_ = false;
};

class GltfBytes {
 public:
  // `path`: for messages, and for the folder of files named by the JSON. `glb_buffer` must outlive the result.
  static Result<GltfBytes> open(std::string_view json, std::string_view glb_buffer, const std::string& path);

  const Json& root() const { return root_; }
  const std::string& path() const { return path_; }
  // Bytes of the file and of the buffers used so far.
  uint64_t size() const { return size_; }
  Error error(const std::string& what) const;        // FileUnreadable
  Error unsupported(const std::string& what) const;  // Unsupported
  Status checkExtensions(const Json& node) const;    // Unsupported: compressed data, instances
  // `type`: SCALAR, VEC2, VEC3, VEC4 or MAT4. `what` is for messages.
  Result<GltfNumbers> accessor(std::optional<uint64_t> index, const char* type, const char* what);

 private:
  // Reads `count` elements of a buffer view, at byteOffset of `source`. False if they do not fit.
  Result<bool> elements(const Json& source, uint64_t count, uint64_t components, uint64_t type,
                        GltfNumbers::Elements& out);
  Result<bool> sparse(const Json& node, uint64_t components, GltfNumbers& out);
  explicit GltfBytes(const std::string& path) : path_(path) {}
  Result<std::string_view> buffer(std::optional<uint64_t> index);
  Status load(const std::string& uri, std::string& out);

  std::string path_;
  Json root_;
  std::string_view glb_buffer_;
  std::vector<std::optional<std::string>> buffers_;  // used buffers outside the GLB
  uint64_t size_ = 0;
};

// Pose of a node.
struct GltfPose {
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
  std::optional<glm::dmat4> matrix;            // replaces translation, rotation, scale
  std::optional<std::vector<double>> weights;  // morph target weights; nullopt: the mesh's own
  glm::dmat4 parentFromNode() const;
};

// Poses of all nodes: as stored, then moved by the animation that `instant` selects, by the rules of glTF 2.0 (appendix
// C: step, linear, cubic spline; held before the first and after the last key). Errors: FileUnreadable; Unsupported
// (several animations, a file of one frame whose animation continues); VideoTooShort (the animation ends before the
// instant).
Result<std::vector<GltfPose>> gltfPoses(GltfBytes& bytes, const MeshInstant& instant);

// Vertices of a primitive under morph targets and a skin.
class GltfShape {
 public:
  // `weights`: of the morph targets; missing ones are 0. `skinned`: moved by joints. Errors: FileUnreadable,
  // Unsupported (a skin without joint weights).
  static Result<GltfShape> open(GltfBytes& bytes, const Json& primitive, std::span<const double> weights, bool skinned);
  uint64_t count() const { return positions_.count(); }
  // Position without, and with, morph targets.
  glm::dvec3 rest(uint64_t i) const { return vectorAt(positions_, i); }
  glm::dvec3 morphed(uint64_t i) const;
  // Position of a skinned vertex in world: its joints' transforms blended by weight. False if a joint is missing.
  bool skinned(uint64_t i, std::span<const glm::dmat4> world_from_rest, glm::dvec3& out) const;
  // Returns true if vertex `i` and vertex `j` of `other` coincide at every instant.
  bool isSame(uint64_t i, const GltfShape& other, uint64_t j) const;

 private:
  struct Target {
    GltfNumbers offsets;
    double weight = 0;
  };
  struct Joints {
    GltfNumbers joints, weights;  // four per vertex
  };
  static glm::dvec3 vectorAt(const GltfNumbers& numbers, uint64_t i) {
    return {numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2)};
  }
  GltfNumbers positions_;
  std::vector<Target> targets_;
  std::vector<Joints> joints_;
};

}  // namespace fourdvt::capture
