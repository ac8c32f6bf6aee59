// SPDX-License-Identifier: Apache-2.0
// Root motion and parameters in isolation: placement, steering, steps, fades; gliding values.
#include <gtest/gtest.h>

#include <cmath>

#include "player/parts/motion.h"

using namespace fourdvt;

namespace {

using Side = RootMotion::Side;

constexpr float kPi = 3.14159265f;

void expectNear(const motion::Placement& placement, glm::vec2 ground_m, float heading_rad) {
  EXPECT_NEAR(placement.ground_m.x, ground_m.x, 1e-5);
  EXPECT_NEAR(placement.ground_m.y, ground_m.y, 1e-5);
  EXPECT_NEAR(motion::wrapAngle(placement.heading_rad - heading_rad), 0, 1e-5);
}

// One member, frames along z: frame f lies at 0.1 f; a pass of four frames travels 0.4.
struct Walk {
  Walk() {
    sequence.frame_count = frames.frame_count = 4;
    sequence.members.resize(1);
    sequence.members[0].travel = {0, 0.4, 0};
    for (int f = 0; f < 4; ++f) frames.root.push_back({0, 0.1f * float(f), 0});
  }
  RootFrame at(uint32_t frame) {
    geometry = {&frames, &index, frame};
    return {sequence, weights, geometry};
  }
  package::Sequence sequence;
  package::ChunkFrames frames;
  package::StreamIndex index;
  FrameGeometry geometry;
  std::vector<float> weights{1};
};

}  // namespace

TEST(PlayerRootMotion, SteersTheShortWayAtTheTurnRateUntilPlaced) {
  RootMotion m(2);
  m.place({{5, -2}, 3});
  m.steer(-3);
  m.turn(0.1);
  expectNear(m.placement(), {5, -2}, 3.2f);
  m.turn(10);
  expectNear(m.placement(), {5, -2}, -3);
  m.place({{1, 2}, 0.5f});
  m.turn(1);
  expectNear(m.placement(), {1, 2}, 0.5f);
}

TEST(PlayerRootMotion, IgnoresWhatIsNoNumber) {
  RootMotion m(2);
  m.place({{1, 2}, 0.5f});
  m.place({{NAN, 2}, 0.5f});
  m.steer(NAN);
  m.turn(1);
  expectNear(m.placement(), {1, 2}, 0.5f);
}

TEST(PlayerRootMotion, MovesInItsHeadingIfItTravels) {
  RootMotion m(2);
  m.place({{0, 0}, kPi / 2});  // faces +x
  m.move({0, 1, 0}, Side::Source);
  expectNear(m.placement(), {0, 0}, kPi / 2);
  m.setTravel(true);
  m.move({0, 1, 0}, Side::Source);
  expectNear(m.placement(), {1, 0}, kPi / 2);
}

TEST(PlayerRootMotion, AFadeMovesByBothSharesAndEndsAtTheTarget) {
  const glm::vec3 shift(0.5f, 0, 0);
  RootMotion m(2);
  m.setTravel(true);
  m.beginFade(shift);
  m.setFade(0.25f);
  expectNear(m.placement(), {0.125f, 0}, 0);
  expectNear(m.sourcePlacement(), {0, 0}, 0);
  m.move({0, 1, 0}, Side::Source);
  expectNear(m.sourcePlacement(), {0, 0.75f}, 0);
  m.move({0, 1, 0}, Side::Target);
  expectNear(m.sourcePlacement(), {0, 1}, 0);
  m.setFade(1);
  expectNear(m.sourcePlacement(), {0, 1}, 0);
  m.finishFade();
  expectNear(m.placement(), {0.5f, 1}, 0);
  expectNear(m.sourcePlacement(), {0.5f, 1}, 0);
}

TEST(PlayerRootMotion, ACancelledFadeLeavesTheSourceWhereItIs) {
  for (bool travel : {false, true}) {
    RootMotion m(2);
    m.setTravel(travel);
    m.place({{1, 2}, 0});
    m.beginFade({0.5f, 0, 0});
    m.setFade(0.5f);
    m.cancelFade();
    expectNear(m.placement(), {1, 2}, 0);
  }
}

TEST(PlayerRootMotion, TheTrailLeadsOverTheEndOfTheLoop) {
  Walk walk;
  RootMotion m(2);
  m.setTravel(true);
  RootTrail trail;
  trail.keep(walk.at(3));
  trail.lead(m, Side::Source, walk.at(1), 1);
  expectNear(m.placement(), {0, 0.2f}, 0);  // the rest of the pass, and one frame
  trail.keep(walk.at(1));
  trail.lead(m, Side::Source, walk.at(2), 0);
  expectNear(m.placement(), {0, 0.3f}, 0);
  trail.keep(walk.at(2));
  trail.lead(m, Side::Source, walk.at(2), 2);
  expectNear(m.placement(), {0, 1.1f}, 0);
}

namespace {

// One parameter from 1 to 3, two members.
package::Sequence speedClass() {
  package::Sequence sequence;
  sequence.members.resize(2);
  sequence.members[0].parameter = {1};
  sequence.members[1].parameter = {3};
  sequence.space.names = {"speed"};
  sequence.space.samples = {{{1}, {1, 0}, {}}, {{3}, {0, 1}, {}}};
  sequence.space.simplices = {{0, 1, 1}};
  return sequence;
}

}  // namespace

TEST(PlayerParameters, WantedValuesAreTheFirstMembersUntilSetAndStayInRange) {
  const package::Sequence sequence = speedClass();
  Parameters parameters(1);
  EXPECT_EQ(parameters.wanted(sequence, 0), 1);
  parameters.set("height", 2);
  EXPECT_EQ(parameters.wanted(sequence, 0), 1);
  parameters.set("speed", 2.5);
  EXPECT_EQ(parameters.wanted(sequence, 0), 2.5);
  parameters.set("speed", 99);
  EXPECT_EQ(parameters.wanted(sequence, 0), 3);
}

TEST(PlayerParameters, ShownValuesGlideAtTheRate) {
  const package::Sequence sequence = speedClass();
  Parameters parameters(0.5);  // half the range a second
  ShownParameters shown;
  shown.enter(sequence, parameters);
  EXPECT_EQ(shown.value(0), 1);
  EXPECT_FALSE(shown.glide(sequence, parameters, 1)) << "it is there";
  parameters.set("speed", 3);
  EXPECT_TRUE(shown.glide(sequence, parameters, 0.5));
  EXPECT_NEAR(shown.value(0), 1.5, 1e-12);
  EXPECT_NEAR(shown.weights().members[1], 0.25, 1e-6);
  EXPECT_TRUE(shown.glide(sequence, parameters, 10));
  EXPECT_EQ(shown.value(0), 3);
}

TEST(PlayerParameters, AnEntryBeginsWhereTheGraphSaysOnce) {
  const package::Sequence sequence = speedClass();
  const Parameters parameters(1);
  ShownParameters shown;
  shown.setEntry(parametersAt(sequence, {0.1f, 0.9f}));
  EXPECT_TRUE(shown.hasEntry());
  EXPECT_EQ(parametersAt(sequence, {0.9f, 0.1f}), std::vector<double>{1});
  shown.enter(sequence, parameters);
  EXPECT_EQ(shown.value(0), 3) << "the sample with the nearest weights";
  EXPECT_FALSE(shown.hasEntry());
  shown.enter(sequence, parameters);
  EXPECT_EQ(shown.value(0), 1) << "then at the wanted value";
}
