// SPDX-License-Identifier: Apache-2.0
// On which side of a plane three other planes meet, answered exactly. A vertex of a hull is known by its planes only,
// so that whoever asks about it gets the same answer (FV96). Does NOT break ties: planes that meet in no single point,
// or four in one, give 0.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace fourdvt::reconstruct {

// n · x + d, with integers of at most 2^29 as coefficients: the determinant of four planes fits into 128 bits.
struct Plane {
  std::array<double, 4> coefficients{};  // integers; n and d

  // The plane through points with normal · x + offset = 0, rounded. The normal is a unit vector. x within [-1, 1]³ is
  // where the answers are to be good; its rounding then moves the plane by about 2^-27.
  static Plane rounded(const glm::dvec3& normal, double offset);
};

// The line in which two planes meet, directed along the cross product of their normals.
struct PlaneLine {
  PlaneLine(const Plane& first, const Plane& second);
  const Plane *first, *second;          // borrowed
  double m01, m02, m03, m12, m13, m23;  // minors of the two rows
};

// The point in which three planes meet.
class PlanePoint {
 public:
  PlanePoint() = default;
  PlanePoint(const PlaneLine& line, const Plane& third);  // borrows the planes
  // 1: the third plane's value grows along the line; -1: it falls; 0: they do not meet in a point.
  int heading() const { return heading_; }
  // The sign of n · x + d of another plane here; 0: it passes through the point.
  int side(const Plane& other) const;
  glm::dvec3 position() const;

 private:
  std::array<const Plane*, 3> planes_{};
  std::array<double, 4> homogeneous_{};
  int heading_ = 0;
};

}  // namespace fourdvt::reconstruct
