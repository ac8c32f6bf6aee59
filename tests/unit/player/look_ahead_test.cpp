// SPDX-License-Identifier: Apache-2.0
// Prefetching of other motions' beginnings while the network is idle: the time saved, and no delay of requests.
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr uint32_t kEntry = 23;

FakeCharacter fourMotions(bool graph = true) {
  FakeCharacter character = FakeBuilder().build({{"walk", 900, 10, 25, true, 192, 16, {}, 3},
                                                 {"run", 60, 10, 25, true, 192, 16, {}, 3},
                                                 {"wave", 60, 10, 25, false, 192, 16, {}, 3},
                                                 {"idle", 200, 10, 25, true, 192, 16, {}, 3},
                                                 {"jump", 60, 10, 25, false, 192, 16, {}, 3}});
  if (graph)
    FakeBuilder::addGraph(character, [](uint32_t, uint32_t, uint32_t) { return motion::Entry{kEntry, 0, 10, 5}; });
  return character;
}

EdgeOptions slowNetwork() {
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  options.bits_per_s = 150'000;                   // three times the rate of a motion
  options.player.encoded_budget_bytes = 200'000;  // less than the first motion
  options.fetch_latency_s = 0;
  return options;
}

struct Scene {
  explicit Scene(const FakeCharacter& character, const EdgeOptions& options = slowNetwork())
      : edge(character, options) {
    EXPECT_TRUE(edge.load());
    edge.player->play();
    run(40);
  }
  void run(double seconds) {
    edge.runUntil([] { return false; }, seconds);
  }
  Player& player() { return *edge.player; }
  // Time until a picture of the state is shown.
  double waitFor(const std::string& state) {
    const double asked_s = edge.now_s;
    EXPECT_TRUE(player().goTo(state).ok());
    EXPECT_TRUE(edge.runUntil(
        [&] { return player().inTransition() || (player().sequence()->name == state && !player().seeking()); }));
    return edge.now_s - asked_s;
  }
  SimulatedEdge edge;
};

}  // namespace

TEST(LookAhead, AMotionIsSeenSooner) {
  const FakeCharacter character = fourMotions();
  EdgeOptions options = slowNetwork();
  options.bits_per_s = 80'000;
  double without_s = 0, with_s = 0;
  for (const bool ahead : {false, true}) {
    Scene scene(character, options);
    const int waiting = scene.edge.events[EventKind::Waiting];
    if (ahead) scene.player().lookAhead(true);
    scene.run(10);
    (ahead ? with_s : without_s) = scene.waitFor("run");
    EXPECT_EQ(scene.edge.events[EventKind::Waiting], waiting);
    scene.run(3);
    EXPECT_EQ(scene.player().sequence()->name, "run");
    EXPECT_TRUE(scene.edge.errors.empty());
  }
  EXPECT_LE(with_s, 0.4) << "the bound of a transition whose target is there";
  EXPECT_GT(without_s, with_s + 0.2);
  std::printf("goTo: seen after %.2f s, with look-ahead %.2f s\n", without_s, with_s);
}

TEST(LookAhead, BeginsWithACommandOrAtOnceAndNotWithANamedRendition) {
  const FakeCharacter character = fourMotions();
  const auto asked = [&](bool at_once, bool command, uint32_t rendition) {
    EdgeOptions options = slowNetwork();
    options.bits_per_s = 0;
    options.player.rendition = rendition;
    Scene scene(character, options);
    scene.player().lookAhead(at_once);
    if (command) scene.waitFor("run");
    scene.run(20);
    const uint64_t before = scene.edge.bytes_asked;
    scene.waitFor("idle");
    scene.run(2);
    return scene.edge.uris.count("jump.bin") > 0 && scene.edge.bytes_asked > before;
  };
  EXPECT_FALSE(asked(false, false, 0));
  EXPECT_FALSE(asked(true, true, 0)) << "named: also for visitors who save data";
  EXPECT_TRUE(asked(true, false, kAutomaticRendition));
  EXPECT_TRUE(asked(false, true, kAutomaticRendition));
}

TEST(LookAhead, NothingOfAnotherMotionWithoutACommand) {
  Scene scene(fourMotions());
  scene.player().lookAhead(false);
  scene.run(30);
  for (const char* uri : {"run.bin", "wave.bin", "idle.bin", "jump.bin"})
    EXPECT_EQ(scene.edge.uris.count(uri), 0u) << uri;
}

