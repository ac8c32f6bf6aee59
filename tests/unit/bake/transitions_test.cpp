// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/transitions.h"

#include <gtest/gtest.h>

#include "motion/motion_graph.h"
#include "motion/placement.h"
#include "motion_shapes.h"

namespace fourdvt::bake {
namespace {

bool keepOn(double) { return true; }

TransitionState stateOf(const Walker& walker) {
  TransitionState state;
  state.frame_count = walker.sequence.frame_count;
  state.frames_per_s = {25};
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
  const motion::Placement away{{0.4f, -0.7f}, 0.9f};  // position of the other capture
  TransitionState moved = stateOf(later);
  moved.positions = [=](uint32_t, uint32_t t) -> Result<Positions> { return placed(later.frame(t), away); };
  moved.root = [=](uint32_t, uint32_t t) {  // along its heading
    const glm::vec2 step = motion::moved({glm::vec2(0), 0.9f}, {0, 1.2f * float(t) / 25, 0}).ground_m;
    return glm::vec3(step, 0);
  };
  const motion::MotionGraph graph = graphOf({stateOf(walker), moved});
  for (uint32_t t = 0; t < 28; ++t) {
    const motion::Entry* entry = graph.entry(0, t, 0, 1);
    ASSERT_NE(entry, nullptr);
    EXPECT_EQ(entry->frame, (t + 18) % 28);
    EXPECT_LT(entry->cost, 1);
    // The target's points, moved by the shift, coincide with the source's.
    const Positions fitted =
        placed(moved.positions(0, entry->frame).value(), {glm::vec2(entry->shift), entry->shift.z});
    EXPECT_LT(largestDistance(fitted, walker.frame(t)), 0.002) << t;
  }
}

TEST(Transitions, CostIsMillimetresOfDistance) {
  // Everything 12 mm higher: no shift over the ground reduces the cost.
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
  // All poses match, but with opposite velocities.
  EXPECT_GT(graphOf({stateOf(walker), backwards}).entry(0, 5, 0, 1)->cost, 100);
  TransitionOptions shape_only;
  shape_only.velocity_weight = 0;
  shape_only.pop_cost_mm = 0;
  shape_only.fades_s = {0.4};
  const auto graph = graphOf({stateOf(walker), backwards}, shape_only);
  const motion::Entry& entry = *graph.entry(0, 5, 0, 1);
  EXPECT_EQ((entry.frame + entry.fade_frames / 2) % 28, 18u) << "28 - 5 - 5: the same pose half way";
  EXPECT_LT(graph.entry(0, 5, 0, 1)->cost, 1);
}

TEST(Transitions, SpeedOverTheGroundCounts) {
  // The same treadmill poses, at rest and travelling, differ by the travel alone.
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
  EXPECT_EQ((graph.entry(0, 0, 0, 1)->frame + 5) % 6, 4u) << "half way";
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
    const motion::Entry& entry = *graph.entry(0, t, 0, 1);
    EXPECT_LE(entry.frame + entry.fade_frames / 2, std::max(10u, entry.fade_frames / 2)) << "or at its start";
    EXPECT_LE(entry.frame + entry.fade_frames, 39u);
  }
  Walker brief("brief", 1.2, 3);
  TransitionState short_one = stateOf(brief);
  short_one.loop = false;
  const motion::Entry whole = *graphOf({stateOf(walker), short_one}).entry(0, 0, 0, 1);
  EXPECT_EQ(whole.frame, 0u);
  EXPECT_EQ(whole.fade_frames, 2u);
}

TEST(Transitions, ClassesAreEnteredAtTheirBestWeight) {
  const Walker slow("slow", 1.2, 28), fast("fast", 2, 28);
  TransitionState both = stateOf(slow);
  both.weight_rows = {{1, 0}, {0, 1}};
  both.frames_per_s = {25, 25};
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

constexpr float kOwnStep_m = 0.03f;
constexpr uint32_t kStill = 40, kLoop = 60;

// Stands, then moves up and down by known steps; every other point is off by ±apart_m, which no rotation or shift
// corrects.
TransitionState jumper(float apart_m) {
  const Walker stand("stand", 0, kLoop);
  TransitionState state = stateOf(stand);
  state.root = [](uint32_t, uint32_t) { return glm::vec3(0); };
  state.positions = [=](uint32_t, uint32_t t) -> Result<Positions> {
    Positions p = stand.pose(0);
    const uint32_t up = t < kStill ? 0 : std::min(t - kStill, kLoop - t);
    for (size_t v = 0; v < p.size(); ++v) p[v].y += float(up) * kOwnStep_m + (v % 2 ? apart_m : -apart_m);
    return p;
  };
  return state;
}

double steepest(uint32_t fade) {
  double most = motion::fadeWeight(0, fade);
  for (uint32_t k = 0; k < fade; ++k)
    most = std::max(most, double(motion::fadeWeight(k + 1, fade) - motion::fadeWeight(k, fade)));
  return most;
}

TEST(Transitions, FadesAreAsLongAsItTakesNotToPop) {
  TransitionOptions options;
  options.pop.mean_share = 1;
  for (const float apart_m : {0.05f, 0.2f, 0.25f, 0.3f, 0.38f}) {
    uint32_t expected = 0;
    for (const double fade_s : options.fades_s)
      if (!expected && steepest(uint32_t(25 * fade_s + 0.5)) * apart_m <= options.max_pop * kOwnStep_m)
        expected = uint32_t(25 * fade_s + 0.5);
    ASSERT_GT(expected, 0u);
    const motion::Entry entry = *graphOf({jumper(0), jumper(apart_m)}, options).entry(0, 2, 0, 1);
    EXPECT_EQ(entry.fade_frames, expected) << apart_m;
    EXPECT_LE(entry.frame + entry.fade_frames, kStill + 1) << "both stand";
  }
  // No fade is long enough: takes the longest, at a price.
  const motion::Entry far = *graphOf({jumper(0), jumper(0.8f)}, options).entry(0, 2, 0, 1);
  const uint32_t longest = uint32_t(25 * options.fades_s.back() + 0.5);
  EXPECT_EQ(far.fade_frames, longest);
  const double over = steepest(longest) * 0.8 / kOwnStep_m - options.max_pop;
  EXPECT_NEAR(far.cost,
              800 + options.fade_cost_mm_per_s * (options.fades_s.back() - options.fades_s.front()) +
                  options.pop_cost_mm * over,
              5);
}

MotionPath pathOf(const TransitionState& state, double frames_per_s, float travel_m) {
  MotionPath path{frames_per_s, state.loop, {}, {}, {}};
  for (uint32_t t = 0; t < state.frame_count; ++t) {
    path.positions.push_back(state.positions(0, t).value());
    path.root_steps.push_back({0, travel_m, 0});
  }
  path.steps = ownSteps(path, 0.04);
  return path;
}

TEST(FadePath, StepsAreThoseSeenFromLookToLook) {
  const Steps at_rate = pathOf(jumper(0), 25, 0).steps[kStill];
  EXPECT_NEAR(at_rate.in_place.furthest, kOwnStep_m, 1e-6);
  EXPECT_NEAR(at_rate.in_place.mean, kOwnStep_m, 1e-6);
  EXPECT_NEAR(pathOf(jumper(0), 30, 0).steps[kStill].in_place.furthest, 2 * kOwnStep_m, 1e-6) << "two now and then";
  EXPECT_NEAR(pathOf(jumper(0), 20, 0).steps[kStill].in_place.furthest, kOwnStep_m, 1e-6);
  const Steps walked = pathOf(jumper(0), 25, 0.04f).steps[kStill];
  EXPECT_NEAR(walked.in_place.furthest, kOwnStep_m, 1e-6);
  EXPECT_NEAR(walked.travelling.furthest, 0.05, 1e-6) << "3, 4, 5";
}

TEST(FadePath, PopIsTheSteepestPartOfTheFade) {
  const MotionPath a = pathOf(jumper(0), 25, 0), b = pathOf(jumper(0.2f), 25, 0);
  const Steps own = larger(a.steps[kStill], b.steps[kStill]);
  for (const uint32_t frames : {10u, 16u}) {
    const double expected = 0.2 * steepest(frames) / kOwnStep_m;
    EXPECT_NEAR(popOf(a, b, {3, 5, frames, glm::vec3(0)}, {own, 9}, {0.04, 1}), expected, 1e-4);
    EXPECT_NEAR(popOf(a, b, {3, 5, frames, glm::vec3(0)}, {own, 9}, {0.04, 0.5}), 2 * expected, 1e-4) << "of the mean";
    // The position moves along the shift at the same speed.
    EXPECT_NEAR(popOf(a, a, {3, 5, frames, glm::vec3(0.2f, 0, 0)}, {own, 9}, {0.04, 1}), expected, 1e-4);
  }
  EXPECT_NEAR(popOf(a, a, {3, 3, 10, glm::vec3(0)}, {own, 9}, {0.04, 1}), 0, 1e-6);
  EXPECT_NEAR(popOf(a, a, {kStill, kStill, 10, glm::vec3(0)}, {own, 9}, {0.04, 1}), 1, 1e-4) << "as fast as itself";
  // During motion the fade adds to the motion's own steps.
  EXPECT_GT(popOf(a, b, {kStill - 5, kStill - 5, 10, glm::vec3(0)}, {own, 9}, {0.04, 1}), 1.5);
}

TEST(Transitions, WhatEndsIsLeftBeforeItStandsStill) {
  TransitionState once = jumper(0);
  once.loop = false;
  const auto graph = graphOf({once, jumper(0)});
  const float soon = graph.entry(0, 5, 0, 1)->cost, late = graph.entry(0, kLoop - 1, 0, 1)->cost;
  EXPECT_LT(soon, 1);
  EXPECT_GT(late, 30) << "0.4 s on its last frame, 100 mm a second";
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
