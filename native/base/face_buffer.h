// SPDX-License-Identifier: Apache-2.0
// CPU depth test of a mesh in a camera's picture, without shading; native only.
#pragma once

#include <cstdint>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"

namespace fourdvt {

// Nearest face and its depth at each sample of a camera's picture.
struct FaceBuffer {
  static constexpr uint32_t kNoFace = 0xffffffff;
  int width = 0, height = 0;   // samples
  std::vector<float> depth_m;  // along the optical axis; infinity for background
  std::vector<uint32_t> face;  // kNoFace for background
};

// Rasterises faces of either orientation at each sample centre, `scale` samples per pixel along each axis. Skips faces
// with a corner behind the camera.
FaceBuffer rasterise(const PinholeCamera& camera, const std::vector<glm::uvec3>& face_vertices,
                     const Positions& positions, int scale);

// Mask of the samples at which rasterise() finds a face: 1, else 0.
std::vector<uint8_t> coveredSamples(const PinholeCamera& camera, const std::vector<glm::uvec3>& face_vertices,
                                    const Positions& positions, int scale);

// Face projected to the picture plane.
struct ProjectedFace {
  glm::dvec2 at[3];         // corners, samples
  double inverse_depth[3];  // 1/m
  // Barycentric weights of a sample, linear in the picture plane. Returns false outside the face or for a face without
  // area.
  bool barycentric(const glm::dvec2& sample, double weights[3]) const;
};

// Returns false if a corner lies behind the camera.
bool projectFace(const PinholeCamera& camera, const glm::uvec3& face, const Positions& positions, int scale,
                 ProjectedFace& out);

}  // namespace fourdvt
