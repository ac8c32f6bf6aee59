// SPDX-License-Identifier: Apache-2.0
// Picture metrics over a region chosen by the caller: PSNR on RGB and SSIM on luma (Wang, Bovik, Sheikh, Simoncelli:
// Image Quality Assessment: From Error Visibility to Structural Similarity, IEEE Transactions on Image Processing
// 13(4), 2004).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/image.h"

namespace fourdvt::measure {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  // undefined score
constexpr double kEqual_db = 100;  // PSNR of equal pictures in a mean, in place of infinity

using Mask = std::vector<uint8_t>;  // width × height, non-zero: inside the region

// RGB of a straight-alpha picture over black, in the encoded (sRGB) values: round(rgb · a / 255).
Image compositedOnBlack(const Image& rgba);
// Pixels with alpha of at least 128 in either picture. Both RGBA and of one size.
Mask unionOfSilhouettes(const Image& a, const Image& b);
// Pixels with alpha of at least 128 in both pictures: excludes the error of the outline.
Mask commonSilhouette(const Image& a, const Image& b);

// 10 log10(255² / MSE), MSE over all three channels of the pixels inside. Infinity for equal pictures, NaN for an empty
// region.
double psnr(const Image& a, const Image& b, const Mask& inside);

// BT.601 luma of encoded RGB (0.299, 0.587, 0.114), 0..255, as the authors' own code converts colour pictures.
std::vector<double> luma(const Image& rgb);

constexpr int kSsimWindow = 11;  // Gaussian window, σ = 1.5 pixels; K1 = 0.01, K2 = 0.03, range 255

// SSIM index at each pixel whose window lies inside the picture; NaN in the border of 5 pixels.
std::vector<double> ssimMap(const Image& a, const Image& b);
// Mean of the map over the pixels inside; NaN for an empty region.
double ssim(const Image& a, const Image& b, const Mask& inside);

}  // namespace fourdvt::measure
