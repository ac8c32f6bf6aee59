// SPDX-License-Identifier: Apache-2.0
// The state machine of transitions in isolation: phases, conditions of waiting, timeouts, and returns.
#include <gtest/gtest.h>

#include "player/parts/motion.h"

using namespace fourdvt;

namespace {

using Phase = Transitions::Phase;
using Step = Transitions::Step;

constexpr uint32_t kEntry = 12, kFade = 10;
const glm::vec3 kShift(0.1f, 0, 0.2f);

// State 0 loops, 30 frames at 30 fps; state 1 does not, 20 frames. Every frame leads to frame 12 of the other.
struct World {
  World() {
    for (uint32_t frames : {30u, 20u}) {
      package::Sequence& sequence = character.sequences.emplace_back();
      sequence.frame_count = frames;
      sequence.fps = 30;
      sequence.loop = frames == 30;
      sequence.members.resize(1);
      sequence.members[0].duration_s = frames / 30.0;
    }
    std::vector<motion::GraphState> states{{30, {{1.0f}}}, {20, {{1.0f}}}};
    std::vector<std::vector<motion::Entry>> tables(4);
    tables[1].assign(30, {kEntry, 0, kFade, 5, kShift});
    tables[2].assign(20, {kEntry, 0, kFade, 5, {}});
    graph = motion::MotionGraph::read(motion::writeMotionGraph(states, tables), character).take();
    see(0, 0);
  }
  // Source state, and the presentation that it currently shows.
  void see(int source, int64_t k) {
    view.source = source;
    view.sequence = &character.sequences[size_t(source)];
    view.loops = view.sequence->loop;
    view.k = k;
    view.clock_s = double(k) / 30;
    view.weights = weights;
    view.graph = &*graph;
    view.target_has_header = true;
  }
  Step step(double now_s) {
    view.now_s = now_s;
    return transitions.step(view);
  }
  auto plan(int target) {
    return transitions.plan(view, character.sequences[size_t(target)], character.sequences[size_t(target)].loop);
  }
  // Advances to Preparing; the fade begins at `begin_k` with the target's frame 12.
  void prepare() {
    transitions.ask(1, 0);
    transitions.setGoal(1);
    transitions.begin(1, 0);
    ASSERT_EQ(step(0), Step::Plan);
    ASSERT_TRUE(plan(1));
  }
  package::Character character;
  std::optional<motion::MotionGraph> graph;
  std::vector<float> weights{1};
  TransitionView view;
  Transitions transitions;
};

}  // namespace

TEST(PlayerPhases, WaitsForGraphAndHeaderThenPlansAndFades) {
  World w;
  EXPECT_EQ(w.step(0), Step::Nothing) << "nobody asked";
  w.transitions.begin(1, 0);
  EXPECT_EQ(w.transitions.phase(), Phase::Wanted);
  w.view.graph = nullptr;
  EXPECT_EQ(w.step(0.1), Step::Nothing);
  w.see(0, 0);
  w.view.target_has_header = false;
  EXPECT_EQ(w.step(0.1), Step::Nothing);
  w.see(0, 0);
  ASSERT_EQ(w.step(0.1), Step::Plan);
  const auto entrance = w.plan(1);
  ASSERT_TRUE(entrance);
  EXPECT_EQ(entrance->frame, kEntry);
  EXPECT_TRUE(entrance->anew);
  EXPECT_EQ(w.transitions.phase(), Phase::Preparing);
  EXPECT_EQ(w.transitions.shift(), kShift);
  w.view.target_prepared = true;
  EXPECT_EQ(w.step(0.15), Step::Nothing) << "the exit frame has not come";
  w.see(0, 20);
  ASSERT_EQ(w.step(0.4), Step::StartFade);
  w.transitions.startFade();
  EXPECT_TRUE(w.transitions.fading());
}

TEST(PlayerPhases, ATargetThatIsLateIsPlannedForAgainWithALongerLead) {
  World w;
  w.prepare();
  w.see(0, 9);
  EXPECT_EQ(w.step(0.3), Step::Plan);
  const auto entrance = w.plan(1);
  ASSERT_TRUE(entrance);
  EXPECT_FALSE(entrance->anew) << "it is being prepared there already";
  w.see(0, 9 + 7);  // .12 s ahead before, .24 s now
  EXPECT_EQ(w.step(0.5), Step::Nothing);
}

