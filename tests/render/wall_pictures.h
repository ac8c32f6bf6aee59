// SPDX-License-Identifier: Apache-2.0
// Pictures of a wall with an analytic pattern.
#pragma once

#include <cmath>

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::testing {

// Waves in several directions, wavelengths of 6 cm or more, about mid-grey.
inline glm::dvec3 patternAt(double x, double y) {
  const double a = std::sin(95 * x + 20 * y), b = std::sin(-40 * x + 80 * y + 1), c = std::sin(60 * x - 55 * y + 2);
  return glm::dvec3(128) + glm::dvec3(45 * a + 45 * b, 45 * b + 45 * c, 45 * c - 45 * a);
}

// Picture of the wall z = depth_m from a camera.
inline Image wall(const PinholeCamera& camera, double depth_m) {
  Image image(camera.width, camera.height, 4, 255);
  const glm::dvec3 centre = camera.centreInWorld();
  const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 ray =
          world_from_cam * glm::dvec3((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
      const glm::dvec3 at = centre + (depth_m - centre.z) / ray.z * ray, color = patternAt(at.x, at.y);
      for (int k = 0; k < 3; ++k) image.at(x, y)[k] = static_cast<uint8_t>(std::lround(color[k]));
    }
  return image;
}

}  // namespace fourdvt::testing
