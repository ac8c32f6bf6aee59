// SPDX-License-Identifier: Apache-2.0
// From costs to depths: semi-global matching (H08 in algorithms/stereo.md) along eight directions, with depths between
// the planes.
#pragma once

#include "reconstruct/stereo/depth_map.h"

namespace fourdvt::reconstruct {

struct SemiGlobalOptions {
  int step_penalty = 12;  // where a neighbour lies one plane away; costs are 0 … 254
  int jump_penalty = 60;  // where it lies further away
  int front_bias = 12;    // per plane, of the sum over eight directions: where nothing is textured, the hull stays
};

// A pixel without any candidate has depth 0. The weight says how much better the best depth is than any other, and how
// well the pictures agree there. An empty volume gives an empty map.
DepthMap semiGlobalDepth(const StereoReference& reference, const CostVolume& volume, const SemiGlobalOptions& options);

}  // namespace fourdvt::reconstruct
