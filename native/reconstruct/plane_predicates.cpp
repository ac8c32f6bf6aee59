// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/plane_predicates.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::reconstruct {
namespace {

__extension__ typedef __int128 Int128;

constexpr double kUnitBits = 27, kMostBits = 29;
// Bounds of what doubles get wrong, for coefficients up to M = 2^29 and half a unit in the last place u = 2^-53. A
// minor of two rows is off by at most 4uM², one of three rows by 30uM³, and the determinant by 216uM⁴.
const double kDoubt3 = std::ldexp(32.0, int(3 * kMostBits) - 53);
const double kDoubt4 = std::ldexp(256.0, int(4 * kMostBits) - 53);
// A point is read from doubles where its weight is this certain: the position is then off by less than 2^-34.
const double kClearWeight = std::ldexp(1.0, int(3 * kMostBits) - 16);

int signOf(Int128 value) { return (value > 0) - (value < 0); }

// The determinants of three rows without column 0, 1, 2 and 3, signed so that their dot product with a fourth row is
// the determinant of all four.
std::array<Int128, 4> exactPoint(const std::array<const Plane*, 3>& planes) {
  int64_t a[4], b[4], c[4];
  for (int i = 0; i < 4; ++i) {
    a[i] = int64_t(planes[0]->coefficients[i]);
    b[i] = int64_t(planes[1]->coefficients[i]);
    c[i] = int64_t(planes[2]->coefficients[i]);
  }
  const auto minor = [&](int i, int j) { return Int128(a[i] * b[j] - a[j] * b[i]); };
  const Int128 m01 = minor(0, 1), m02 = minor(0, 2), m03 = minor(0, 3), m12 = minor(1, 2), m13 = minor(1, 3),
               m23 = minor(2, 3);
  return {-(c[1] * m23 - c[2] * m13 + c[3] * m12), c[0] * m23 - c[2] * m03 + c[3] * m02,
          -(c[0] * m13 - c[1] * m03 + c[3] * m01), c[0] * m12 - c[1] * m02 + c[2] * m01};
}

}  // namespace

Plane Plane::rounded(const glm::dvec3& normal, double offset) {
  const double scale = std::min(std::ldexp(1.0, int(kUnitBits)), std::ldexp(1.0, int(kMostBits)) / std::abs(offset));
  return {{std::round(normal.x * scale), std::round(normal.y * scale), std::round(normal.z * scale),
           std::round(offset * scale)}};
}

PlaneLine::PlaneLine(const Plane& first_plane, const Plane& second_plane) : first(&first_plane), second(&second_plane) {
  const auto &a = first->coefficients, &b = second->coefficients;
  m01 = a[0] * b[1] - a[1] * b[0];
  m02 = a[0] * b[2] - a[2] * b[0];
  m03 = a[0] * b[3] - a[3] * b[0];
  m12 = a[1] * b[2] - a[2] * b[1];
  m13 = a[1] * b[3] - a[3] * b[1];
  m23 = a[2] * b[3] - a[3] * b[2];
}

PlanePoint::PlanePoint(const PlaneLine& line, const Plane& third) : planes_{line.first, line.second, &third} {
  const auto& c = third.coefficients;
  homogeneous_ = {
      -(c[1] * line.m23 - c[2] * line.m13 + c[3] * line.m12), c[0] * line.m23 - c[2] * line.m03 + c[3] * line.m02,
      -(c[0] * line.m13 - c[1] * line.m03 + c[3] * line.m01), c[0] * line.m12 - c[1] * line.m02 + c[2] * line.m01};
  const double weight = homogeneous_[3];
  heading_ = std::abs(weight) > kDoubt3 ? (weight > 0 ? 1 : -1) : signOf(exactPoint(planes_)[3]);
}

int PlanePoint::side(const Plane& other) const {
  const auto& d = other.coefficients;
  const auto& x = homogeneous_;
  const double determinant = x[0] * d[0] + x[1] * d[1] + x[2] * d[2] + x[3] * d[3];
  if (std::abs(determinant) > kDoubt4) return determinant > 0 ? heading_ : -heading_;
  const std::array<Int128, 4> exact = exactPoint(planes_);
  Int128 sum = 0;
  for (int i = 0; i < 4; ++i) sum += exact[i] * Int128(int64_t(d[i]));
  return signOf(sum) * heading_;
}

glm::dvec3 PlanePoint::position() const {
  const auto& x = homogeneous_;
  if (std::abs(x[3]) > kClearWeight) return glm::dvec3(x[0], x[1], x[2]) / x[3];
  const std::array<Int128, 4> exact = exactPoint(planes_);
  return glm::dvec3(double(exact[0]), double(exact[1]), double(exact[2])) / double(exact[3]);
}

}  // namespace fourdvt::reconstruct
