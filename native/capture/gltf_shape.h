// SPDX-License-Identifier: Apache-2.0
// Vertices of a glTF primitive under morph targets and a skin.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "capture/gltf_bytes.h"

namespace fourdvt::capture {

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
