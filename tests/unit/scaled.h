// SPDX-License-Identifier: Apache-2.0
// The same scene at another size: everything is moved away from, or towards, the world's origin.
#pragma once

#include <cstdlib>

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::testing {

inline PinholeCamera scaled(PinholeCamera camera, double by) {
  camera.cam_from_world[3] = glm::dvec4(by * glm::dvec3(camera.cam_from_world[3]), 1);
  return camera;
}

inline Positions scaled(Positions positions, double by) {
  for (glm::vec3& p : positions) p *= float(by);
  return positions;
}

// The share of the pixels that are drawn in either picture in which a channel differs by more than `levels`.
inline double shareThatDiffers(const Image& a, const Image& b, int levels) {
  int drawn = 0, different = 0;
  for (size_t i = 0; i < a.pixels.size(); i += 4) {
    if (a.pixels[i + 3] == 0 && b.pixels[i + 3] == 0) continue;
    ++drawn;
    bool differs = false;
    for (size_t k = i; k < i + 4; ++k) differs |= std::abs(int(a.pixels[k]) - int(b.pixels[k])) > levels;
    different += differs;
  }
  return drawn ? double(different) / drawn : 1;
}

}  // namespace fourdvt::testing
