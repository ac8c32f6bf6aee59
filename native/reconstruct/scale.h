// SPDX-License-Identifier: Apache-2.0
// The performer's place and size, and the size of a pixel there: the measures that all lengths of a reconstruction
// follow, so that a scene in other units, or a figurine, gives the same surface. Does NOT make a surface.
#pragma once

#include <span>

#include "base/mesh.h"
#include "reconstruct/carve.h"

namespace fourdvt::reconstruct {

// Measures of the silhouettes' hull, from a coarse carving. A rig that is scaled by s gives lengths that are scaled by s.
struct SceneScale {
  BoundingBox bounds;             // world, metres
  glm::dvec3 centre_in_world{0};  // of the volume, metres
  double extent_m = 0;            // the longest side of the bounds
  double area_m2 = 0;
  double thickness_m = 0;  // three volumes over the area: a ball's radius; hardly changes with a pose or a group
  double footprint_m = 0;  // of a pixel at the centre: the median over the views of depth over focal length
};

// At least two views. Errors: those of carve().
Result<SceneScale> scaleOf(std::span<const CarvingView> views);

// Footprints of a pixel along a voxel: 5 mm for a person who fills 480 x 640 pixels.
inline constexpr double kVoxelFootprints = 1.35;
// The side of a voxel for a scene: that many footprints, or more where the surface would have over four times
// `most_faces`.
double voxelFor(const SceneScale& scale, size_t most_faces);

// Metres of the world per metre of a scene in which the performer is as thick as a person. Lengths that suit a person
// hold in the latter.
double metresPerPersonMetre(const SceneScale& scale);

// The camera of a scene whose lengths are divided by `divisor`, round the world's origin.
PinholeCamera dividedCamera(const PinholeCamera& camera, double divisor);

}  // namespace fourdvt::reconstruct
