// SPDX-License-Identifier: Apache-2.0
// Camera model of the studio: adds backdrop, gain and noise to a rendered picture, and derives a matte that may be
// eroded.
#pragma once

#include <glm/glm.hpp>

#include "base/image.h"
#include "lab/studio/studio.h"

namespace fourdvt::studio {

class Sensor {
 public:
  // Uses the green backdrop.
  Sensor(const StudioKnobs& knobs, int camera, int width, int height);
  // Uses this backdrop, RGB.
  Sensor(const StudioKnobs& knobs, int camera, Image backdrop);
  // Picture of the empty studio, RGB, with this camera's gain and without noise.
  const Image& plate() const { return plate_; }
  // RGB gain of a clip's picture relative to the plates, which have 1: smooth drift of exposure and white balance,
  // bounded by the knobs. `time`: 0…1 from the clip's first picture to its last.
  glm::dvec3 drift(size_t clip, double time) const;
  // Converts premultiplied RGBA to a recorded RGB picture. `shot` seeds the noise and is unique per picture of this
  // camera. `backdrop`: RGB, replaces the constructor's, e.g. with a shadow on it; null: the constructor's. `drift`:
  // the picture's gain relative to the plates.
  Image expose(const Image& picture, uint64_t shot, const Image* backdrop = nullptr,
               const glm::dvec3& drift = glm::dvec3(1)) const;
  // Recorded picture of the empty studio, with noise; `take` counts such recordings of one camera. `backdrop`: as
  // above.
  Image recordedPlate(uint32_t take, const Image* backdrop = nullptr) const;
  // Matte as one channel.
  Image matte(const Image& picture) const;

 private:
  const StudioKnobs knobs_;
  const int camera_;
  double gain_[3];
  Image backdrop_, plate_;
};

}  // namespace fourdvt::studio
