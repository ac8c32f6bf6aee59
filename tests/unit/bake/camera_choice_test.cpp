// SPDX-License-Identifier: Apache-2.0
// Selection of a character's cameras among many: spread in direction, none that shows little of the surface.
#include "bake/method/camera_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "look_at.h"

namespace fourdvt::bake {
namespace {

using Cameras = std::vector<PinholeCamera>;

// A box round the origin, by its corners and their middles.
Positions box() {
  Positions out;
  for (int k = 0; k < 27; ++k) out.emplace_back(0.3f * (k % 3 - 1), 0.8f * (k / 3 % 3 - 1), 0.2f * (k / 9 - 1));
  return out;
}

PinholeCamera cameraAt(double azimuth_deg, double focal_px = 400) {
  const double a = azimuth_deg * 3.14159265358979 / 180;
  PinholeCamera camera = testing::lookAt({3 * std::sin(a), 0, 3 * std::cos(a)}, {0, 0, 0}, 480, 640, focal_px);
  camera.name = "at" + std::to_string(int(std::lround(azimuth_deg)));
  return camera;
}

Cameras ringOf(int count) {
  Cameras out;
  for (int k = 0; k < count; ++k) out.push_back(cameraAt(360.0 * k / count));
  return out;
}

TEST(CameraChoice, AllWhereTheyFit) {
  EXPECT_EQ(chooseCameras(ringOf(4), box(), 4), (std::vector<size_t>{0, 1, 2, 3}));
}

TEST(CameraChoice, FourOfAFineRingStandAQuarterApart) {
  for (const int count : {64, 128}) {
    const auto chosen = chooseCameras(ringOf(count), box(), 4);
    ASSERT_EQ(chosen.size(), 4u);
    for (size_t k = 0; k < 4; ++k) EXPECT_EQ(chosen[k] - chosen[0], k * count / 4) << count;
  }
}

TEST(CameraChoice, ThirtyOneOfAHundredAndTwentyEightLeaveNoGap) {
  const auto chosen = chooseCameras(ringOf(128), box(), 31);
  ASSERT_EQ(chosen.size(), 31u);
  for (size_t k = 0; k < chosen.size(); ++k) {  // mean spacing 4.1 of 128; farthest points keep within twice it
    const size_t next = k + 1 < chosen.size() ? chosen[k + 1] : chosen[0] + 128;
    EXPECT_LE(next - chosen[k], 8u);
  }
  EXPECT_EQ(chosen, chooseCameras(ringOf(128), box(), 31));
}

TEST(CameraChoice, CamerasThatShowLittleAreLeftOut) {
  Cameras cameras = ringOf(8);
  cameras[2].cx = 480 + 100;  // only the box's edge lies inside the right border
  cameras[5].cam_from_world = testing::lookAt({-3, 0, 0}, {-6, 0, 0}, 480, 640, 400).cam_from_world;  // looks away
  const auto chosen = chooseCameras(cameras, box(), 6);
  EXPECT_EQ(chosen, (std::vector<size_t>{0, 1, 3, 4, 6, 7}));
}

TEST(CameraChoice, PixelsOutweighAFewDegrees) {
  const Cameras cameras{cameraAt(0),  cameraAt(180, 150), cameraAt(170), cameraAt(90, 150),
                        cameraAt(80), cameraAt(270, 150), cameraAt(260)};
  EXPECT_EQ(chooseCameras(cameras, box(), 4), (std::vector<size_t>{0, 2, 4, 6}));
}

TEST(CameraChoice, ByNameInTheCapturesOrder) {
  const Cameras cameras = ringOf(4);
  const auto found = camerasByName(cameras, {"at270", "at0", "at270"});
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found.value(), (std::vector<size_t>{0, 3}));
  const auto none = camerasByName(cameras, {"at0", "left"});
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().id, ErrorId::InvalidArgument);
  for (const char* part : {"\"left\"", "at0, at90, at180, at270"})
    EXPECT_NE(none.error().message.find(part), std::string::npos) << none.error().message;
}

}  // namespace
}  // namespace fourdvt::bake