TEST(PlayerPhases, SelectsWithoutAGraphOrIfADecoderGivesNothingForFiveSeconds) {
  World w;
  w.transitions.begin(1, 0);
  w.view.graph_failed = true;
  EXPECT_EQ(w.step(0.1), Step::Select);
  w.view.graph_failed = false;
  w.view.target_has_header = false;
  EXPECT_EQ(w.step(60), Step::Nothing) << "the network is waited for";
  w.view.target_fetched = true;
  EXPECT_EQ(w.step(64.9), Step::Nothing);
  EXPECT_EQ(w.step(65.1), Step::Select);
  w.view.held = true;
  EXPECT_EQ(w.step(80), Step::Nothing);
  w.view.held = false;
  EXPECT_EQ(w.step(84), Step::Nothing) << "the pause does not count";
  EXPECT_EQ(w.step(86), Step::Select);
}

TEST(PlayerPhases, TheGraphMayHaveNoWay) {
  World w;
  w.transitions.begin(0, 0);
  EXPECT_FALSE(w.plan(0));
}

TEST(PlayerPhases, FadesWithNewPicturesAndIntoAnEndingStateFaster) {
  World w;
  w.prepare();
  w.transitions.startFade();
  EXPECT_TRUE(w.transitions.stepFade(kEntry, true));
  const float first = w.transitions.fade();
  EXPECT_GT(first, 0) << "the target is seen at once";
  EXPECT_FALSE(w.transitions.stepFade(kEntry + 1, false)) << "no new picture";
  EXPECT_FALSE(w.transitions.stepFade(kEntry, true)) << "no time has passed";
  EXPECT_TRUE(w.transitions.stepFade(kEntry + 3, true));
  EXPECT_GT(w.transitions.fade(), first);
  EXPECT_TRUE(w.transitions.stepFade(19, false)) << "the end needs no picture";
  EXPECT_EQ(w.transitions.fade(), 1) << "its last frame is 19, seven after the entry";
}

TEST(PlayerPhases, AskedWhileFadingItIsTakenUpLater) {
  World w;
  EXPECT_FALSE(w.transitions.ask(1, 0)) << "to begin at once";
  w.prepare();
  w.transitions.startFade();
  EXPECT_TRUE(w.transitions.ask(0, 1));
  EXPECT_EQ(w.transitions.goal(), 0);
  w.transitions.finish(0, true, false);
  EXPECT_EQ(w.transitions.phase(), Phase::None);
  EXPECT_EQ(w.transitions.goal(), 0) << "still wanted";
}

TEST(PlayerPhases, ACancelledOneLeavesNothing) {
  World w;
  w.prepare();
  w.transitions.startFade();
  w.transitions.stepFade(kEntry + 3, true);
  w.transitions.cancel(0);
  EXPECT_EQ(w.transitions.phase(), Phase::None);
  EXPECT_EQ(w.transitions.target(), -1);
  EXPECT_EQ(w.transitions.fade(), 0);
  EXPECT_EQ(w.transitions.goal(), 0);
  EXPECT_EQ(w.step(1), Step::Nothing);
}

TEST(PlayerPhases, AStateThatDoesNotLoopReturnsAsLateAsTheFadeAllows) {
  World w;
  EXPECT_EQ(w.transitions.returnTo(), -1);
  w.transitions.finish(0, true, false);
  ASSERT_EQ(w.transitions.returnTo(), 0);
  const package::Sequence& to = w.character.sequences[0];
  const double needed = (0.12 + 0.12) * 30 + kFade;  // lead, choice, fade: 17.2 frames
  for (int64_t k = 0; k < 20; ++k) {
    w.see(1, k);
    EXPECT_EQ(w.transitions.returnDue(w.view, to), 19 - double(k) <= needed) << k;
    w.view.graph = nullptr;
    EXPECT_EQ(w.transitions.returnDue(w.view, to), k == 19) << "without a graph at the end";
  }
  w.transitions.askReturn(3);
  EXPECT_EQ(w.transitions.goal(), 0);
  w.transitions.finish(1, false, true);
  EXPECT_EQ(w.transitions.returnTo(), -1) << "it is back";
  w.transitions.finish(1, false, false);
  EXPECT_EQ(w.transitions.returnTo(), -1) << "never to one that ends itself";
}
