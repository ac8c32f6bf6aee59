// SPDX-License-Identifier: Apache-2.0
#include "track/frame_paths.h"

#include <gtest/gtest.h>

namespace fourdvt::track {
namespace {

TEST(FramePaths, FollowTheDeepestBranchAndBranchOff) {
  // 3 → 2 → 1 → 0, 3 → 4 → 5, 2 → 6
  const std::vector<TrackingStep> steps{{3, 3}, {4, 3}, {2, 3}, {6, 2}, {5, 4}, {1, 2}, {0, 1}};
  const auto paths = framePaths(steps, 8);
  ASSERT_EQ(paths.size(), 3u);
  EXPECT_EQ(paths[0].parent, 3u);
  EXPECT_EQ(paths[0].frames, (std::vector<uint32_t>{3, 2, 1, 0}));
  EXPECT_EQ(paths[1].parent, 3u);
  EXPECT_EQ(paths[1].frames, (std::vector<uint32_t>{4, 5}));
  EXPECT_EQ(paths[2].parent, 2u);
  EXPECT_EQ(paths[2].frames, (std::vector<uint32_t>{6}));
}

TEST(FramePaths, AreBoundedInLength) {
  std::vector<TrackingStep> steps{{0, 0}};
  for (uint32_t f = 1; f < 7; ++f) steps.push_back({f, f - 1});
  const auto paths = framePaths(steps, 3);
  ASSERT_EQ(paths.size(), 3u);
  EXPECT_EQ(paths[1].parent, 2u);
  EXPECT_EQ(paths[1].frames, (std::vector<uint32_t>{3, 4, 5}));
  EXPECT_EQ(paths[2].frames, (std::vector<uint32_t>{6}));
}

}  // namespace
}  // namespace fourdvt::track
