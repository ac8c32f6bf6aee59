// SPDX-License-Identifier: Apache-2.0
// Carves space with silhouettes: what is left is where the performer can be. Blocks of voxels from large to small, so
// that empty space costs little. Does NOT make a surface.
#pragma once

#include <functional>
#include <span>

#include "base/camera.h"
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

// The space that the cameras of a rig look at: the bounds within which silhouettes carve. Does NOT look at pictures.

// The point that lies closest to the rays through the middle of all pictures, metres.
glm::dvec3 middleOf(std::span<const PinholeCamera> cameras);
// The largest distance from the middle at which the performer may be; grows with the rig.
double reachOf(std::span<const PinholeCamera> cameras, const glm::dvec3& middle);
// True if at least so many cameras see the sphere or part of it.
bool isSeen(std::span<const PinholeCamera> cameras, size_t least_cameras, const glm::dvec3& centre, double radius);

// Volume that more than half of the cameras see, m³, to within a few percent: all that silhouettes which cover the
// pictures would leave. 0: there is none.
double seenVolume(std::span<const PinholeCamera> cameras);

// The visual hull by voxels: the robust choice. Its surface lies within about a fifth of a voxel of the cones' common
// part, and its edges are rounded. Does NOT need clean outlines.

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
