// SPDX-License-Identifier: Apache-2.0
// Keeps the silhouettes that the hull keeps: what stereo took away although some camera's silhouette needs it is given
// back, at the place along the ray where the least was taken. Does NOT give back what the hull lacks, nor change what
// no ray misses.
#pragma once

#include <span>

#include "reconstruct/carve.h"

namespace fourdvt::reconstruct {

struct OutlineOptions {
  int rounds = 3;             // of looking for rays that miss the surface; 0: nothing is given back
  double tolerance_px = 0.1;  // by which the surface's outline may lie inside the hull's
  double depth_voxels = 1;    // into which a ray enters the surface at least, where it enters the hull as deep
  double reach_voxels = 2.5;  // over which a given distance fades, beside as much as was missing
  double rim_px = 6;          // nearer to the outline every pixel has a ray, beyond only some
  int stride_px = 2;          // between those
};

// Rays of all cameras.
struct OutlineFigures {
  size_t rays = 0;     // that meet the hull
  size_t missing = 0;  // that missed the surface before
  size_t left = 0;     // that miss it still
};

// `hull` has values in all blocks (withValuesInside), `distance` has the same blocks. `views`: those that the hull was
// carved with. Only raises `distance`, never above the hull. The same result whatever the threads.
OutlineFigures keepOutlines(const SparseDistance& hull, std::span<const CarvingView> views,
                            const OutlineOptions& options, SparseDistance& distance);

}  // namespace fourdvt::reconstruct
