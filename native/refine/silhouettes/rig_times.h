// SPDX-License-Identifier: Apache-2.0
// Time offsets of cameras, in fractional frames, with which simultaneous silhouettes have a common volume. Calibrations
// are fixed.
#pragma once

#include "refine/silhouettes/others_hull.h"

namespace fourdvt::refine {

struct CameraTime {
  double offset_frames = 0;     // picture f + offset_frames shows the instant f
  double deviation_frames = 0;  // standard deviation
  bool known = false;           // enough motion to determine the offset
};

struct TimeOptions {
  int max_frames = 8;  // maximum difference of an offset from the median; 0: fractions only
};

// Fits one offset per camera; their median is 0, since absolute time is not observable. `rig`: calibration and initial
// offsets.
std::vector<CameraTime> fitTimes(const SilhouetteClip& clip, const RigState& rig, const TimeOptions& options);

}  // namespace fourdvt::refine
