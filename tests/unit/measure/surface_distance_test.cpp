// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/surface_distance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fourdvt::measure {
namespace {

// Square of 1 m in the plane y = height, 2 · n · n faces, first corner at x = from.
TriangleMesh square(float height, float from = 0, int n = 4) {
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) mesh.positions.push_back({from + float(i) / n, height, float(k) / n});
  const auto at = [&](int i, int k) { return uint32_t(i * (n + 1) + k); };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      mesh.faces.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      mesh.faces.push_back({at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)});
    }
  return mesh;
}

TEST(SurfaceDistance, ParallelSquaresAreAsFarApartEverywhere) {
  const DistanceFigures figures = surfaceDistance(square(0), square(0.07f), 0.02);
  EXPECT_NEAR(figures.mean_m, 0.07, 1e-6);
  EXPECT_NEAR(figures.median_m, 0.07, 1e-6);
  EXPECT_NEAR(figures.p95_m, 0.07, 1e-6);
}

TEST(SurfaceDistance, ReachesEdgesAndCornersFromBeyond) {
  const DistanceToSurface distance(square(0));
  EXPECT_NEAR(distance.at({0.5, 0, 0.5}), 0, 1e-9);
  EXPECT_NEAR(distance.at({-0.3, 0.4, 0.5}), 0.5, 1e-9);
  EXPECT_NEAR(distance.at({1.2, 0.1, 1.2}), std::sqrt(0.04 + 0.04 + 0.01), 1e-6);
  EXPECT_EQ(distance.at({9, 9, 9}, 0.5), 0.5) << "no farther than the limit";
}

TEST(SurfaceDistance, HalfOfAShiftedSquareLiesApart) {
  // Points of the shifted square beyond the other's edge: distances from 0 to 0.5 m, uniform.
  const DistanceFigures figures = surfaceDistance(square(0, 0.5f), square(0), 0.01);
  EXPECT_NEAR(figures.mean_m, 0.125, 0.005);
  EXPECT_NEAR(figures.median_m, 0, 0.02);
  EXPECT_NEAR(figures.p95_m, 0.45, 0.01);
}

TEST(SurfaceDistance, PointsAreSpreadEvenlyWhateverTheFacesSize) {
  const size_t coarse = pointsOn(square(0, 0, 1), 0.02).size(), fine = pointsOn(square(0, 0, 40), 0.02).size();
  EXPECT_NEAR(double(coarse), 2500, 5);
  EXPECT_NEAR(double(fine), 2500, 5);
}

TEST(SurfaceDistance, FacesOfAnySizeAreHeldInBoundedMemory) {
  TriangleMesh huge = square(0);
  for (glm::vec3& p : huge.positions) p *= 1e5f;  // 100 km: wrong units
  EXPECT_NEAR(DistanceToSurface(huge).at({5e4, 0.3, 5e4}), 0.3, 1e-3);
}

}  // namespace
}  // namespace fourdvt::measure
