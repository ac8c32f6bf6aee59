// SPDX-License-Identifier: Apache-2.0
// The studio's cameras: a ring, held-out views between them, calibration errors, COLMAP text.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/result.h"
#include "studio/studio.h"

namespace fourdvt::studio {

struct Rig {
  std::vector<PinholeCamera> ring;  // cam00 …, as the pictures are taken
  std::vector<PinholeCamera> test;  // test00 … test02: between ring cameras, and from other heights
  double near_m = 0.1, far_m = 100;
};

// As close as every point of `bounds` stays inside every picture, with a margin.
Rig makeRig(const BoundingBox& bounds, int cameras, int width, int height);
// What a calibration with these errors would have found.
std::vector<PinholeCamera> miscalibrated(const std::vector<PinholeCamera>& truth, const StudioKnobs& knobs);
// cameras.txt and images.txt in `folder`, which is made. Errors: WriteFailed.
Status writeColmap(const std::string& folder, std::span<const PinholeCamera> cameras);

}  // namespace fourdvt::studio
