// SPDX-License-Identifier: Apache-2.0
// Carves space with silhouettes: what is left is where the performer can be. Blocks of voxels from large to small, so
// that empty space costs little. Does NOT make a surface.
#pragma once

#include <span>

#include "base/result.h"
#include "reconstruct/level_set.h"
#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {

// A silhouette and the distances to its outline.
struct CarvingView {
  const silhouette::Silhouette* silhouette = nullptr;
  silhouette::SilhouetteDistance distance;
};

// The smallest distance over the cameras that see a point, metres (pixels times depth over focal length). A point
// counts only where more than half of the cameras see it: beyond, two opposite ones would leave phantoms. Grid cells
// are aligned to multiples of the voxel, the same in every frame. Error NothingVisible: no point is left; the message
// names the camera that disagrees with most others, or says that the cameras see no common volume.
Result<SparseDistance> carve(std::span<const CarvingView> views, double voxel_m);

// A box round the performer, from cells that are halved until it is so many of them long: no length is given, so that a
// rig in other units gives the same cells. World, metres. Errors: those of carve().
struct CoarseBounds {
  glm::dvec3 low{0}, high{0};
  double cell_m = 0;
};
Result<CoarseBounds> coarseBounds(std::span<const CarvingView> views, int cells_along);

}  // namespace fourdvt::reconstruct
