// SPDX-License-Identifier: Apache-2.0
// Transitions through the motion graph against the simulated edge.
#include <cmath>

#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

const glm::vec3 kShift{0.06f, -0.04f, 0.1f};
constexpr uint32_t kEntry = 12, kFade = 10;
constexpr double kWalk_s = 1.4, kRun_s = 0.7;
constexpr float kWalkStep_m = 1.75f / 28, kIdleStep_m = 0.02f;

motion::Entry chooseEntry(uint32_t source, uint32_t, uint32_t target) {
  const uint32_t row = target == 0 ? 1 : 0;  // locomotion is entered at its second member
  return {kEntry, row, kFade, 5, source < target ? kShift : glm::vec3(0)};
}

FakeCharacter threeStates(bool graph = true) {
  const FakeMember walk{1.25, kWalk_s, {0, 1.75, 0}}, run{2.7, kRun_s, {0, 1.89, 0}};
  FakeCharacter character =
      FakeBuilder().build({{"locomotion", 28, 10, 28 / 1.05, true, 192, 16, {walk, run}},
                           {"pickup", 45, 9, 30, false, 128, 32},
                           {"idle", 30, 10, 25, true, 192, 16, {{0, 1.2, {0, 30 * kIdleStep_m, 0}}}}});
  if (graph) FakeBuilder::addGraph(character, chooseEntry);
  return character;
}

struct Scene {
  explicit Scene(const FakeCharacter& character, const EdgeOptions& options = {}) : edge(character, options) {
    EXPECT_TRUE(edge.player->loadManifest(character.manifest).ok());
    EXPECT_TRUE(edge.runUntilShown());
    edge.player->play();
    run(1);
  }
  Player& player() { return *edge.player; }
  std::string state() { return player().sequence()->name; }
  void run(double seconds) {
    edge.runUntil([] { return false; }, seconds);
  }
  bool arrives(const std::string& name) {
    return edge.runUntil([&] { return state() == name && !player().seeking() && !player().inTransition(); }, 8);
  }
  bool fades() {
    return edge.runUntil([&] { return player().inTransition(); }, 8);
  }
  // Expects matching pairs of picture and mesh, and continuing frames.
  void expectPlays() {
    const uint64_t before = player().stats().frames_shown;
    for (int i = 0; i < 100; ++i) {
      edge.step(0.01);
      if (!player().inTransition()) edge.expectPaired();
    }
    EXPECT_GT(player().stats().frames_shown, before + 15);
  }
  glm::mat4 world() { return player().figure().value().world_from_character; }
  SimulatedEdge edge;
};

float distance(const glm::mat4& a, const glm::mat4& b) { return glm::length(glm::vec3(a[3] - b[3])); }

}  // namespace

TEST(PlayerTransition, FadesWithinItsLatencyAndLosesNoPicture) {
  Scene s(threeStates());
  const double asked_s = s.edge.now_s;
  const uint64_t late = s.player().stats().frames_late;
  ASSERT_TRUE(s.player().goTo("idle").ok());
  EXPECT_EQ(s.player().goal(), "idle");
  EXPECT_EQ(s.state(), "locomotion");
  ASSERT_TRUE(s.fades());
  EXPECT_LE(s.edge.now_s - asked_s, 0.4) << "with header and GOP to be fetched";
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 1);
  EXPECT_EQ(s.edge.openDecoders(), 2);
  const double fade_s = s.edge.now_s;
  float fade = 0;
  int steps = 0;
  while (s.player().inTransition()) {
    const render::Figure figure = s.player().figure().value();
    ASSERT_EQ(figure.looks.size(), 2u);
    EXPECT_GE(figure.fade, fade);
    EXPECT_LE(figure.fade - fade, 0.16f) << "a smooth step of ten frames";
    steps += figure.fade != fade;
    fade = figure.fade;
    s.edge.draw();
    s.edge.step(0.008);
  }
  EXPECT_GE(steps, 10) << "with every picture";
  EXPECT_LE(steps, 22) << "of either, and no more often";
  EXPECT_NEAR(s.edge.now_s - fade_s, 10 / 25.0, 0.05);
  EXPECT_EQ(s.state(), "idle");
  EXPECT_EQ(s.player().frame(), kEntry + kFade) << "entered as the fade began";
  EXPECT_EQ(s.edge.events[EventKind::TransitionEnded], 1);
  EXPECT_EQ(s.edge.events[EventKind::SequenceChanged], 1);
  s.edge.step(0.008);
  EXPECT_EQ(s.edge.openDecoders(), 1) << "the other decoder is given back";
  EXPECT_EQ(s.player().stats().frames_late, late);
  EXPECT_TRUE(s.edge.errors.empty());
  EXPECT_EQ(s.player().figure().value().looks.size(), 1u);
  s.expectPlays();
}

