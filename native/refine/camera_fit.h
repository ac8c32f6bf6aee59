// SPDX-License-Identifier: Apache-2.0
// Fits pose, focal length and time offset of one camera such that a surface's outlines align with its mattes, with
// standard deviations. The surface is a mesh, or the visual hull of the other cameras' mattes (silhouettes/). Includes
// offsets of the surface that vary slowly with time.
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
// Change of a camera, applied in this order: rotation about its own axes, translation along them, zoom.
struct CameraChange {
  glm::dvec3 turn_rad{0};  // rotation vector in the camera's frame
  glm::dvec3 move_m{0};    // translation of the world in the camera's frame
  double zoom_log = 0;     // focal length × exp
  double frames = 0;       // added to the camera's offset_frames by the caller; changed() ignores it
};
PinholeCamera changed(const PinholeCamera& camera, const CameraChange& change);

// Outline point and the block of the surface that contains it. Errors of a mesh are correlated within a block and
// across frames: blocks, not points, are independent samples.
struct BlockedPoint {
  OutlinePoint point;
  uint32_t block = 0;
  float pixels_per_frame = 0;  // speed of the matte's edge along `outward`; 0: unknown
};

struct CameraStep {
  CameraChange change;
  bool solvable = false;              // enough points in all directions
  glm::dvec3 turn_deviation_rad{0};   // standard deviation of the rotation, by a jackknife over blocks
  double shift_deviation_pixels = 0;  // the rotation's standard deviation as RMS displacement of the points
  double frames_deviation = 0;        // standard deviation of the time offset
};

// Unknowns of a fit besides rotation. `place`: position and focal length.
struct Freedom {
  bool turn = true, place = false, time = false;
};

// Kind of surface. A hull contains the performer and touches the outline in few places: points with "too large"
// residuals get less weight, "too small" ones dominate the fit.
enum class SurfaceKind { Mesh, Hull };

// One Gauss-Newton step with Tukey's weights. Priors with the usual accuracy of calibrated rigs hold position and focal
// length near `given`, the camera before any step. A uniform offset of the surface is an unknown of its own, so that
// errors of the mesh's size leave the camera unchanged.
CameraStep fitCamera(const PinholeCamera& camera, const PinholeCamera& given, std::span<const BlockedPoint> points,
                     Freedom freedom, SurfaceKind surface = SurfaceKind::Mesh);

// RMS distance between the points' projections by two cameras, pixels. The points were measured with `a`.
double shiftPixels(const PinholeCamera& a, const PinholeCamera& b, std::span<const BlockedPoint> points);

constexpr double kClearDeviations = 3;  // standard deviations; larger changes are significant

// Measures the outline against a camera's mattes with the camera replaced by `as`; edges are searched within
// `reach_pixels`.
using MeasurePoints = std::function<std::vector<BlockedPoint>(const PinholeCamera& as, float reach_pixels)>;

// Displacement by a camera's change, as RMS of the outline's shift in the picture, with its standard deviation.
struct CameraShift {
  double pixels = 0, deviation_pixels = 0;
};

struct CameraRefit {
  PinholeCamera camera;                                      // refined, or the current one
  bool changed = false;                                      // significantly better than the current one
  std::optional<CameraShift> best;                           // relative to the given camera; none: too few constraints
  glm::dvec3 turn_deviation_deg{0};                          // set with `best`
  double spread_before_pixels = 0, spread_after_pixels = 0;  // robust scale of the residuals
};

// Fits rotation, then, with `with_place`, position and focal length too; points are measured anew after every step.
// `given`: camera before any refinement. The change is kept only if it exceeds `deviations` standard deviations.
CameraRefit refitCamera(const PinholeCamera& current, const PinholeCamera& given, const MeasurePoints& measure,
                        bool with_place, SurfaceKind surface, double deviations = kClearDeviations);

// Residual offsets of one frame, beyond the constant offsets.
struct SlowFrame {
  uint32_t index = 0;
  std::vector<std::vector<OffsetClaim>> claims;  // [camera]
};

// Fits slowly varying departures from the constant offsets, for meshes whose error depends on the pose: one per given
// frame, from its neighbours in time. Returns none where the data do not support them: the frames must be close in
// time, and offsets fitted to even-numbered cameras must reduce the residuals of odd-numbered ones. `loop_frames`:
// length of a loop, else 0.
std::optional<capture::SlowOffsets> fitSlowOffsets(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                                   size_t vertices, uint32_t loop_frames);

}  // namespace fourdvt::refine
