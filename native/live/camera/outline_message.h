// SPDX-License-Identifier: Apache-2.0
// Conversion of a coverage to a camera's message: outline rings within the message limits, the performer's bounding
// box, and the picture within it as JPEG.
#pragma once

#include <vector>

#include "base/image.h"
#include "live/protocol/camera_messages.h"

namespace fourdvt::live {

constexpr int kCropMargin_px = 8;

// Sets coverage outside the region to background; a region of zero width stands for the whole picture.
void keepRegion(const package::Rect& region, Image& coverage);

// Bounding box of the performer plus kCropMargin_px, clipped to the region, on even pixels where the picture permits.
// Zero width: no performer is visible.
package::Rect cropOf(const Image& coverage, const package::Rect& region);

// Outline of the coverage in sixteenths of a pixel. Above kMaxRings, the smallest rings are dropped; above
// kMaxRingPoints, the tolerance grows until the points fit.
std::vector<Ring16> ringsOf(const Image& coverage, double tolerance_px);

// Encodes the crop as 4:2:0 JPEG, lowering the quality until the message fits its limit.
std::vector<uint8_t> jpegOf(const Image& rgb, const package::Rect& crop, int quality);

}  // namespace fourdvt::live