// From every frame of every state to every other state, at 60 ticks a second: the target is shown within the bound.
TEST(PlayerTransition, KeepsTheLatencyBoundFromEveryFrame) {
  FakeCharacter character = threeStates(false);
  FakeBuilder::addGraph(character, [](uint32_t source, uint32_t frame, uint32_t target) {
    motion::Entry entry = chooseEntry(source, frame, target);
    entry.cost = 10000 - 100 * float(frame);  // waiting is always cheaper
    return entry;
  });
  const char* names[] = {"locomotion", "pickup", "idle"};
  const uint32_t frames[] = {28, 44, 30};  // pickup has ended after its last one
  for (int from = 0; from < 3; ++from) {
    for (int to = 0; to < 3; ++to) {
      if (from == to) continue;
      double max_s = 0;
      for (uint32_t frame = 0; frame < frames[from]; ++frame) {
        EdgeOptions options;
        options.seed = frame + 1;
        Scene s(character, options);
        ASSERT_TRUE(s.player().selectSequence(names[from]).ok());
        s.player().seekFrame(frame);
        ASSERT_TRUE(s.edge.runUntil([&] { return s.state() == names[from] && !s.player().seeking(); }));
        const double asked_s = s.edge.now_s;
        ASSERT_TRUE(s.player().goTo(names[to]).ok());
        while (!(s.player().inTransition() && s.player().figure().value().fade > 0) && s.edge.now_s < asked_s + 2)
          s.edge.step(1 / 60.0);
        max_s = std::max(max_s, s.edge.now_s - asked_s);
      }
      EXPECT_LE(max_s, 0.4) << names[from] << " to " << names[to];
      EXPECT_GT(max_s, 0.3) << "and all of it is used";
    }
  }
}

// The drawn mesh blends from the source's to the target's, which is moved by the shift.
TEST(PlayerTransition, FadesTheMesh) {
  Scene s(threeStates());
  ASSERT_TRUE(s.player().goTo("idle").ok());
  ASSERT_TRUE(s.fades());
  double last = 0;
  const double far_m = kStep_m * kFrameStride * kSequenceFrames * 2;  // identifies idle
  while (s.player().inTransition()) {
    const float fade = s.player().figure().value().fade;
    const double share = s.edge.draw().x_m / far_m;
    EXPECT_NEAR(share, fade, 0.03);
    EXPECT_GE(share, last - 0.02);
    last = share;
    s.edge.step(0.01);
  }
}

TEST(PlayerTransition, TravelsWithoutAJump) {
  Scene s(threeStates());
  s.player().setTravel(true);
  ASSERT_TRUE(s.player().goTo("idle").ok());
  const float max_m = kWalkStep_m * 1.01f + 0.17f * glm::length(glm::vec2(kShift));
  glm::mat4 world = s.world();
  motion::Placement placement = s.player().placement();
  const glm::mat4 shift = motion::worldFromCharacter(motion::moved({}, kShift));
  glm::mat4 target(0);
  while (s.state() == "locomotion" && s.edge.now_s < 20) {
    const bool fading = s.player().inTransition();
    if (fading) target = s.world() * shift;
    s.edge.step(0.004);
    EXPECT_LE(glm::length(s.player().placement().ground_m - placement.ground_m), max_m);
    EXPECT_LE(std::abs(s.player().placement().heading_rad - placement.heading_rad), 0.17f * kShift.z + 1e-4f);
    if (s.player().inTransition() && fading) {
      EXPECT_LE(distance(s.world(), world), kWalkStep_m * 1.01f) << "the source walks on, feet on the ground";
    }
    world = s.world();
    placement = s.player().placement();
  }
  // After the last mixture the target continues from its place.
  EXPECT_LE(distance(s.world(), target), kIdleStep_m * 2);
  EXPECT_NEAR(s.player().placement().heading_rad, kShift.z, 1e-4);
}

