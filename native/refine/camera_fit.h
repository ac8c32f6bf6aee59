// SPDX-License-Identifier: Apache-2.0
// Turns, moves and zooms one camera such that the mesh's outlines come to lie on its mattes, and says how sure that is.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "refine/outline.h"

namespace fourdvt::refine {

// A change of a camera: first turned about its own axes, then moved along them, then zoomed.
struct CameraChange {
  glm::dvec3 turn_rad{0};  // rotation vector in the camera's frame
  glm::dvec3 move_m{0};    // of the world in the camera's frame
  double zoom_log = 0;     // focal length × exp
};
PinholeCamera changed(const PinholeCamera& camera, const CameraChange& change);

// A point and the block of the surface that it belongs to. The mesh's own errors are alike within a block, and in all
// frames: blocks, not points, are independent.
struct BlockedPoint {
  OutlinePoint point;
  uint32_t block = 0;
};

struct CameraStep {
  CameraChange change;
  bool solvable = false;              // enough points all round
  glm::dvec3 turn_deviation_rad{0};   // standard deviation of the rotation, by leaving out one block at a time
  double shift_deviation_pixels = 0;  // the same as the root mean square of the points' places in the picture
};

// What a fit may change.
enum class Freedom { Rotation, All };

// One Gauss-Newton step with Tukey's weights. Position and focal length are held near those of `given`, the camera
// before any step, by how well rigs are calibrated. A uniform error of the mesh's size does not turn into a change of
// the camera: it has an unknown of its own.
CameraStep fitCamera(const PinholeCamera& camera, const PinholeCamera& given, std::span<const BlockedPoint> points,
                     Freedom freedom);

// Root mean square of how far the points lie apart in two cameras' pictures, pixels. They were taken with `a`.
double shiftPixels(const PinholeCamera& a, const PinholeCamera& b, std::span<const BlockedPoint> points);

}  // namespace fourdvt::refine
