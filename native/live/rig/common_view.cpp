// SPDX-License-Identifier: Apache-2.0
#include "live/rig/common_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt::live {
namespace {

using Cameras = std::vector<capture::CaptureCamera>;

constexpr int kHalfCells = 48;          // of the grid, along each axis from the middle
constexpr double kLeastDistance = 0.1;  // of the farthest camera's, along the optical axis, from camera to box

// The point that has the least sum of squared distances from the rays through the middles of the pictures.
glm::dvec3 meetingPoint(const Cameras& cameras) {
  glm::dmat3 sum(0.0);
  glm::dvec3 right(0.0), mean(0.0);
  for (const auto& c : cameras) {
    const glm::dvec3 along = c.pinhole.middleRayInWorld(), centre = c.pinhole.centreInWorld();
    const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(along, along);
    sum += across;
    right += across * centre;
    mean += centre / double(cameras.size());
  }
  // Parallel rays meet nowhere.
  return glm::determinant(sum) > 1e-9 ? glm::inverse(sum) * right : mean;
}

bool seenByAll(const Cameras& cameras, const glm::dvec3& point, double nearest_m) {
  return std::all_of(cameras.begin(), cameras.end(), [&](const auto& c) {
    const glm::dvec3 pixel = c.pinhole.project(point);
    return pixel.z >= nearest_m && pixel.x >= 0 && pixel.y >= 0 && pixel.x <= c.pinhole.width &&
           pixel.y <= c.pinhole.height;
  });
}

// Moves the nearest face inwards wherever a camera lies within the box or close to it.
void keepCamerasOutside(const Cameras& cameras, const glm::dvec3& middle, double margin_m, glm::dvec3& low,
                        glm::dvec3& high) {
  for (const auto& c : cameras) {
    const glm::dvec3 at = c.pinhole.centreInWorld();
    if (glm::any(glm::lessThan(at, low - margin_m)) || glm::any(glm::greaterThan(at, high + margin_m))) continue;
    const glm::dvec3 off = at - middle, away = glm::abs(off);
    const int axis = away.x >= away.y && away.x >= away.z ? 0 : away.y >= away.z ? 1 : 2;
    if (off[axis] > 0)
      high[axis] = std::min(high[axis], at[axis] - margin_m);
    else
      low[axis] = std::max(low[axis], at[axis] + margin_m);
  }
}

}  // namespace

std::optional<BoundingBox> commonView(const Cameras& cameras, double ground_y_m) {
  if (cameras.empty()) return std::nullopt;
  const glm::dvec3 middle = meetingPoint(cameras);
  double reach_m = 0;
  for (const auto& c : cameras) reach_m = std::max(reach_m, glm::length(c.pinhole.centreInWorld() - middle));
  if (!(reach_m > 0)) return std::nullopt;
  const double cell_m = reach_m / kHalfCells, nearest_m = kLeastDistance * reach_m;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int z = -kHalfCells; z <= kHalfCells; ++z)
    for (int y = -kHalfCells; y <= kHalfCells; ++y)
      for (int x = -kHalfCells; x <= kHalfCells; ++x) {
        const glm::dvec3 point = middle + cell_m * glm::dvec3(x, y, z);
        if (point.y < ground_y_m - cell_m || !seenByAll(cameras, point, nearest_m)) continue;
        low = glm::min(low, point), high = glm::max(high, point);
      }
  if (!(low.x <= high.x)) return std::nullopt;
  low -= cell_m / 2, high += cell_m / 2;
  low.y = std::max(low.y, ground_y_m - 0.01 * (high.y - ground_y_m));
  keepCamerasOutside(cameras, middle, nearest_m, low, high);
  if (!glm::all(glm::lessThan(low, high))) return std::nullopt;
  return BoundingBox{glm::vec3(low), glm::vec3(high)};
}

}  // namespace fourdvt::live
