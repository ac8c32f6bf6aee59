// SPDX-License-Identifier: Apache-2.0
#include "live/server/camera_regions.h"

#include "live/server/tiles.h"

namespace fourdvt::live {
namespace {

using package::Rect;

constexpr double kRoomShare = 0.25, kLeastRoomShare = 0.15;  // of the performer's longer side, on each side
constexpr int kRoomPixels = 16, kLeastRoomPixels = 8;
constexpr double kTooLarge = 1.6;  // times the pixels of the region that would do
constexpr int64_t kUnseen_us = 1'000'000;

double areaOf(const Rect& r) { return double(r.width) * r.height; }

}  // namespace

std::vector<bool> CameraRegions::update(std::span<const Rect> boxes, int64_t now_us) {
  std::vector<bool> changed(cameras_.size(), false);
  if (boxes.empty()) {
    if (seen_us_ != INT64_MIN && now_us - seen_us_ < kUnseen_us) return changed;
    for (size_t c = 0; c < cameras_.size(); ++c) changed[c] = regions_[c].width != 0, regions_[c] = {};
    return changed;
  }
  seen_us_ = now_us;
  for (size_t c = 0; c < cameras_.size(); ++c) {
    if (boxes[c].width == 0) continue;  // not seen by this camera: as it was
    const Rect all{0, 0, cameras_[c].width, cameras_[c].height};
    const Rect wanted = padded(boxes[c], kRoomShare, kRoomPixels, all);
    const Rect least = padded(boxes[c], kLeastRoomShare, kLeastRoomPixels, all);
    const Rect& now = regions_[c].width == 0 ? all : regions_[c];
    if (areaOf(common(least, now)) == areaOf(least) && areaOf(now) <= kTooLarge * areaOf(wanted)) continue;
    regions_[c] = wanted;
    changed[c] = true;
  }
  return changed;
}

}  // namespace fourdvt::live
