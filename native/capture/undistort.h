// SPDX-License-Identifier: Apache-2.0
// Removes lens distortion; the maps are computed once a camera.
#pragma once

#include <memory>

#include "base/image.h"
#include "capture/capture.h"

namespace fourdvt::capture {

class Undistorter {
 public:
  explicit Undistorter(const CaptureCamera& camera);
  ~Undistorter();
  Undistorter(Undistorter&&) noexcept;
  Undistorter& operator=(Undistorter&&) noexcept;
  // Pictures as captured → as the pinhole camera would see them. Outside the capture, colour (3 channels) repeats the
  // border and a matte (1 channel) is 0.
  Image apply(Image picture) const;

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;  // null: nothing to remove
};

}  // namespace fourdvt::capture
