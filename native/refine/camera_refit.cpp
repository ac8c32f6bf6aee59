// SPDX-License-Identifier: Apache-2.0
#include "refine/camera_refit.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"

namespace fourdvt::refine {
namespace {

// Added to standard deviations for what leaving out blocks cannot tell (the surface's errors all round).
constexpr double kUnknownPixels = 0.1;
constexpr double kMorePoints = 1.2;  // or so many times the points come within reach
constexpr Freedom kTurn{}, kAll{.place = true};
constexpr int kSteps = 10, kWideSteps = 4;
constexpr double kWideRad = 0.026;       // the first steps search the matte's edge up to 1.5° away
constexpr double kSettledPixels = 0.02;  // a smaller step ends the fit

class Fit {
 public:
  Fit(const PinholeCamera& given, const MeasurePoints& measure, SurfaceKind surface, double deviations)
      : given_(given), measure_(measure), surface_(surface), deviations_(deviations) {}

  // The camera that fits best from `from` on; `from` itself where nothing can be said.
  PinholeCamera fitted(const PinholeCamera& from, Freedom freedom, CameraStep& last) const {
    PinholeCamera best = from;
    const float near = OutlineOptions().reach_pixels, wide = std::max(near, static_cast<float>(kWideRad * from.fx));
    for (int step = 0; step < kSteps; ++step) {
      const auto points = measure_(best, step < kWideSteps && !freedom.place ? wide : near);
      last = fitCamera(best, given_, points, freedom, surface_);
      if (!last.solvable) return from;
      const PinholeCamera next = refine::changed(best, last.change);
      const double shift = shiftPixels(best, next, points);
      best = next;
      if (shift < kSettledPixels) break;
    }
    return best;
  }

  // `out` gets the spreads.
  bool clearlyBetter(const PinholeCamera& from, const PinholeCamera& to, double deviation_pixels,
                     CameraRefit& out) const {
    const float reach = OutlineOptions().reach_pixels;
    const auto before = measure_(from, reach), after = measure_(to, reach);
    const double shift = shiftPixels(to, from, after);
    if (!(shift >= deviations_ * std::hypot(deviation_pixels, kUnknownPixels))) return false;
    std::vector<double> spread[2];
    for (const BlockedPoint& s : before) spread[0].push_back(s.point.residual_pixels);
    for (const BlockedPoint& s : after) spread[1].push_back(s.point.residual_pixels);
    out.spread_before_pixels = robustScale(spread[0]), out.spread_after_pixels = robustScale(spread[1]);
    // Far off, few edges are within reach at all.
    return out.spread_after_pixels < out.spread_before_pixels || after.size() > kMorePoints * double(before.size());
  }

  void tell(const PinholeCamera& best, const CameraStep& step, CameraRefit& out) const {
    const auto points = measure_(best, OutlineOptions().reach_pixels);
    out.best = CameraShift{shiftPixels(best, given_, points), step.shift_deviation_pixels};
    out.turn_deviation_deg = step.turn_deviation_rad * kDegrees;
  }

 private:
  const PinholeCamera& given_;
  const MeasurePoints& measure_;
  SurfaceKind surface_;
  double deviations_;
};

}  // namespace

CameraRefit refitCamera(const PinholeCamera& current, const PinholeCamera& given, const MeasurePoints& measure,
                        bool with_place, SurfaceKind surface, double deviations) {
  CameraRefit out{.camera = current};
  const Fit fit(given, measure, surface, deviations);
  CameraStep step;
  const PinholeCamera turned = fit.fitted(current, kTurn, step);
  if (!step.solvable) return out;
  fit.tell(turned, step, out);
  out.changed = fit.clearlyBetter(current, turned, step.shift_deviation_pixels, out);
  if (out.changed) out.camera = turned;
  if (!with_place) return out;
  const PinholeCamera moved = fit.fitted(turned, kAll, step);
  if (!step.solvable || !fit.clearlyBetter(out.camera, moved, step.shift_deviation_pixels, out)) return out;
  out.changed = true;
  out.camera = moved;
  fit.tell(moved, step, out);
  return out;
}

}  // namespace fourdvt::refine
