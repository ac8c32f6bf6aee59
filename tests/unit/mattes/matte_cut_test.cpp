// SPDX-License-Identifier: Apache-2.0
// Compares the minimum cut of a matte with all labellings of a small picture.
#include <gtest/gtest.h>

#include <random>

#include "mattes/background_key.h"

namespace fourdvt::mattes {

using namespace capture;

namespace {

constexpr int kSide = 4;

double costOf(const CutCosts& costs, const cv::Mat& mask) {
  double sum = 0;
  const auto border = [&](int x, int y, int dx, int dy, const cv::Mat& weights) {
    if (x + dx < 0 || x + dx >= kSide || y + dy >= kSide) return;
    if (mask.at<uint8_t>(y, x) != mask.at<uint8_t>(y + dy, x + dx)) sum += weights.at<float>(y, x);
  };
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      if (mask.at<uint8_t>(y, x)) sum += costs.object_minus_background.at<float>(y, x);
      border(x, y, 1, 0, costs.right);
      border(x, y, 0, 1, costs.down);
      border(x, y, 1, 1, costs.down_right);
      border(x, y, -1, 1, costs.down_left);
    }
  return sum;
}

TEST(CaptureMatteCut, NoSplitIsCheaper) {
  std::mt19937 random(5);
  const auto filled = [&](float low, float high) {
    cv::Mat out(kSide, kSide, CV_32F);
    for (int i = 0; i < kSide * kSide; ++i)
      out.at<float>(i / kSide, i % kSide) = low + (high - low) * float(random() % 1000) / 1000;
    return out;
  };
  for (int trial = 0; trial < 20; ++trial) {
    const CutCosts costs{filled(-3, 3), filled(0, 2), filled(0, 2), filled(0, 1), filled(0, 1)};
    cv::Mat given(kSide, kSide, CV_8U), open(kSide, kSide, CV_8U);
    for (int i = 0; i < kSide * kSide; ++i) {
      given.at<uint8_t>(i / kSide, i % kSide) = random() % 2 ? 255 : 0;
      open.at<uint8_t>(i / kSide, i % kSide) = random() % 4 ? 255 : 0;
    }
    double cheapest = 1e9;
    cv::Mat mask(kSide, kSide, CV_8U);
    for (unsigned bits = 0; bits < 1u << (kSide * kSide); ++bits) {
      bool allowed = true;
      for (int i = 0; i < kSide * kSide; ++i) {
        mask.at<uint8_t>(i / kSide, i % kSide) = bits >> i & 1 ? 255 : 0;
        allowed &=
            open.at<uint8_t>(i / kSide, i % kSide) || (bits >> i & 1) == (given.at<uint8_t>(i / kSide, i % kSide) > 0);
      }
      if (allowed) cheapest = std::min(cheapest, costOf(costs, mask));
    }
    const cv::Mat cut = cheapestCut(costs, given, open);
    EXPECT_NEAR(costOf(costs, cut), cheapest, 1e-3) << trial;
    for (int i = 0; i < kSide * kSide; ++i)
      if (!open.at<uint8_t>(i / kSide, i % kSide)) {
        EXPECT_EQ(cut.at<uint8_t>(i / kSide, i % kSide), given.at<uint8_t>(i / kSide, i % kSide));
      }
  }
}

}  // namespace
}  // namespace fourdvt::mattes
