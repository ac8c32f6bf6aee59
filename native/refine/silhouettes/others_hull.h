// SPDX-License-Identifier: Apache-2.0
// Compares a camera's silhouette with the visual hull of all other cameras' silhouettes at the same instant. The hull
// contains the performer and touches its outline in few places: a silhouette that exceeds the hull contradicts it, one
// inside is consistent. Evaluates the hull along single rays, without its surface.
//
// Source: Carlos Hernández, Francis Schmitt, Roberto Cipolla: Silhouette Coherence for Camera Calibration under
// Circular Motion. IEEE Transactions on Pattern Analysis and Machine Intelligence 29(2), 2007.
#pragma once

#include <optional>
#include <vector>

#include "refine/camera_fit.h"
#include "refine/silhouettes/silhouette_clip.h"

namespace fourdvt::refine {

// Calibration and times of a rig. Picture f + offset_frames[c] of camera c shows the instant f.
struct RigState {
  std::vector<PinholeCamera> cameras;  // sized to the clip's pictures
  std::vector<double> offset_frames;
  std::vector<char> ignored;  // cameras excluded from comparisons; empty: none
  bool ignores(size_t camera) const { return camera < ignored.size() && ignored[camera]; }
};

// Performer at an instant: the centre, which is the point nearest to the rays through the silhouettes' centres, and the
// maximum distance from it.
struct Extent {
  glm::dvec3 middle_in_world{0};
  double radius_m = 0;
  bool known = false;  // at least three cameras have a silhouette
};
Extent extentOf(const SilhouetteClip& clip, const RigState& rig, double instant);

class OthersHull {
 public:
  // Hull of all cameras but `camera` at the instant of its picture `frame`. A point counts as inside if at most
  // `tolerated` cameras contradict it. Borrows `clip` and `rig`.
  OthersHull(const SilhouetteClip& clip, const RigState& rig, size_t camera, size_t frame, size_t tolerated);
  // False if fewer than two other cameras have a silhouette of this instant.
  bool usable() const { return usable_; }

  struct Deepest {
    float inside_pixels = 0;  // pixels of this camera; negative: distance of the ray from the hull
    float depth_m = 0;        // along the optical axis
    bool seen = false;
  };
  // Deepest point in the hull along a pixel's ray.
  Deepest alongRay(const glm::vec2& pixel) const;

  // Point of the hull's outline along the silhouette's normal; none if it is further away than `reach_pixels`, or the
  // hull exceeds the silhouette by more than kMaxSlackPixels.
  static constexpr float kMaxSlackPixels = 8;
  std::optional<OutlinePoint> outlineAt(const EdgePoint& edge, float reach_pixels) const;

 private:
  struct Other {
    SilhouetteClip::Instant instant;
    glm::dvec3 at_centre{0}, per_metre{0};  // homogeneous pixel along this ray: at_centre + depth · per_metre
    glm::dmat3 per_pixel{1};                // per_metre = per_pixel · (x, y, 1)
    double scale = 1;                       // ratio of focal lengths, this camera's to the other's
  };
  float insideAt(const std::vector<Other>& others, double depth_m) const;

  PinholeCamera camera_;
  size_t tolerated_;
  std::vector<Other> others_;
  double near_m_ = 0, far_m_ = 0;
  bool usable_ = false;
};

// Distance by which a camera's silhouettes exceed the hull of all others that are not ignored.
struct StickOut {
  size_t points = 0;       // on outlines
  double mean_pixels = 0;  // in the clip's pictures; a point counts at most kMaxOutsidePixels
  double far_share = 0;    // share of points that exceed the hull by more than two pixels
};
constexpr float kMaxOutsidePixels = 8;
// Uses about `per_picture` points in each of at most `frames` frames.
StickOut stickOut(const SilhouetteClip& clip, const RigState& rig, size_t camera, size_t frames, size_t per_picture,
                  size_t tolerated);

// All points of a camera's silhouettes: about `per_picture` in each of `frames`, assigned to blocks of space.
std::vector<BlockedPoint> hullPoints(const SilhouetteClip& clip, const RigState& rig, size_t camera,
                                     const std::vector<size_t>& frames, size_t per_picture, size_t tolerated,
                                     float reach_pixels);

}  // namespace fourdvt::refine
