// SPDX-License-Identifier: Apache-2.0
// What one camera says about where the performer can be.
#pragma once

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::reconstruct {

// The picture elements in which a camera sees the performer. What lies outside the picture is unknown, not empty.
struct Silhouette {
  PinholeCamera camera;
  Image coverage;  // 1 channel, the camera's size: 0 background, 255 performer, the outline at 127.5 between centres
};

}  // namespace fourdvt::reconstruct
