// SPDX-License-Identifier: Apache-2.0
// Removes lens distortion and skew. The maps are computed once per camera.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "base/image.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// Distorts: maps a pixel of the camera's pinhole to the pixel of the filmed picture.
glm::dvec2 filmedPixel(const CaptureCamera& camera, const glm::dvec2& pinhole_pixel);

// Undistorts: maps a pixel of the filmed picture to the pinhole's. NaN where the lens formula has no inverse.
glm::dvec2 pinholePixel(const CaptureCamera& camera, const glm::dvec2& filmed_pixel);

// Interpolation between pixels: Fine for pictures that are kept; Fast is twice as quick and slightly softer.
enum class LensFilter { Fine, Fast };

class Undistorter {
 public:
  explicit Undistorter(const CaptureCamera& camera);
  ~Undistorter();
  Undistorter(Undistorter&&) noexcept;
  Undistorter& operator=(Undistorter&&) noexcept;
  // Resamples a captured picture to the pinhole camera. Beyond the captured picture, colour (3 channels) repeats the
  // border and a matte (1 channel) is 0.
  Image apply(Image picture, LensFilter filter = LensFilter::Fine) const;

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;  // null without distortion
};

}  // namespace fourdvt::capture
