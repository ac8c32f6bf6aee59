// SPDX-License-Identifier: Apache-2.0
// Turns, moves and zooms one camera, and shifts it in time, such that a surface's outlines come to lie on its mattes,
// and says how sure that is. The surface is a mesh, or the visual hull of the other cameras' mattes (silhouettes/).
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "capture/surface_offsets.h"
#include "refine/outline.h"
#include "refine/surface_fit.h"

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

// Fits a camera step by step to points that are measured anew after every step, and keeps the change only if it
// explains more than chance could. Does NOT measure: the outlines of a mesh or of a visual hull come from its caller.

constexpr double kClearDeviations = 3;  // standard deviations that chance does not explain

// Measures the outline against a camera's mattes as if it were `as`; edges are searched up to `reach_pixels` away.
using MeasurePoints = std::function<std::vector<BlockedPoint>(const PinholeCamera& as, float reach_pixels)>;

// How far a camera would move, as the root mean square of the outline's shift in the picture, and how sure that is.
struct CameraShift {
  double pixels = 0, deviation_pixels = 0;
};

struct CameraRefit {
  PinholeCamera camera;              // the refined one, or the current one
  bool changed = false;              // clearly better than the current one
  std::optional<CameraShift> best;   // against the given camera; none: the outline says too little
  glm::dvec3 turn_deviation_deg{0};  // with `best`
  double spread_before_pixels = 0, spread_after_pixels = 0;  // robust scale of the residuals
};

// Turns first, then, `with_place`, moves and zooms, too. `given`: before any refinement. `deviations`: how many of them
// a change must exceed.
CameraRefit refitCamera(const PinholeCamera& current, const PinholeCamera& given, const MeasurePoints& measure,
                        bool with_place, SurfaceKind surface, double deviations = kClearDeviations);

// Offsets that vary slowly with time, for meshes whose error depends on the pose.

// What the outlines of one frame still lack, given the constant offsets.
struct SlowFrame {
  uint32_t index = 0;
  std::vector<std::vector<OffsetClaim>> claims;  // [camera]
};

// Departures from the constant offsets at the frames given, each from its neighbours in time. None where the data do
// not support them: the frames must be close in time, and what the cameras with even numbers say must bring the
// outlines closer in those with odd numbers. `loop_frames`: of a loop, else 0.
std::optional<capture::SlowOffsets> fitSlowOffsets(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                                   size_t vertices, uint32_t loop_frames);

}  // namespace fourdvt::refine