// A page enables the prefetching with the second part of the player, possibly after the visitor's first command.
TEST(LookAhead, CountsACommandSinceTheFirstPictureAndNotTheFirstMotion) {
  const FakeCharacter character = fourMotions();
  for (const bool command : {false, true}) {
    EdgeOptions options;
    options.player.rendition = kAutomaticRendition;
    SimulatedEdge edge(character, options);
    Player& player = *edge.player;
    ASSERT_TRUE(player.selectSequence("run").ok());  // as by an attribute
    ASSERT_TRUE(edge.load());
    player.play();
    const auto run = [&] { edge.runUntil([] { return false; }, 10); };
    run();
    ASSERT_TRUE(player.hasFrame());
    if (command) {
      ASSERT_TRUE(player.goTo("idle").ok());
      run();
    }
    player.lookAhead(false);
    run();
    EXPECT_EQ(edge.uris.count("jump.bin") > 0, command);
  }
}

// A seek at any moment during the prefetching.
TEST(LookAhead, NoNeedWaitsForIt) {
  const FakeCharacter character = fourMotions();
  int under_way = 0;
  const auto wait = [&](bool ahead, double moment_s) {
    EdgeOptions options = slowNetwork();
    options.player.encoded_budget_bytes = 100'000;
    Scene scene(character, options);
    const int waiting = scene.edge.events[EventKind::Waiting];
    if (ahead) scene.player().lookAhead(true);
    scene.run(moment_s);
    if (ahead) under_way += scene.edge.uris.count("run.bin") > 0 && scene.edge.uris.count("idle.0.mp4") == 0;
    const double sought_s = scene.edge.now_s;
    scene.player().seekFrame(400);  // not held
    EXPECT_TRUE(scene.edge.runUntilShown());
    const double waited_s = scene.edge.now_s - sought_s;
    scene.run(20);
    EXPECT_EQ(scene.edge.uris.count("idle.0.mp4"), ahead ? 1u : 0u) << "it goes on later";
    EXPECT_LE(scene.edge.max_bytes_held, options.player.encoded_budget_bytes);
    EXPECT_EQ(scene.edge.events[EventKind::Waiting], waiting);
    return waited_s;
  };
  for (double moment_s = 0.02; moment_s < 0.6; moment_s += 0.08)
    EXPECT_LE(wait(true, moment_s), wait(false, moment_s) + 0.02) << moment_s;
  EXPECT_GT(under_way, 3);
}

TEST(LookAhead, IsBoundedInBytesAndInMotions) {
  EdgeOptions options = slowNetwork();
  options.bits_per_s = 0;
  FakeCharacter character = fourMotions(false);
  FakeBuilder::addGraph(character, [](uint32_t, uint32_t frame, uint32_t) {
    return motion::Entry{frame % 50, 0, 10, 5};
  });
  Scene scene(character, options);
  scene.player().lookAhead(true);
  scene.run(60);
  EXPECT_EQ(scene.edge.uris.count("jump.bin"), 0u) << "the fourth motion";
  for (const char* uri : {"run.0.mp4", "wave.0.mp4", "idle.0.mp4"}) {
    EXPECT_GE(scene.edge.uris.count(uri), 1u) << uri;
    EXPECT_LE(scene.edge.uris.count(uri), 4u) << uri << ": of its six GOPs or more";
  }
}

TEST(LookAhead, AFileThatFailsIsNoErrorUntilItIsNeeded) {
  for (const char* uri : {"run.bin", "run.0.mp4"}) {
    FakeCharacter character = fourMotions();
    Scene scene(character);
    scene.edge.replaceFile(uri, {});
    scene.player().lookAhead(true);
    scene.run(20);
    EXPECT_TRUE(scene.edge.errors.empty() && scene.edge.warnings.empty());
    EXPECT_EQ(scene.edge.uris.count(uri), 1u) << "once";
    EXPECT_GE(scene.edge.uris.count("idle.0.mp4"), 1u) << "the others come";
    ASSERT_TRUE(scene.player().selectSequence("run").ok());
    scene.run(2);
    EXPECT_EQ(scene.edge.errors.size(), uri == std::string("run.bin") ? 1u : 0u) << "asked for again";
    if (scene.edge.errors.empty()) {
      EXPECT_EQ(scene.player().sequence()->name, "run");
    }
  }
}
