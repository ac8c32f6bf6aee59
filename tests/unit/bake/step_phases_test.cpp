// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bake/motion/class_plan.h"

namespace fourdvt::bake {
namespace {

TEST(StepPhases, FollowTheMembersOwnTime) {
  const uint32_t frames[] = {2, 7};
  // 4 phases of a loop of 10 frames, which begins at frame 6 and has another speed in its second half.
  const double source[] = {6, 7, 10, 13};
  const auto phases = stepPhases(frames, source, 10, 4);
  ASSERT_EQ(phases.size(), 2u);
  EXPECT_DOUBLE_EQ(phases[0], 1.0 / 4);            // frame 7
  EXPECT_DOUBLE_EQ(phases[1], (2 + 2.0 / 3) / 4);  // frame 2, 12 in this pass
  const double once[] = {0, 2, 4};
  const auto of_motion = stepPhases(std::vector<uint32_t>{1, 3, 9}, once, 0, 3);
  ASSERT_EQ(of_motion.size(), 2u) << "frame 9 lies outside";
  EXPECT_DOUBLE_EQ(of_motion[0], 0.5 / 3);
  EXPECT_DOUBLE_EQ(of_motion[1], 1.5 / 3);
}

TEST(StepPhases, MeansGoRoundALoopsEnd) {
  const auto mean = meanSteps({{0.02, 0.5}, {0.48, 0.98}}, true);
  ASSERT_EQ(mean.size(), 2u);
  EXPECT_NEAR(mean[0], 0, 1e-12);
  EXPECT_NEAR(mean[1], 0.49, 1e-12);
  EXPECT_EQ(meanSteps({{0.1, 0.6}, {0.3}}, true), (std::vector<double>{0.1, 0.6})) << "another number of steps";
  EXPECT_TRUE(meanSteps({{}, {}}, true).empty());
}

}  // namespace
}  // namespace fourdvt::bake
