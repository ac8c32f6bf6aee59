// SPDX-License-Identifier: Apache-2.0
// The player against a simulated edge: for all latencies, seeks, loops and rates, picture and geometry on screen are of
// one frame, and memory is bounded.
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

FakeCharacter twoSequences() {
  return FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}, {"pickup", 23, 9, 30, false, 128, 32}});
}

uint64_t largestGopBytes(const FakeCharacter& character) {
  uint64_t largest = 0;
  for (const FakeSequence& s : character.sequences) {
    largest = std::max<uint64_t>(largest, character.files.at(s.name + ".mp4").size() / (s.frames / s.gop));
  }
  return largest + 2000;  // and for its chunk
}

}  // namespace

TEST(PlayerSimulation, LoadsPausedAtFrameZero) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  EXPECT_EQ(edge.player->frame(), 0u);
  EXPECT_TRUE(edge.player->paused());
  edge.expectPaired();
  EXPECT_EQ(edge.events[EventKind::LoadedMetadata], 1);
  EXPECT_EQ(edge.events[EventKind::CanPlay], 1);
  ASSERT_FALSE(edge.progress.empty());
  EXPECT_LE(edge.progress.back().loaded_bytes, edge.progress.back().total_bytes);
  for (int i = 0; i < 100; ++i) edge.step(0.02);
  EXPECT_EQ(edge.player->frame(), 0u);
}

TEST(PlayerSimulation, PlaysEveryFrameInOrderOverLoops) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  edge.expectEveryFrame(28, 4);
  EXPECT_EQ(edge.player->stats().barcode_mismatches, 0u);
  EXPECT_LE(edge.events[EventKind::TimeUpdate], int(edge.now_s * 4) + 1);
}

TEST(PlayerSimulation, PlaysTheChosenRenditionOfEverySequence) {
  const FakeCharacter character =
      FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 3}, {"pickup", 23, 9, 30, false, 144, 32, {}, 2}});
  for (uint32_t rendition : {0u, 1u, 2u, kHighestRendition}) {
    SimulatedEdge edge(character, {.player = {.rendition = rendition}});
    ASSERT_TRUE(edge.load());
    edge.expectPaired();
    edge.player->play();
    for (const char* sequence : {"pickup", "walk"}) {
      ASSERT_TRUE(edge.player->selectSequence(sequence).ok());
      ASSERT_TRUE(edge.runUntilShown());
      for (int i = 0; i < 30; ++i) edge.step(0.02);
      edge.expectPaired();
    }
    EXPECT_TRUE(edge.errors.empty());
    EXPECT_EQ(edge.player->stats().barcode_mismatches, 0u);
  }
}

TEST(PlayerSimulation, RunsAtTheSequencesRate) {
  const FakeCharacter character = twoSequences();
  for (double rate : {0.5, 1.0, 2.0, 4.0}) {
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.load());
    edge.player->setRate(rate);
    edge.player->play();
    edge.runUntil([] { return false; }, 2);  // caches fill
    int frames = 0;
    for (uint32_t last = edge.player->frame(); edge.now_s < 12;) {
      edge.step(0.004);
      frames += int((edge.player->frame() + 28 - last) % 28);
      last = edge.player->frame();
    }
    EXPECT_NEAR(frames / (10 * 25 * rate), 1, 0.06) << rate;
  }
}

TEST(PlayerSimulation, AtRateZeroItPlaysAndTheFrameStays) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  edge.runUntil([] { return false; }, 1.5);
  edge.player->setRate(0);
  const uint32_t frame = edge.player->frame();
  const int updates = edge.events[EventKind::TimeUpdate];
  edge.runUntil([] { return false; }, 3);
  EXPECT_EQ(edge.player->frame(), frame);
  EXPECT_FALSE(edge.player->paused());
  EXPECT_EQ(edge.events[EventKind::TimeUpdate], updates);
  EXPECT_EQ(edge.events[EventKind::Paused], 0);
  EXPECT_TRUE(edge.player->goTo("pickup").ok());  // by a cut, since it is paused
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->sequence()->name == "pickup" && !edge.player->seeking(); }));
  EXPECT_EQ(edge.player->frame(), 0u);
  edge.player->setRate(1);
  EXPECT_TRUE(edge.runUntil([&] { return edge.player->frame() > 5; }));
  EXPECT_TRUE(edge.errors.empty());
}

TEST(PlayerSimulation, TheClocksTimeGoesOnBetweenFramesAndRoundTheLoop) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 20, 10, 10, true, 192, 16}});
  SimulatedEdge edge(character, {});
  EXPECT_EQ(edge.player->clockTime(), 0);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  double last = edge.player->clockTime();
  int between = 0, begun = 0;
  edge.runUntil(
      [&] {
        const double now = edge.player->clockTime(), of_frame = edge.player->currentTime();
        if (now < last) ++begun;
        last = now;
        between += now > of_frame + 0.02;
        EXPECT_GE(now, of_frame - 1e-6);
        EXPECT_LE(now, of_frame + 0.1 + 1e-6);
        return false;
      },
      5);
  EXPECT_EQ(begun, 2);
  EXPECT_GT(between, 20);
  edge.player->pause();
  edge.player->seekFrame(7);
  EXPECT_NEAR(edge.player->clockTime(), 0.7, 1e-9) << "wanted, not shown yet";
  EXPECT_EQ(edge.player->clockTime(), 0.7);
}

