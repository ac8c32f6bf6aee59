// SPDX-License-Identifier: Apache-2.0
// Temporal averaging of the signed distance where the pictures are static. Surfaces with visible change follow without
// lag.
#pragma once

#include <span>
#include <vector>

#include "base/image.h"
#include "reconstruct/level_set.h"
#include "reconstruct/stereo/plane_sweep.h"

namespace fourdvt::reconstruct {

class SteadyDistance {
 public:
  // `kept`: weight of the previous frame where nothing changed, 0 … 1.
  explicit SteadyDistance(float kept) : kept_(kept) {}
  // Blends frames in temporal order, of the same cameras and voxel size. `pictures`: RGBA of the sizes of the maps'
  // cameras; `maps`: one per picture, possibly empty. `hull` has the blocks of `distance`. Where both are equal and the
  // hull moves, the previous frame is ignored: motion of untextured surfaces is invisible. Stores this one frame.
  void blend(std::span<const Image> pictures, std::span<const DepthMap> maps, const SparseDistance& hull,
             SparseDistance& distance);
  void forget();

 private:
  float kept_;
  std::vector<Image> pictures_;
  SparseDistance before_, hull_;
};

// Change of a picture per pixel, height × width: 0 up to the level of codec noise, 1 for clear changes.
std::vector<float> changeOf(const Image& before, const Image& now);

}  // namespace fourdvt::reconstruct