TEST(PlayerTransition, StaysInPlaceWhenNotTravelling) {
  Scene s(threeStates());
  s.player().setPlacement({{3, 4}, 0.5f});
  ASSERT_TRUE(s.player().goTo("idle").ok());
  ASSERT_TRUE(s.fades());
  glm::mat4 world = s.world();
  while (s.player().inTransition()) {
    s.edge.step(0.004);
    EXPECT_EQ(s.player().placement().ground_m, glm::vec2(3, 4));
    if (s.player().inTransition()) {
      EXPECT_LE(distance(s.world(), world), 0.17f * glm::length(glm::vec2(kShift)) * 1.1f);
    }
    world = s.world();
  }
  EXPECT_LE(distance(s.world(), motion::worldFromCharacter({{3, 4}, 0.5f})), 1e-6f);
}

TEST(PlayerTransition, EntersAClassAtTheGraphsWeightsAndGlidesOn) {
  Scene s(threeStates());
  ASSERT_TRUE(s.player().selectSequence("idle").ok());
  ASSERT_TRUE(s.arrives("idle"));
  ASSERT_TRUE(s.player().setParameter("speed_mps", 1.6, false).ok());
  EXPECT_NEAR(s.player().parameter("speed_mps"), 1.6, 1e-12) << "kept for the class";
  ASSERT_TRUE(s.player().goTo("locomotion").ok());
  ASSERT_TRUE(s.arrives("locomotion"));
  const double at = s.player().parameter("speed_mps");
  EXPECT_LT(at, 2.7);
  s.run(2);
  EXPECT_NEAR(s.player().parameter("speed_mps"), 1.6, 1e-9);
  EXPECT_NEAR(s.edge.draw().member, 0.35 / 1.45, 1e-3);
  // The second track's parameter started at the entry's.
  ASSERT_TRUE(s.player().selectSequence("idle").ok());
  ASSERT_TRUE(s.arrives("idle"));
  ASSERT_TRUE(s.player().goTo("locomotion").ok());
  ASSERT_TRUE(s.fades());
  EXPECT_NEAR(s.player().figure().value().looks[1].weights[1], 1, 0.1);
}

TEST(PlayerTransition, AStateThatDoesNotLoopReturns) {
  Scene s(threeStates());
  ASSERT_TRUE(s.player().goTo("pickup").ok());
  ASSERT_TRUE(s.arrives("pickup"));
  uint32_t last = 0;
  while (s.state() == "pickup" && s.edge.now_s < 20) {
    s.edge.step(0.008);
    if (s.state() == "pickup") last = std::max(last, s.player().frame());
  }
  EXPECT_EQ(s.state(), "locomotion");
  EXPECT_EQ(s.player().goal(), "locomotion");
  EXPECT_GE(last, 40u) << "plays nearly to its end";
  EXPECT_EQ(s.edge.events[EventKind::Ended], 0);
  EXPECT_EQ(s.edge.events[EventKind::TransitionEnded], 2);
  s.expectPlays();
  // Ends when it is selected.
  ASSERT_TRUE(s.player().selectSequence("pickup").ok());
  s.run(4);
  EXPECT_EQ(s.state(), "pickup");
  EXPECT_EQ(s.edge.events[EventKind::Ended], 1);
}

