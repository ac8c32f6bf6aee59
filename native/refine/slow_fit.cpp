// SPDX-License-Identifier: Apache-2.0
#include "refine/slow_fit.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/robust.h"

namespace fourdvt::refine {
namespace {

constexpr uint32_t kLargestGap = 8;  // frames between two that are looked at
constexpr uint32_t kWindow = 3;      // frames before and after that count for one
constexpr double kLeastFall = 0.05;  // share by which the other cameras' misfit must fall
constexpr SurfaceFitOptions kOptions{.bound_m = 0.005, .stiffness = 3, .keep = 4, .keep_at_median = false};

uint32_t distance(uint32_t a, uint32_t b, uint32_t loop_frames) {
  const uint32_t straight = a < b ? b - a : a - b;
  return loop_frames > 0 ? std::min(straight, loop_frames - straight) : straight;
}

// [frame][vertex] offsets from the claims of every `step`-th camera, beginning with the first.
std::vector<std::vector<float>> fitFrom(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                        size_t vertices, uint32_t loop_frames, size_t step) {
  const std::vector<float> none(vertices);
  std::vector<std::vector<float>> out(frames.size());
  inParallel(frames.size(), [&](int f) {
    std::vector<OffsetClaim> claims;
    for (const SlowFrame& near : frames) {
      if (distance(near.index, frames[size_t(f)].index, loop_frames) > kWindow) continue;
      for (size_t c = 0; c < near.claims.size(); c += step)
        claims.insert(claims.end(), near.claims[c].begin(), near.claims[c].end());
    }
    out[size_t(f)] = fitOffsets(claims, edges, none, {}, kOptions);
  });
  return out;
}

}  // namespace

std::optional<capture::SlowOffsets> fitSlowOffsets(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                                   size_t vertices, uint32_t loop_frames) {
  if (frames.size() < 3 || frames[0].claims.size() < 2) return std::nullopt;
  for (size_t i = 1; i < frames.size(); ++i)
    if (frames[i].index - frames[i - 1].index > kLargestGap) return std::nullopt;
  const auto half = fitFrom(frames, edges, vertices, loop_frames, 2);
  std::vector<double> without, with;
  for (size_t f = 0; f < frames.size(); ++f)
    for (size_t c = 1; c < frames[f].claims.size(); c += 2)
      for (const OffsetClaim& claim : frames[f].claims[c]) {
        without.push_back(claim.offset_m);
        with.push_back(claim.offset_m - (1 - claim.to_share) * half[f][claim.from] -
                       claim.to_share * half[f][claim.to]);
      }
  if (!(robustScale(with) < (1 - kLeastFall) * robustScale(without))) return std::nullopt;
  capture::SlowOffsets out;
  for (const SlowFrame& frame : frames) out.frames.push_back(frame.index);
  out.offset_m = fitFrom(frames, edges, vertices, loop_frames, 1);
  out.loop_frames = loop_frames;
  return out;
}

}  // namespace fourdvt::refine
