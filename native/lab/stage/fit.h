// SPDX-License-Identifier: Apache-2.0
// Pictures and cameras of another size: scaled until the whole picture fits, and widened on two sides. Does NOT crop.
#pragma once

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::stage {

struct Fit {
  int left = 0, top = 0, inner_width = 0, inner_height = 0;  // of the scaled picture, in the new one
  int width = 0, height = 0;
};

Fit fitInto(int from_width, int from_height, int width, int height);
PinholeCamera fitted(const PinholeCamera& camera, const Fit& fit);
// Beyond the scaled picture, what lies at its border goes on.
Image fitted(const Image& picture, const Fit& fit);
// The same, but beyond the scaled picture `beside` is shown, which has the new size: a plate, so that both agree there.
Image fitted(const Image& picture, const Fit& fit, const Image& beside);

}  // namespace fourdvt::stage
