// SPDX-License-Identifier: Apache-2.0
// Voxel carving by silhouettes, from large blocks to small ones so that empty space costs little; the space that a
// rig's cameras see; and the volumetric visual hull, which is robust against unclean outlines.
#pragma once

#include <functional>
#include <span>

#include "base/camera.h"
#include "base/result.h"
#include "reconstruct/level_set.h"
#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {
// Silhouette with signed distances to its outline.
struct CarvingView {
  const silhouette::Silhouette* silhouette = nullptr;
  silhouette::SilhouetteDistance distance;
};

// Signed distance: the minimum over the cameras that see a point, metres (pixels times depth over focal length). Points
// seen by at most half of the cameras are outside, since two opposite cameras would leave phantoms there. Grid cells
// are aligned to multiples of the voxel, equally in every frame. Error NothingVisible: the hull is empty; the message
// names the camera whose removal leaves the largest volume, or reports that the cameras see no common volume.
Result<SparseDistance> carve(std::span<const CarvingView> views, double voxel_m);

// Bounding box of the performer, by halving cells until it is at least `cells_along` of them long. Independent of the
// rig's unit of length. World, metres. Errors: those of carve().
struct CoarseBounds {
  glm::dvec3 low{0}, high{0};
  double cell_m = 0;
};
Result<CoarseBounds> coarseBounds(std::span<const CarvingView> views, int cells_along);

// Point closest to the rays through the centres of all pictures, metres.
glm::dvec3 middleOf(std::span<const PinholeCamera> cameras);
// Maximum distance of the performer from `middle`; scales with the rig.
double reachOf(std::span<const PinholeCamera> cameras, const glm::dvec3& middle);
// True if at least `min_cameras` cameras see part of the sphere.
bool isSeen(std::span<const PinholeCamera> cameras, size_t min_cameras, const glm::dvec3& centre, double radius);

// Volume seen by more than half of the cameras, m³, within a few percent: an upper limit of the hull, reached by
// silhouettes that cover the pictures. 0: there is none.
double seenVolume(std::span<const PinholeCamera> cameras);

struct VolumetricOptions {
  double voxel_m = 0.005;
  double adaptivity = 0.1;  // 0 … 1: fewer faces where the surface is flat; reduced where faces would cross
};

struct VolumetricHull {
  SparseDistance distance;  // source of the mesh
  TriangleMesh mesh;
  size_t dropped = 0;  // removed components: specks below 27 voxels and phantoms, see dropNeedless
};

// Extracts the zero surface, with less adaptivity, down to 0, where merged faces would cross. `drop` removes components
// first.
TriangleMesh solidSurface(const SparseDistance& distance, double adaptivity,
                          const std::function<void(TriangleMesh&)>& drop);

// Visual hull by voxels. Its surface lies within about a fifth of a voxel of the cones' intersection; its edges are
// rounded. The mesh passes checkMesh, except where the voxel grid itself prevents it. Errors: those of carve().
Result<VolumetricHull> volumetricHull(std::span<const CarvingView> views, const VolumetricOptions& options);

}  // namespace fourdvt::reconstruct
