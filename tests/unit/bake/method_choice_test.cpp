// SPDX-License-Identifier: Apache-2.0
// The choice of a method: the rule on synthetic scores, costs, the mask of blended pixels, and registration of shifted
// pictures.
#include "bake/method/method_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/method/view_scores.h"
#include "look_at.h"

namespace fourdvt::bake {
namespace {

MethodScore score(const char* method, double cost, double psnr_db, double ssim = 0.8) {
  return {method, cost, psnr_db, ssim, psnr_db, psnr_db, ssim};
}

// Rule without corrections.
constexpr ChoiceRule kPlain{.own_share = 0, .search_db = 0, .blend_db_per_px = 0};

std::string verdictOn(const MethodChoice& choice, const std::string& method) {
  for (const MethodVerdict& v : choice.verdicts)
    if (v.score.method == method) return v.verdict;
  return "none";
}

MethodChoice choose(const std::vector<MethodScore>& scores) { return chooseMethod(scores, {}, kPlain); }

TEST(MethodChoice, TheBestOfThoseWithinTheCost) {
  const std::vector<MethodScore> scores{score("fvvr", 1, 22.1), score("linear", 1.1, 22), score("sweep", 1.4, 22.5),
                                        score("floating", 4, 23)};
  const MethodChoice choice = chooseMethod(scores, {0.2, 45}, kPlain);
  EXPECT_EQ(choice.method, "sweep");
  EXPECT_EQ(verdictOn(choice, "sweep"), "taken");
  EXPECT_EQ(verdictOn(choice, "fvvr"), "0.40 dB below the best");
  EXPECT_EQ(verdictOn(choice, "floating"), "costs 4.0 × FVVR's frame");
  EXPECT_EQ(chooseMethod(scores, {0.2, 45}, {.most_cost = 4, .search_db = 0}).method, "floating");
}

TEST(MethodChoice, AmongEqualsTheCheaper) {
  EXPECT_EQ(choose({score("fvvr", 1, 22), score("sweep", 1.4, 22.04)}).method, "fvvr");
  EXPECT_EQ(choose({score("sweep", 1.4, 22.04), score("fvvr", 1, 22)}).method, "fvvr") << "in any order";
  EXPECT_EQ(choose({score("fvvr", 1, 22), score("linear", 1, 22.04)}).method, "fvvr") << "the first";
  EXPECT_EQ(choose({score("fvvr", 1, 22), score("sweep", 1.4, 22.06)}).method, "sweep");
  EXPECT_EQ(choose({score("fvvr", 1, 22, 0.8), score("sweep", 1.4, 22.04, 0.81)}).method, "sweep")
      << "not equal: sharper";
}

TEST(MethodChoice, NothingThatIsBelowLinear) {
  const MethodChoice choice = chooseMethod({score("fvvr", 1, 21.9), score("linear", 1.1, 21.97)}, {}, kPlain);
  EXPECT_EQ(choice.method, "linear");
  EXPECT_EQ(verdictOn(choice, "fvvr"), "0.07 dB below linear");
}

TEST(MethodChoice, NoSweepWhereCalibrationIsOff) {
  const std::vector<MethodScore> scores{score("fvvr", 1, 22), score("linear", 1.1, 22), score("sweep", 1.4, 23)};
  EXPECT_EQ(chooseMethod(scores, {1.9, 60}).method, "sweep");
  EXPECT_EQ(chooseMethod(scores, {2.1, 60}).method, "fvvr");
  EXPECT_EQ(verdictOn(chooseMethod(scores, {2.13, 60}), "sweep"), "the cameras' pictures lie 2.1 pixels off");
}

TEST(MethodChoice, CorrectsWhatLeavingOutGetsWrong) {
  const std::vector<MethodScore> scores{score("fvvr", 1, 21.8), score("linear", 1.1, 22), score("sweep", 1.4, 21.2)};
  constexpr ChoiceRule kLeftOut{.own_share = 0, .search_db = 1};
  const MethodChoice choice = chooseMethod(scores, {0, 60}, kLeftOut);
  EXPECT_EQ(choice.method, "sweep") << "0.8 dB below linear, and 1 dB is for the search";
  EXPECT_DOUBLE_EQ(choice.verdicts[2].judged_db, 22.2);
  EXPECT_EQ(chooseMethod(scores, {}, kPlain).method, "linear");
  EXPECT_DOUBLE_EQ(chooseMethod(scores, {0, 45}, kLeftOut).verdicts[2].judged_db, 21.7) << "half of it";
  EXPECT_EQ(chooseMethod(scores, {0, 20}).method, "linear") << "cameras near each other";
  EXPECT_EQ(chooseMethod(scores, {2.1, 60}).method, "fvvr") << "no search; linear is judged as 21.37";
  EXPECT_EQ(chooseMethod({scores[0], scores[1]}, {0.4, 60}).method, "linear") << "judged as 21.88";
}

TEST(MethodChoice, JudgesViewsBetweenTheOwnAndTheLeftOut) {
  std::vector<MethodScore> scores{score("fvvr", 1, 22), score("linear", 1.1, 22), score("sweep", 1.4, 22.3)};
  scores[0].own_psnr_db = 25, scores[1].own_psnr_db = 40, scores[2].own_psnr_db = 25;
  constexpr ChoiceRule kOwn{.own_share = 0.3, .own_until_px = 1.5, .search_db = 0, .blend_db_per_px = 0};
  const MethodChoice choice = chooseMethod(scores, {}, kOwn);
  EXPECT_EQ(choice.method, "linear") << "the others blur what a camera beside the visitor sees";
  EXPECT_NEAR(choice.verdicts[1].judged_db, 22 - 10 * std::log10(0.7 + 0.3 * std::pow(10, -1.8)), 1e-9);
  EXPECT_EQ(chooseMethod(scores, {}, kPlain).method, "sweep");
  EXPECT_DOUBLE_EQ(chooseMethod(scores, {1.5, 0}, kOwn).verdicts[1].judged_db, 22) << "all errors are calibration's";
}

TEST(MethodChoice, NoneWhereAllAreTooDear) {
  const MethodChoice choice = chooseMethod({score("floating", 4, 22)}, {});
  EXPECT_TRUE(choice.method.empty());
  EXPECT_EQ(choice.verdicts.size(), 1u);
  EXPECT_TRUE(choose({}).method.empty());
}

TEST(MethodChoice, RefusesRulesThatCannotBe) {
  EXPECT_EQ(ChoiceRule{}.check(), "");
  EXPECT_NE((ChoiceRule{.most_cost = 0.5}.check()), "");
  EXPECT_NE((ChoiceRule{.most_cost = std::nan("")}.check()), "");
  EXPECT_NE((ChoiceRule{.tie_db = -1}.check()), "");
  EXPECT_NE((ChoiceRule{.own_share = 1}.check()), "");
}

TEST(MethodCosts, AreFvvrsFramesAndFallWithTheFaces) {
  for (const size_t faces : {size_t(1), size_t(3000), size_t(10'000), size_t(1'000'000)}) {
    EXPECT_EQ(methodCost("fvvr", faces), 1) << faces;
    EXPECT_LT(methodCost("sweep", faces), methodCost("floating", faces)) << faces;
  }
  EXPECT_GE(methodCost("floating", 3000), methodCost("floating", 20'000));
  EXPECT_EQ(methodCost("floating", 1), methodCost("floating", 2)) << "beyond the table as at its end";
  EXPECT_GE(methodCost("linear", 32'000), 1) << "FVVR is left for what is better only";
  EXPECT_TRUE(std::isinf(methodCost("no-such-method", 8000)));
  EXPECT_EQ(methodCandidates().front(), "fvvr") << "shifts are measured on it";
}

// Dots of all sizes on a fixed pattern, moved by `moved`.
Image dotted(int width, int height, glm::dvec2 moved) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = x - moved.x, v = y - moved.y;
      const double value = 128 + 50 * std::sin(0.31 * u + 0.12 * v) + 50 * std::sin(-0.17 * u + 0.41 * v + 1);
      for (int k = 0; k < 3; ++k) out.at(x, y)[k] = uint8_t(std::lround(value));
    }
  return out;
}

TEST(Registration, FindsHowFarAPictureLiesOff) {
  const Image truth = dotted(90, 70, {0, 0});
  const measure::Mask inside(90 * 70, 1);
  for (const glm::dvec2 moved : {glm::dvec2(0, 0), glm::dvec2(2.5, -1.25), glm::dvec2(-6, 3)}) {
    const RegisteredScore found = registeredScore(truth, dotted(90, 70, moved), inside);
    EXPECT_NEAR(found.shift_px.x, moved.x, 0.13);
    EXPECT_NEAR(found.shift_px.y, moved.y, 0.13);
    EXPECT_GT(found.psnr_db, 25) << "but for the border, which is repeated";
  }
  const RegisteredScore far = registeredScore(truth, dotted(90, 70, {40, 0}), inside);
  EXPECT_LE(std::abs(far.shift_px.x), kMaxShift_px);
}

TEST(Registration, LooksAtNothingOutside) {
  const Image truth = dotted(60, 60, {0, 0});
  Image picture = truth;
  measure::Mask inside(60 * 60, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 60; ++x) picture.at(x, y)[0] = 255, inside[size_t(y) * 60 + size_t(x)] = 0;
  const RegisteredScore found = registeredScore(truth, picture, inside);
  EXPECT_EQ(found.shift_px, glm::dvec2(0));
  EXPECT_EQ(found.psnr_db, measure::kEqual_db);
}

// Wall of 2 × 2 m at z = 0; cameras stand 3 m in front of it.
const TriangleMesh kWall{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
PinholeCamera beforeTheWall(double x) { return testing::lookAt({x, 0, 3}, {0, 0, 0}, 120, 100, 100); }

double shareOf(const measure::Mask& mask) {
  return double(std::count(mask.begin(), mask.end(), 1)) / double(mask.size());
}

TEST(SharedSight, IsBetweenTwoCameras) {
  const std::vector<PinholeCamera> cameras{beforeTheWall(-1), beforeTheWall(0), beforeTheWall(1)};
  const SharedSight sight(cameras, kWall, 1);
  EXPECT_GT(shareOf(sight.of(cameras[1], 1)), 0.25) << "what the wall covers of the picture";
  EXPECT_EQ(shareOf(SharedSight({cameras[0], cameras[1]}, kWall, 1).of(cameras[1], 1)), 0) << "one is left";
  EXPECT_EQ(shareOf(SharedSight({cameras[1]}, kWall, 1).of(cameras[1], 0)), 0) << "none is left";
  const TriangleMesh back{kWall.positions, {{0, 2, 1}, {0, 3, 2}}};
  EXPECT_EQ(shareOf(SharedSight(cameras, back, 1).of(cameras[1], 1)), 0) << "seen from behind";
}

TEST(SharedSight, NeedsWeightsOfLikeSize) {
  // Seen by one frontal camera and one grazing one, at a cosine of .14: its share is below a quarter.
  const std::vector<PinholeCamera> cameras{beforeTheWall(0), testing::lookAt({21, 0, 3}, {0, 0, 0}, 120, 100, 100)};
  EXPECT_EQ(shareOf(SharedSight(cameras, kWall, 1).of(beforeTheWall(0.2), std::nullopt)), 0);
}

TEST(SharedSight, IsNotWhereAScreenHidesOneOfThem) {
  TriangleMesh scene = kWall;  // a screen 0.5 m in front of the wall hides it from the left camera
  for (const glm::vec3 p :
       {glm::vec3(-1.2, -1, 0.8), glm::vec3(0, -1, 0.8), glm::vec3(0, 1, 0.8), glm::vec3(-1.2, 1, 0.8)})
    scene.positions.push_back(p);
  scene.faces.insert(scene.faces.end(), {{4, 5, 6}, {4, 6, 7}});
  const std::vector<PinholeCamera> cameras{beforeTheWall(-2), beforeTheWall(1)};
  const PinholeCamera view = beforeTheWall(0.8);
  const auto isShared = [&](const TriangleMesh& surface, const glm::dvec3& point) {
    const glm::dvec3 at = view.project(point);
    return SharedSight(cameras, surface, 1).of(view, std::nullopt)[size_t(at.y) * 120 + size_t(at.x)] != 0;
  };
  EXPECT_TRUE(isShared(kWall, {0.4, 0, 0}));
  EXPECT_FALSE(isShared(scene, {0.4, 0, 0})) << "the left camera's ray passes z = 0.8 at x = -0.24";
  EXPECT_TRUE(isShared(scene, {0.9, 0, 0})) << "at x = 0.13";
}

TEST(SharedSight, LargePicturesHaveTheirOwnPixels) {
  PinholeCamera large = testing::lookAt({0.1, 0, 3}, {0, 0, 0}, 1200, 1000, 1000);
  const std::vector<PinholeCamera> cameras{beforeTheWall(-1), beforeTheWall(1)};
  const measure::Mask mask = SharedSight(cameras, kWall, 1).of(large, std::nullopt);
  ASSERT_EQ(mask.size(), size_t(1200 * 1000));
  EXPECT_TRUE(mask[500 * 1200 + 600]);
  EXPECT_FALSE(mask[5]);
}

}  // namespace
}  // namespace fourdvt::bake
