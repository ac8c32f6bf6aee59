// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/root_track.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

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

// Mean distance between the track and `travelled` along z, metres, over frames and 20 runs, if every vertex of `frame`
// jitters by up to 6 mm in every frame.
double jitteredError(const Walker& walker, const std::function<Positions(uint32_t)>& frame,
                     const std::function<double(uint32_t)>& travelled) {
  constexpr int kRuns = 20;
  double sum = 0;
  uint32_t count = 0;
  for (uint32_t seed = 1; seed <= kRuns; ++seed) {
    std::vector<Positions> frames;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> jitter_m(-0.006f, 0.006f);
    for (uint32_t t = 0; t < walker.sequence.frame_count; ++t) {
      frames.push_back(frame(t));
      for (glm::vec3& p : frames.back()) p += glm::vec3(jitter_m(random), 0, jitter_m(random));
    }
    const ReadPositions read = [&](const capture::CaptureSequence&, uint32_t t) {
      return Result<Positions>(frames[t]);
    };
    const auto found = rootTrack(walker.capture, walker.sequence, read).value();
    for (uint32_t t = 0; t < found.size(); ++t) sum += std::abs(found[t].y - travelled(t));
    count = uint32_t(found.size());
  }
  return sum / (kRuns * count);
}

// Errors of steps measured frame by frame would add up; a whole contact averages them. `first_share` 0.2: a foot that
// stands at the pass's end also stands at its beginning.
TEST(RootTrack, JitterDoesNotAddUpToADrift) {
  for (const double first_share : {0.0, 0.2}) {
    Walker walker("walk", 1.2, 28);
    walker.first_share = first_share;
    const double error_m = jitteredError(
        walker, [&](uint32_t t) { return walker.frame(t); },
        [&](uint32_t t) { return walker.travelled(first_share + t / 28.0) - walker.travelled(first_share); });
    EXPECT_LT(error_m, first_share == 0 ? 0.003 : 0.0035) << first_share;
  }
}

// Both feet stand still while the body, and the character's frame with it, sways: contacts as long as the loop, longer
// than the limit for one piece, and without a loop.
TEST(RootTrack, FeetThatAlwaysStandShowHowTheBodySways) {
  for (const uint32_t frames : {20u, 60u, 400u}) {
    Walker walker("sway", 0, frames);
    walker.sequence.loop = frames < 400;
    const double passes = walker.sequence.loop ? 1 : 8;
    const auto sway = [&](uint32_t t) { return 0.05 * std::sin(kTau * passes * t / frames); };
    const double error_m = jitteredError(
        walker,
        [&](uint32_t t) {
          Positions standing = walker.pose(0);
          for (glm::vec3& p : standing) p.z -= float(sway(t));
          return standing;
        },
        sway);
    EXPECT_LT(error_m, 0.003) << frames;
  }
}

TEST(RootTrack, AShortLoopStands) {
  const Walker walker("stand", 0, 3);
  EXPECT_LT(glm::length(track(walker).back()), 1e-4);
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

TEST(Footfalls, AreWhereAWalkersFeetComeDown) {
  Walker walker("walk", 1.2, 28);
  const ReadPositions read = [&](const capture::CaptureSequence&, uint32_t t) {
    return Result<Positions>(walker.frame(t));
  };
  const auto found = [&] { return footfalls(walker.capture, walker.sequence, track(walker), read).value(); };
  EXPECT_EQ(found(), (std::vector<uint32_t>{0, 14}));
  walker.first_share = 0.25;  // the loop begins while one foot stands and the other swings
  EXPECT_EQ(found(), (std::vector<uint32_t>{7, 21}));
  walker.first_share = 1.5 / 28;
  EXPECT_EQ(found(), (std::vector<uint32_t>{13, 27})) << "round the loop's end";
  walker.sequence.loop = false;
  walker.first_share = 0.25;
  EXPECT_EQ(found(), (std::vector<uint32_t>{7, 21})) << "the foot that stands in frame 0 has come down before";
}

TEST(Footfalls, ThereAreNoneWhereNobodyMoves) {
  const Walker walker("stand", 1.2, 28);
  const ReadPositions read = [&](const capture::CaptureSequence&, uint32_t) {
    return Result<Positions>(walker.frame(3));
  };
  capture::CaptureSequence still = walker.sequence;
  still.root_velocity_mps = glm::dvec3(0);
  const std::vector<glm::vec3> at_rest(29, glm::vec3(0));
  EXPECT_TRUE(footfalls(walker.capture, still, at_rest, read).value().empty());
}

}  // namespace
}  // namespace fourdvt::bake
