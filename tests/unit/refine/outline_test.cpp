// SPDX-License-Identifier: Apache-2.0
#include "refine/outline.h"

#include <gtest/gtest.h>

#include "sphere_fixture.h"

namespace fourdvt::refine {
namespace {

std::vector<OutlinePoint> measure(const BallMesh& mesh, const MatteCrop& matte, const OutlineOptions& options = {}) {
  return outlinePoints(ballCamera(0, 8), mesh.faces, mesh.edges, mesh.positions, mesh.normals, matte, options);
}

TEST(Outline, ClosedMeshHasOneInnerEdgeForEveryTwoCorners) {
  const BallMesh mesh = ballMesh(1, 2);
  EXPECT_EQ(mesh.edges.size(), mesh.faces.size() * 3 / 2);
}

TEST(Outline, ResidualIsTheDistanceBetweenTheCircles) {
  // 4 mm on a ball 4 m away, with f = 1500: 1.5 pixels.
  const double expected = kBallFocal * 0.004 / kBallDistance_m;
  const auto too_large = measure(ballMesh(kBallRadius_m + 0.004, 5), ballMatte());
  ASSERT_GT(too_large.size(), 300u);
  EXPECT_NEAR(medianResidual(too_large), -expected, 0.08);
  EXPECT_NEAR(medianResidual(measure(ballMesh(kBallRadius_m - 0.004, 5), ballMatte())), expected, 0.08);
  EXPECT_NEAR(medianResidual(measure(ballMesh(kBallRadius_m, 5), ballMatte())), 0, 0.08);
}

TEST(Outline, ResidualInMetresIsTheOffsetThatIsMissing) {
  for (const OutlinePoint& s : measure(ballMesh(kBallRadius_m + 0.004, 5), ballMatte()))
    EXPECT_NEAR(s.residual_pixels / s.pixels_per_metre, -0.004, 0.0012);
}

TEST(Outline, MatteBiasIsTakenOff) {
  OutlineOptions options;
  options.matte_bias_pixels = -2;
  EXPECT_NEAR(medianResidual(measure(ballMesh(kBallRadius_m, 5), ballMatte(-2), options)), 0, 0.08);
  EXPECT_NEAR(medianResidual(measure(ballMesh(kBallRadius_m, 5), ballMatte(-2))), -2, 0.08);
}

TEST(Outline, NothingIsSaidBeyondReachOrWithoutAMatte) {
  OutlineOptions options;
  options.reach_pixels = 3;
  EXPECT_TRUE(measure(ballMesh(kBallRadius_m, 5), ballMatte(-6), options).empty());
  EXPECT_TRUE(measure(ballMesh(kBallRadius_m, 5), MatteCrop{Image(20, 20, 1, 0), 100, 100}).empty());
  EXPECT_TRUE(measure(ballMesh(kBallRadius_m, 5), MatteCrop{}).empty());
}

TEST(Outline, FigureThatThePictureCutsOffHasNoEdgeThere) {
  // The camera looks aside, so that half of the ball lies outside the picture.
  PinholeCamera camera = ballCamera(0, 8);
  camera.cx = 20;
  const MatteCrop whole = ballMatte();
  MatteCrop half;
  half.alpha = Image(kBallPicture, kBallPicture, 1);
  for (int y = 0; y < kBallPicture; ++y)
    for (int x = 0; x + kBallPicture / 2 - 20 < kBallPicture; ++x)
      *half.alpha.at(x, y) = *whole.alpha.at(x + kBallPicture / 2 - 20, y);
  const BallMesh mesh = ballMesh(kBallRadius_m, 5);
  const auto points = outlinePoints(camera, mesh.faces, mesh.edges, mesh.positions, mesh.normals, half, {});
  ASSERT_GT(points.size(), 100u);
  for (const OutlinePoint& p : points) EXPECT_LT(std::abs(p.residual_pixels), 1);
}

TEST(Outline, MatteCropReadsBetweenPixelsAndZeroOutside) {
  MatteCrop crop{Image(2, 1, 1), 10, 20};
  *crop.alpha.at(0, 0) = 100;
  *crop.alpha.at(1, 0) = 200;
  EXPECT_FLOAT_EQ(crop.at(10.5f, 20.5f), 100);
  EXPECT_FLOAT_EQ(crop.at(11, 20.5f), 150);
  EXPECT_FLOAT_EQ(crop.at(11.5f, 21), 100);
  EXPECT_FLOAT_EQ(crop.at(5, 5), 0);
}

TEST(Outline, EdgesInsideTheOutlineDoNotCount) {
  // A small ball in front of the large one: its outline lies inside.
  BallMesh both = ballMesh(kBallRadius_m);
  const BallMesh small = ballMesh(0.1, 3);
  const size_t large_samples = measure(both, ballMatte()).size();
  const PinholeCamera camera = ballCamera(0, 8);
  const glm::vec3 before(camera.centreInWorld() * 0.3);
  const uint32_t first = uint32_t(both.positions.size());
  for (const glm::vec3& p : small.positions) both.positions.push_back(p + before);
  for (const glm::uvec3& f : small.faces) both.faces.push_back(f + first);
  computeVertexNormals(both.faces, both.positions.data(), both.positions.size(), both.normals);
  both.edges = innerEdges(both.faces);
  EXPECT_EQ(measure(both, ballMatte()).size(), large_samples);
}

}  // namespace
}  // namespace fourdvt::refine
