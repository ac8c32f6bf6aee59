// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bake/transitions.h"
#include "motion/motion_graph.h"
#include "motion/placement.h"
#include "motion_shapes.h"

namespace fourdvt::bake {
namespace {

bool keepOn(double) { return true; }

TransitionState stateOf(const Walker& walker) {
  TransitionState state;
  state.frame_count = walker.sequence.frame_count;
  state.fps = 25;
  state.loop = walker.sequence.loop;
  state.weight_rows = {{1}};
  state.positions = [walker](uint32_t, uint32_t t) -> Result<Positions> { return walker.frame(t); };
  state.root = [walker](uint32_t, uint32_t t) {
    return glm::vec3(0, walker.travelled(double(t) / walker.sequence.frame_count), 0);
  };
  return state;
}

Positions placed(Positions p, const motion::Placement& placement) {
  const glm::mat4 world = motion::worldFromCharacter(placement);
  for (glm::vec3& v : p) v = glm::vec3(world * glm::vec4(v, 1));
  return p;
}

motion::MotionGraph graphOf(const std::vector<TransitionState>& states, const TransitionOptions& options = {}) {
  package::Character character;
  for (const TransitionState& state : states) {
    package::Sequence sequence;
    sequence.frame_count = state.frame_count;
    sequence.loop = state.loop;
    sequence.members.resize(state.weight_rows[0].size());
    character.sequences.push_back(sequence);
  }
  auto bytes = buildMotionGraph(states, options, keepOn);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message;
  auto graph = motion::MotionGraph::read(bytes.value(), character);
  EXPECT_TRUE(graph.ok()) << graph.error().message;
  return graph.take();
}

TEST(Transitions, FindTheSameMotionElsewhereTurnedAndMoved) {
  const Walker walker("walk", 1.2, 28);
  Walker later = walker;
  later.first_share = 10.0 / 28;
  const motion::Placement away{{0.4f, -0.7f}, 0.9f};  // where the other capture stood
  TransitionState moved = stateOf(later);
  moved.positions = [=](uint32_t, uint32_t t) -> Result<Positions> { return placed(later.frame(t), away); };
  moved.root = [=](uint32_t, uint32_t t) {  // along its own heading
    const glm::vec2 step = motion::moved({glm::vec2(0), 0.9f}, {0, 1.2f * float(t) / 25, 0}).ground_m;
    return glm::vec3(step, 0);
  };
  const motion::MotionGraph graph = graphOf({stateOf(walker), moved});
  for (uint32_t t = 0; t < 28; ++t) {
    const motion::Entry* entry = graph.entry(0, t, 0, 1);
    ASSERT_NE(entry, nullptr);
    EXPECT_EQ(entry->frame, (t + 18) % 28);
    EXPECT_LT(entry->cost, 1);
    // The other's points, moved by the shift, are this one's.
    const Positions fitted =
        placed(moved.positions(0, entry->frame).value(), {glm::vec2(entry->shift), entry->shift.z});
    EXPECT_LT(largestDistance(fitted, walker.frame(t)), 0.002) << t;
  }
}

TEST(Transitions, CostIsMillimetresOfDistance) {
  // Everything 12 mm higher: nothing over the ground can help.
  const Walker stand("stand", 0, 4);
  TransitionState higher = stateOf(stand);
  higher.positions = [=](uint32_t, uint32_t t) -> Result<Positions> {
    Positions p = stand.pose(0);
    for (glm::vec3& v : p) v.y += 0.012f;
    return p;
  };
  TransitionState still = stateOf(stand);
  still.positions = [=](uint32_t, uint32_t) -> Result<Positions> { return stand.pose(0); };
  EXPECT_NEAR(graphOf({still, higher}).entry(0, 2, 0, 1)->cost, 12, 0.1);
}

TEST(Transitions, OppositeMotionDoesNotFit) {
  const Walker walker("walk", 1.2, 28);
  TransitionState backwards = stateOf(walker);
  backwards.positions = [=](uint32_t, uint32_t t) -> Result<Positions> { return walker.frame((28 - t) % 28); };
  backwards.root = [](uint32_t, uint32_t t) { return glm::vec3(0, -1.2f * float(t) / 25, 0); };
  // Every pose is there, but none moves the same way.
  EXPECT_GT(graphOf({stateOf(walker), backwards}).entry(0, 5, 0, 1)->cost, 100);
  TransitionOptions shape_only;
  shape_only.velocity_weight = 0;
  const auto graph = graphOf({stateOf(walker), backwards}, shape_only);
  EXPECT_EQ(graph.entry(0, 5, 0, 1)->frame, 23u);
  EXPECT_LT(graph.entry(0, 5, 0, 1)->cost, 1);
}

TEST(Transitions, SpeedOverTheGroundCounts) {
  // The same treadmill poses at rest and travelling differ by the travel alone.
  const Walker stand("stand", 0, 6);
  TransitionState gliding = stateOf(stand);
  gliding.root = [](uint32_t, uint32_t t) { return glm::vec3(0, 0.5f * float(t) / 25, 0); };
  EXPECT_NEAR(graphOf({stateOf(stand), gliding}).entry(0, 1, 0, 1)->cost, 1000 * 0.2 * 0.5, 1);  // √λ_v = 0.2 s
}

TEST(Transitions, AppearanceDecidesBetweenEqualPoses) {
  const Walker stand("stand", 0, 6);
  TransitionState still = stateOf(stand), other = stateOf(stand);
  for (TransitionState* state : {&still, &other})
    state->positions = [=](uint32_t, uint32_t) -> Result<Positions> { return stand.pose(0); };
  still.atlas = [](uint32_t, uint32_t) -> Result<Image> { return Image(32, 32, 3, 200); };
  other.atlas = [](uint32_t, uint32_t t) -> Result<Image> { return Image(32, 32, 4, t == 4 ? 149 : 20); };
  const auto graph = graphOf({still, other});
  EXPECT_EQ(graph.entry(0, 0, 0, 1)->frame, 4u);
  EXPECT_NEAR(graph.entry(0, 0, 0, 1)->cost, 60 * 0.2, 0.1);
  other.atlas = [](uint32_t, uint32_t) -> Result<Image> { return Image(16, 16, 3); };
  EXPECT_FALSE(buildMotionGraph({still, other}, {}, keepOn).ok());
}

TEST(Transitions, WhatDoesNotLoopIsEnteredNearItsStart) {
  const Walker walker("walk", 1.2, 40);
  TransitionState once = stateOf(walker);
  once.loop = false;
  const auto graph = graphOf({stateOf(walker), once});
  for (uint32_t t = 0; t < 40; ++t) {
    EXPECT_GE(graph.entry(0, t, 0, 1)->frame, 5u);
    EXPECT_LE(graph.entry(0, t, 0, 1)->frame, 10u);
  }
  Walker brief("brief", 1.2, 3);
  TransitionState short_one = stateOf(brief);
  short_one.loop = false;
  EXPECT_EQ(graphOf({stateOf(walker), short_one}).entry(0, 0, 0, 1)->frame, 1u);
}

TEST(Transitions, ClassesAreEnteredAtTheirBestWeight) {
  const Walker slow("slow", 1.2, 28), fast("fast", 2, 28);
  TransitionState both = stateOf(slow);
  both.weight_rows = {{1, 0}, {0, 1}};
  both.positions = [=](uint32_t row, uint32_t t) -> Result<Positions> {
    return row == 0 ? slow.frame(t) : fast.frame(t);
  };
  both.root = [=](uint32_t row, uint32_t t) { return glm::vec3(0, (row == 0 ? slow : fast).travelled(t / 28.0), 0); };
  const auto graph = graphOf({stateOf(fast), both});
  EXPECT_EQ(graph.entry(0, 3, 0, 1)->weight_row, 1u);
  EXPECT_EQ(graph.entry(0, 3, 0, 1)->frame, 3u);
  EXPECT_GT(graph.entry(1, 3, 0, 0)->cost, 20);
  EXPECT_LT(graph.entry(1, 3, 1, 0)->cost, 1);
}

TEST(Transitions, ErrorsAndStopsComeThrough) {
  const Walker walker("walk", 1.2, 8);
  TransitionState broken = stateOf(walker);
  broken.positions = [](uint32_t, uint32_t t) -> Result<Positions> {
    if (t == 5) return Error{ErrorId::FileMissing, "gone"};
    return Walker("walk", 1.2, 8).frame(t);
  };
  EXPECT_EQ(buildMotionGraph({stateOf(walker), broken}, {}, keepOn).error().id, ErrorId::FileMissing);
  const auto stopped = buildMotionGraph({stateOf(walker)}, {}, [](double share) { return share < 0.3; });
  EXPECT_EQ(stopped.error().id, ErrorId::Interrupted);
}

}  // namespace
}  // namespace fourdvt::bake
