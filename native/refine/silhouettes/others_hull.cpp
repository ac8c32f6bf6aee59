// SPDX-License-Identifier: Apache-2.0
#include "refine/silhouettes/others_hull.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>

namespace fourdvt::refine {
namespace {

constexpr int kDepths = 64;      // samples along a ray
constexpr int kFiner = 2;        // rounds of refinement around the best sample
constexpr int kFinerDepths = 4;  // per side
constexpr size_t kMinOthers = 2;
constexpr double kBlock_m = 0.2;
constexpr float kFarPixels = 2;  // beyond, a point contradicts the hull
constexpr int kSearchSteps = 16, kRootSteps = 3;

glm::dmat3 intrinsics(const PinholeCamera& camera) {
  return {camera.fx, 0, 0, 0, camera.fy, 0, camera.cx, camera.cy, 1};
}

}  // namespace

Extent extentOf(const SilhouetteClip& clip, const RigState& rig, double instant) {
  glm::dmat3 left(0.0);
  glm::dvec3 right(0);
  struct Seen {
    const PinholeCamera* camera;
    glm::dvec2 low, high;
  };
  std::vector<Seen> seen;
  for (size_t c = 0; c < rig.cameras.size(); ++c) {
    const auto box = clip.boundsAt(c, instant + rig.offset_frames[c]);
    if (!box) continue;
    const PinholeCamera& camera = rig.cameras[c];
    const glm::dvec2 at = 0.5 * (box->first + box->second);
    const glm::dvec3 ray =
        glm::normalize(glm::transpose(glm::dmat3(camera.cam_from_world)) *
                       glm::dvec3((at.x - camera.cx) / camera.fx, (at.y - camera.cy) / camera.fy, 1));
    const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(ray, ray);
    left += across;
    right += across * camera.centreInWorld();
    seen.push_back({&camera, box->first, box->second});
  }
  Extent out;
  if (seen.size() < kMinOthers + 1) return out;
  out.middle_in_world = glm::inverse(left) * right;
  for (const Seen& s : seen) {
    const glm::dvec3 p = s.camera->project(out.middle_in_world);
    if (!(p.z > 0)) continue;
    const glm::dvec2 to = glm::max(glm::abs(s.low - glm::dvec2(p)), glm::abs(s.high - glm::dvec2(p)));
    out.radius_m = std::max(out.radius_m, glm::length(to / glm::dvec2(s.camera->fx, s.camera->fy)) * p.z);
  }
  out.known = out.radius_m > 0 && std::isfinite(out.radius_m);
  return out;
}

OthersHull::OthersHull(const SilhouetteClip& clip, const RigState& rig, size_t camera, size_t frame, size_t tolerated)
    : camera_(rig.cameras[camera]), tolerated_(tolerated) {
  const double instant = double(frame) - rig.offset_frames[camera];
  const Extent extent = extentOf(clip, rig, instant);
  const double depth = camera_.project(extent.middle_in_world).z;
  if (!extent.known || !(depth > 0)) return;
  near_m_ = std::max(depth - extent.radius_m, 0.05 * depth);
  far_m_ = depth + extent.radius_m;
  const glm::dmat4 world_from_cam = glm::inverse(camera_.cam_from_world);
  size_t possible = 0;
  for (size_t o = 0; o < rig.cameras.size(); ++o) {
    if (o == camera || rig.ignores(o)) continue;
    ++possible;
    Other other;
    other.instant = clip.instant(o, instant + rig.offset_frames[o]);
    if (!other.instant.before) continue;
    const PinholeCamera& view = rig.cameras[o];
    const glm::dmat4 view_from_cam = view.cam_from_world * world_from_cam;
    other.at_centre = intrinsics(view) * glm::dvec3(view_from_cam[3]);
    other.per_pixel = intrinsics(view) * glm::dmat3(view_from_cam) * glm::inverse(intrinsics(camera_));
    other.scale = camera_.fx / view.fx;
    others_.push_back(other);
  }
  usable_ = others_.size() >= kMinOthers + tolerated && 3 * others_.size() >= 2 * possible;
}

float OthersHull::insideAt(const std::vector<Other>& others, double depth_m) const {
  float lowest = 1e6f, second = 1e6f;
  size_t seen = 0;
  for (const Other& other : others) {
    const glm::dvec3 h = other.at_centre + depth_m * other.per_metre;
    if (!(h.z > 0)) continue;
    const float value = other.instant.at(h.x / h.z, h.y / h.z);
    if (value > 0.5f * silhouette::SilhouetteDistance::kOutside) continue;
    ++seen;
    const auto here = float(value * other.scale * h.z / depth_m);
    if (here < lowest)
      second = lowest, lowest = here;
    else
      second = std::min(second, here);
    if (tolerated_ == 0 && lowest < -1e4f) break;
  }
  return seen < kMinOthers + tolerated_ ? -1e6f : tolerated_ > 0 ? second : lowest;
}

OthersHull::Deepest OthersHull::alongRay(const glm::vec2& pixel) const {
  std::vector<Other> others = others_;
  for (Other& other : others) other.per_metre = other.per_pixel * glm::dvec3(pixel, 1);
  Deepest best{-1e6f, 0, false};
  const auto look = [&](double depth) {
    const float inside = insideAt(others, depth);
    if (inside > best.inside_pixels) best = {inside, float(depth), true};
  };
  double step = (far_m_ - near_m_) / kDepths;
  for (int i = 0; i <= kDepths; ++i) look(near_m_ + i * step);
  if (!best.seen) return best;
  for (int finer = 0; finer < kFiner; ++finer) {
    const double middle = best.depth_m;
    step /= kFinerDepths;
    for (int i = 1 - kFinerDepths; i < kFinerDepths; ++i)
      if (i != 0) look(middle + i * step);
  }
  return best;
}

std::optional<OutlinePoint> OthersHull::outlineAt(const EdgePoint& edge, float reach_pixels) const {
  Deepest here = alongRay(edge.pixel);
  if (!here.seen) return std::nullopt;
  const bool outward = here.inside_pixels >= 0;
  const float most = outward ? std::min(kMaxSlackPixels, reach_pixels) : reach_pixels, sign = outward ? 1.0f : -1.0f;
  // Brackets the crossing between a position inside the hull and one outside, then applies the secant method.
  float in = 0, out = 0, value_in = here.inside_pixels, value_out = here.inside_pixels, way = 0;
  Deepest at = here;
  bool crossed = false;
  for (int step = 0; step < kSearchSteps && !crossed; ++step) {
    if (way >= most) return std::nullopt;
    way = std::min(most, way + std::max(0.5f, std::abs(at.inside_pixels)));
    at = alongRay(edge.pixel + sign * way * edge.outward);
    if (!at.seen) return std::nullopt;
    crossed = (at.inside_pixels >= 0) != outward;
    ((at.inside_pixels >= 0) ? in : out) = way;
    ((at.inside_pixels >= 0) ? value_in : value_out) = at.inside_pixels;
  }
  if (!crossed) return std::nullopt;
  for (int step = 0; step < kRootSteps; ++step) {
    way = in + (out - in) * std::clamp(value_in / (value_in - value_out), 0.1f, 0.9f);
    at = alongRay(edge.pixel + sign * way * edge.outward);
    (at.inside_pixels >= 0 ? in : out) = way;
    (at.inside_pixels >= 0 ? value_in : value_out) = at.inside_pixels;
  }
  way = in + (out - in) * std::clamp(value_in / (value_in - value_out), 0.0f, 1.0f);
  OutlinePoint point;
  const glm::vec2 pixel = edge.pixel + sign * way * edge.outward;
  point.point_in_cam = at.depth_m * glm::vec3((pixel.x - float(camera_.cx)) / float(camera_.fx),
                                              (pixel.y - float(camera_.cy)) / float(camera_.fy), 1);
  point.outward = edge.outward;
  point.pixels_per_metre = float(camera_.fx) / at.depth_m;
  point.residual_pixels = -sign * way;
  return point;
}

StickOut stickOut(const SilhouetteClip& clip, const RigState& rig, size_t camera, size_t frames, size_t per_picture,
                  size_t tolerated) {
  StickOut out;
  for (const size_t frame : clip.spreadFrames(frames)) {
    const OthersHull hull(clip, rig, camera, frame, tolerated);
    if (!hull.usable()) continue;
    for (const EdgePoint& edge : clip.edge(camera, frame, per_picture)) {
      const OthersHull::Deepest deepest = hull.alongRay(edge.pixel);
      if (!deepest.seen) continue;
      const float outside = std::max(0.0f, -deepest.inside_pixels);
      ++out.points;
      out.mean_pixels += std::min(outside, kMaxOutsidePixels);
      out.far_share += outside > kFarPixels;
    }
  }
  out.mean_pixels /= double(std::max<size_t>(1, out.points));
  out.far_share /= double(std::max<size_t>(1, out.points));
  return out;
}

std::vector<BlockedPoint> hullPoints(const SilhouetteClip& clip, const RigState& rig, size_t camera,
                                     const std::vector<size_t>& frames, size_t per_picture, size_t tolerated,
                                     float reach_pixels) {
  std::vector<BlockedPoint> out;
  const glm::mat4 world_from_cam(glm::inverse(rig.cameras[camera].cam_from_world));
  for (const size_t frame : frames) {
    const OthersHull hull(clip, rig, camera, frame, tolerated);
    if (!hull.usable()) continue;
    for (const EdgePoint& edge : clip.edge(camera, frame, per_picture)) {
      const auto point = hull.outlineAt(edge, reach_pixels);
      if (!point) continue;
      const glm::ivec3 cube =
          glm::floor(glm::vec3(world_from_cam * glm::vec4(point->point_in_cam, 1)) / float(kBlock_m));
      const auto block = uint32_t((cube.x & 1023) << 20 | (cube.y & 1023) << 10 | (cube.z & 1023));
      out.push_back({*point, block, edge.pixels_per_frame});
    }
  }
  return out;
}

}  // namespace fourdvt::refine
