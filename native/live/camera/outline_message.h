// SPDX-License-Identifier: Apache-2.0
// From a coverage to what a camera sends: rings within the limits of the messages, the box round the performer, and its
// picture as JPEG. Does NOT key.
#pragma once

#include <vector>

#include "base/image.h"
#include "live/protocol/camera_messages.h"

namespace fourdvt::live {

constexpr int kCropMargin_px = 8;

// Sets what lies outside of the region to background; a region without width is the whole picture.
void keepRegion(const package::Rect& region, Image& coverage);

// The box round the performer and kCropMargin_px more, in the region, from even to even pixels where the picture lets
// it. No width: there is no performer.
package::Rect cropOf(const Image& coverage, const package::Rect& region);

// The coverage's outline on sixteenths of a pixel. More than kMaxRings: the smallest are left out. More than
// kMaxRingPoints: the tolerance grows until they are fewer.
std::vector<Ring16> ringsOf(const Image& coverage, double tolerance_px);

// 4:2:0, of the crop; at a lower quality where the message would be too long otherwise.
std::vector<uint8_t> jpegOf(const Image& rgb, const package::Rect& crop, int quality);

}  // namespace fourdvt::live
