// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "base/camera.h"

namespace fourdvt::testing {

// Camera at `eye` that looks at `target`, Y up (Z up where it looks straight up or down); square pixels, principal
// point in the middle.
inline PinholeCamera lookAt(const glm::dvec3& eye, const glm::dvec3& target, int width, int height, double focal_px) {
  const glm::dvec3 forward = glm::normalize(target - eye);
  const glm::dvec3 up = std::abs(forward.y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, up)), down = glm::cross(forward, right);
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal_px;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  const glm::dmat3 cam_from_world = glm::transpose(glm::dmat3(right, down, forward));
  camera.cam_from_world = glm::dmat4(cam_from_world);
  camera.cam_from_world[3] = glm::dvec4(-(cam_from_world * eye), 1);
  return camera;
}

}  // namespace fourdvt::testing
