// SPDX-License-Identifier: Apache-2.0
// A picture against the truth it stands for when it may lie elsewhere as a whole. Errors of calibration displace what
// is drawn for a camera that was left out; errors of the surface do not, since cameras on both sides of it are
// displaced to opposite sides.
#pragma once

#include <glm/glm.hpp>

#include "base/image.h"
#include "measure/metrics.h"

namespace fourdvt::bake {

struct RegisteredScore {
  glm::dvec2 shift_px{0};        // of the picture against the truth, in steps of a quarter pixel, at most kMostShift_px
  double psnr_db = 0, ssim = 0;  // inside, once it is moved back
};
constexpr int kMostShift_px = 8;

// RGB of one size; `inside` is not empty.
RegisteredScore registeredScore(const Image& truth, const Image& picture, const measure::Mask& inside);

}  // namespace fourdvt::bake
