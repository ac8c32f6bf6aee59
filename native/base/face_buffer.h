// SPDX-License-Identifier: Apache-2.0
// Depth test of a mesh in a camera's picture, on the CPU. Does not shade; native only.
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
  std::vector<float> depth_m;  // along the optical axis; infinity where nothing is
  std::vector<uint32_t> face;  // kNoFace where nothing is
};

// Draws faces of either orientation at each sample centre, `scale` samples per pixel along each axis. A face with a
// corner behind the camera is left out.
FaceBuffer rasterise(const PinholeCamera& camera, const std::vector<glm::uvec3>& face_vertices,
                     const Positions& positions, int scale);

// A face in the picture plane.
struct ProjectedFace {
  glm::dvec2 at[3];         // corners, samples
  double inverse_depth[3];  // 1/m
  // Weights of the corners, linear in the picture plane. False outside of the face, or if it has no area.
  bool barycentric(const glm::dvec2& sample, double weights[3]) const;
};

// False if a corner lies behind the camera.
bool projectFace(const PinholeCamera& camera, const glm::uvec3& face, const Positions& positions, int scale,
                 ProjectedFace& out);

}  // namespace fourdvt
