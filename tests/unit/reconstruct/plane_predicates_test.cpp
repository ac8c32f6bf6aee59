// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "reconstruct/hull_planes.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kMax = 1 << 29;
const Plane kX{{kMax - 1, 1, 2, 0}}, kY{{1, kMax - 3, 1, 0}}, kZ{{2, 5, kMax - 7, 0}};

int side(const Plane& a, const Plane& b, const Plane& c, const Plane& d) {
  return PlanePoint(PlaneLine(a, b), c).side(d);
}

TEST(PlanePredicates, OneUnitOfAnOffsetDecides) {
  // The three planes meet at the origin; doubles cannot distinguish 2^-29 from zero here.
  for (int unit : {-1, 0, 1}) {
    const Plane d{{kMax, -kMax + 1, kMax - 2, double(unit)}};
    EXPECT_EQ(side(kX, kY, kZ, d), unit);
    EXPECT_EQ(side(kY, kX, kZ, d), unit);
    EXPECT_EQ(side(kZ, kX, kY, d), unit);
  }
}

TEST(PlanePredicates, HeadingIsTheOrientationOfTheNormals) {
  EXPECT_EQ(PlanePoint(PlaneLine(kX, kY), kZ).heading(), 1);
  EXPECT_EQ(PlanePoint(PlaneLine(kY, kX), kZ).heading(), -1);
  const Plane in_between{{kMax / 2, kMax / 2, 0, 17}};
  EXPECT_EQ(PlanePoint(PlaneLine({{kMax, 0, 0, 1}}, {{0, kMax, 0, 2}}), in_between).heading(), 0);
  // Nearly parallel to the line, but still with a heading.
  const Plane x{{kMax, 0, 0, 1}}, y{{0, kMax, 0, 2}};
  EXPECT_EQ(PlanePoint(PlaneLine(x, y), {{kMax, kMax, 1, 0}}).heading(), 1);
  EXPECT_EQ(PlanePoint(PlaneLine(x, y), {{kMax, kMax, -1, 0}}).heading(), -1);
}

TEST(PlanePredicates, AnswersDoNotDependOnTheOrder) {
  // Planes through one point, rounded: all determinants are tiny, and many are zero in doubles.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 point(coordinate(random), coordinate(random), coordinate(random));
    Plane p[4];
    for (Plane& plane : p) {
      const glm::dvec3 n = glm::normalize(glm::dvec3(coordinate(random), coordinate(random), coordinate(random)));
      plane = Plane::rounded(n, -glm::dot(n, point));
    }
    const int expected = side(p[0], p[1], p[2], p[3]);
    EXPECT_EQ(side(p[1], p[2], p[0], p[3]), expected);
    EXPECT_EQ(side(p[2], p[1], p[0], p[3]), expected);
    EXPECT_EQ(side(p[0], p[2], p[1], p[3]), expected);
    // The same determinant with planes exchanged: D lies in front of C if C lies behind D.
    const int heading = PlanePoint(PlaneLine(p[0], p[1]), p[2]).heading();
    const int other = PlanePoint(PlaneLine(p[0], p[1]), p[3]).heading();
    EXPECT_EQ(side(p[0], p[1], p[3], p[2]) * other, -expected * heading);
    EXPECT_LT(glm::distance(PlanePoint(PlaneLine(p[0], p[1]), p[2]).position(), point), 1e-3);
  }
}

// Two planes along z whose normals, of 28 bits each, have a cross product of -1: products of 55 bits, too many for
// doubles, cancel. They meet in x = 3, y = -5.
std::array<Plane, 2> almostParallel(double m) {
  return {Plane{{m, m + 1, 0, 2 * m + 5}}, Plane{{m + 1, m + 2, 0, 2 * m + 7}}};
}

TEST(PlanePredicates, HeadingOfLinesAlmostInThePlane) {
  // The third normal is the difference of the others plus z: the determinant is -1 again, of terms of 56 bits.
  for (int i = 0; i < 200; ++i) {
    auto [a, b] = almostParallel((1 << 27) + 3 * i + 1);
    a.coefficients[2] = (1 << 28) + 7 * i + 3;
    b.coefficients[2] = (1 << 28) - 11 * i;
    const Plane c{{-1, -1, a.coefficients[2] - b.coefficients[2] + 1, 5}};
    EXPECT_EQ(PlanePoint(PlaneLine(a, b), c).heading(), -1);
    EXPECT_EQ(PlanePoint(PlaneLine(b, a), c).heading(), 1);
  }
}

TEST(PlanePredicates, AlmostParallelPlanesAreToldApart) {
  const Plane z{{0, 0, 1, -2}};
  for (int i = 0; i < 200; ++i) {
    const auto [a, b] = almostParallel((1 << 27) + 3 * i + 1);
    const PlanePoint point(PlaneLine(a, b), z);
    EXPECT_EQ(point.heading(), -1);
    EXPECT_EQ(point.position(), glm::dvec3(3, -5, 2));
    for (int unit : {-1, 0, 1}) {
      EXPECT_EQ(point.side({{1, 0, 0, -3.0 + unit}}), unit);
      EXPECT_EQ(point.side({{kMax / 2 - 1, kMax / 2 - 3, 7, kMax - 26 + unit}}), unit);
    }
  }
}

}  // namespace
}  // namespace fourdvt::reconstruct
