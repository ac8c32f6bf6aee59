// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/semi_global.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr uint16_t kFar = 20000;     // more than any path cost
constexpr int kSameMinimum = 2;      // planes: what lies nearer to the best one is no rival
constexpr float kClearMargin = 254;  // by which a sum over eight directions is better than any rival's: weight 1
constexpr float kLeastWeight = 0.05f;
using Path = std::array<uint16_t, kMaxLabels + 2>;  // label l at l + 1, kFar at both ends

struct PathState {
  Path costs{};
  uint16_t least = 0;
  int first_plane = CostVolume::kNone;
};

// One step along a path: the state of `previous` shifted to this pixel's planes, and this pixel's costs on top.
void advance(const uint8_t* costs, int labels, int first_plane, const PathState& previous, int step_penalty,
             int jump_penalty, PathState& next, uint16_t* sums) {
  next.first_plane = first_plane;
  next.costs[0] = next.costs[labels + 1] = kFar;
  uint16_t least = kFar;
  if (previous.first_plane == CostVolume::kNone) {
    for (int l = 0; l < labels; ++l) next.costs[l + 1] = costs[l];
  } else {
    const int shift = first_plane - previous.first_plane;  // label l here is label l + shift there
    const uint16_t jump = uint16_t(previous.least + jump_penalty);
    Path shifted;
    const Path* from = &previous.costs;
    if (shift != 0) {
      for (int l = 0; l < labels + 2; ++l) {
        const int there = l + shift;
        shifted[l] = there < 1 || there > labels ? kFar : previous.costs[there];
      }
      from = &shifted;
    }
    const uint16_t* p = from->data();
    for (int l = 0; l < labels; ++l) {
      const uint16_t near = uint16_t(std::min(p[l], p[l + 2]) + step_penalty);
      const uint16_t best = std::min(std::min(p[l + 1], near), jump);
      next.costs[l + 1] = uint16_t(costs[l] + best - previous.least);
    }
  }
  for (int l = 0; l < labels; ++l) least = std::min(least, next.costs[l + 1]);
  next.least = least;
  for (int l = 0; l < labels; ++l) sums[l] = uint16_t(sums[l] + next.costs[l + 1]);
}

// Four directions: along the row, and from the three pixels of the row before. `down`: rows from the top, else from
// the bottom (and columns from the right).
void scan(const CostVolume& volume, const SemiGlobalOptions& options, bool down, std::vector<uint16_t>& sums) {
  const int w = volume.width, h = volume.height, labels = volume.labels;
  sums.assign(volume.costs.size(), 0);
  std::vector<PathState> before[3], here[3];
  for (int k = 0; k < 3; ++k) before[k].resize(w + 2), here[k].resize(w + 2);
  for (int row = 0; row < h; ++row) {
    const int y = down ? row : h - 1 - row;
    PathState along[2];
    int now = 0;
    for (int column = 0; column < w; ++column) {
      const int x = down ? column : w - 1 - column;
      const size_t i = size_t(y) * w + x;
      const int first = volume.first_plane[i];
      if (first == CostVolume::kNone) {
        along[now].first_plane = CostVolume::kNone;
        for (int k = 0; k < 3; ++k) here[k][x + 1].first_plane = CostVolume::kNone;
        continue;
      }
      const uint8_t* costs = &volume.costs[i * labels];
      uint16_t* to = &sums[i * labels];
      advance(costs, labels, first, along[now], options.step_penalty, options.jump_penalty, along[1 - now], to);
      now = 1 - now;
      for (int k = 0; k < 3; ++k)
        advance(costs, labels, first, before[k][x + k], options.step_penalty, options.jump_penalty, here[k][x + 1], to);
    }
    for (int k = 0; k < 3; ++k) std::swap(before[k], here[k]);
  }
}

// A pixel's costs, summed over all directions.
struct Sums {
  const uint8_t* costs = nullptr;  // of the pixel alone
  std::vector<int> sums;

  bool candidate(int label) const { return costs[label] != CostVolume::kOutside; }
  // The candidate with the smallest sum of cost and `bias` per plane; -1 if there is none.
  int best(int bias) const {
    int best = -1;
    for (int l = 0; l < int(sums.size()); ++l)
      if (candidate(l) && (best < 0 || sums[l] + l * bias < sums[best] + best * bias)) best = l;
    return best;
  }
  // Where the sums have their minimum beside this label, planes: two lines of equal slope.
  float offset(int label) const {
    if (label == 0 || label + 1 == int(sums.size())) return 0;
    const float before = float(sums[label - 1] - sums[label]), after = float(sums[label + 1] - sums[label]);
    const float steeper = std::max(before, after);
    return steeper > 0 ? std::clamp((before - after) / (2 * steeper), -0.5f, 0.5f) : 0;
  }
  float weight(int label, int bias) const {
    int rival = -1;
    for (int l = 0; l < int(sums.size()); ++l)
      if (std::abs(l - label) > kSameMinimum && candidate(l) &&
          (rival < 0 || sums[l] + l * bias < sums[rival] + rival * bias))
        rival = l;
    const float margin = rival < 0 ? 0 : float(sums[rival] + rival * bias - sums[label] - label * bias) / kClearMargin;
    const float match = 1 - float(costs[label]) / 254;
    return std::clamp(margin, kLeastWeight, 1.0f) * match * match;
  }
};

}  // namespace

DepthMap semiGlobalDepth(const StereoReference& reference, const CostVolume& volume, const SemiGlobalOptions& options) {
  DepthMap out;
  out.camera = reference.camera;
  out.x = volume.x, out.y = volume.y, out.width = volume.width, out.height = volume.height;
  const int labels = volume.labels;
  std::vector<uint16_t> sums[2];
  inParallel(2, [&](int k) { scan(volume, options, k == 0, sums[k]); });
  const size_t pixels = volume.first_plane.size();
  out.depth_m.assign(pixels, 0), out.weight.assign(pixels, 0), out.front_m.assign(pixels, 0);
  Sums pixel;
  pixel.sums.resize(labels);
  for (size_t i = 0; i < pixels; ++i) {
    const int first = volume.first_plane[i];
    if (first == CostVolume::kNone) continue;
    out.front_m[i] = (float(first) + 0.5f) * volume.step_m;
    pixel.costs = &volume.costs[i * labels];
    for (int l = 0; l < labels; ++l) pixel.sums[l] = sums[0][i * labels + l] + sums[1][i * labels + l];
    const int best = pixel.best(options.front_bias);
    if (best < 0) continue;
    out.depth_m[i] = (float(first + best) + pixel.offset(best)) * volume.step_m;
    out.weight[i] = pixel.weight(best, options.front_bias);
  }
  return out;
}

}  // namespace fourdvt::reconstruct
