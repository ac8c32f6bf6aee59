// SPDX-License-Identifier: Apache-2.0
#include "live/camera/keyer.h"

#include <gtest/gtest.h>

#include <numbers>

#include "silhouette/contour.h"
#include "stage_fixture.h"

namespace fourdvt::live {
namespace {

using namespace fourdvt::live::testing;

constexpr Colour kRed{170, 40, 45}, kDark{35, 35, 42}, kWhite{235, 235, 235};

Image keyOf(const std::vector<Image>& plates, const Image& picture) {
  auto keyer = Keyer::create(plates);
  EXPECT_TRUE(keyer.ok());
  const auto coverage = keyer.value()->key(picture);
  EXPECT_TRUE(coverage.ok());
  return *coverage.value();
}

size_t covered(const Image& coverage) {
  return size_t(std::count_if(coverage.pixels.begin(), coverage.pixels.end(), [](uint8_t c) { return c >= 128; }));
}

// Largest distance between the outline and the circle, without the ring along the picture's border.
double outlineError_px(const Image& coverage, const glm::dvec2& centre, double radius_px) {
  double worst = 0;
  size_t points = 0;
  for (const auto& ring : silhouette::outlineOf(coverage, {0, 4}).rings)
    for (const glm::dvec2& p : ring) {
      if (p.x < 1 || p.y < 1 || p.x > coverage.width - 1 || p.y > coverage.height - 1) continue;
      worst = std::max(worst, std::abs(glm::length(p - centre) - radius_px));
      ++points;
    }
  EXPECT_GT(points, 2 * std::numbers::pi * radius_px / 2);
  return worst;
}

class KeyerSizes : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(KeyerSizes, OutlinesADiscToAboutHalfAPixel) {
  const auto [width, height] = GetParam();
  const glm::dvec2 centre(0.45 * width + 0.3, 0.5 * height + 0.2);
  const double radius_px = 0.25 * height + 0.4;
  for (const Image& plate : {wallPlate(width, height), greenPlate(width, height)})
    for (const Colour& colour : {kRed, kDark, kWhite}) {
      Image picture = plate;
      paintDisc(picture, centre, radius_px, colour);
      const Image coverage = keyOf({plate}, picture);
      EXPECT_GT(discIou(coverage, centre, radius_px), 0.985) << colour[0];
      EXPECT_LT(outlineError_px(coverage, centre, radius_px), 0.55) << colour[0];
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, KeyerSizes,
                         ::testing::Values(std::pair(320, 240), std::pair(322, 243), std::pair(640, 480),
                                           std::pair(961, 543)));

TEST(Keyer, SeesNothingOnTheEmptyStage) {
  const Image plate = wallPlate(320, 240);
  EXPECT_EQ(covered(keyOf({plate}, plate)), 0u);
  Image noisy = plate;
  addNoise(noisy, 5, 3);
  EXPECT_EQ(covered(keyOf({plate}, noisy)), 0u);
}

TEST(Keyer, SeesADiscThroughNoise) {
  const Image plate = wallPlate(320, 240);
  const glm::dvec2 centre(150, 110);
  Image picture = plate;
  paintDisc(picture, centre, 60, kRed);
  addNoise(picture, 5, 7);
  const Image coverage = keyOf({plate}, picture);
  EXPECT_GT(discIou(coverage, centre, 60), 0.97);
}

TEST(Keyer, LeavesShadowsToTheBackground) {
  const glm::dvec2 centre(150, 90), below(200, 190);
  for (const auto& [plate, dark] : {std::pair(wallPlate(320, 240), 0.68), std::pair(greenPlate(320, 240), 0.45)}) {
    Image picture = plate;
    shade(picture, [&, least = dark](int x, int y) {  // with a soft border, below the disc and beside it
      const glm::dvec2 off = (glm::dvec2(x, y) - below) / glm::dvec2(90, 40);
      return 1 - (1 - least) * std::clamp(3 * (1.2 - glm::length(off)), 0.0, 1.0);
    });
    Image shadow_alone = picture;
    EXPECT_EQ(covered(keyOf({plate}, shadow_alone)), 0u);
    paintDisc(picture, centre, 70, kRed);
    const Image coverage = keyOf({plate}, picture);
    EXPECT_GT(discIou(coverage, centre, 70), 0.98);
    EXPECT_LT(outlineError_px(coverage, centre, 70), 1.5);  // where the shadow's border meets the disc
  }
}

TEST(Keyer, LeavesHolesThatShowThePlate) {
  const Image plate = wallPlate(320, 240);
  const glm::dvec2 centre(160, 120);
  Image picture = plate;
  paint(
      picture, [&](int x, int y) { return discShare(x, y, centre, 80) - discShare(x, y, centre, 30); }, kRed);
  const Image coverage = keyOf({plate}, picture);
  EXPECT_EQ(*coverage.at(160, 120), 0);
  EXPECT_EQ(*coverage.at(160, 180), 255);
  EXPECT_NEAR(double(covered(coverage)), std::numbers::pi * (80 * 80 - 30 * 30), 300);
}

TEST(Keyer, ClosesSmallHolesAndRemovesSpecks) {
  const Image plate = wallPlate(320, 240);
  const glm::dvec2 centre(140, 120);
  Image picture = plate;
  paintDisc(picture, centre, 60, kRed);
  for (int y = 118; y < 122; ++y)
    for (int x = 138; x < 142; ++x) std::copy_n(plate.at(x, y), 3, picture.at(x, y));  // a button of the wall's colour
  paintDisc(picture, {280, 40}, 2.5, kWhite);
  const Image coverage = keyOf({plate}, picture);
  EXPECT_GE(*coverage.at(140, 120), 128);
  EXPECT_GT(discIou(coverage, centre, 60), 0.98);
}

TEST(Keyer, AllowsForWhatMovesInThePlates) {
  std::vector<Image> plates;
  for (int i = 0; i < 6; ++i) {
    plates.push_back(wallPlate(320, 240));
    for (int y = 20; y < 80; ++y)
      for (int x = 200; x < 290; ++x)
        for (int c = 0; c < 3; ++c) plates.back().at(x, y)[c] = uint8_t(100 + 50 * ((i + x / 9) % 3) / (c + 1));
  }
  Image picture = plates[1];
  paintDisc(picture, {100, 130}, 50, kRed);
  const Image coverage = keyOf({plates[0], plates[2], plates[3], plates[4], plates[5]}, picture);
  EXPECT_GT(discIou(coverage, {100, 130}, 50), 0.98);
}

TEST(Keyer, HasNoMemoryOfOtherPictures) {
  const Image plate = wallPlate(320, 240);
  auto keyer = Keyer::create({plate});
  ASSERT_TRUE(keyer.ok());
  Image last;
  for (const glm::dvec2& centre : {glm::dvec2(80, 100), glm::dvec2(108, 131), glm::dvec2(135, 100)}) {
    last = plate;
    paintDisc(last, centre, 40, kDark);
    ASSERT_TRUE(keyer.value()->key(last).ok());
  }
  EXPECT_EQ(keyer.value()->key(last).value()->pixels, keyOf({plate}, last).pixels);
  Image before = plate;
  paintDisc(before, {100, 100}, 42, kWhite);
  ASSERT_TRUE(keyer.value()->key(before).ok());
  EXPECT_EQ(keyer.value()->key(last).value()->pixels, keyOf({plate}, last).pixels);
}

TEST(Keyer, RefusesOtherSizes) {
  EXPECT_EQ(Keyer::create({}).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(Keyer::create({Image(32, 24, 3), Image(24, 32, 3)}).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(Keyer::create({Image(32, 24, 1)}).error().id, ErrorId::InvalidArgument);
  auto keyer = Keyer::create({Image(32, 24, 3, 90)});
  ASSERT_TRUE(keyer.ok());
  EXPECT_EQ(keyer.value()->key(Image(24, 32, 3)).error().id, ErrorId::InvalidArgument);
  EXPECT_TRUE(keyer.value()->key(Image(32, 24, 3, 90)).ok());
}

TEST(Keyer, KeysTheSmallestPictures) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 2), std::pair(5, 1), std::pair(1, 401)}) {
    auto keyer = Keyer::create({Image(width, height, 3, 90)});
    ASSERT_TRUE(keyer.ok());
    EXPECT_TRUE(keyer.value()->key(Image(width, height, 3, 250)).ok());
  }
}

}  // namespace
}  // namespace fourdvt::live
