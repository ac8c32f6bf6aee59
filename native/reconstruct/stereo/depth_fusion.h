// SPDX-License-Identifier: Apache-2.0
// Depth maps and a hull to one signed distance. Does NOT leave the hull, and leaves it alone where no map knows better.
#pragma once

#include <span>

#include "reconstruct/level_set.h"
#include "reconstruct/stereo/depth_map.h"

namespace fourdvt::reconstruct {

struct FusionOptions {
  double truncation_m = 0.03;   // what lies deeper behind a map's surface is unknown to it
  double hull_stays_m = 0.003;  // the hull stays where the maps go no deeper than this; from thrice as much on they win
  double least_weight = 0.25;   // of all maps together; below, the hull stays
};

// On the hull's grid.
struct FusedDistance {
  SparseDistance distance;         // with values in all blocks of the hull
  std::vector<BlockValues> trust;  // by block: weight of the maps; 0: they know nothing and the hull stays
};

FusedDistance fuseDepths(const SparseDistance& hull, std::span<const DepthMap> maps, const FusionOptions& options);

}  // namespace fourdvt::reconstruct
