// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/epipolar_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fourdvt::reconstruct {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;  // rad
constexpr double kDoubt = 1e-5;                 // rad, added to the angles of a wedge on either side
constexpr double kDoubtShare = 0.1;  // of its own angle, added as well: flat corners move when planes are rounded
constexpr double kLeastSine = 1e-3;  // between viewing line and baseline; below, the angle is not to be relied on

struct Pencil {
  glm::dvec3 across, up;  // unit, at right angles with the baseline

  explicit Pencil(const glm::dvec3& baseline) {
    const glm::dvec3 along = glm::normalize(baseline), size = glm::abs(along);
    const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                            : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                 : glm::dvec3(0, 0, 1);
    across = glm::normalize(glm::cross(along, axis));
    up = glm::cross(along, across);
  }
};

// The angles of a wedge in steps of the circle, `first` … `first + count - 1`, to be taken modulo `steps`.
struct Span {
  int first = 0, count = 0;
};

Span spanOf(const Pencil& pencil, const glm::dvec3& from, const glm::dvec3& to, int steps) {
  const glm::dvec2 a(glm::dot(from, pencil.across), glm::dot(from, pencil.up));
  const glm::dvec2 b(glm::dot(to, pencil.across), glm::dot(to, pencil.up));
  const double start = std::atan2(a.y, a.x), swept = std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
  const bool unclear = glm::length(a) < kLeastSine || glm::length(b) < kLeastSine;
  if (unclear || std::abs(swept) > kTurn / 2 - kLeastSine) return {0, steps};
  const double doubt = kDoubt + kDoubtShare * std::abs(swept), middle = start + swept / 2 + 2 * kTurn;
  const double low = middle - std::abs(swept) / 2 - doubt, high = middle + std::abs(swept) / 2 + doubt;
  const int first = int(std::floor(low / kTurn * steps)), last = int(std::floor(high / kTurn * steps));
  return {first, std::min(last - first + 1, steps)};
}

}  // namespace

void visitEpipolarPairs(const HullPlanes& planes, int first, int second,
                        const std::function<bool(uint32_t, uint32_t)>& visit) {
  const Pencil pencil(planes.centres[second] - planes.centres[first]);
  const auto ours = planes.ofCamera(first), theirs = planes.ofCamera(second);
  const int steps = std::clamp(int(2 * theirs.size()), 16, 8192);
  const auto span = [&](const HullPlane& wedge) {
    return spanOf(pencil, wedge.from_ray, planes.planes[wedge.next].from_ray, steps);
  };
  std::vector<std::vector<uint32_t>> buckets(steps);
  for (uint32_t i = 0; i < theirs.size(); ++i) {
    if (!theirs[i].reaches_bounds) continue;
    const Span s = span(theirs[i]);
    for (int k = 0; k < s.count; ++k) buckets[(s.first + k) % steps].push_back(i);
  }
  std::vector<uint32_t> seen_by(theirs.size(), ~0u);
  for (uint32_t e = 0; e < ours.size(); ++e) {
    if (!ours[e].reaches_bounds) continue;
    const Span s = span(ours[e]);
    for (int k = 0; k < s.count; ++k)
      for (uint32_t f : buckets[(s.first + k) % steps]) {
        if (seen_by[f] == e) continue;
        seen_by[f] = e;
        if (!visit(planes.first[first] + e, planes.first[second] + f)) return;
      }
  }
}

}  // namespace fourdvt::reconstruct
