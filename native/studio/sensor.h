// SPDX-License-Identifier: Apache-2.0
// Turns a rendered picture into what a studio camera records: with backdrop, gain and noise, and with a matte that may
// be too small.
#pragma once

#include "base/image.h"
#include "studio/studio.h"

namespace fourdvt::studio {

class Sensor {
 public:
  Sensor(const StudioKnobs& knobs, int camera, int width, int height);
  // The empty studio, RGB, with this camera's gain and without noise.
  const Image& plate() const { return plate_; }
  // Makes RGB from a premultiplied RGBA picture. `shot` seeds the noise: a number that no other picture of this camera
  // has.
  Image expose(const Image& picture, uint64_t shot) const;
  // Returns one channel.
  Image matte(const Image& picture) const;

 private:
  const StudioKnobs knobs_;
  const int camera_;
  double gain_[3];
  Image backdrop_, plate_;
};

}  // namespace fourdvt::studio
