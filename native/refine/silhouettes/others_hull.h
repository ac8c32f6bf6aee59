// SPDX-License-Identifier: Apache-2.0
// Compares a camera's silhouette with the visual hull of all other cameras' silhouettes at the same instant. The hull
// holds the performer, and touches the rim of it in few places: a silhouette that sticks out of the hull contradicts
// it, one that lies inside does not. Does NOT make the hull: looks along single rays.
// Source: HSC07 (silhouette coherence) in algorithms/calibration.md.
#pragma once

#include <optional>
#include <vector>

#include "refine/camera_fit.h"
#include "refine/silhouettes/silhouette_clip.h"

namespace fourdvt::refine {

// Calibration and time of a rig. Picture number f + offset_frames[c] of camera c shows the instant f.
struct RigState {
  std::vector<PinholeCamera> cameras;  // of the clip's pictures
  std::vector<double> offset_frames;
  std::vector<char> ignored;  // cameras that the others shall not be compared with; empty: none
  bool ignores(size_t camera) const { return camera < ignored.size() && ignored[camera]; }
};

// The middle of what the cameras see at an instant, nearest to the rays through their silhouettes' middles, and its
// largest distance from there.
struct Extent {
  glm::dvec3 middle_in_world{0};
  double radius_m = 0;
  bool known = false;  // at least three cameras see it
};
Extent extentOf(const SilhouetteClip& clip, const RigState& rig, double instant);

class OthersHull {
 public:
  // All others of `camera` at the instant of its picture `frame`. `tolerated`: so many of the others may contradict a
  // place without ruling it out. Borrows.
  OthersHull(const SilhouetteClip& clip, const RigState& rig, size_t camera, size_t frame, size_t tolerated);
  // Fewer than two others saw this instant, or nothing at all: nothing can be said.
  bool usable() const { return usable_; }

  struct Deepest {
    float inside_pixels = 0;  // of this camera; negative: how far the ray passes outside the hull
    float depth_m = 0;        // along the optical axis
    bool seen = false;
  };
  // The place along a pixel's ray that lies deepest in the hull.
  Deepest alongRay(const glm::vec2& pixel) const;

  // The point of the hull's outline along the normal of the silhouette's; none where the two lie further apart than
  // `reach_pixels`, or the hull more than kMostSlackPixels outside.
  static constexpr float kMostSlackPixels = 8;
  std::optional<OutlinePoint> outlineAt(const EdgePoint& edge, float reach_pixels) const;

 private:
  struct Other {
    SilhouetteClip::Instant instant;
    glm::dvec3 at_centre{0}, per_metre{0};  // homogeneous pixel of a place: at_centre + depth · per_metre (of this ray)
    glm::dmat3 per_pixel{1};                // per_metre = per_pixel · (x, y, 1)
    double scale = 1;                       // this camera's pixels per pixel and metre of depth
  };
  float insideAt(const std::vector<Other>& others, double depth_m) const;

  PinholeCamera camera_;
  size_t tolerated_;
  std::vector<Other> others_;
  double near_m_ = 0, far_m_ = 0;
  bool usable_ = false;
};

// How far a camera's silhouettes stick out of the hull of all others that are not ignored.
struct StickOut {
  size_t points = 0;       // of outlines
  double mean_pixels = 0;  // of the clip's pictures; a point counts kMostOutsidePixels at most
  double far_share = 0;    // of the points, by more than two pixels
};
constexpr float kMostOutsidePixels = 8;
// About `per_picture` points in at most `frames` frames.
StickOut stickOut(const SilhouetteClip& clip, const RigState& rig, size_t camera, size_t frames, size_t per_picture,
                  size_t tolerated);

// All points of a camera's silhouettes: about `per_picture` of each of `frames`, in blocks of space.
std::vector<BlockedPoint> hullPoints(const SilhouetteClip& clip, const RigState& rig, size_t camera,
                                     const std::vector<size_t>& frames, size_t per_picture, size_t tolerated,
                                     float reach_pixels);

}  // namespace fourdvt::refine
