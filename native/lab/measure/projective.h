// SPDX-License-Identifier: Apache-2.0
// The yardstick: plain projective texturing of the mesh from all camera pictures with a depth test, blended per
// fragment by LVDT Eq. 3-4 (corrected sign, camera-to-point rays). No layers, no texture atlas, no codec, no GPU.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::measure {

struct ProjectiveOptions {
  int samples = 2;  // samples per pixel along each axis
  double depth_tolerance_m = 0.01;  // of a person's surface (base/length_scale.h)
};

// RGBA straight alpha; alpha = covered share of the samples. A covered sample that no camera sees takes the camera that
// faces it best in spite of occlusion. `pictures`: one RGB(A) picture per camera.
Image renderProjective(const PinholeCamera& view, std::span<const PinholeCamera> cameras,
                       std::span<const Image> pictures, const std::vector<glm::uvec3>& face_vertices,
                       const Positions& positions, const ProjectiveOptions& options = {});

}  // namespace fourdvt::measure
