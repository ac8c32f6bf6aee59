// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/rig_space.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fourdvt::reconstruct {
namespace {

constexpr double kNearReach = 4, kFarReach = 32;  // spreads of the cameras: rays that meet, rays side by side
constexpr double kSideBySide = 0.94;              // cosine between any two rays: they fix no distance
constexpr double kEverywhere = 1e9;               // pixels
constexpr size_t kEnoughCells = 20'000;
constexpr int kMostHalvings = 20;

}  // namespace

glm::dvec3 middleOf(std::span<const PinholeCamera> cameras) {
  glm::dmat3 a(0);
  glm::dvec3 b(0);
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 axis = camera.middleRayInWorld(), c = camera.centreInWorld();
    const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(axis, axis) * 0.999;
    a += across;
    b += across * c;
  }
  return glm::inverse(a) * b;
}

double reachOf(std::span<const PinholeCamera> cameras, const glm::dvec3& middle) {
  double spread = 0, from_middle = 0, least_cosine = 1;
  for (const PinholeCamera& a : cameras) {
    const glm::dvec3 centre = a.centreInWorld(), axis = a.middleRayInWorld();
    from_middle = std::max(from_middle, glm::distance(middle, centre));
    for (const PinholeCamera& b : cameras) {
      spread = std::max(spread, glm::distance(centre, b.centreInWorld()));
      least_cosine = std::min(least_cosine, glm::dot(axis, b.middleRayInWorld()));
    }
  }
  const double reach = std::max(2 * from_middle, spread * (least_cosine > kSideBySide ? kFarReach : kNearReach));
  return reach > 0 ? reach : 1;  // one centre for all: no distance is better than another
}

bool isSeen(std::span<const PinholeCamera> cameras, size_t least_cameras, const glm::dvec3& centre, double radius) {
  size_t count = 0;
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 p = camera.project(centre);
    if (p.z <= -radius) continue;
    const double reach = p.z > 1.5 * radius ? std::max(camera.fx, camera.fy) * radius / (p.z - radius) : kEverywhere;
    count += p.x > -reach && p.y > -reach && p.x < camera.width + reach && p.y < camera.height + reach;
  }
  return count >= least_cameras;
}

double seenVolume(std::span<const PinholeCamera> cameras) {
  const size_t needed = cameras.size() / 2 + 1;
  const glm::dvec3 middle = middleOf(cameras);
  double side = 2 * reachOf(cameras, middle);
  std::vector<glm::dvec3> centres{middle};
  for (int halving = 0; halving < kMostHalvings && !centres.empty() && centres.size() < kEnoughCells; ++halving) {
    side /= 2;
    std::vector<glm::dvec3> parts;
    for (const glm::dvec3& centre : centres)
      for (int k = 0; k < 8; ++k) {
        const glm::dvec3 part = centre + side * (glm::dvec3(k & 1, k >> 1 & 1, k >> 2) - 0.5);
        if (isSeen(cameras, needed, part, std::sqrt(0.75) * side)) parts.push_back(part);
      }
    centres = std::move(parts);
  }
  const auto seen = std::count_if(centres.begin(), centres.end(),
                                  [&](const glm::dvec3& centre) { return isSeen(cameras, needed, centre, 0); });
  return double(seen) * side * side * side;
}

}  // namespace fourdvt::reconstruct
