// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/robust.h"
#include "refine/silhouettes/rig_fit.h"

namespace fourdvt::refine {
namespace {

constexpr size_t kCoarseFrames = 12, kCoarsePoints = 40;
constexpr size_t kFineFrames = 24, kFinePoints = 80;
constexpr double kFramesCost = 0.002;  // pixels per frame: prefers the smaller of two offsets with equal fit
constexpr int kCoarseRounds = 6, kFineRounds = 10;
constexpr double kSettledFrames = 0.01, kLargestStep = 1, kDamping = 0.7;
constexpr float kReachPixels = 12;
constexpr double kMaxDeviation = 0.2;  // frames; above, an offset counts as unknown
constexpr size_t kToleratedFrom =
    7;  // cameras; from this number on, one other camera may be inconsistent in a comparison

// Whole number of frames near `middle` with which a camera fits the others best.
double bestWhole(const SilhouetteClip& clip, const RigState& rig, size_t camera, double middle,
                 const TimeOptions& options, size_t tolerated) {
  const int count = 2 * options.max_frames + 1;
  std::vector<double> costs(count, 1e9);
  inParallel(count, [&](int i) {
    RigState tried = rig;
    tried.offset_frames[camera] = middle + i - options.max_frames;
    const StickOut cost = stickOut(clip, tried, camera, kCoarseFrames, kCoarsePoints, tolerated);
    if (cost.points > 0) costs[i] = cost.mean_pixels + kFramesCost * std::abs(i - options.max_frames);
  });
  const auto least = std::min_element(costs.begin(), costs.end());
  return *least < 1e9 ? middle + double(least - costs.begin()) - options.max_frames : rig.offset_frames[camera];
}

// Optimises whole frames, camera by camera, until none changes.
void fitWhole(const SilhouetteClip& clip, RigState& rig, const TimeOptions& options, size_t tolerated) {
  for (int round = 0; round < kCoarseRounds; ++round) {
    bool changed = false;
    for (size_t c = 0; c < rig.cameras.size(); ++c) {
      const double middle = std::round(quantile(rig.offset_frames, 0.5));
      const double best = bestWhole(clip, rig, c, middle, options, tolerated);
      changed |= std::abs(best - rig.offset_frames[c]) > 0.5;
      rig.offset_frames[c] = best;
    }
    if (!changed) break;
  }
}

// One step of every camera's offset; returns the largest.
double stepTimes(const SilhouetteClip& clip, const std::vector<size_t>& frames, RigState& rig,
                 std::vector<CameraTime>& out) {
  const size_t cameras = rig.cameras.size();
  std::vector<CameraStep> steps(cameras);
  inParallel(cameras, [&](int c) {
    const auto points = hullPoints(clip, rig, c, frames, kFinePoints, 0, kReachPixels);
    steps[c] = fitCamera(rig.cameras[c], rig.cameras[c], points, {.turn = false, .time = true}, SurfaceKind::Hull);
  });
  double largest = 0;
  for (size_t c = 0; c < cameras; ++c) {
    out[c].known = steps[c].solvable && steps[c].frames_deviation < kMaxDeviation;
    out[c].deviation_frames = steps[c].frames_deviation;
    if (!out[c].known) continue;
    const double step = std::clamp(kDamping * steps[c].change.frames, -kLargestStep, kLargestStep);
    rig.offset_frames[c] += step;
    largest = std::max(largest, std::abs(step));
  }
  return largest;
}

}  // namespace

std::vector<CameraTime> fitTimes(const SilhouetteClip& clip, const RigState& given, const TimeOptions& options) {
  RigState rig = given;
  const size_t cameras = rig.cameras.size();
  std::vector<CameraTime> out(cameras);
  if (options.max_frames > 0) fitWhole(clip, rig, options, cameras >= kToleratedFrom ? 1 : 0);
  const std::vector<size_t> frames = clip.spreadFrames(kFineFrames);
  for (int round = 0; round < kFineRounds; ++round)
    if (stepTimes(clip, frames, rig, out) < kSettledFrames) break;
  const double middle = quantile(rig.offset_frames, 0.5);
  for (size_t c = 0; c < cameras; ++c) out[c].offset_frames = rig.offset_frames[c] - middle;
  return out;
}

}  // namespace fourdvt::refine
