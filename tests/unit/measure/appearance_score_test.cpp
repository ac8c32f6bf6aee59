// SPDX-License-Identifier: Apache-2.0
// Blur, displacement and flicker of pictures with known results.
#include "lab/measure/appearance_score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fourdvt::measure {
namespace {

constexpr int kSide = 96;

// Opaque picture of grey `level(x, y)`.
template <class Level>
Image picture(const Level& level, int channels = 3) {
  Image out(kSide, kSide, channels, 255);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) std::fill_n(out.at(x, y), 3, uint8_t(level(x, y)));
  return out;
}

// Noise that differs from all its shifts.
int noise(int x, int y) {
  uint32_t h = uint32_t(x + 50) * 374761393u + uint32_t(y + 50) * 668265263u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return int((h ^ (h >> 16)) & 127) + 64;
}

Mask everywhere() { return Mask(kSide * kSide, 1); }

Mask insideOf(int margin) {
  Mask out(kSide * kSide, 0);
  for (int y = margin; y < kSide - margin; ++y)
    for (int x = margin; x < kSide - margin; ++x) out[size_t(y) * kSide + x] = 1;
  return out;
}

TEST(Rmse, IsTheShareOfTheWholeRange) {
  const Image a = picture([](int, int) { return 100; });
  EXPECT_NEAR(rmse(a, picture([](int, int) { return 151; }), everywhere()), 0.2, 1e-12);
  // Half of the pixels differ by 51 levels.
  EXPECT_NEAR(rmse(a, picture([](int x, int) { return x % 2 ? 151 : 100; }), everywhere()), 0.2 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(rmse(a, picture([](int x, int) { return x % 2 ? 151 : 100; }), everywhere()),
              std::pow(10, -psnr(a, picture([](int x, int) { return x % 2 ? 151 : 100; }), everywhere()) / 20), 1e-9);
  EXPECT_TRUE(std::isnan(rmse(a, a, Mask(kSide * kSide, 0))));
}

TEST(GradientRatio, IsTheSquareOfTheContrast) {
  const auto grating = [](double contrast) {
    return picture([=](int x, int) { return std::lround(128 + contrast * std::sin(2 * M_PI * x / 16)); });
  };
  EXPECT_NEAR(gradientRatio(grating(80), grating(40), everywhere()), 0.25, 0.005);
  EXPECT_NEAR(gradientRatio(grating(40), grating(80), everywhere()), 4, 0.08);
  // Mean of two pictures a quarter of the wavelength apart: cos²(45°) remains.
  const Image ghost = picture([](int x, int) {
    return std::lround(128 + 40 * (std::sin(2 * M_PI * x / 16) + std::sin(2 * M_PI * (x + 4) / 16)));
  });
  EXPECT_NEAR(gradientRatio(grating(80), ghost, everywhere()), 0.5, 0.01);
  EXPECT_TRUE(std::isnan(gradientRatio(picture([](int, int) { return 9; }), ghost, everywhere())));
}

TEST(ShiftTolerantPsnr, ForgivesWhatLiesWithinReach) {
  const Image truth = picture(noise);
  const auto moved = [](int dx, int dy) { return picture([=](int x, int y) { return noise(x + dx, y + dy); }); };
  EXPECT_EQ(shiftTolerantPsnr(truth, truth, insideOf(8)), 100);
  EXPECT_LT(psnr(truth, moved(2, -3), insideOf(8)), 20);
  EXPECT_EQ(shiftTolerantPsnr(truth, moved(2, -3), insideOf(8)), 100);
  EXPECT_LT(shiftTolerantPsnr(truth, moved(4, 0), insideOf(8)), 22);
  EXPECT_TRUE(std::isnan(shiftTolerantPsnr(truth, truth, Mask(kSide * kSide, 0))));
}

TEST(ShiftTolerantPsnr, EveryBlockHasItsOwnShift) {
  const Image truth = picture(noise);
  // The left half is shifted one way, the right half the other; the border lies between two blocks.
  const Image torn = picture([](int x, int y) { return noise(x + (x < 48 ? 3 : -3), y); });
  Mask away = insideOf(8);
  for (int y = 0; y < kSide; ++y)
    for (int x = 44; x < 52; ++x) away[size_t(y) * kSide + x] = 0;
  EXPECT_EQ(shiftTolerantPsnr(truth, torn, away), 100);
  EXPECT_LT(shiftTolerantPsnr(truth, torn, away, {.block_px = kSide}), 25);  // no single shift fits both halves
}

TEST(ShiftTolerantPsnr, IsPsnrWithoutReachAndNeverBelowIt) {
  const Image truth = picture(noise), other = picture([](int x, int y) { return noise(x, y) + x % 7; });
  const Mask inside = insideOf(5);
  EXPECT_NEAR(shiftTolerantPsnr(truth, other, inside, {.reach_px = 0}), psnr(truth, other, inside), 1e-9);
  EXPECT_GE(shiftTolerantPsnr(truth, other, inside), psnr(truth, other, inside));
}

FlowField still() { return {kSide, kSide, std::vector<glm::vec2>(kSide * kSide, glm::vec2(0))}; }
FlowField shifted(glm::vec2 by) { return {kSide, kSide, std::vector<glm::vec2>(kSide * kSide, by)}; }
Image opaque(int (*level)(int, int)) { return picture(level, 4); }

TEST(Flicker, AnErrorThatStaysDoesNotCount) {
  const TrueAndDrawn wrong{opaque([](int, int) { return 90; }), opaque([](int x, int) { return 90 + x % 5; })};
  EXPECT_EQ(flickerLevels(wrong, wrong, still()), 0);
}

TEST(Flicker, AnErrorThatRidesOnTheSurfaceDoesNotCount) {
  // Truth and error both move by five pixels.
  const TrueAndDrawn before{opaque([](int x, int y) { return noise(x, y); }),
                            opaque([](int x, int y) { return noise(x, y) + noise(x + 9, y) % 11; })};
  const TrueAndDrawn now{opaque([](int x, int y) { return noise(x - 5, y); }),
                         opaque([](int x, int y) { return noise(x - 5, y) + noise(x + 4, y) % 11; })};
  EXPECT_EQ(flickerLevels(before, now, shifted({5, 0})), 0);
  EXPECT_GT(flickerLevels(before, now, still()), 3);
}

TEST(Flicker, AnErrorThatComesCountsWithItsSize) {
  const TrueAndDrawn good{opaque([](int x, int y) { return noise(x, y); }),
                          opaque([](int x, int y) { return noise(x, y); })};
  const TrueAndDrawn brighter{good.truth, opaque([](int x, int y) { return noise(x, y) + 12; })};
  EXPECT_EQ(flickerLevels(good, brighter, still()), 12);
  EXPECT_EQ(flickerLevels(brighter, good, still()), 12);
  // The truth brightens equally: no flicker.
  const TrueAndDrawn both{brighter.picture, brighter.picture};
  EXPECT_EQ(flickerLevels(good, both, still()), 0);
}

TEST(Flicker, CountsOnlyWhereMotionIsKnownAndThePerformerIsShown) {
  const TrueAndDrawn good{opaque([](int x, int y) { return noise(x, y); }),
                          opaque([](int x, int y) { return noise(x, y); })};
  TrueAndDrawn half = good;  // wrong on the left, and nothing there in the truth
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < 40; ++x) std::fill_n(half.picture.at(x, y), 3, uint8_t(250)), half.truth.at(x, y)[3] = 0;
  EXPECT_EQ(flickerLevels(good, half, still()), 0);
  FlowField unknown = still();
  std::fill(unknown.displacement.begin(), unknown.displacement.end(), glm::vec2(std::nanf("")));
  EXPECT_TRUE(std::isnan(flickerLevels(good, half, unknown)));
}

