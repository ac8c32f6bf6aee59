// SPDX-License-Identifier: Apache-2.0
// Baseline: plain projective texturing of the mesh from all camera pictures with a depth test, blended per fragment by
// LVDT Eq. 3-4 (Volino and Hilton: Layered View-Dependent Texture Maps, CVMP 2013), with corrected sign and rays from
// the camera to the point. CPU only; no layers, texture atlas or codec.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::measure {

struct ProjectiveOptions {
  int samples = 2;                  // samples per pixel along each axis
  double depth_tolerance_m = 0.01;  // for a person's surface (lengthScale in base/mesh.h)
};

// RGBA straight alpha; alpha = covered share of the samples. A covered sample without a visible camera uses the
// best-facing one, ignoring occlusion. `pictures`: one RGB(A) picture per camera.
Image renderProjective(const PinholeCamera& view, std::span<const PinholeCamera> cameras,
                       std::span<const Image> pictures, const std::vector<glm::uvec3>& face_vertices,
                       const Positions& positions, const ProjectiveOptions& options = {});

}  // namespace fourdvt::measure