// Returning requires a fetch that takes longer than the rest of the motion.
TEST(PlayerTransition, WaitsOnItsLastFrameForTheReturn) {
  int waited = 0;
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.player.encoded_budget_bytes = 1;
    Scene s(threeStates(), options);
    ASSERT_TRUE(s.player().goTo("pickup").ok());
    ASSERT_TRUE(s.arrives("pickup"));
    s.edge.options.fetch_latency_s = 2;
    int last_frame_ticks = 0;
    ASSERT_TRUE(s.edge.runUntil(
        [&] {
          last_frame_ticks += s.state() == "pickup" && s.player().frame() == 44;
          return s.state() == "locomotion" && !s.player().seeking();
        },
        40));
    waited += last_frame_ticks > 20;
    EXPECT_EQ(s.edge.events[EventKind::Ended], 0);
    EXPECT_FALSE(s.player().paused());
  }
  EXPECT_GT(waited, 2);
}

TEST(PlayerTransition, WithoutAGraphSelects) {
  for (int kind = 0; kind < 4; ++kind) {
    FakeCharacter character = threeStates(kind > 0);
    if (kind == 1) character.files.erase("graph.bin");
    if (kind == 2) character.files["graph.bin"][4] ^= 9;
    Scene s(character);
    if (kind == 3) s.player().pause();
    ASSERT_TRUE(s.player().goTo("idle").ok());
    ASSERT_TRUE(s.arrives("idle")) << kind;
    EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 0);
    EXPECT_EQ(s.edge.events[EventKind::SequenceChanged], 1);
    EXPECT_TRUE(s.edge.errors.empty());
    EXPECT_EQ(s.player().goal(), "idle");
    EXPECT_EQ(s.edge.openDecoders(), 1);
  }
  Scene s(threeStates());
  EXPECT_EQ(s.player().goTo("dance").error().id, ErrorId::InvalidArgument);
  ASSERT_TRUE(s.player().goTo("locomotion").ok());
  s.run(1);
  EXPECT_EQ(s.edge.events[EventKind::SequenceChanged], 0) << "it is there already";
}

// A page starts without the data for transitions.
TEST(PlayerTransition, CutsUntilTheyAreAllowed) {
  EdgeOptions options;
  options.player.transitions = false;
  Scene s(threeStates(), options);
  s.run(1);
  const auto asksForGraph = [&] {
    return std::any_of(s.edge.uris.begin(), s.edge.uris.end(),
                       [](const std::string& uri) { return uri == "graph.bin"; });
  };
  EXPECT_FALSE(asksForGraph());
  ASSERT_TRUE(s.player().goTo("idle").ok());
  ASSERT_TRUE(s.arrives("idle"));
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 0);
  s.player().allowTransitions();
  s.run(1);
  EXPECT_TRUE(asksForGraph());
  ASSERT_TRUE(s.player().goTo("locomotion").ok());
  ASSERT_TRUE(s.fades());
  ASSERT_TRUE(s.arrives("locomotion"));
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 1);
}

TEST(PlayerTransition, WithoutASecondDecoderSelects) {
  Scene s(threeStates());
  s.edge.second_decoder_fails = true;
  ASSERT_TRUE(s.player().goTo("pickup").ok());
  ASSERT_TRUE(s.arrives("pickup"));
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 0);
  EXPECT_TRUE(s.edge.errors.empty());
  EXPECT_EQ(s.edge.openDecoders(), 1);
  EXPECT_TRUE(s.arrives("locomotion")) << "and it returns all the same";
  s.expectPlays();
  EXPECT_TRUE(s.edge.errors.empty());
}

