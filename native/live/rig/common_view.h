// SPDX-License-Identifier: Apache-2.0
// The box of space that all cameras of a rig see, for a rig that names none. Does NOT look at pictures.
#pragma once

#include <optional>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::live {

// World, metres: above the ground but for a hundredth of its height, with every camera outside. Accurate to about a
// fiftieth of the cameras' distance. None where no space is seen by all.
std::optional<BoundingBox> commonView(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m);

}  // namespace fourdvt::live
