// SPDX-License-Identifier: Apache-2.0
// The figures' region, computed by hand: its place, and the moments when its size changes.
#include <gtest/gtest.h>

#include "../look_at.h"
#include "render/passes.h"

namespace fourdvt::render {
namespace {

class FigureRegionTest : public ::testing::Test {
 protected:
  // View from `distance_m` in front of a box of 1 m × 2 m × 1 m that stands at (x, 0, 0).
  bool update(double distance_m, float x = 0, bool all = false) {
    Figure figure{&model_};
    figure.world_from_character[3] = {x, 0, 0, 1};
    const auto camera = testing::lookAt({0, 1, distance_m}, {0, 1, 0}, 1000, 800, 800);
    return region_.update({&figure, 1}, viewFromCamera(camera), all);
  }
  void expectSize(int width, int height) const {
    EXPECT_EQ(region_.region().width, width);
    EXPECT_EQ(region_.region().height, height);
  }
  // Expects the bounds' front side, 0.5 m nearer than their centre, inside the region.
  void expectHolds(double distance_m, double x) const {
    const double px_per_m = 800 / (distance_m - 0.5), middle = 500 + px_per_m * x;
    const gpu::Region& r = region_.region();
    EXPECT_LE(r.x, std::max(0.0, middle - px_per_m / 2));
    EXPECT_GE(r.x + r.width, std::min(1000.0, middle + px_per_m / 2));
    EXPECT_LE(r.y, 400 - px_per_m);
    EXPECT_GE(r.y + r.height, 400 + px_per_m);
    EXPECT_GE(r.x, 0);
    EXPECT_GE(r.y, 0);
    EXPECT_LE(r.x + r.width, 1000);
    EXPECT_LE(r.y + r.height, 800);
  }

  CharacterModel model_ = [] {
    CharacterModel model;
    model.frame_bounds = {{-0.5f, 0, -0.5f}, {0.5f, 2, 0.5f}};
    return model;
  }();
  FigureRegion region_;
};

TEST_F(FigureRegionTest, holdsTheBoundsInSteps) {
  EXPECT_TRUE(update(4.5));  // 200 × 400 pixels
  expectSize(256, 448);
  expectHolds(4.5, 0);
  for (const float x : {0.7f, -1.1f, 2.1f, -2.3f, 2.4f}) {
    EXPECT_FALSE(update(4.5, x));
    expectHolds(4.5, x);
  }
  EXPECT_FALSE(region_.isWhole());
}

TEST_F(FigureRegionTest, growsAtOnceAndShrinksWhenMuchIsSpareForLong) {
  update(8.5);
  expectSize(128, 256);
  EXPECT_TRUE(update(4.5));
  expectSize(256, 448);
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(update(5.5));  // 160 × 320: more than half of the area in steps
  for (int i = 0; i < 249; ++i) EXPECT_FALSE(update(8.5));
  EXPECT_FALSE(update(4.5));
  for (int i = 0; i < 249; ++i) EXPECT_FALSE(update(8.5));
  EXPECT_TRUE(update(8.5));
  expectSize(128, 256);
  expectHolds(8.5, 0);
}

TEST_F(FigureRegionTest, isTheWholeViewWhereBoundsReachBehindTheEye) {
  EXPECT_TRUE(update(0.4));
  EXPECT_TRUE(region_.isWhole());
  expectSize(1000, 800);
}

TEST_F(FigureRegionTest, isTheWholeViewOnDemandOrIfItIsNearlyThat) {
  update(4.5, 0, true);
  EXPECT_TRUE(region_.isWhole());
  region_ = {};
  update(1.3);  // 1000 × 2000
  EXPECT_TRUE(region_.isWhole());
}

TEST_F(FigureRegionTest, liesInTheViewWhereNoFigureIs) {
  update(4.5, 50);
  expectSize(64, 448);
  EXPECT_EQ(region_.region().x, 1000 - 64);
  region_ = {};
  region_.update({}, viewFromCamera(testing::lookAt({0, 1, 3}, {0, 1, 0}, 40, 30, 50)), false);
  expectSize(40, 30);
  EXPECT_TRUE(region_.isWhole());
}

}  // namespace
}  // namespace fourdvt::render
