// SPDX-License-Identifier: Apache-2.0
// Fits the plates of the empty studio to one picture whose exposure, white balance or camera position differs a little:
// gain and offset per channel, a homography, and the noise that is left, by brightness and at edges. All are fitted
// robustly to what looks like background; the object may cover up to half of the picture. Does NOT find the object, and
// does NOT follow cameras that turned by more than about 2 % of the picture. Method: algorithms/mattes.md.
#pragma once

#include <array>

#include "base/image.h"
#include "capture/background_model.h"

namespace fourdvt::capture {

struct PlateFit {
  BackgroundModel background;          // the plates as this picture would show them
  std::array<float, 3> gain{1, 1, 1};  // RGB, picture / plates, sRGB-encoded levels above the curve's toe
  float shift_pixels = 0;              // mean displacement of the picture's corners; 0: the plates stay where they are
  float residual_levels = 0;           // median absolute difference that is left
};

// `picture`: 3 channels, the plates' size. A difference that is no clear gain (below half a percent and one level, a
// shift below 0.15 pixels) is left alone, so that plates that fit are returned as they are.
PlateFit fitPlate(const BackgroundModel& plates, const Image& picture);

}  // namespace fourdvt::capture