TEST(VisibleMotion, FollowsTheSurfaceAndLeavesOutWhatIsHiddenThen) {
  PinholeCamera camera;
  camera.width = 80, camera.height = 60;
  camera.fx = camera.fy = 50, camera.cx = 40, camera.cy = 30;
  // A static wall at 2 m, and a smaller plate at 1 m that moves 0.2 m to the right: 10 pixels.
  const auto quad = [](double x0, double x1, double y, double z) {
    return Positions{{x0, -y, z}, {x1, -y, z}, {x1, y, z}, {x0, y, z}};
  };
  Positions before = quad(-1.4, 1.4, 1, 2), now = before;
  for (const glm::vec3& p : quad(-0.2, 0, 0.3, 1)) before.push_back(p);
  for (const glm::vec3& p : quad(0, 0.2, 0.3, 1)) now.push_back(p);
  const std::vector<glm::uvec3> faces{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const FlowField motion = visibleMotion(camera, faces, before, now);
  const auto at = [&](int x, int y) { return motion.displacement[size_t(y) * 80 + x]; };
  EXPECT_NEAR(at(35, 30).x, 10, 1e-3);  // on the plate
  EXPECT_NEAR(at(35, 30).y, 0, 1e-3);
  EXPECT_NEAR(at(20, 30).x, 0, 1e-3);     // on the wall
  EXPECT_TRUE(std::isnan(at(45, 30).x));  // on the wall, where the plate will be
  EXPECT_TRUE(std::isnan(at(45, 1).x));   // off both
}

TEST(AppearanceScore, EqualPicturesHaveNoFault) {
  const Image same = opaque([](int x, int y) { return noise(x, y); });
  AppearanceLane lane;
  lane.add(same, same, "a");
  lane.add(same, opaque([](int x, int y) { return (noise(x, y) + 128) / 2; }), "b");
  const auto scores = lane.finish();
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_EQ(scores[0].first, "a");
  EXPECT_EQ(scores[0].second.rmse, 0);
  EXPECT_EQ(scores[0].second.gradient_ratio, 1);
  EXPECT_EQ(scores[0].second.shift_tolerant_db, 100);
  EXPECT_EQ(scores[0].second.picture.psnr_fg_db, 100);
  EXPECT_NEAR(scores[1].second.gradient_ratio, 0.25, 0.02);
  const AppearanceScore mean = meanAppearance({scores[0].second, scores[1].second});
  EXPECT_NEAR(mean.rmse, scores[1].second.rmse / 2, 1e-12);
  EXPECT_TRUE(std::isnan(meanAppearance({}).rmse));
}

}  // namespace
}  // namespace fourdvt::measure
