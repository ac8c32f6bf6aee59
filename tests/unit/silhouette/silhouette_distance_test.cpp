// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "silhouette/silhouette.h"

namespace fourdvt::silhouette {
namespace {

// Coverage of the half plane n · p < d, 16 × 16 samples per pixel, with a border of background.
Image halfPlane(double angle, double d, int side = 64) {
  Image out(side, side, 1);
  for (int y = 4; y < side - 4; ++y)
    for (int x = 4; x < side - 4; ++x) {
      int hits = 0;
      for (int k = 0; k < 256; ++k)
        hits += std::cos(angle) * (x + (k % 16 + 0.5) / 16) + std::sin(angle) * (y + (k / 16 + 0.5) / 16) < d;
      *out.at(x, y) = uint8_t(std::lround(hits * 255 / 256.0));
    }
  return out;
}

TEST(SilhouetteDistance, IsExactNearStraightEdges) {
  for (const double angle : {0.0, 0.3, 0.8, 1.3}) {
    const double d = 32.3 * (std::cos(angle) + std::sin(angle));
    const SilhouetteDistance distance(halfPlane(angle, d));
    double worst = 0, worst_near = 0;
    for (double y = 24; y < 40; y += 0.7)
      for (double x = 24; x < 40; x += 0.7) {
        const double exact = d - (std::cos(angle) * x + std::sin(angle) * y);
        const double error = std::abs(distance.at(x, y) - exact);
        if (std::abs(exact) < 1.5) worst_near = std::max(worst_near, error);
        if (std::abs(exact) < 6) worst = std::max(worst, error);
      }
    EXPECT_LT(worst_near, 0.15) << "at " << angle;
    EXPECT_LT(worst, 0.4) << "at " << angle;
  }
}

TEST(SilhouetteDistance, BeyondTheMarginIsNeverFartherThanTheOutline) {
  Image disc(400, 300, 1);
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; ++x)
      if (std::hypot(x - 90, y - 80) < 20) *disc.at(x, y) = 255;
  const SilhouetteDistance distance(disc);
  for (double y = 1; y < 300; y += 13)
    for (double x = 1; x < 400; x += 11) {
      const double exact = 20 - std::hypot(x - 90.5, y - 80.5);
      if (exact > -10) continue;
      EXPECT_GT(distance.at(x, y), exact - 1.5) << x << " " << y;
      EXPECT_LT(distance.at(x, y), 0);
    }
}

TEST(SilhouetteDistance, APerformerOnTheBorderReachesToThePicturesEdge) {
  Image bar(64, 48, 1);  // crosses the picture from left to right
  for (int y = 20; y < 30; ++y)
    for (int x = 0; x < 64; ++x) *bar.at(x, y) = 255;
  const SilhouetteDistance distance(bar);
  for (const double x : {0.0, 0.2, 0.5, 32.0, 63.6, 64.0}) {
    EXPECT_NEAR(distance.at(x, 23.5), 3.5, 0.1) << x;
    EXPECT_NEAR(distance.at(x, 18), -2, 0.1) << x;
  }
}

TEST(SilhouetteDistance, KnowsNothingOutsideThePicture) {
  const SilhouetteDistance distance(halfPlane(0, 30));
  EXPECT_EQ(distance.at(-0.1, 10), SilhouetteDistance::kOutside);
  EXPECT_EQ(distance.at(10, 64.1), SilhouetteDistance::kOutside);
}

TEST(SilhouetteDistance, EmptyAndFullPicturesHaveNoOutline) {
  const SilhouetteDistance empty(Image(8, 8, 1, 0)), full(Image(8, 8, 1, 255));
  EXPECT_TRUE(empty.empty());
  EXPECT_LT(empty.at(4, 4), -1000);
  EXPECT_TRUE(full.full());
  EXPECT_GT(full.at(4, 4), 1000);
  EXPECT_NE(full.at(4, 4), SilhouetteDistance::kOutside);
}

}  // namespace
}  // namespace fourdvt::silhouette
