// SPDX-License-Identifier: Apache-2.0
// Colour calibration per camera: an affine 3×4 map of every camera's picture that makes overlapping views agree
// (algorithms/texels.md). Estimated from surface points that several cameras see frontally, before extraction. Works
// on encoded sRGB values. The mean map over the cameras is the identity, which preserves the rig's overall colours.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// Corrected = matrix * colour + offset; colours 0..1.
struct ColourMap {
  glm::mat3 matrix{1};
  glm::vec3 offset{0};
};

// Applies a map to the colours; alpha is unchanged.
void applyColours(const ColourMap& map, Image& rgba);

class ColourCalibrator {
 public:
  explicit ColourCalibrator(size_t camera_count) : camera_count_(camera_count) {}
  // Adds a frame's observations. fractions: [camera][face], see Visibility. pictures: RGBA, straight alpha.
  void add(std::span<const PinholeCamera> cameras, const MeshTopology& topology, const Positions& positions,
           std::span<const float> fractions, std::span<const Image> pictures);
  // Returns one map per camera, the identity for cameras with too few observations. The fit is robust (outliers such
  // as highlights have less weight) and has a prior towards the identity.
  std::vector<ColourMap> solve() const;
  size_t observationCount() const { return observations_.size(); }

 private:
  struct Observation {  // the same surface point in two cameras
    uint16_t a, b;
    glm::vec3 colour_a, colour_b;
    float weight;
  };
  void keep(const Observation& observation);
  size_t camera_count_;
  uint64_t seen_ = 0;
  std::vector<Observation> observations_;  // bounded by reservoir sampling
};

}  // namespace fourdvt::bake
