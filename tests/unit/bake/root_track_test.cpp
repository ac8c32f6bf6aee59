// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/root_track.h"

#include <gtest/gtest.h>

#include "motion_shapes.h"

namespace fourdvt::bake {
namespace {

std::vector<glm::vec3> track(const Walker& walker, std::string* note = nullptr) {
  const ReadPositions read = [&](const capture::CaptureSequence&, uint32_t t) {
    return Result<Positions>(walker.frame(t));
  };
  auto found = rootTrack(walker.capture, walker.sequence, read, note);
  EXPECT_TRUE(found.ok());
  return found.take();
}

FootSkate skate(const Walker& walker, const std::vector<glm::vec3>& along) {
  const ReadPositions read = [&](const capture::CaptureSequence&, uint32_t t) {
    return Result<Positions>(walker.frame(t));
  };
  return footSkate(walker.capture, walker.sequence, along, read).value();
}

TEST(RootTrack, AWalkersFeetGiveItsTravelExactly) {
  const Walker walker("walk", 1.2, 28);
  const auto found = track(walker);
  ASSERT_EQ(found.size(), 29u);
  EXPECT_EQ(found[0], glm::vec3(0));
  for (uint32_t t = 0; t <= 28; ++t) {
    EXPECT_NEAR(found[t].x, 0, 1e-4);
    EXPECT_NEAR(found[t].y, walker.travelled(t / 28.0), 1e-4);
    EXPECT_EQ(found[t].z, 0);
  }
  EXPECT_LT(skate(walker, found).max_m, 1e-4);
  EXPECT_GT(skate(walker, found).contacts, 4);
}

TEST(RootTrack, WithoutADeclaredVelocityToo) {
  Walker walker("walk", 1.2, 28);
  walker.sequence.root_velocity_mps = glm::dvec3(0);
  EXPECT_NEAR(track(walker).back().y, walker.travelled(1), 1e-3);
}

TEST(RootTrack, FollowsASpeedThatVariesWithinThePass) {
  const Walker walker("walk", 1.2, 28, 0.3);
  const auto found = track(walker);
  std::vector<glm::vec3> constant;
  for (uint32_t t = 0; t <= 28; ++t) {
    EXPECT_NEAR(found[t].y, walker.travelled(t / 28.0), 0.01) << t;
    constant.emplace_back(0, 1.2 * t / 25, 0);
  }
  EXPECT_LT(skate(walker, found).max_m, 0.3 * skate(walker, constant).max_m);
}

TEST(RootTrack, ADeclaredVelocityFarFromTheFeetWins) {
  Walker walker("walk", 1.2, 28);
  walker.sequence.root_velocity_mps = {0, 0, 1.6};
  std::string note;
  EXPECT_NEAR(track(walker, &note).back().y, 1.6 * 28 / 25, 1e-4);
  EXPECT_NE(note.find("walk"), std::string::npos);
  walker.sequence.root_velocity_mps = {0, 0, 1.3};
  note.clear();
  EXPECT_NEAR(track(walker, &note).back().y, walker.travelled(1), 0.02);
  EXPECT_EQ(note, "");
}

TEST(RootTrack, AStandingFigureStays) {
  Walker walker("stand", 0, 20);
  walker.sequence.loop = false;
  const auto found = track(walker);
  ASSERT_EQ(found.size(), 21u);
  EXPECT_LT(glm::length(found.back()), 1e-4);
}

}  // namespace
}  // namespace fourdvt::bake
