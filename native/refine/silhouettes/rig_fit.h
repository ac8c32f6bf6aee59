// SPDX-License-Identifier: Apache-2.0
// Calibrates a rig from silhouettes alone: refits pose and focal length of a camera where the hull of the others
// supports it significantly, with fixed times; and fits times with fixed calibrations (rig_times.cpp).
#pragma once

#include <functional>

#include "refine/camera_fit.h"
#include "refine/silhouettes/others_hull.h"

namespace fourdvt::refine {

// Silhouettes of one sequence with its cameras' time offsets.
struct TimedClip {
  const SilhouetteClip* clip = nullptr;
  std::vector<double> offset_frames;
};

// Refits the cameras `given`, which all clips share, and returns [camera]. Changes one camera at a time, the one whose
// residuals shrink most, until no change is significant. `ignored`: cameras that are neither changed nor compared; may
// be empty. `go_on` returns false to stop early.
std::vector<CameraRefit> fitRig(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& given,
                                const std::vector<char>& ignored, const std::function<bool()>& go_on);

// Rigs that differ by a shift of the performer's position fit equally well. Returns the one with the minimum sum of
// rotation angles; cameras within `near_deg` [camera] of their given pose are returned as given. `middle_in_world`:
// performer's centre.
std::vector<PinholeCamera> minTurned(const std::vector<PinholeCamera>& given, const std::vector<PinholeCamera>& found,
                                     const glm::dvec3& middle_in_world, const std::vector<double>& near_deg);

// Outline errors [camera] over all clips.
std::vector<StickOut> stickOut(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& cameras,
                               const std::vector<char>& ignored);

// Time offset of a camera with which simultaneous silhouettes have a common volume.
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
