// SPDX-License-Identifier: Apache-2.0
// Cameras back in place from silhouettes alone: a camera turns, moves and zooms where the hull of all others asks for
// it clearly. Does NOT touch times: rig_times.h does.
#pragma once

#include <functional>

#include "refine/camera_fit.h"
#include "refine/silhouettes/others_hull.h"

namespace fourdvt::refine {

// Silhouettes of one sequence, and its cameras' offsets in time.
struct TimedClip {
  const SilhouetteClip* clip = nullptr;
  std::vector<double> offset_frames;
};

// [camera]. All clips have the cameras `given`. One camera at a time changes, the one whose residuals shrink most,
// until none is clearly off. `ignored`: cameras that neither change nor count; may be empty. `go_on` returns false to
// stop early.
std::vector<CameraRefit> fitRig(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& given,
                                const std::vector<char>& ignored, const std::function<bool()>& go_on);

// Cameras that turn to a performer who stands elsewhere fit as well as those that turn to where the performer is: of
// all such rigs the one that turns fewest cameras (least sum of angles), and leaves those as given that are within
// `near_deg` [camera] of it. `middle_in_world`: of the performer.
std::vector<PinholeCamera> leastTurned(const std::vector<PinholeCamera>& given, const std::vector<PinholeCamera>& found,
                                       const glm::dvec3& middle_in_world, const std::vector<double>& near_deg);

// [camera] over all clips.
std::vector<StickOut> stickOut(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& cameras,
                               const std::vector<char>& ignored);

}  // namespace fourdvt::refine
