// SPDX-License-Identifier: Apache-2.0
#include "track/time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fourdvt::testing {
namespace {

using track::smoothInTime;

std::vector<double> trusted(size_t frames) { return std::vector<double>(frames, 1); }

TEST(Time, KeepsStraightMotion) {
  std::vector<Positions> frames;
  for (int f = 0; f < 20; ++f) frames.push_back({{0.05f * float(f), 1, 0}});
  auto smoothed = frames;
  smoothInTime(smoothed, trusted(20), false, {});
  for (size_t f = 0; f < 20; ++f) EXPECT_LT(glm::distance(smoothed[f][0], frames[f][0]), 1e-5f);
}

TEST(Time, CalmsNoiseAtRest) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.001f);
  std::vector<Positions> frames(50, Positions(200));
  for (auto& positions : frames)
    for (auto& p : positions) p = {noise(random), noise(random), noise(random)};
  const auto change = [](const std::vector<Positions>& list) {
    double square = 0;
    for (size_t f = 1; f < list.size(); ++f)
      for (size_t v = 0; v < list[f].size(); ++v)
        square += glm::dot(list[f][v] - list[f - 1][v], list[f][v] - list[f - 1][v]);
    return std::sqrt(square / double((list.size() - 1) * list[0].size()));
  };
  const double before = change(frames);
  smoothInTime(frames, trusted(50), false, {});
  EXPECT_NEAR(before, 0.001 * std::sqrt(6.0), 2e-4);
  EXPECT_LT(change(frames), 0.25 * before);
}

// A hand that swings 0.4 m to and fro in ten frames.
TEST(Time, KeepsFastSwings) {
  std::vector<Positions> frames;
  for (int f = 0; f < 40; ++f) frames.push_back({{0.2f * std::sin(0.6283f * float(f)), 0, 0}});
  auto smoothed = frames;
  smoothInTime(smoothed, trusted(40), true, {});
  for (size_t f = 0; f < 40; ++f) EXPECT_LT(glm::distance(smoothed[f][0], frames[f][0]), 0.003f) << f;
}

TEST(Time, InterpolatesFramesWithoutTrust) {
  std::vector<Positions> frames;
  for (int f = 0; f < 20; ++f) frames.push_back({{0.01f * float(f), 0, 0}});
  frames[9] = frames[10] = {{5, 5, 5}};
  auto trust = trusted(20);
  trust[9] = trust[10] = 0;
  smoothInTime(frames, trust, false, {});
  EXPECT_LT(glm::distance(frames[9][0], glm::vec3(0.09f, 0, 0)), 1e-3f);
  EXPECT_LT(glm::distance(frames[10][0], glm::vec3(0.10f, 0, 0)), 1e-3f);
}

TEST(Time, TreatsALoopsSeamAsAnyFrame) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0, 0.001f);
  std::vector<Positions> frames(16, Positions(1));
  for (auto& positions : frames) positions[0] = {noise(random), 0, 0};
  auto turned = frames;
  std::rotate(turned.begin(), turned.begin() + 5, turned.end());
  smoothInTime(frames, trusted(16), true, {});
  smoothInTime(turned, trusted(16), true, {});
  for (size_t f = 0; f < 16; ++f) EXPECT_LT(glm::distance(frames[(f + 5) % 16][0], turned[f][0]), 5e-5f) << f;
}

}  // namespace
}  // namespace fourdvt::testing
