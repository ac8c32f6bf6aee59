// SPDX-License-Identifier: Apache-2.0
// Turns, moves and zooms one camera, and shifts it in time, such that a surface's outlines come to lie on its mattes,
// and says how sure that is. The surface is a mesh, or the visual hull of the other cameras' mattes (silhouettes/).
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
  double frames = 0;       // added to the camera's offset_frames; changed() leaves it to its caller
};
PinholeCamera changed(const PinholeCamera& camera, const CameraChange& change);

// A point and the block of the surface that it belongs to. The mesh's own errors are alike within a block, and in all
// frames: blocks, not points, are independent.
struct BlockedPoint {
  OutlinePoint point;
  uint32_t block = 0;
  float pixels_per_frame = 0;  // how fast the matte's edge moves along `outward`; 0: not known
};

struct CameraStep {
  CameraChange change;
  bool solvable = false;              // enough points all round
  glm::dvec3 turn_deviation_rad{0};   // standard deviation of the rotation, by leaving out one block at a time
  double shift_deviation_pixels = 0;  // the same as the root mean square of the points' places in the picture
  double frames_deviation = 0;        // of the shift in time
};

// Unknowns of a fit. `place`: position and focal length.
struct Freedom {
  bool turn = true, place = false, time = false;
};

// Kind of surface. A hull lies outside the performer nearly everywhere and on the outline in few places: points that
// say "too large" count less, and the fit follows those that say "too small" most.
enum class SurfaceKind { Mesh, Hull };

// One Gauss-Newton step with Tukey's weights. Position and focal length are held near those of `given`, the camera
// before any step, by how well rigs are calibrated. A uniform error of the mesh's size does not turn into a change of
// the camera: it has an unknown of its own.
CameraStep fitCamera(const PinholeCamera& camera, const PinholeCamera& given, std::span<const BlockedPoint> points,
                     Freedom freedom, SurfaceKind surface = SurfaceKind::Mesh);

// Root mean square of how far the points lie apart in two cameras' pictures, pixels. They were taken with `a`.
double shiftPixels(const PinholeCamera& a, const PinholeCamera& b, std::span<const BlockedPoint> points);

}  // namespace fourdvt::refine
