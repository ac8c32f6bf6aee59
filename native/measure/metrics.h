// SPDX-License-Identifier: Apache-2.0
// Picture metrics over a region: PSNR on RGB and SSIM on luma (Wang, Bovik, Sheikh, Simoncelli 2004).
// Does NOT read files, composite for the caller's back or choose the region.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/image.h"

namespace fourdvt::measure {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  // nothing to measure
constexpr double kEqual_db = 100;  // PSNR of equal pictures in a mean, which infinity would spoil

using Mask = std::vector<uint8_t>;  // width × height, non-zero: inside the region

// RGB of a straight-alpha picture over black, in the encoded (sRGB) values: round(rgb · a / 255).
Image compositedOnBlack(const Image& rgba);
// Where the alpha of either picture is at least 128. Both RGBA and of one size.
Mask unionOfSilhouettes(const Image& a, const Image& b);
// Where the alpha of both pictures is at least 128: this leaves the error of the outline out.
Mask commonSilhouette(const Image& a, const Image& b);

// 10 log10(255² / MSE), MSE over all three channels of the pixels inside. Infinity for equal pictures, NaN for an
// empty region.
double psnr(const Image& a, const Image& b, const Mask& inside);

// BT.601 luma of encoded RGB (0.299, 0.587, 0.114), 0..255, as the authors' own code converts colour pictures.
std::vector<double> luma(const Image& rgb);

constexpr int kSsimWindow = 11;  // Gaussian window, σ = 1.5 pixels; K1 = 0.01, K2 = 0.03, range 255

// SSIM index at every pixel whose window lies inside the picture; NaN in the border of 5 pixels.
std::vector<double> ssimMap(const Image& a, const Image& b);
// Mean of the map over the pixels inside; NaN if there is none.
double ssim(const Image& a, const Image& b, const Mask& inside);

}  // namespace fourdvt::measure