TEST(PlayerTransition, ADamagedTargetLeavesTheSourcePlaying) {
  for (const char* file : {"idle.mp4", "idle.bin"}) {
    FakeCharacter character = threeStates();
    character.files.erase(file);
    Scene s(character);
    ASSERT_TRUE(s.player().goTo("idle").ok());
    ASSERT_TRUE(s.edge.runUntil([&] { return !s.edge.errors.empty(); }));
    EXPECT_EQ(s.edge.errors[0].id, ErrorId::FetchFailed);
    s.expectPlays();
    EXPECT_EQ(s.state(), "locomotion");
    EXPECT_EQ(s.player().goal(), "locomotion");
    EXPECT_EQ(s.edge.errors.size(), 1u);
    ASSERT_TRUE(s.player().goTo("idle").ok()) << "asked for again, it is tried again";
    ASSERT_TRUE(s.edge.runUntil([&] { return s.edge.errors.size() == 2; }));
    s.expectPlays();
    EXPECT_EQ(s.edge.openDecoders(), 1);
    ASSERT_TRUE(s.player().goTo("pickup").ok());
    EXPECT_TRUE(s.arrives("pickup"));
  }
}

TEST(PlayerTransition, AfterTheirMakingAheadNoPictureWaitsForAProgram) {
  for (bool ahead : {false, true}) {
    Scene s(threeStates());
    s.edge.draw();
    while (ahead && s.player().makeNextProgram({})) continue;
    const uint64_t programs = s.edge.device.counters().live_programs;
    ASSERT_TRUE(s.player().setParameter("speed_mps", 2, true).ok());
    s.run(0.2);
    s.edge.draw();
    ASSERT_TRUE(s.player().goTo("pickup").ok());
    ASSERT_TRUE(s.fades());
    s.edge.draw();
    EXPECT_EQ(s.edge.device.counters().live_programs == programs, ahead);
    EXPECT_FALSE(ahead && s.player().makeNextProgram({}));
  }
}

TEST(PlayerTransition, SeeksAndSelectionsEndIt) {
  for (bool fading : {false, true}) {
    for (bool travel : {false, true}) {
      for (const char* selected : {"", "locomotion", "pickup", "idle"}) {
        Scene s(threeStates());
        s.player().setTravel(travel);
        ASSERT_TRUE(s.player().goTo("idle").ok());
        if (fading) {
          ASSERT_TRUE(s.fades());
          s.run(0.15);
        }
        const glm::vec2 before = s.player().placement().ground_m;
        if (*selected)
          ASSERT_TRUE(s.player().selectSequence(selected).ok());
        else
          s.player().seekFrame(7);
        EXPECT_FALSE(s.player().inTransition());
        EXPECT_LE(glm::length(s.player().placement().ground_m - before), glm::length(glm::vec2(kShift)));
        s.player().pause();
        ASSERT_TRUE(s.edge.runUntilShown());
        const std::string expected = *selected ? selected : "locomotion";
        EXPECT_EQ(s.state(), expected);
        EXPECT_EQ(s.player().goal(), expected);
        if (!*selected) {
          EXPECT_EQ(s.player().frame(), 7u);
        }
        s.edge.expectPaired();
        EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], s.edge.events[EventKind::TransitionEnded]);
        EXPECT_EQ(s.edge.openDecoders(), 1);
        s.player().play();
        s.expectPlays();
        EXPECT_EQ(s.state(), expected) << "nothing is left of it";
      }
    }
  }
}

TEST(PlayerTransition, APauseHoldsIt) {
  Scene s(threeStates());
  ASSERT_TRUE(s.player().goTo("idle").ok());
  ASSERT_TRUE(s.fades());
  s.run(0.1);
  s.player().pause();
  const float fade = s.player().figure().value().fade;
  s.run(7);
  EXPECT_TRUE(s.player().inTransition());
  EXPECT_EQ(s.player().figure().value().fade, fade);
  s.player().play();
  EXPECT_TRUE(s.arrives("idle"));
  EXPECT_EQ(s.edge.events[EventKind::TransitionEnded], 1);
}

