// SPDX-License-Identifier: Apache-2.0
// Which part of its picture each camera shall send: round the performer, with room to move; all of it while nobody is
// seen. Changes only when it is worth a message. Does NOT send anything.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "package/character.h"

namespace fourdvt::live {

class CameraRegions {
 public:
  explicit CameraRegions(std::vector<PinholeCamera> cameras)
      : cameras_(std::move(cameras)), regions_(cameras_.size()) {}
  // boxes: projectedBox of each camera; no width: it does not see the hull. Empty: there is no hull. True where a
  // region was changed.
  std::vector<bool> update(std::span<const package::Rect> boxes, int64_t now_us);
  const package::Rect& region(size_t camera) const { return regions_[camera]; }  // no width: all

 private:
  std::vector<PinholeCamera> cameras_;
  std::vector<package::Rect> regions_;
  int64_t seen_us_ = INT64_MIN;  // last time that there was a hull
};

}  // namespace fourdvt::live
