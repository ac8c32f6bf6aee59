// SPDX-License-Identifier: Apache-2.0
// Turns a rendered picture into what a studio camera records: with backdrop, gain and noise, and with a matte that may
// be too small.
#pragma once

#include <glm/glm.hpp>

#include "base/image.h"
#include "lab/studio/studio.h"

namespace fourdvt::studio {

class Sensor {
 public:
  // In front of the green backdrop.
  Sensor(const StudioKnobs& knobs, int camera, int width, int height);
  // In front of this backdrop, RGB.
  Sensor(const StudioKnobs& knobs, int camera, Image backdrop);
  // The empty studio, RGB, with this camera's gain and without noise.
  const Image& plate() const { return plate_; }
  // RGB gain in a clip's picture beside the plates', which have 1: exposure and white balance that drift smoothly, by
  // at most what the knobs say. `time`: 0…1 from the clip's first picture to its last.
  glm::dvec3 drift(size_t clip, double time) const;
  // Makes RGB from a premultiplied RGBA picture. `shot` seeds the noise: a number that no other picture of this camera
  // has. `backdrop`: what is behind, RGB, in place of the constructor's, e.g. with a shadow on it; null: the
  // constructor's. `drift`: the picture's gain beside the plates'.
  Image expose(const Image& picture, uint64_t shot, const Image* backdrop = nullptr,
               const glm::dvec3& drift = glm::dvec3(1)) const;
  // The empty studio as it is recorded, with noise; `take` counts such recordings of one camera. `backdrop`: as above.
  Image recordedPlate(uint32_t take, const Image* backdrop = nullptr) const;
  // Returns one channel.
  Image matte(const Image& picture) const;

 private:
  const StudioKnobs knobs_;
  const int camera_;
  double gain_[3];
  Image backdrop_, plate_;
};

}  // namespace fourdvt::studio
