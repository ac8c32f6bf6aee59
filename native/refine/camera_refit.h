// SPDX-License-Identifier: Apache-2.0
// Fits a camera step by step to points that are measured anew after every step, and keeps the change only if it
// explains more than chance could. Does NOT measure: the outlines of a mesh or of a visual hull come from its caller.
#pragma once

#include <functional>
#include <optional>

#include "refine/camera_fit.h"

namespace fourdvt::refine {

constexpr double kClearDeviations = 3;  // standard deviations that chance does not explain

// Measures the outline against a camera's mattes as if it were `as`; edges are searched up to `reach_pixels` away.
using MeasurePoints = std::function<std::vector<BlockedPoint>(const PinholeCamera& as, float reach_pixels)>;

// How far a camera would move, as the root mean square of the outline's shift in the picture, and how sure that is.
struct CameraShift {
  double pixels = 0, deviation_pixels = 0;
};

struct CameraRefit {
  PinholeCamera camera;              // the refined one, or the current one
  bool changed = false;              // clearly better than the current one
  std::optional<CameraShift> best;   // against the given camera; none: the outline says too little
  glm::dvec3 turn_deviation_deg{0};  // with `best`
  double spread_before_pixels = 0, spread_after_pixels = 0;  // robust scale of the residuals
};

// Turns first, then, `with_place`, moves and zooms, too. `given`: before any refinement. `deviations`: how many of them
// a change must exceed.
CameraRefit refitCamera(const PinholeCamera& current, const PinholeCamera& given, const MeasurePoints& measure,
                        bool with_place, SurfaceKind surface, double deviations = kClearDeviations);

}  // namespace fourdvt::refine
