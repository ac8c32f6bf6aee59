// SPDX-License-Identifier: Apache-2.0
// A body of points whose limbs swing with a known period while it walks an arc of known speed.
#include "track/cycle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace fourdvt::track {
namespace {

constexpr uint32_t kPeriod = 24;
constexpr double kFps = 25, kSpeed_mps = 1.3, kTurn_rad_s = 0.15, kSwing_rad = 0.5;

struct Walk {
  double speed_mps = kSpeed_mps, turn_rad_s = kTurn_rad_s, swing_rad = kSwing_rad;
  double growth = 0;     // of the swing, per frame
  double sinking_m = 0;  // per frame
};

// Turns about y by `angle`, positive from +z towards +x.
glm::dvec3 turned(const glm::dvec3& p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

// Place of the walk at frame f, on the ground.
glm::dvec3 placeAt(double f, const Walk& walk) {
  const double turn = walk.turn_rad_s / kFps * f, radius = walk.turn_rad_s == 0 ? 0 : walk.speed_mps / walk.turn_rad_s;
  return glm::dvec3(2, 0, -1) + (radius == 0 ? glm::dvec3(0, 0, walk.speed_mps / kFps * f)
                                             : glm::dvec3(radius * (1 - std::cos(turn)), 0, radius * std::sin(turn)));
}

// Body at frame f: a trunk, and four limbs of which opposite ones swing alike; it faces +z at frame 0.
Positions bodyAt(double f, const Walk& walk) {
  std::vector<glm::dvec3> points;
  const double phase = glm::two_pi<double>() * f / kPeriod, swing = walk.swing_rad * (1 + walk.growth * f);
  for (int i = 0; i < 60; ++i)
    points.emplace_back(0.15 * std::cos(i), 0.9 + 0.01 * i + 0.02 * walk.swing_rad * std::cos(2 * phase),
                        0.1 * std::sin(i));
  for (const double side : {-1.0, 1.0})
    for (const double top : {0.9, 1.4})
      for (int i = 1; i <= 20; ++i) {
        const double angle = (top < 1 ? side : -side) * swing * std::sin(phase), along = 0.04 * i;
        points.emplace_back(side * (top < 1 ? 0.1 : 0.25), top - along * std::cos(angle), along * std::sin(angle));
      }
  const double turn = walk.turn_rad_s / kFps * f;
  Positions out;
  for (const glm::dvec3& p : points)
    out.emplace_back(placeAt(f, walk) + turned(p, turn) - glm::dvec3(0, walk.sinking_m * f, 0));
  return out;
}

std::vector<Positions> clip(uint32_t frames, const Walk& walk = {}) {
  std::vector<Positions> out;
  for (uint32_t f = 0; f < frames; ++f) out.push_back(bodyAt(f, walk));
  return out;
}

double farthest(const Positions& a, const Positions& b) {
  float out = 0;
  for (size_t v = 0; v < a.size(); ++v) out = std::max(out, glm::distance(a[v], b[v]));
  return out;
}

Positions moved(const GroundMotion& motion, const Positions& positions) {
  Positions out;
  for (const glm::vec3& p : positions) out.emplace_back(motion(p));
  return out;
}

// Largest second difference of three successive frames: their acceleration, metres per frame².
double bend(const Positions& a, const Positions& b, const Positions& c) {
  float out = 0;
  for (size_t v = 0; v < a.size(); ++v) out = std::max(out, glm::length(a[v] - 2.f * b[v] + c[v]));
  return out;
}

double largestBend(std::span<const Positions> frames) {
  double out = 0;
  for (size_t f = 2; f < frames.size(); ++f) out = std::max(out, bend(frames[f - 2], frames[f - 1], frames[f]));
  return out;
}

// The same of a loop that goes on into its next pass.
double largestBend(const Loop& loop) {
  std::vector<Positions> frames = loop.frames;
  for (int f = 0; f < 2; ++f) frames.push_back(moved(loop.travel, loop.frames[f]));
  return largestBend(std::span<const Positions>(frames));
}

TEST(Cycle, IsFoundInAWalkOnAnArc) {
  const auto frames = clip(3 * kPeriod);
  const auto cycle = findCycle(frames, 8, 60);
  ASSERT_TRUE(cycle);
  EXPECT_EQ(cycle->last - cycle->first, kPeriod);  // neither half of a stride nor two of them
  EXPECT_LT(cycle->error_m, 1e-5);
  EXPECT_LT(cycle->error_share, 0.01);
  EXPECT_NEAR(cycle->travel.turn_rad, kTurn_rad_s * kPeriod / kFps, 1e-5);
  EXPECT_LT(farthest(moved(cycle->travel, frames[cycle->first]), frames[cycle->last]), 1e-5);
}

// Adds up to half of `size_m` to every coordinate.
void addNoise(std::vector<Positions>& frames, float size_m) {
  uint32_t state = 1;
  for (Positions& positions : frames)
    for (glm::vec3& p : positions)
      for (int k = 0; k < 3; ++k) {
        state = 1664525 * state + 1013904223;
        p[k] += size_m * (float(state >> 8) / float(1 << 24) - 0.5f);
      }
}

// Every other stride is 4 mm higher, which is less than the noise: two strides fit a little better than one.
TEST(Cycle, IsTheShortestOfEquallyGoodOnes) {
  auto frames = clip(4 * kPeriod);
  addNoise(frames, 0.01f);
  for (uint32_t f = 0; f < frames.size(); ++f)
    for (glm::vec3& p : frames[f]) p.y += f / kPeriod % 2 == 1 ? 0.004f : 0;
  const auto cycle = findCycle(frames, 8, 60);
  ASSERT_TRUE(cycle);
  EXPECT_EQ(cycle->last - cycle->first, kPeriod);
}

// With that much noise, neighbouring lengths are nearly as good.
TEST(Cycle, IsTheBestOfNeighbouringLengths) {
  auto frames = clip(3 * kPeriod);
  addNoise(frames, 0.08f);
  const auto cycle = findCycle(frames, 8, 60);
  ASSERT_TRUE(cycle);
  EXPECT_EQ(cycle->last - cycle->first, kPeriod);
}

TEST(Cycle, IsFoundInHeightsAlone) {
  Walk walk;
  walk.speed_mps = walk.turn_rad_s = walk.swing_rad = 0;
  auto frames = clip(3 * kPeriod, walk);
  for (uint32_t f = 0; f < frames.size(); ++f)
    for (glm::vec3& p : frames[f]) p.y += 0.1f * std::sin(glm::two_pi<float>() * float(f) / kPeriod);
  const auto cycle = findCycle(frames, 8, 60);
  ASSERT_TRUE(cycle);
  EXPECT_EQ(cycle->last - cycle->first, kPeriod);
}

TEST(Cycle, IsThatOfTheWalkAndNotOfStandingBeforeIt) {
  auto frames = clip(3 * kPeriod);
  for (uint32_t f = 0; f < 40; ++f) frames.insert(frames.begin(), frames[0]);
  const auto cycle = findCycle(frames, 8, 60);
  ASSERT_TRUE(cycle);
  EXPECT_GE(cycle->first, 40u);
  EXPECT_EQ(cycle->last - cycle->first, kPeriod);
}

TEST(Cycle, RepeatsNothingWhereNothingMoves) {
  const std::vector<Positions> frames(40, bodyAt(0, {}));
  const auto cycle = findCycle(frames, 8, 60);
  ASSERT_TRUE(cycle);
  EXPECT_EQ(cycle->last - cycle->first, 8u);
  EXPECT_NEAR(cycle->error_share, 1, 1e-6);
}

TEST(Cycle, NeedsEnoughFrames) {
  EXPECT_FALSE(findCycle(clip(8), 8, 60));
  EXPECT_FALSE(findCycle(clip(2), 1, 60));
  EXPECT_FALSE(findCycle({}, 1, 60));
  EXPECT_TRUE(findCycle(clip(9), 8, 60));
}

TEST(Loop, OfAnExactCycleKeepsItsFrames) {
  const auto frames = clip(3 * kPeriod);
  const auto found = findCycle(frames, kPeriod, kPeriod);
  ASSERT_TRUE(found);
  const Loop loop = closeCycle(frames, {5, 5 + kPeriod, 0, 0, found->travel}, 6);
  ASSERT_EQ(loop.frames.size(), kPeriod);
  for (uint32_t f = 0; f < kPeriod; ++f) EXPECT_LT(farthest(loop.frames[f], frames[5 + f]), 1e-5);
}

// A stride that becomes larger and sinks closes with steps as even as its own, faded before either end or spread.
TEST(Loop, IsClosedWithoutAJump) {
  Walk walk;
  walk.growth = 0.003;
  walk.sinking_m = 0.0015;
  const auto frames = clip(3 * kPeriod, walk);
  const double usual = largestBend(frames);
  const std::vector<Positions> exact(frames.begin() + 10, frames.begin() + 11 + kPeriod);
  const auto loopOf = [&](std::span<const Positions> given, uint32_t first, uint32_t blend) {
    const auto found = findCycle(exact, kPeriod, kPeriod);
    return closeCycle(given, {first, first + kPeriod, 0, 0, found->travel}, blend);
  };
  const std::span<const Positions> all = frames;
  EXPECT_GT(largestBend({{frames.begin() + 10, frames.begin() + 10 + kPeriod}, loopOf(exact, 0, 0).travel}),
            1.5 * usual);
  EXPECT_LT(largestBend(loopOf(all, 10, 8)), 1.1 * usual);                          // fades into frames 2…9
  EXPECT_LT(largestBend(loopOf(all.subspan(10), 0, 8)), 1.1 * usual);               // into frames from the last one on
  EXPECT_LT(largestBend(loopOf(all.subspan(10, kPeriod + 1), 0, 8)), 1.1 * usual);  // spread
  EXPECT_LT(farthest(loopOf(all, 10, 8).frames[0], frames[10]), 1e-9);
  EXPECT_LT(farthest(loopOf(all.subspan(10), 0, 8).frames[kPeriod - 1], frames[9 + kPeriod]), 1e-9);
}

// The misfit that is spread does not depend on where in the room the clip is, and half of it is at each end.
TEST(Loop, SpreadsTheMisfit) {
  Walk walk;
  walk.sinking_m = 0.001;
  const auto frames = clip(kPeriod + 1, walk);
  const auto cycle = findCycle(frames, kPeriod, kPeriod);
  ASSERT_TRUE(cycle);
  const Loop loop = closeCycle(frames, *cycle, 0);
  for (uint32_t f = 0; f < kPeriod; ++f) {
    Positions level = bodyAt(f, {});
    for (glm::vec3& p : level) p.y -= float(walk.sinking_m * kPeriod / 2);
    EXPECT_LT(farthest(loop.frames[f], level), 1e-5) << f;
  }
}

TEST(Travel, HasSpeedPlaceAndHeadingOfTheWalk) {
  for (const double turn : {0.0, kTurn_rad_s, -0.4}) {
    Walk walk;
    walk.turn_rad_s = turn;
    const auto frames = clip(3 * kPeriod, walk);
    const Cycle cycle = *findCycle(frames, 8, 60);
    const Travel travel = travelOf(closeCycle(frames, cycle, 4), kFps);
    const double middle = cycle.first + 0.5 * kPeriod, heading = turn / kFps * middle;
    const glm::dvec3 wanted = kSpeed_mps * glm::dvec3(std::sin(heading), 0, std::cos(heading));
    EXPECT_LT(glm::distance(travel.velocity_mps, wanted), 0.02 * kSpeed_mps) << turn;
    EXPECT_LT(glm::distance(glm::dvec3(1, 0, 1) * travel.place_m, placeAt(middle, walk)), 0.01) << turn;
  }
}

TEST(Travel, OfSomebodyWhoStandsIsNone) {
  Walk walk;
  walk.speed_mps = walk.turn_rad_s = 0;
  walk.swing_rad = 0.05;
  const auto frames = clip(3 * kPeriod, walk);
  EXPECT_LT(glm::length(travelOf(closeCycle(frames, *findCycle(frames, 8, 60), 4), kFps).velocity_mps), 1e-4);
}

}  // namespace
}  // namespace fourdvt::track
