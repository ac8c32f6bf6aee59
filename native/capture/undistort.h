// SPDX-License-Identifier: Apache-2.0
// Removes lens distortion. The maps are computed once per camera.
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
  // Turns a captured picture into what the pinhole camera would see. Beyond the captured picture, colour (3 channels)
  // repeats the border and a matte (1 channel) is 0.
  Image apply(Image picture) const;

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;  // null if there is no distortion
};

}  // namespace fourdvt::capture
