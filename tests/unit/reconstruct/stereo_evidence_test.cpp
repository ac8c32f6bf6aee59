// SPDX-License-Identifier: Apache-2.0
// Evidence that weights a depth: contrast, and confirmation by other cameras.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "look_at.h"
#include "reconstruct/stereo/plane_sweep.h"
#include "reconstruct/stereo/stereo_refiner.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kSide = 64;

// RGBA picture, opaque in its middle half; `grey`: by column and row.
Image picture(const std::function<double(int, int)>& grey) {
  Image out(kSide, kSide, 4);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const bool inside = x >= kSide / 4 && y >= kSide / 4 && x < 3 * kSide / 4 && y < 3 * kSide / 4;
      for (int k = 0; k < 3; ++k) out.at(x, y)[k] = inside ? uint8_t(grey(x, y) + 0.5) : uint8_t(k == 1 ? 255 : 0);
      out.at(x, y)[3] = inside ? 255 : 0;
    }
  return out;
}

float inTheMiddle(const Image& image) { return textureOf(image)[kSide / 2 * kSide + kSide / 2]; }

TEST(StereoTexture, FlatColourSlowShadingAndNoiseShowNothing) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1.2);  // 2.4 levels in pictures of twice the size
  for (const float t : {inTheMiddle(picture([](int, int) { return 120; })),
                        inTheMiddle(picture([](int x, int y) { return 60 + 1.5 * x + 0.5 * y; })),
                        inTheMiddle(picture([&](int, int) { return 120 + noise(random); }))})
    EXPECT_LT(t, 0.08f);
}

// A checkerboard of ±a: 3 a² in three channels, all of it detail except the 5 × 5 mean's (a / 25)².
TEST(StereoTexture, ContrastShows) {
  float last = 0;
  for (const double a : {3.0, 6.0, 20.0}) {
    const float t = inTheMiddle(picture([=](int x, int y) { return 120 + ((x + y) % 2 ? a : -a); }));
    EXPECT_GT(t, last);
    last = t;
  }
  EXPECT_GT(last, 0.95f);
}

// The outline is the strongest edge of all, but gives no evidence of depth.
TEST(StereoTexture, TheOutlineIsNoTexture) {
  const std::vector<float> texture = textureOf(picture([](int, int) { return 120; }));
  for (const float t : texture) ASSERT_LT(t, 0.01f);
}

TEST(StereoTexture, WeighsAndForgets) {
  DepthMap map;
  map.x = map.y = kSide / 2 - 1, map.width = map.height = 2;
  map.depth_m.assign(4, 1), map.weight.assign(4, 0.5f), map.front_m.assign(4, 1);
  DepthMap flat = map;
  weighByTexture(picture([](int x, int y) { return (x + y) % 2 ? 160 : 80; }), map);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(map.weight[i], 0.5f, 0.01f);
    EXPECT_EQ(map.depth_m[i], 1);
  }
  weighByTexture(picture([](int, int) { return 120; }), flat);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(flat.weight[i], 0);
    EXPECT_EQ(flat.depth_m[i], 0);
  }
}

// Cameras on an arc of 20 degrees in front of the wall z = 0, whose depth maps are `wrong_m` too large or too small in
// a share of their pixels.
std::vector<DepthMap> wall(double share, double wrong_m) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> chance(0, 1);
  std::vector<DepthMap> out;
  for (int k = 0; k < 4; ++k) {
    DepthMap& map = out.emplace_back();
    const double angle = 0.1 * k;
    map.camera = testing::lookAt({2 * std::sin(angle), 0, 2 * std::cos(angle)}, {0, 0, 0}, kSide, kSide, 200);
    map.width = map.height = kSide;
    const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(map.camera.cam_from_world));
    const glm::dvec3 eye = map.camera.centreInWorld();
    for (int i = 0; i < kSide * kSide; ++i) {
      const glm::dvec3 ray = world_from_cam * glm::dvec3((i % kSide + 0.5 - map.camera.cx) / map.camera.fx,
                                                         (i / kSide + 0.5 - map.camera.cy) / map.camera.fy, 1);
      const double off = chance(random) < share ? wrong_m * (2 * chance(random) - 1) : 0;
      map.depth_m.push_back(float(-eye.z / ray.z + off));
      map.weight.push_back(1), map.front_m.push_back(1);
    }
  }
  return out;
}

double meanWeight(std::vector<DepthMap> maps) {
  keepConsistent(maps, 0.01);
  double sum = 0;
  for (const DepthMap& map : maps)
    for (const float w : map.weight) sum += w / double(map.weight.size() * maps.size());
  return sum;
}

TEST(StereoAgreement, DepthsThatOthersConfirmStay) {
  EXPECT_GT(meanWeight(wall(0, 0)), 0.95);
  EXPECT_GT(meanWeight(wall(0.1, 0.1)), 0.6);
}

// Scatter of a decimetre in all maps: some depths agree by chance. All are rejected.
TEST(StereoAgreement, MapsThatAgreeByChanceAreNotBelieved) { EXPECT_EQ(meanWeight(wall(1, 0.1)), 0); }

}  // namespace
}  // namespace fourdvt::reconstruct
