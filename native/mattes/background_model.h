// SPDX-License-Identifier: Apache-2.0
// Statistical model of the empty studio from its plates, mean and variance per pixel, and its fit to one picture. Reads
// no files.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/image.h"

namespace fourdvt::mattes {

// sRGB encodes linear light x as 1.055 x^(1/2.4) - 0.055 (IEC 61966-2-1). With this offset in levels added, scaling
// linear light (shadow, exposure) scales the encoded values, too.
inline constexpr float kToe = 0.055f * 255;

struct BackgroundModel {
  int width = 0, height = 0;
  int plates = 0;           // number of averaged plates
  std::vector<float> mean;  // [pixel][RGB] levels of 255, sRGB-encoded
  // [pixel] variance per channel in addition to sensor noise, levels²: motion and flicker between several plates, and
  // the effect of a sub-pixel shift at the plates' own edges.
  std::vector<float> extra;
  // [pixel] 0 where no plate shows the background and `mean` is undefined; empty: shown everywhere.
  std::vector<uint8_t> known;
};

// `plates`: at least one, all of one size, 3 channels.
BackgroundModel makeBackgroundModel(std::span<const Image> plates);
// Mean as a picture, RGB.
Image meanPicture(const BackgroundModel& model);

// Returns true for a chroma key backdrop: most of the plate has one saturated colour.
bool isChromaPlate(const Image& plate);

// Plates fitted to one picture whose exposure, white balance or camera position differs a little: gain and offset per
// channel, a homography, and the residual noise by brightness and at edges. All are fitted robustly to pixels that
// resemble the background; the object may cover up to half of the picture. Camera rotations above about 2 % of the
// picture are not fitted. Method: algorithms/mattes.md.
struct PlateFit {
  BackgroundModel background;          // plates as this picture would show them
  std::array<float, 3> gain{1, 1, 1};  // RGB, picture / plates, sRGB-encoded levels above the curve's toe
  float shift_pixels = 0;              // mean displacement of the picture's corners; 0: no shift
  float residual_levels = 0;           // median absolute residual
};

// `picture`: 3 channels, the plates' size. Differences below half a percent and one level, and shifts below 0.15
// pixels, are ignored, so that plates that fit are returned unchanged.
PlateFit fitPlate(const BackgroundModel& plates, const Image& picture);

}  // namespace fourdvt::mattes
