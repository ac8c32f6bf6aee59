// SPDX-License-Identifier: Apache-2.0
// Seeks that show the GOP's key until the wanted frame is decoded: when they do so, their events and counters, and that
// no shown frame is farther from the wanted one than the frame before.
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr uint32_t kGop = 20;

EdgeOptions previewing(bool on = true) {
  EdgeOptions options;
  options.player.preview_seeks = on;
  return options;
}

FakeCharacter oneMotion() { return FakeBuilder().build({{"walk", 100, kGop, 25, true, 192, 16}}); }

struct Seeking {
  explicit Seeking(const EdgeOptions& options = previewing()) : edge(oneMotion(), options) {
    EXPECT_TRUE(edge.load());
    edge.runUntil([&] { return edge.pendingFetches().empty(); });
  }
  // Frames shown until the wanted one.
  std::vector<uint32_t> framesTo(uint32_t frame) {
    std::vector<uint32_t> seen;
    edge.player->seekFrame(frame);
    const int seeked = edge.events[EventKind::Seeked];
    uint32_t last = edge.player->frame();
    EXPECT_TRUE(edge.runUntil([&] {
      edge.expectPaired();
      if (edge.player->frame() != last) seen.push_back(last = edge.player->frame());
      EXPECT_EQ(edge.events[EventKind::Seeked] > seeked, !edge.player->seeking());
      return !edge.player->seeking();
    }));
    EXPECT_EQ(edge.player->frame(), frame);
    return seen;
  }
  SimulatedEdge edge;
};

using Frames = std::vector<uint32_t>;

}  // namespace

TEST(PreviewSeeks, TheKeyComesFirstThenTheWantedFrame) {
  Seeking s;
  EXPECT_EQ(s.framesTo(78), (Frames{60, 78}));
  EXPECT_EQ(s.framesTo(17), (Frames{0, 17}));
  const PlayerStats stats = s.edge.player->stats();
  EXPECT_EQ(stats.frames_shown, 5u);
  EXPECT_EQ(stats.frames_late, 0u);
  EXPECT_EQ(stats.barcode_mismatches, 0u);
  EXPECT_TRUE(s.edge.player->paused());
  EXPECT_EQ(s.edge.events[EventKind::Seeked], 2);
}

TEST(PreviewSeeks, TimeIsThatOfTheWantedFrame) {
  Seeking s;
  s.edge.player->seekFrame(78);
  ASSERT_TRUE(s.edge.runUntil([&] { return s.edge.player->frame() == 60; }));
  EXPECT_TRUE(s.edge.player->seeking());
  EXPECT_NEAR(s.edge.player->currentTime(), 78 / 25.0, 1e-9);
}

TEST(PreviewSeeks, NotWhereTheKeyIsWantedOrNoNearer) {
  Seeking s;
  EXPECT_EQ(s.framesTo(60), Frames{60});
  EXPECT_EQ(s.framesTo(75), Frames{75}) << "the key is shown already";
  EXPECT_EQ(s.framesTo(72), Frames{72}) << "75 is nearer than 60";
  EXPECT_EQ(s.framesTo(65), (Frames{60, 65})) << "60 is nearer than 72";
  EXPECT_EQ(s.framesTo(58), Frames{58}) << "65 of the next GOP is nearer than 40";
}

TEST(PreviewSeeks, OffByDefault) {
  EXPECT_FALSE(PlayerOptions{}.preview_seeks);
  Seeking s(previewing(false));
  EXPECT_EQ(s.framesTo(78), Frames{78});
}

TEST(PreviewSeeks, WhilePlayingTheClockWaitsForTheWantedFrame) {
  Seeking s;
  s.edge.player->play();
  ASSERT_TRUE(s.edge.runUntil([&] { return s.edge.player->frame() == 5; }));
  EXPECT_EQ(s.framesTo(50), (Frames{40, 50}));
  const uint64_t late = s.edge.player->stats().frames_late;
  ASSERT_TRUE(s.edge.runUntil([&] { return s.edge.player->frame() == 70; }, 1));
  EXPECT_EQ(s.edge.player->stats().frames_late, late);
}

TEST(PreviewSeeks, TheKeyIsSeenWhileGeometryIsDecodedInSlices) {
  Seeking s;
  s.edge.player->sliceDecoding({.steps = 2});
  s.edge.player->seekFrame(79);
  int before = 0, key = 0;
  ASSERT_TRUE(s.edge.runUntil([&] {
    before += s.edge.player->frame() == 0;
    key += s.edge.player->frame() == 60;
    return !s.edge.player->seeking();
  }));
  EXPECT_LT(before, key);
  EXPECT_EQ(s.edge.player->frame(), 79u);
}

TEST(PreviewSeeks, AnotherSequenceChangesWithItsWantedFrame) {
  FakeCharacter character =
      FakeBuilder().build({{"walk", 100, kGop, 25, true, 192, 16}, {"run", 100, kGop, 25, true, 192, 16}});
  SimulatedEdge edge(character, previewing());
  ASSERT_TRUE(edge.load());
  ASSERT_TRUE(edge.player->selectSequence("run").ok());
  edge.player->seekFrame(50);
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.player->frame(), 50u);
  EXPECT_EQ(edge.events[EventKind::SequenceChanged], 1);
  EXPECT_EQ(edge.player->stats().frames_shown, 2u) << "no key of it";
}

// Dragging a timeline: seeks follow before the previous one has finished.
TEST(PreviewSeeks, DraggingNeverShowsWhatIsFurtherAway) {
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    EdgeOptions options = previewing();
    options.seed = seed;
    options.decode_s = {0.004 * seed};
    Seeking s(options);
    if (seed % 2) s.edge.player->sliceDecoding({.steps = seed});
    int keys = 0;
    for (int drag = 0; drag < 300; ++drag) {
      const uint32_t wanted = s.edge.below(100);
      const auto distance = [&] { return std::abs(int(s.edge.player->frame()) - int(wanted)); };
      int nearest = distance();
      s.edge.player->seekFrame(wanted);
      for (uint32_t ticks = s.edge.below(20); ticks > 0; --ticks) {
        s.edge.step(0.016);
        s.edge.expectPaired();
        EXPECT_LE(distance(), nearest);
        nearest = distance();
        keys += s.edge.player->seeking() && s.edge.player->frame() % kGop == 0;
      }
      ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << seed;
    }
    EXPECT_GT(keys, 20);
    EXPECT_TRUE(s.edge.runUntilShown());
    EXPECT_TRUE(s.edge.errors.empty());
  }
}
