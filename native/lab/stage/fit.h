// SPDX-License-Identifier: Apache-2.0
// Pictures and cameras of another size: scaled to fit uncropped, and padded on two sides.
#pragma once

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::stage {

struct Fit {
  int left = 0, top = 0, inner_width = 0, inner_height = 0;  // scaled picture's place in the new one
  int width = 0, height = 0;
};

Fit fitInto(int from_width, int from_height, int width, int height);
PinholeCamera fitted(const PinholeCamera& camera, const Fit& fit);
// Pads with the scaled picture's border pixels.
Image fitted(const Image& picture, const Fit& fit);
// Variant that pads with `beside`, of the new size: a plate, so that both agree there.
Image fitted(const Image& picture, const Fit& fit, const Image& beside);

}  // namespace fourdvt::stage
