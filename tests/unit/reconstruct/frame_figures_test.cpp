// SPDX-License-Identifier: Apache-2.0
// Measurements of frames, and of the surface against hull and silhouettes.
#include "reconstruct/run/frame_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reconstruct/run/silhouette_match.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

TEST(FrameFigures, TextHasNullForWhatIsNoNumber) {
  FrameFigures f;
  f.overlap = {0.5, std::numeric_limits<double>::quiet_NaN()};
  const std::string text = figuresText(f);
  EXPECT_NE(text.find(R"("overlap":[0.5,null])"), std::string::npos) << text;
}

// Square upright plate facing the camera, `side_m` wide, at z.
TriangleMesh plate(double side_m, double z) {
  const float s = float(side_m / 2), at = float(z);
  TriangleMesh out;
  out.positions = {{-s, -s, at}, {s, -s, at}, {s, s, at}, {-s, s, at}};
  out.faces = {{0, 1, 2}, {0, 2, 3}};
  return out;
}

TEST(SilhouetteMatch, OutlineDistanceIsThatOfTwoSquares) {
  // 2 m away at a focal length of 300: 150 pixels per metre. Sides of 96 and 90 pixels.
  const PinholeCamera camera = lookingAt({0, 0, 0}, {0, 0, 2}, 200, 200, 300);
  const silhouette::Silhouette silhouette{camera, coverageOf(camera, boxShape({-0.32, -0.32, -1e-6}, {0.32, 0.32, 0}))};
  const SilhouetteMatch same = silhouetteMatch(silhouette, plate(0.64, 0));
  EXPECT_GT(same.overlap, 0.99);
  EXPECT_LT(same.outline_px, 0.3);
  const SilhouetteMatch smaller = silhouetteMatch(silhouette, plate(0.60, 0));
  EXPECT_NEAR(smaller.overlap, 90.0 * 90 / (96 * 96), 0.01);
  EXPECT_NEAR(smaller.outline_px, 3, 0.3);
  EXPECT_TRUE(std::isnan(silhouetteMatch(silhouette, TriangleMesh()).outline_px));
}

TEST(SilhouetteMatch, MovedIsWhatLiesDeeperOrIsGone) {
  const PinholeCamera camera = lookingAt({0, 0, 0}, {0, 0, 2}, 200, 200, 300);
  const TriangleMesh hull = plate(0.64, 0);
  EXPECT_EQ(movedShare(camera, hull, hull, 0.003), 0);
  EXPECT_EQ(movedShare(camera, hull, plate(1, -0.002), 0.003), 0);
  EXPECT_EQ(movedShare(camera, hull, plate(1, -0.004), 0.003), 1);
  EXPECT_NEAR(movedShare(camera, hull, plate(0.32, 0), 0.003), 0.75, 0.02);
  EXPECT_EQ(movedShare(camera, hull, TriangleMesh(), 0.003), 1);
  EXPECT_EQ(movedShare(camera, TriangleMesh(), hull, 0.003), 0);
}

}  // namespace
}  // namespace fourdvt::reconstruct
