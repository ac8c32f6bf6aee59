// SPDX-License-Identifier: Apache-2.0
// A face of the surface laid into the plane, and how a texture stretches over it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "track/mesh/surface.h"

namespace fourdvt::track {

// Square of the L2 stretch and L∞ stretch of a map from the plane to a triangle. Source: Pedro V. Sander, John Snyder,
// Steven J. Gortler, Hugues Hoppe: Texture Mapping Progressive Meshes. SIGGRAPH, 2001, Section 3.
struct TriangleStretch {
  double square, longest;
  double flat_area;  // negative: mirrored
};

class FlatTriangle {
 public:
  FlatTriangle(const Surface& s, uint32_t face)
      : FlatTriangle(s.points[s.faces[face].x], s.points[s.faces[face].y], s.points[s.faces[face].z]) {}

  // Isometric; slivers are widened to kMinHeight of their longest side, so that all have an area.
  FlatTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 ab = b - a, ac = c - a;
    const double longest = std::max({glm::length(ab), glm::length(ac), glm::length(c - b), 1e-9});
    const double base = std::max(glm::length(ab), kMinHeight * longest);
    corners[1] = {base, 0};
    corners[2] = {glm::dot(ac, ab) / base, std::max(glm::length(glm::cross(ab, ac)) / base, kMinHeight * longest)};
  }

  double area() const { return corners[1].x * corners[2].y / 2; }

  // Half the cotangent of the angle at corner k, bounded.
  double weight(int k) const {
    const glm::dvec2 a = corners[(k + 1) % 3] - corners[k], b = corners[(k + 2) % 3] - corners[k];
    return std::clamp(glm::dot(a, b) / (4 * area()), 0.01, 10.0);
  }

  TriangleStretch stretch(const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& r) const {
    const double area = ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / 2;
    if (!(area != 0)) return {0, 0, 0};
    const glm::dvec2 along_s =
        (corners[0] * (q.y - r.y) + corners[1] * (r.y - p.y) + corners[2] * (p.y - q.y)) / (2 * area);
    const glm::dvec2 along_t =
        (corners[0] * (r.x - q.x) + corners[1] * (p.x - r.x) + corners[2] * (q.x - p.x)) / (2 * area);
    const double a = glm::dot(along_s, along_s), b = glm::dot(along_s, along_t), c = glm::dot(along_t, along_t);
    return {(a + c) / 2, std::sqrt((a + c + std::sqrt((a - c) * (a - c) + 4 * b * b)) / 2), area};
  }

  std::array<glm::dvec2, 3> corners{};  // the first at the origin, the second on x, the third above

 private:
  static constexpr double kMinHeight = 1e-3;
};

}  // namespace fourdvt::track
