// SPDX-License-Identifier: Apache-2.0
// The visual hull by voxels: the robust choice. Its surface lies within about a fifth of a voxel of the cones' common
// part, and its edges are rounded. Does NOT need clean outlines.
#pragma once

#include <functional>
#include <span>

#include "base/result.h"
#include "reconstruct/carve.h"

namespace fourdvt::reconstruct {

struct VolumetricOptions {
  double voxel_m = 0.005;
  double adaptivity = 0.1;  // 0 … 1: fewer faces where the surface is flat; less where faces would cross
};

struct VolumetricHull {
  SparseDistance distance;  // what the surface was taken from
  TriangleMesh mesh;
  size_t dropped = 0;  // components that were left out: specks below 27 voxels and phantoms, see dropNeedless
};

// The surface where the distance is zero: with fewer merged faces, or none, where merged ones would cross. `drop`
// leaves parts of it out first.
TriangleMesh solidSurface(const SparseDistance& distance, double adaptivity,
                          const std::function<void(TriangleMesh&)>& drop);

// The mesh passes checkMesh, except where voxels alone leave it no choice. Errors: those of carve().
Result<VolumetricHull> volumetricHull(std::span<const CarvingView> views, const VolumetricOptions& options);

}  // namespace fourdvt::reconstruct
