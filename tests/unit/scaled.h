// SPDX-License-Identifier: Apache-2.0
// Scales a scene about the world's origin.
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

// Share of the pixels covered in either picture that differ by more than `levels` in a channel.
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
