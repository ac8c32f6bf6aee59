// SPDX-License-Identifier: Apache-2.0
// Vertices of a glTF primitive as morph targets and a skin move them.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "capture/gltf_bytes.h"

namespace fourdvt::capture {

class GltfShape {
 public:
  // `weights` of the morph targets; those that are not given are 0. `skinned`: moved by joints. Errors: FileUnreadable,
  // Unsupported (a skin, but no weights of its joints).
  static Result<GltfShape> open(GltfBytes& bytes, const Json& primitive, std::span<const double> weights, bool skinned);
  uint64_t count() const { return positions_.count(); }
  // A vertex without morphs, and with them.
  glm::dvec3 rest(uint64_t i) const { return vectorAt(positions_, i); }
  glm::dvec3 morphed(uint64_t i) const;
  // A skinned vertex in world: the mean of its joints' transforms, by weight. False if it names a joint that is
  // missing.
  bool skinned(uint64_t i, std::span<const glm::dmat4> world_from_rest, glm::dvec3& out) const;
  // True if vertex `i` and vertex `j` of `other` are one at every instant.
  bool isSame(uint64_t i, const GltfShape& other, uint64_t j) const;

 private:
  struct Target {
    GltfNumbers offsets;
    double weight = 0;
  };
  struct Joints {
    GltfNumbers joints, weights;  // four a vertex
  };
  static glm::dvec3 vectorAt(const GltfNumbers& numbers, uint64_t i) {
    return {numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2)};
  }
  GltfNumbers positions_;
  std::vector<Target> targets_;
  std::vector<Joints> joints_;
};

}  // namespace fourdvt::capture
