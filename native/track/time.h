// SPDX-License-Identifier: Apache-2.0
// Smoothing of tracked positions in time: noise of single frames goes, motion stays.
#pragma once

#include <span>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::track {

struct TimeOptions {
  double noise_m = 0.002;         // deviation of a fitted position from the true one
  double acceleration_m = 0.001;  // change of a vertex's displacement from frame to frame
  double motion_m = 0.004;        // changes well above this are motion, and are kept
  int rounds = 5;                 // rounds of reweighting
};

// Moves the positions of each vertex towards a course without change of velocity, robustly (Cauchy weights), so that
// the accelerations of a fast limb remain. Frames with trust 0 have no part: they are interpolated. `trust`: [frame];
// `loop`: the first frame follows the last. Requires as many vertices in all frames.
void smoothInTime(std::vector<Positions>& frames, std::span<const double> trust, bool loop, const TimeOptions& options);

}  // namespace fourdvt::track
