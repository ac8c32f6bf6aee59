// SPDX-License-Identifier: Apache-2.0
// The measures of a scene, from analytic balls; invariant under a change of units.
#include "reconstruct/scale.h"

#include <gtest/gtest.h>

#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kBall_m = 0.15;

struct Views {
  explicit Views(std::vector<silhouette::Silhouette> given) : silhouettes(std::move(given)) {
    for (const silhouette::Silhouette& s : silhouettes)
      views.push_back({&s, silhouette::SilhouetteDistance(s.coverage)});
  }
  std::vector<silhouette::Silhouette> silhouettes;
  std::vector<CarvingView> views;
};

// The same pictures, with cameras of a scene `scale` times as large.
Views scaled(const Rig& rig, double scale) {
  std::vector<silhouette::Silhouette> out = rig.silhouettes();
  for (silhouette::Silhouette& s : out) s.camera.cam_from_world[3] *= glm::dvec4(scale, scale, scale, 1);
  return Views(std::move(out));
}

TEST(SceneScale, OfABall) {
  const glm::dvec3 centre(0.05, 0.1, -0.07);
  const Views rig(Rig(ringCameras(9), ballShape(centre, kBall_m)).silhouettes());
  const auto found = scaleOf(rig.views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const SceneScale& scale = found.value();
  EXPECT_NEAR(scale.extent_m, 2 * kBall_m, 0.1 * kBall_m);
  EXPECT_NEAR(scale.area_m2, 4 * 3.14159 * kBall_m * kBall_m, 0.03);
  EXPECT_NEAR(scale.thickness_m, kBall_m, 0.05 * kBall_m);
  EXPECT_LT(glm::distance(scale.centre_in_world, centre), 0.05 * kBall_m);
  EXPECT_NEAR(scale.footprint_m, std::hypot(2, 0.6 - 0.1) / 300, 0.03 * 2 / 300);  // the cameras' focal length: 300
}

TEST(SceneScale, FollowsTheScene) {
  const Rig rig(ringCameras(7), either(ballShape({0.1, 0.3, 0}, 0.12), boxShape({-0.1, -0.3, -0.05}, {0.2, 0.2, 0.1})));
  const auto one = scaleOf(Views(rig.silhouettes()).views);
  ASSERT_TRUE(one.ok());
  for (const double s : {0.05, 20.0, 1e-3, 1e3}) {
    const Views views = scaled(rig, s);
    const auto other = scaleOf(views.views);
    ASSERT_TRUE(other.ok()) << s;
    EXPECT_NEAR(other.value().extent_m / s, one.value().extent_m, 1e-5) << s;
    EXPECT_NEAR(other.value().area_m2 / s / s, one.value().area_m2, 1e-5) << s;
    EXPECT_NEAR(other.value().thickness_m / s, one.value().thickness_m, 1e-6) << s;
    EXPECT_NEAR(other.value().footprint_m / s, one.value().footprint_m, 1e-8) << s;
  }
}

TEST(SceneScale, OfAPerformerFarOffBeforeCamerasSideBySide) {
  std::vector<PinholeCamera> cameras;
  for (int k = 0; k < 5; ++k) {
    const glm::dvec3 from(0.15 * k - 0.3, 0, 0);
    cameras.push_back(lookingAt(from + glm::dvec3(0, 0, -1), from, 320, 240, 300));
  }
  const Views rig(Rig(cameras, ballShape({0, 0, -4}, 0.1)).silhouettes());
  const auto found = scaleOf(rig.views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  // The outermost cones overlap from 3 m to 6 m.
  EXPECT_NEAR(found.value().extent_m, 3, 0.5);
  EXPECT_NEAR(found.value().footprint_m, 4.3 / 300, 0.1 * 4 / 300);
}

TEST(SceneScale, APlaceWithoutPerformerHasNone) {
  std::vector<silhouette::Silhouette> odd = Rig(ringCameras(6), ballShape({0, 0, 0}, kBall_m)).silhouettes();
  odd[2].coverage = coverageOf(odd[2].camera, ballShape({0, 0.5, 0}, kBall_m));
  const auto found = scaleOf(Views(odd).views);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().id, ErrorId::NothingVisible);
  EXPECT_NE(found.error().message.find("cam02"), std::string::npos) << found.error().message;
}

TEST(SceneScale, VoxelsFollowPixelsUntilFacesBoundThem) {
  SceneScale scale;
  scale.footprint_m = 0.004;
  scale.area_m2 = 2;
  EXPECT_DOUBLE_EQ(voxelFor(scale, 150'000), kVoxelFootprints * 0.004);
  scale.footprint_m = 0.0005;  // a surface of 3 faces per voxel's side of area: 4 × 150000 = 3 · 2 m² / voxel²
  EXPECT_NEAR(voxelFor(scale, 150'000), std::sqrt(3 * 2 / 600'000.0), 1e-9);
}

TEST(SceneScale, APersonInTheStudioGetsFiveMillimetres) {
  SceneScale scale;  // the studio's: 480 x 640 pixels, 8 cameras
  scale.footprint_m = 0.003698;
  scale.area_m2 = 1.8;
  scale.thickness_m = 0.1228;
  EXPECT_NEAR(voxelFor(scale, 150'000), 0.005, 0.0001);
  EXPECT_NEAR(metresPerPersonMetre(scale), 1, 0.01);
}

TEST(Carve, ARoomCostsLittle) {
  const auto judgedIn = [](double room_m) {
    std::vector<PinholeCamera> cameras;
    for (int k = 0; k < 8; ++k) {
      const double azimuth = 2 * 3.14159265358979 * k / 8 + 0.1;
      const glm::dvec3 from(room_m / 2 * std::sin(azimuth), 0.2 * room_m, room_m / 2 * std::cos(azimuth));
      cameras.push_back(lookingAt({0, 0, 0}, from, 240, 240, 200 * room_m / 2));
    }
    const Views rig(Rig(cameras, boxShape({-0.1, -0.4, -0.1}, {0.2, 0.4, 0.1})).silhouettes());
    const auto carved = carve(rig.views, 0.01);
    EXPECT_TRUE(carved.ok());
    return double(carved.value().cells_judged);
  };
  const double small = judgedIn(3), large = judgedIn(15);
  EXPECT_LT(large, 1.3 * small) << small;
}

}  // namespace
}  // namespace fourdvt::reconstruct
