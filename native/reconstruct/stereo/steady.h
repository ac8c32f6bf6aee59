// SPDX-License-Identifier: Apache-2.0
// Keeps a surface still where the pictures stand still: there its signed distance is averaged over time. Does NOT touch
// what a camera sees change, so that nothing lags behind.
#pragma once

#include <span>
#include <vector>

#include "base/image.h"
#include "reconstruct/level_set.h"
#include "reconstruct/stereo/plane_sweep.h"

namespace fourdvt::reconstruct {

class SteadyDistance {
 public:
  // `kept`: share of the frame before where nothing changed, 0 … 1.
  explicit SteadyDistance(float kept) : kept_(kept) {}
  // Frames in order of time, of the same cameras and voxel size. `pictures`: RGBA of the sizes of the maps' cameras;
  // `maps`: one per picture, empty ones allowed. `hull` has the blocks of `distance`; where both are
  // the same and the hull moves, nothing is kept: a surface without texture looks the same when it moves. Keeps this
  // one frame.
  void blend(std::span<const Image> pictures, std::span<const DepthMap> maps, const SparseDistance& hull,
             SparseDistance& distance);
  void forget();

 private:
  float kept_;
  std::vector<Image> pictures_;
  SparseDistance before_, hull_;
};

// How much a picture changed at each pixel, height × width: 0 not at all, or no more than a codec's noise; 1 clearly.
std::vector<float> changeOf(const Image& before, const Image& now);

}  // namespace fourdvt::reconstruct