TEST(PlayerTransition, AskedAgainWhileFadingItFollows) {
  Scene s(threeStates());
  ASSERT_TRUE(s.player().goTo("idle").ok());
  ASSERT_TRUE(s.fades());
  ASSERT_TRUE(s.player().goTo("pickup").ok());
  EXPECT_EQ(s.player().goal(), "pickup");
  ASSERT_TRUE(s.arrives("idle"));
  ASSERT_TRUE(s.arrives("pickup"));
  ASSERT_TRUE(s.arrives("idle")) << "that is where it came from";
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 3);
  // Before the fade a new command replaces the earlier one.
  ASSERT_TRUE(s.player().goTo("pickup").ok());
  ASSERT_TRUE(s.player().goTo("locomotion").ok());
  ASSERT_TRUE(s.arrives("locomotion"));
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 4);
}

TEST(PlayerTransition, AskedWhileFadingAPauseHoldsItToo) {
  Scene s(threeStates());
  ASSERT_TRUE(s.player().goTo("idle").ok());
  ASSERT_TRUE(s.fades());
  ASSERT_TRUE(s.player().goTo("pickup").ok());
  s.player().pause();
  s.run(7);
  s.player().play();
  ASSERT_TRUE(s.arrives("pickup"));
  EXPECT_EQ(s.edge.events[EventKind::TransitionStarted], 2) << "not cut";
}

TEST(PlayerTransition, SlowFetchesOnlyDelayIt) {
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.fetch_latency_s = 1;
    options.decode_latency_s = 0.02;
    Scene s(threeStates(), options);
    s.run(4);
    ASSERT_TRUE(s.player().goTo("idle").ok());
    ASSERT_TRUE(s.fades()) << seed;
    EXPECT_TRUE(s.arrives("idle"));
    EXPECT_TRUE(s.edge.errors.empty());
  }
}

// Transitions, seeks, selections, pauses in any order: no stall, and memory is bounded.
TEST(PlayerTransition, HundredsOfThemInAnyOrder) {
  const char* names[] = {"locomotion", "pickup", "idle"};
  int transitions = 0;
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.stale_delivery = 1;
    options.fetch_latency_s = 0.03 * seed;
    options.decode_latency_s = 0.002 * seed;
    options.reorder_delay = 1 + int(seed % 4);
    options.player.encoded_budget_bytes = 20000;
    Scene s(threeStates(), options);
    s.player().setTravel(true);
    const uint64_t textures = s.edge.device.counters().live_textures;
    const uint64_t shown = s.player().stats().frames_shown;
    for (const double end_s = s.edge.now_s + 60; s.edge.now_s < end_s;) {
      s.edge.step(s.edge.uniform(0.03));
      if (!s.player().inTransition() && s.player().hasFrame()) s.edge.expectPaired();
      EXPECT_LE(s.edge.openDecoders(), 2);
      EXPECT_LE(s.edge.device.counters().live_textures, textures + 3 * 4 + 8);
      switch (s.edge.below(s.player().paused() ? 12 : 150)) {
        case 0:
          s.player().seekFrame(s.edge.below(40));
          break;
        case 1:
          ASSERT_TRUE(s.player().selectSequence(names[s.edge.below(3)]).ok());
          break;
        case 2:
          s.player().pause();
          break;
        case 3:
          s.player().steer(s.edge.uniform(6));
          break;
        case 4:
          ASSERT_TRUE(s.player().setParameter("speed_mps", s.edge.uniform(4), false).ok());
          break;
        case 5:
        case 6:
        case 7:
        case 8:
          ASSERT_TRUE(s.player().goTo(names[s.edge.below(3)]).ok());
          break;
        default:
          if (s.player().paused()) s.player().play();
      }
    }
    ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << seed;
    EXPECT_GT(s.player().stats().frames_shown, shown + 600) << "stalled, seed " << seed;
    EXPECT_EQ(s.player().stats().barcode_mismatches, 0u);
    EXPECT_TRUE(s.edge.errors.empty());
    EXPECT_LE(s.edge.max_bytes_held, options.player.encoded_budget_bytes);
    EXPECT_EQ(s.edge.device.takeErrors(), "");
    transitions += s.edge.events[EventKind::TransitionStarted];
  }
  EXPECT_GT(transitions, 100);
  std::printf("%d transitions\n", transitions);
}