TEST(PlayerSimulation, BufferedIsWhatPlaysWithoutAFetch) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 100, 10, 25, false, 192, 16}});
  EdgeOptions options;
  options.player.encoded_budget_bytes = 1;  // keeps the necessary data only
  SimulatedEdge edge(character, options);
  EXPECT_FALSE(edge.player->buffered(0));
  ASSERT_TRUE(edge.load());
  edge.runUntil([&] { return edge.pendingFetches().empty(); });
  const auto first = edge.player->buffered(0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->start_s, 0);
  EXPECT_GT(first->end_s, 0.39);
  EXPECT_FALSE(edge.player->buffered(1));
  edge.player->seekFrame(60);
  ASSERT_TRUE(edge.runUntilShown());
  edge.runUntil([&] { return edge.pendingFetches().empty(); });
  const auto later = edge.player->buffered(0);
  ASSERT_TRUE(later);
  EXPECT_NEAR(later->start_s, 2.4, 1e-9) << "what was before has gone";
  EXPECT_LE(later->end_s, 4 + 1e-9);
}

TEST(PlayerSimulation, SeeksToEveryFrameExactly) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
  edge.expectExactSeeks();
  EXPECT_EQ(edge.events[EventKind::Seeked], 28 + 23);
  edge.player->seekFrame(9999);
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.player->frame(), 22u);
}

TEST(PlayerSimulation, EndsOnTheLastFrameAndPlaysAgain) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
  ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
  edge.player->play();
  for (int round = 1; round <= 2; ++round) {
    ASSERT_TRUE(edge.runUntil([&] { return edge.events[EventKind::Ended] == round; }));
    EXPECT_EQ(edge.player->frame(), 22u);
    EXPECT_EQ(edge.player->currentTime(), edge.player->sequence()->duration_s());
    EXPECT_EQ(edge.events[EventKind::Paused], round);
    EXPECT_TRUE(edge.player->paused());
    edge.expectPaired();
    edge.player->play();
  }
  EXPECT_GE(edge.flushes, 2);
  edge.player->pause();
  edge.player->seek(edge.player->sequence()->duration_s());
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.player->frame(), 22u);
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 3; })) << "from the beginning";
  edge.player->setLoop(1);
  const int ended = edge.events[EventKind::Ended];
  edge.runUntil([] { return false; }, 5);
  EXPECT_EQ(edge.events[EventKind::Ended], ended);
}

TEST(PlayerSimulation, KeepsTheOldPictureUntilTheNewSequenceIsReady) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  for (const char* name : {"pickup", "walk", "pickup"}) {
    ASSERT_TRUE(edge.player->selectSequence(name).ok());
    for (int i = 0; i < 400 && edge.player->seeking(); ++i) {
      edge.expectPaired();
      edge.step(0.006);
    }
    EXPECT_FALSE(edge.player->seeking());
    edge.expectPaired();
  }
  EXPECT_EQ(edge.events[EventKind::SequenceChanged], 3);
  EXPECT_EQ(edge.player->selectSequence("dance").error().id, ErrorId::InvalidArgument);
}

TEST(PlayerSimulation, ADecoderThatHoldsManyPicturesDoesNotStallIt) {
  const FakeCharacter character = twoSequences();
  EdgeOptions options;
  options.reorder_delay = 14;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  EXPECT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown > 60; }));
}

// Ten thousand presentations with seeks, loops, rates, pauses and sequence changes, over several seeds.
TEST(PlayerSimulation, TenThousandFramesWithoutAMismatch) {
  const FakeCharacter character = twoSequences();
  uint64_t shown = 0, checked = 0, mismatches = 0;
  int stale = 0;
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.fetch_latency_s = 0.02 * seed;
    options.decode_latency_s = 0.001 * seed;
    options.stale_delivery = 1;
    options.reorder_delay = 1 + int(seed % 4);
    options.player.encoded_budget_bytes = seed % 2 ? 4 * largestGopBytes(character) : 1u << 20;
    SimulatedEdge edge(character, options);
    ASSERT_TRUE(edge.load());
    edge.player->play();
    uint32_t last = 9999;
    for (uint64_t target = 1000; edge.player->stats().frames_shown < target && edge.now_s < 400;) {
      edge.step(edge.uniform(0.03));
      if (edge.player->frame() != last) edge.expectPaired();
      last = edge.player->frame();
      switch (edge.below(80)) {
        case 0:
          edge.player->seekFrame(edge.below(30));
          break;
        case 1:
          edge.player->setRate(0.25 + edge.uniform(3.7));
          break;
        case 2:
          ASSERT_TRUE(edge.player->selectSequence(edge.below(2) ? "walk" : "pickup").ok());
          break;
        case 3:
          edge.player->pause();
          break;
        case 4:
          edge.player->setLoop(int(edge.below(3)) - 1);
          break;
        default:
          if (edge.player->paused() && edge.below(10) == 0) edge.player->play();
      }
    }
    ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << seed;
    ASSERT_GE(edge.player->stats().frames_shown, 1000u) << "stalled, seed " << seed;
    EXPECT_TRUE(edge.errors.empty());
    EXPECT_LE(edge.max_slots_busy, options.player.picture_slots);
    EXPECT_LE(edge.max_bytes_held, options.player.encoded_budget_bytes) << seed;
    shown += edge.player->stats().frames_shown;
    checked += edge.player->stats().barcode_checked;
    mismatches += edge.player->stats().barcode_mismatches;
    stale += edge.stale_answers;
  }
  EXPECT_GE(shown, 10000u);
  EXPECT_EQ(mismatches, 0u);
  EXPECT_GT(stale, 20);
  std::printf("%llu shown, %llu barcodes, %d stale answers refused\n", static_cast<unsigned long long>(shown),
              static_cast<unsigned long long>(checked), stale);
}
