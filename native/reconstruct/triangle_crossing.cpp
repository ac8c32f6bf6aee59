// SPDX-License-Identifier: Apache-2.0
// The separating axis theorem: convex bodies are apart where their shadows on the normal of a face, or of two edges,
// are apart; for two triangles in one plane, on the normals of edges within the plane.
#include "reconstruct/triangle_crossing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt::reconstruct {
namespace {

// Unit, or zero for a triangle's side without length.
glm::dvec3 direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

// How deep the shadows of both on the axis reach into each other; infinity for an axis without direction.
double overlap(const Triangle& a, const Triangle& b, const glm::dvec3& axis) {
  const double length = glm::length(axis);
  if (length < 1e-150) return std::numeric_limits<double>::infinity();
  const glm::dvec3 unit = axis / length;
  const glm::dvec3& origin = a[0];  // small numbers round less
  const auto shadow = [&](const Triangle& t) {
    const double p = glm::dot(t[0] - origin, unit), q = glm::dot(t[1] - origin, unit),
                 r = glm::dot(t[2] - origin, unit);
    return glm::dvec2(std::min({p, q, r}), std::max({p, q, r}));
  };
  const glm::dvec2 of_a = shadow(a), of_b = shadow(b);
  return std::min(of_a.y - of_b.x, of_b.y - of_a.x);
}

}  // namespace

double crossingDepth(const Triangle& a, const Triangle& b, double tolerance) {
  glm::dvec3 edges_a[3], edges_b[3];
  for (int i = 0; i < 3; ++i) {
    edges_a[i] = direction(a[(i + 1) % 3] - a[i]);
    edges_b[i] = direction(b[(i + 1) % 3] - b[i]);
  }
  const glm::dvec3 normal_a = glm::cross(edges_a[0], edges_a[1]), normal_b = glm::cross(edges_b[0], edges_b[1]);
  double depth = std::numeric_limits<double>::infinity();
  const auto apart = [&](const glm::dvec3& axis) {
    depth = std::min(depth, overlap(a, b, axis));
    return depth <= tolerance;
  };
  // A triangle in the plane of another has no depth along its normal; within the plane it may have.
  const auto spread = [&](const Triangle& of, const Triangle& from, const glm::dvec3& normal) {
    double most = 0;
    for (const glm::dvec3& p : of) most = std::max(most, std::abs(glm::dot(p - from[0], direction(normal))));
    return most;
  };
  const bool flat = glm::length(normal_a) > 0 && glm::length(normal_b) > 0 && spread(b, a, normal_a) <= tolerance &&
                    spread(a, b, normal_b) <= tolerance;
  if (flat && glm::dot(normal_a, normal_b) < 0) return 0;  // the two sides of a sheet
  if (!flat && (apart(normal_a) || apart(normal_b))) return 0;
  for (int i = 0; i < 3; ++i) {
    if (apart(glm::cross(normal_a, edges_a[i])) || apart(glm::cross(normal_b, edges_b[i]))) return 0;
    for (int k = 0; k < 3 && !flat; ++k)
      if (apart(glm::cross(edges_a[i], edges_b[k]))) return 0;
  }
  return std::isfinite(depth) ? depth : 0;  // points have no depth
}

}  // namespace fourdvt::reconstruct
