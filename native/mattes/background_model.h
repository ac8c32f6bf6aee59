// SPDX-License-Identifier: Apache-2.0
// The empty studio as its plates show it: the mean of every pixel, and how far a picture may stray from it; and its fit
// to one picture. Does NOT read files.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/image.h"

namespace fourdvt::mattes {

// sRGB encodes linear light x as 1.055 x^(1/2.4) - 0.055 (IEC 61966-2-1): with this many levels more, a shadow or an
// exposure, which scales linear light, scales the encoded values, too.
inline constexpr float kToe = 0.055f * 255;

struct BackgroundModel {
  int width = 0, height = 0;
  int plates = 0;           // how many were averaged
  std::vector<float> mean;  // [pixel][RGB] levels of 255, sRGB-encoded
  // [pixel] variance per channel, in levels², that comes on top of sensor noise: from several plates, what moves and
  // flickers; and at the plates' own edges, what a shift of a fraction of a pixel changes.
  std::vector<float> extra;
  // [pixel] 0 where no plate shows the background, so that `mean` says nothing; empty: it is shown everywhere.
  std::vector<uint8_t> known;
};

// `plates`: at least one, all of one size, 3 channels.
BackgroundModel makeBackgroundModel(std::span<const Image> plates);
// The mean as a picture, RGB.
Image meanPicture(const BackgroundModel& model);

// Whether a plate is a chroma key backdrop: most of it has one saturated colour.
bool isChromaPlate(const Image& plate);

// Plates fitted to one picture whose exposure, white balance or camera position differs a little: gain and offset per
// channel, a homography, and the noise that is left, by brightness and at edges. All are fitted robustly to what looks
// like background; the object may cover up to half of the picture. Cameras that turned by more than about 2 % of the
// picture are not followed. Method: algorithms/mattes.md.
struct PlateFit {
  BackgroundModel background;          // the plates as this picture would show them
  std::array<float, 3> gain{1, 1, 1};  // RGB, picture / plates, sRGB-encoded levels above the curve's toe
  float shift_pixels = 0;              // mean displacement of the picture's corners; 0: the plates stay where they are
  float residual_levels = 0;           // median absolute difference that is left
};

// `picture`: 3 channels, the plates' size. A difference that is no clear gain (below half a percent and one level, a
// shift below 0.15 pixels) is left alone, so that plates that fit are returned as they are.
PlateFit fitPlate(const BackgroundModel& plates, const Image& picture);

}  // namespace fourdvt::mattes
