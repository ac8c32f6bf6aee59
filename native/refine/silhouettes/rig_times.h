// SPDX-License-Identifier: Apache-2.0
// Offsets of cameras in time, in fractions of frames: the ones with which silhouettes of one instant have a common
// volume. Does NOT change calibrations.
#pragma once

#include "refine/silhouettes/others_hull.h"

namespace fourdvt::refine {

struct CameraTime {
  double offset_frames = 0;     // picture number f + offset_frames shows the instant f
  double deviation_frames = 0;  // standard deviation
  bool known = false;           // something moves clearly enough
};

struct TimeOptions {
  int most_frames = 8;  // offsets beyond this, of one camera to the median of all, are not searched; 0: only fractions
};

// One offset per camera; their median is 0, for nothing says which camera is on time. `rig`: calibration, and the
// offsets to start from.
std::vector<CameraTime> fitTimes(const SilhouetteClip& clip, const RigState& rig, const TimeOptions& options);

}  // namespace fourdvt::refine
