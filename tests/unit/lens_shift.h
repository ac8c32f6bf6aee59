// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/camera.h"

namespace fourdvt::testing {

// Camera turned about its own vertical by this angle, with a lens shift that keeps the former optical axis in the
// middle of the picture. Beyond half the field of view the principal point lies outside the picture.
inline PinholeCamera withShiftedLens(PinholeCamera camera, double angle_rad) {
  camera.cam_from_world = glm::rotate(glm::dmat4(1), angle_rad, glm::dvec3(0, 1, 0)) * camera.cam_from_world;
  camera.cx = camera.width / 2.0 - camera.fx * std::tan(angle_rad);
  return camera;
}

}  // namespace fourdvt::testing
