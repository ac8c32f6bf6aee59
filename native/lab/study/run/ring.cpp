// SPDX-License-Identifier: Apache-2.0
#include "lab/study/run/ring.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace fourdvt::study {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846, kMargin = 1.08;

double turned(double degrees) {
  const double rest = std::fmod(degrees, 360.0);
  return rest < 0 ? rest + 360 : rest;
}

struct RigPoint {
  double azimuth_deg, elevation_deg, distance_m;
};

std::vector<RigPoint> rigPoints(std::span<const PinholeCamera> cameras, const glm::dvec3& target) {
  std::vector<RigPoint> points;
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 d = camera.centreInWorld() - target;
    const double length = glm::length(d);
    points.push_back({turned(std::atan2(d.x, d.z) * kDegrees), std::asin(d.y / length) * kDegrees, length});
  }
  std::sort(points.begin(), points.end(),
            [](const RigPoint& a, const RigPoint& b) { return a.azimuth_deg < b.azimuth_deg; });
  return points;
}

// Interpolates linearly in azimuth between the two neighbouring cameras.
RigPoint rigAt(const std::vector<RigPoint>& rig, double azimuth_deg) {
  for (size_t i = 0; i < rig.size(); ++i) {
    const RigPoint &a = rig[i], &b = rig[(i + 1) % rig.size()];
    const double gap = rig.size() == 1 ? 360 : turned(b.azimuth_deg - a.azimuth_deg);
    const double along = turned(azimuth_deg - a.azimuth_deg);
    if (along > gap) continue;
    const double t = gap > 0 ? along / gap : 0;
    return {azimuth_deg, a.elevation_deg + t * (b.elevation_deg - a.elevation_deg),
            a.distance_m + t * (b.distance_m - a.distance_m)};
  }
  return rig[0];
}

int rounded16(double pixels, int largest) {
  const int up = static_cast<int>(std::ceil(pixels / 16)) * 16;
  return std::min(up, largest / 2 * 2);
}

// Side lengths of the picture that contains the box in all views, pixels.
glm::ivec2 pictureSize(std::span<const PinholeCamera> cameras, const BoundingBox& bounds,
                       const std::vector<RigPoint>& rig, double focal) {
  const glm::dvec3 half = 0.5 * glm::dvec3(bounds.max - bounds.min);
  const double radius = std::hypot(half.x, half.z);
  double nearest = std::numeric_limits<double>::infinity(), steepest = 0;
  for (const RigPoint& p : rig) {
    nearest = std::min(nearest, p.distance_m);
    steepest = std::max(steepest, std::abs(p.elevation_deg) / kDegrees);
  }
  const double depth = std::max(nearest - radius, 0.1 * nearest);
  const double upright = half.y * std::cos(steepest) + radius * std::sin(steepest);
  return {rounded16(kMargin * 2 * radius * focal / depth, cameras[0].width),
          rounded16(kMargin * 2 * upright * focal / depth, cameras[0].height)};
}

}  // namespace

std::vector<double> ringAzimuths_deg(std::vector<double> cameras, int count) {
  for (double& a : cameras) a = turned(a);
  std::sort(cameras.begin(), cameras.end());
  std::vector<double> special;  // camera, middle, camera, …
  for (size_t i = 0; i < cameras.size(); ++i) {
    const double gap = i + 1 < cameras.size() ? cameras[i + 1] - cameras[i] : cameras[0] + 360 - cameras[i];
    special.push_back(cameras[i]);
    special.push_back(turned(cameras[i] + gap / 2));
  }
  std::vector<double> out;
  const int known = static_cast<int>(special.size());
  if (count <= known) {
    for (int i = 0; i < count; ++i) {
      const int even = 2 * static_cast<int>(std::lround(double(i) * known / count / 2));
      out.push_back(special[(even + (i & 1)) % known]);
    }
  } else {
    std::vector<bool> taken(count, false);
    for (int i = 0; i < count; ++i) out.push_back(turned(special[0] + 360.0 * i / count));
    for (double direction : special) {
      const int nearest = static_cast<int>(std::lround(turned(direction - special[0]) * count / 360)) % count;
      if (taken[nearest]) continue;
      taken[nearest] = true;
      out[nearest] = direction;
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<RingView> ringViews(std::span<const PinholeCamera> cameras, const BoundingBox& bounds, uint32_t frame_count,
                                int count) {
  const glm::dvec3 target = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
  const std::vector<RigPoint> rig = rigPoints(cameras, target);
  double focal = 0;
  for (const PinholeCamera& camera : cameras) focal += 0.5 * (camera.fx + camera.fy) / cameras.size();
  const glm::ivec2 size = pictureSize(cameras, bounds, rig, focal);
  std::vector<double> azimuths;
  for (const RigPoint& p : rig) azimuths.push_back(p.azimuth_deg);
  azimuths = ringAzimuths_deg(azimuths, count);
  std::vector<RingView> views;
  for (int i = 0; i < count; ++i) {
    const RigPoint p = rigAt(rig, azimuths[i]);
    RingView view;
    view.camera = cameraFromOrbit(
        {p.azimuth_deg, p.elevation_deg, p.distance_m, target, 2 * std::atan(0.5 * size.y / focal) * kDegrees}, size.x,
        size.y);
    const std::string name = printed("az%05.1f", p.azimuth_deg);
    view.camera.name = name;
    view.frame = static_cast<uint32_t>(static_cast<uint64_t>(i) * frame_count / count);
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace fourdvt::study
