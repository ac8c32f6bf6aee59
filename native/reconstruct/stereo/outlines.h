// SPDX-License-Identifier: Apache-2.0
// Restores silhouettes of the hull: where stereo removed surface that a camera's silhouette requires, adds it again at
// the point of the ray with the minimum removal. Raises the distance, at most up to the hull, and only around rays that
// miss the surface.
#pragma once

#include <span>

#include "reconstruct/carve.h"

namespace fourdvt::reconstruct {

struct OutlineOptions {
  int rounds = 3;             // iterations of finding rays that miss the surface; 0: off
  double tolerance_px = 0.1;  // permitted gap between the surface's outline and the hull's
  double depth_voxels = 1;    // minimum depth of a ray in the surface, if it is that deep in the hull
  double reach_voxels = 2.5;  // fall-off radius of an added distance, in addition to the gap
  double rim_px = 6;          // within this distance of the outline every pixel has a ray, beyond every `stride_px`-th
  int stride_px = 2;          // stride of rays beyond `rim_px`
};

// Ray counts over all cameras.
struct OutlineFigures {
  size_t rays = 0;     // rays that meet the hull
  size_t missing = 0;  // rays that missed the surface before
  size_t left = 0;     // rays that still miss the surface
};

// `hull` has values in all blocks (withValuesInside), `distance` has the same blocks. `views`: those that the hull was
// carved with. Only raises `distance`, at most to the hull. Deterministic for any number of threads.
OutlineFigures keepOutlines(const SparseDistance& hull, std::span<const CarvingView> views,
                            const OutlineOptions& options, SparseDistance& distance);

}  // namespace fourdvt::reconstruct
