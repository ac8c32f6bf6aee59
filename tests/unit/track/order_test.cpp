// SPDX-License-Identifier: Apache-2.0
#include "track/order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fourdvt::track {
namespace {

// A disc at `x` in one camera.
FrameThumbnails frameAt(int x, int y_middle = 50) {
  Image picture(200, 100, 4);
  for (int y = 0; y < 100; ++y)
    for (int column = 0; column < 200; ++column)
      if ((column - x) * (column - x) + (y - y_middle) * (y - y_middle) < 30 * 30)
        for (int c = 0; c < 4; ++c) picture.at(column, y)[c] = c == 3 ? 255 : 200;
  return thumbnailsOf(std::vector<Image>{picture});
}

TEST(TrackingOrder, DissimilarityGrowsWithTheMotion) {
  const FrameThumbnails a = frameAt(60);
  EXPECT_EQ(dissimilarity(a, a), 0);
  EXPECT_LT(dissimilarity(a, frameAt(65)), dissimilarity(a, frameAt(80)));
  EXPECT_NEAR(dissimilarity(a, frameAt(140)), 1, 0.02);
}

TEST(TrackingOrder, FramesAreReachedInShortSteps) {
  // A motion to the right and back: the way back has the poses of the way there.
  std::vector<FrameThumbnails> frames;
  for (const int x : {40, 60, 80, 100, 81, 61, 41}) frames.push_back(frameAt(x));
  const std::vector<TrackingStep> steps = trackingOrder(frames, 0);
  ASSERT_EQ(steps.size(), frames.size());
  EXPECT_EQ(steps[0].frame, 0u);
  const double longest = dissimilarity(frames[0], frames[1]);
  std::vector<uint32_t> done{0};
  for (size_t i = 1; i < steps.size(); ++i) {
    EXPECT_NE(std::find(done.begin(), done.end(), steps[i].parent), done.end());
    EXPECT_LE(steps[i].dissimilarity, longest);
    EXPECT_GT(steps[i].depth, 0u);
    done.push_back(steps[i].frame);
    if (steps[i].frame == 6) {
      EXPECT_EQ(steps[i].parent, 0u);  // the last frame's pose is the first's
    }
  }
  std::sort(done.begin(), done.end());
  EXPECT_EQ(done, (std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(TrackingOrder, LoopsAreFollowedInBothDirections) {
  std::vector<FrameThumbnails> frames;
  constexpr uint32_t kFrames = 16;
  for (uint32_t f = 0; f < kFrames; ++f) {
    const double angle = 6.283185 * f / kFrames;
    frames.push_back(frameAt(100 + int(60 * std::sin(angle)), 50 + int(18 * std::cos(angle))));
  }
  for (const uint32_t root : {0u, 5u})
    for (const TrackingStep& step : trackingOrder(frames, root)) {
      const uint32_t away = (step.frame + kFrames - root) % kFrames;
      EXPECT_LE(step.depth, std::min(away, kFrames - away) + 1);
    }
}

}  // namespace
}  // namespace fourdvt::track
