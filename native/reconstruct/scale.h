// SPDX-License-Identifier: Apache-2.0
// Position and size of the performer and of a pixel there. All lengths of a reconstruction are multiples of these, so
// that scaled scenes, such as a figurine, have the same surface.
#pragma once

#include <span>

#include "base/mesh.h"
#include "reconstruct/carve.h"

namespace fourdvt::reconstruct {

// Measures of the silhouettes' hull, from a coarse carving; scaling the rig by s scales all lengths by s.
struct SceneScale {
  BoundingBox bounds;             // world, metres
  glm::dvec3 centre_in_world{0};  // centroid of the volume, metres
  double extent_m = 0;            // longest side of the bounds
  double area_m2 = 0;
  double thickness_m =
      0;  // 3 · volume / area, which is the radius of a ball; nearly independent of pose and number of people
  double footprint_m = 0;  // size of a pixel at the centre: median over the views of depth over focal length
};

// Requires at least two views. Errors: those of carve().
Result<SceneScale> scaleOf(std::span<const CarvingView> views);

// Voxel size in pixel footprints: 5 mm for a person who fills 480 x 640 pixels.
inline constexpr double kVoxelFootprints = 1.35;
// Voxel size for a scene: kVoxelFootprints, or more where the surface would exceed four times `max_faces`.
double voxelFor(const SceneScale& scale, size_t max_faces);

// Metres of the world per metre of a normalised scene, in which the performer is as thick as a person. Lengths tuned
// for a person apply in the normalised scene.
double metresPerPersonMetre(const SceneScale& scale);

// Camera of the scene with all lengths divided by `divisor`, about the world's origin.
PinholeCamera dividedCamera(const PinholeCamera& camera, double divisor);

}  // namespace fourdvt::reconstruct
