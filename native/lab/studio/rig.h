// SPDX-License-Identifier: Apache-2.0
// The studio's cameras: a ring, held-out views between them, calibration errors, COLMAP text.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/result.h"
#include "lab/studio/studio.h"

namespace fourdvt::studio {

struct Rig {
  std::vector<PinholeCamera> ring;  // cam00 …, true cameras of the pictures
  std::vector<PinholeCamera> test;  // test00 … test02: between ring cameras, and from other heights
  double near_m = 0.1, far_m = 100;
};

// Places the cameras at the minimum distance at which `bounds` stays inside all pictures, with a margin.
Rig makeRig(const BoundingBox& bounds, int cameras, int width, int height);
// Cameras as found by a calibration with the errors of `knobs`.
std::vector<PinholeCamera> miscalibrated(const std::vector<PinholeCamera>& truth, const StudioKnobs& knobs);
// Cameras of the plates: rotated so that the picture's centre moves by knobs.plate_move_pixels in a direction per
// camera, rolled so that its corners move by a third of that, and moved by 0.2 mm a pixel.
std::vector<PinholeCamera> plateCameras(const std::vector<PinholeCamera>& ring, const StudioKnobs& knobs);
// Creates `folder` and writes cameras.txt and images.txt into it; positions are multiplied by `scale`; `lens`: k1, k2,
// k3 of all cameras. Errors: WriteFailed.
Status writeColmap(const std::string& folder, std::span<const PinholeCamera> cameras, double scale,
                   const std::array<double, 3>& lens = {});

}  // namespace fourdvt::studio
