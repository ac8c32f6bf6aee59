// SPDX-License-Identifier: Apache-2.0
// Removes lens distortion and skew. The maps are computed once per camera.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "base/image.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// The pixel at which the lens images what the camera's pinhole shows at `pinhole_pixel`.
glm::dvec2 filmedPixel(const CaptureCamera& camera, const glm::dvec2& pinhole_pixel);

// The inverse: the pinhole's pixel that the lens images at `filmed_pixel`. NaN where the lens's formula has none.
glm::dvec2 pinholePixel(const CaptureCamera& camera, const glm::dvec2& filmed_pixel);

// Between a picture's pixels: Fine suits pictures that are kept; Fast is twice as quick and softens a little.
enum class LensFilter { Fine, Fast };

class Undistorter {
 public:
  explicit Undistorter(const CaptureCamera& camera);
  ~Undistorter();
  Undistorter(Undistorter&&) noexcept;
  Undistorter& operator=(Undistorter&&) noexcept;
  // Turns a captured picture into what the pinhole camera would see. Beyond the captured picture, colour (3 channels)
  // repeats the border and a matte (1 channel) is 0.
  Image apply(Image picture, LensFilter filter = LensFilter::Fine) const;

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;  // null if there is no distortion
};

}  // namespace fourdvt::capture
