// SPDX-License-Identifier: Apache-2.0
// Plates from clips in which the performer is always visible.
#include "mattes/clip_plates.h"

#include <gtest/gtest.h>

#include "mattes_fixture.h"

namespace fourdvt::mattes {
namespace {

TEST(ClipPlates, ShowWhatIsBehindTheMasks) {
  const auto rig = ringOf(3);
  std::vector<Image> pictures;
  std::vector<cv::Mat> masks;
  for (uint32_t k = 0; k < 10; ++k) {
    // One ball that moves two metres back and forth, and one that never leaves.
    const std::vector<Ball> balls{{{0.2 * k - 0.9, 0.3, 0}, 0.2}, {{0, -0.3, 0}, 0.15}};
    pictures.push_back(filmed(rig, 0, balls, k));
    masks.push_back(maskOf(rig[0], balls));
  }
  const BackgroundModel plate = plateBehind(pictures, masks);
  ASSERT_EQ(plate.known.size(), size_t(kSide * kSide));
  const cv::Mat hidden = maskOf(rig[0], {{{0, -0.3, 0}, 0.15}});
  double worst = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const size_t i = size_t(y) * kSide + size_t(x);
      if (hidden.at<uint8_t>(y, x)) {
        EXPECT_EQ(plate.known[i], 0) << x << " " << y;
      }
      if (plate.known[i]) worst = std::max(worst, std::abs(plate.mean[3 * i] - roomLevel(0, x, y, 0)));
    }
  EXPECT_LT(worst, 6);  // noise of a median of at least three
  size_t known = 0;
  for (const uint8_t k : plate.known) known += k;
  EXPECT_GT(double(known), 0.9 * kSide * kSide);
}

TEST(ClipPlates, SeparateAPerformerWhoNeverLeaves) {
  const auto rig = ringOf(5, 96);
  constexpr size_t kSamples = 7;
  std::vector<std::vector<Image>> pictures(rig.size());
  std::vector<std::vector<cv::Mat>> truth(rig.size());
  for (size_t k = 0; k < kSamples; ++k) {
    const double t = double(k);
    const std::vector<Ball> balls{{{0.45 * std::sin(t), 0, 0.45 * std::cos(1.3 * t)}, 0.33, {200, 90, 70}, 35},
                                  {{0.45 * std::sin(t), 0.42, 0.45 * std::cos(1.3 * t)}, 0.17, {70, 60, 190}, 35}};
    // Another person moves, visible to camera 1 only.
    const Ball stranger{{-1.25, 0.1 * std::sin(3 * t), 0.3}, 0.2, {90, 200, 90}, 35};
    for (size_t i = 0; i < rig.size(); ++i) {
      auto seen = balls;
      if (i == 1) seen.push_back(stranger);
      pictures[i].push_back(filmed(rig, int(i), seen, uint32_t(10 * k + i)));
      truth[i].push_back(maskOf(rig[i], balls));
    }
  }
  const auto clips = separateClips(rig, -0.5, pictures);
  for (size_t i = 0; i < rig.size(); ++i) {
    double mean = 0;
    for (size_t k = 0; k < kSamples; ++k) mean += unionShare(clips[i].masks[k], truth[i][k]) / kSamples;
    EXPECT_GT(mean, 0.9) << i;
  }
}

}  // namespace
}  // namespace fourdvt::mattes
