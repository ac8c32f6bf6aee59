// SPDX-License-Identifier: Apache-2.0
// Geometry decoded in slices: amount and order of decoding per tick, equality of playing and seeking with and without
// slices, and reports of damage.
#include "camera_character.h"
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr uint32_t kStepsOfARow = 2;  // positions and labels of one member
constexpr bool kSought = false;       // replaces `due`

FakeCharacter twoSequences() {
  return FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}, {"pickup", 23, 9, 30, false, 128, 32}});
}

// Loading with all fetches answered.
struct Held {
  explicit Held(FakeCharacter made = twoSequences(), uint32_t rendition = kHighestRendition)
      : character(std::move(made)), loading(outbox, 1 << 20, rendition) {
    EXPECT_TRUE(loading.readManifest(character.manifest).ok());
  }
  void fill(const Need& need) {
    for (bool more = true; more;) {
      loading.requestMissing({&need, 1}, -1);
      more = false;
      for (Request request; outbox.nextRequest(request); more = true) {
        const FetchRange& range = std::get<FetchRange>(request);
        const std::span<const uint8_t> file = character.files.at(range.uri);
        EXPECT_TRUE(loading.receive(range.id, file.subspan(range.offset, range.bytes)).status.ok());
      }
    }
  }
  uint64_t ahead(const Need& need) {
    const uint64_t rows = loading.decodeStats().rows;
    loading.decodeAhead({&need, 1}, false);
    return loading.decodeStats().rows - rows;
  }
  bool has(uint32_t frame, bool due = true) {
    FrameGeometry found;
    EXPECT_TRUE(loading.geometry(0, frame, due, found).ok());
    if (found) {
      EXPECT_EQ(found.frames->positions[found.row * found.frames->vertex_count].x, int(frame) * kFrameStride);
    }
    return bool(found);
  }
  FakeCharacter character;
  Outbox outbox;
  Loading loading;
};

double g_clock_s = 0;
double everyLookTakesAMillisecond() { return g_clock_s += 0.001; }

FakeCharacter oneMotion() { return FakeBuilder().build({{"walk", 60, 20, 25, true, 192, 16}}); }

}  // namespace

TEST(DecodeSlices, AFrameWaitsForTheRowsBeforeIt) {
  Held held;
  held.loading.sliceDecoding({.steps = 1 + 4 * kStepsOfARow});
  const Need need{0, 7, true, {}};
  held.fill(need);
  EXPECT_FALSE(held.has(7));
  EXPECT_EQ(held.loading.decodeStats().rows, 0u);
  EXPECT_EQ(held.ahead(need), 4u) << "and the decoder is open";
  EXPECT_FALSE(held.has(5));
  EXPECT_FALSE(held.has(4, kSought));
  EXPECT_TRUE(held.has(4)) << "the next row comes at once if it is due";
  EXPECT_EQ(held.ahead(need), 4u) << "of that frame, and one that follows";
  EXPECT_TRUE(held.has(7, kSought));
  EXPECT_TRUE(held.has(3));
  EXPECT_EQ(held.loading.decodeStats().rows, 9u) << "none was decoded twice";
}

TEST(DecodeSlices, StepsArePartsOfRows) {
  Held held;
  held.loading.sliceDecoding({.steps = 1});
  const Need need{0, 5, true, {}};
  held.fill(need);
  EXPECT_EQ(held.ahead(need), 0u) << "opens the decoder";
  for (int row = 0; row < 6; ++row) {
    EXPECT_EQ(held.ahead(need), 0u);
    EXPECT_EQ(held.ahead(need), 1u);
  }
  EXPECT_EQ(held.ahead(need), 0u);
  EXPECT_TRUE(held.has(5));
  EXPECT_TRUE(held.has(6)) << "half of it was there";
}

TEST(DecodeSlices, FollowingFramesComeNextAcrossGopsAndTheLoop) {
  Held held;
  held.loading.sliceDecoding({.steps = 100});
  held.fill({0, 25, true, {}});
  EXPECT_EQ(held.ahead({0, 25, true, {}}), 8u + 10u) << "the last GOP of 8, then the first";
  EXPECT_TRUE(held.has(27));
  EXPECT_TRUE(held.has(9));
  EXPECT_EQ(held.ahead({0, 25, true, {}}), 0u);
  Held once;
  once.loading.sliceDecoding({.steps = 100});
  once.fill({0, 25, false, {}});
  EXPECT_EQ(once.ahead({0, 25, false, {}}), 8u) << "it ends";
}

TEST(DecodeSlices, WhatEveryTrackShowsComesBeforeWhatFollows) {
  Held held;
  held.loading.sliceDecoding({.steps = 2 + 12 * kStepsOfARow});
  held.fill({0, 5, true, {}});
  held.fill({1, 5, false, {}});
  const Need needs[] = {{0, 5, true, {}}, {1, 5, false, {}}};
  held.loading.decodeAhead(needs, false);
  FrameGeometry second;
  ASSERT_TRUE(held.loading.geometry(1, 5, true, second).ok());
  EXPECT_TRUE(second);
  EXPECT_EQ(held.loading.decodeStats().rows, 12u);
}

TEST(DecodeSlices, TheClockEndsASlice) {
  Held held(oneMotion());
  held.loading.sliceDecoding({.steps = 100, .seconds = 0.0065, .now_s = everyLookTakesAMillisecond});
  const Need need{0, 19, true, {}};
  held.fill(need);
  EXPECT_EQ(held.ahead(need), 0u) << "three looks at the clock a step, and the decoder has to be opened";
  held.loading.tick(0);
  const DecodeStats& stats = held.loading.decodeStats();
  EXPECT_NEAR(stats.seconds, 0.002, 1e-9) << "one a step";
  EXPECT_NEAR(stats.longest_tick_s, 0.002, 1e-9);
  held.ahead(need);
  EXPECT_NEAR(stats.rowSeconds(), 0.004 / double(stats.timed_rows), 1e-9);
  EXPECT_EQ(stats.timed_rows, 1u);
  EXPECT_NEAR(stats.seconds, 0.004, 1e-9);
  EXPECT_NEAR(stats.longest_tick_s, 0.002, 1e-9) << "in one tick";
  for (const auto& [tick_s, spent_s] : {std::pair{0.001, 0.007}, {0.06, 0.01}}) {
    held.loading.tick(tick_s);
    held.loading.decodeAhead({&need, 1}, true);
    EXPECT_NEAR(stats.longest_tick_s, spent_s, 1e-9) << "longer while seeking";
  }
}

TEST(DecodeSlices, OneStepATickHoweverShortTheTime) {
  Held held;
  held.loading.sliceDecoding({.steps = 100, .seconds = 0, .now_s = everyLookTakesAMillisecond});
  const Need need{0, 3, true, {}};
  held.fill(need);
  for (uint32_t tick = 0; tick < 1 + 4 * kStepsOfARow; ++tick) held.ahead(need);
  EXPECT_EQ(held.loading.decodeStats().rows, 4u);
}

TEST(DecodeSlices, APassBeginsWithTheFineChunkThoughTheCoarseIsDecodedAhead) {
  const auto chunkBytes = [](Held& held) {
    FrameGeometry found;
    EXPECT_TRUE(held.loading.geometry(0, 10, true, found).ok());
    return found ? found.index->position_step_m : 0;
  };
  Held held(FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 2, 1}}), 0);
  held.loading.sliceDecoding({.steps = 100});
  held.fill({0, 5, true, {}});
  held.ahead({0, 5, true, {}});
  held.loading.ladder().setQuality(1, 0);  // decoded rows are kept
  held.fill({0, 5, true, {}});
  EXPECT_EQ(chunkBytes(held), kStep_m);
  EXPECT_TRUE(held.has(11));
}

TEST(DecodeSlices, NoTickDecodesMoreThanItsSliceAndOneDueRow) {
  SimulatedEdge edge(oneMotion(), {});
  edge.player->sliceDecoding({.steps = 2 * kStepsOfARow});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  uint64_t rows = edge.player->stats().decoded.rows;
  int seeks = 0, ticks_of_seeks = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    if (tick % 100 == 50) ++seeks, edge.player->seekFrame(edge.below(60));
    ticks_of_seeks += edge.player->seeking();
    edge.step(0.012);
    EXPECT_LE(edge.player->stats().decoded.rows - rows, 3u);
    rows = edge.player->stats().decoded.rows;
    edge.expectPaired();
  }
  EXPECT_EQ(edge.events[EventKind::Seeked], seeks);
  EXPECT_LT(ticks_of_seeks / seeks, 20);
}

TEST(DecodeSlices, SeeksAreExactWithTheSmallestSlice) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  edge.player->sliceDecoding({.steps = 1});
  ASSERT_TRUE(edge.load());
  edge.expectExactSeeks();
}

TEST(DecodeSlices, EveryFrameIsShownWhereTheSliceKeepsUp) {
  SimulatedEdge edge(oneMotion(), {});
  edge.player->sliceDecoding({.steps = 1});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown >= 300; }, 14));
  EXPECT_EQ(edge.player->stats().frames_late, 0u);
  EXPECT_EQ(edge.events[EventKind::Waiting], 0);
}

// Four pictures per tick are due: each tick shows the one whose row is decoded next.
TEST(DecodeSlices, PlayingGoesOnWhereTheSliceDoesNotKeepUp) {
  EdgeOptions options;
  options.player.picture_slots = 8;
  options.decode_latency_s = options.copy_latency_s = options.fetch_latency_s = 0;
  SimulatedEdge edge(FakeBuilder().build({{"walk", 900, 100, 100, true, 192, 16}}), options);
  edge.player->sliceDecoding({.steps = 1});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  edge.player->setRate(4);
  int shown = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const uint64_t before = edge.player->stats().frames_shown;
    edge.step(0.01);
    edge.expectPaired();
    shown += edge.player->stats().frames_shown > before;
  }
  EXPECT_GT(shown, 180);
  EXPECT_EQ(edge.events[EventKind::Waiting], 0);
}

TEST(DecodeSlices, ThousandsOfFramesWithoutAMismatch) {
  const FakeCharacter character = FakeBuilder().build(
      {{"walk", 28, 10, 25, true, 192, 16, {}, 2, 1}, {"go", 40, 20, 30, true, 224, 16, {{1, 1, {}}, {2, 1, {}}}}});
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.fetch_latency_s = 0.02 * seed;
    SimulatedEdge edge(character, options);
    edge.player->sliceDecoding({.steps = seed});
    ASSERT_TRUE(edge.load());
    edge.player->play();
    for (int i = 0; i < 6000; ++i) {
      edge.step(edge.uniform(0.03));
      edge.expectPaired();
      edge.command();
      ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << seed;
    }
    EXPECT_TRUE(edge.errors.empty());
    EXPECT_GT(edge.player->stats().frames_shown, 800u) << seed;
  }
}

TEST(DecodeSlices, ADamagedRowIsReportedThoughALaterOneIsSought) {
  FakeCharacter character = oneMotion();
  std::vector<uint8_t>& file = character.files.at("walk.bin");
  const std::string walk = std::string("/extensions/") + package::kExtensionName + "/sequences/0/stream/headerLength";
  const auto header = std::span(file).first(size_t(*character.manifest.number(walk)));
  const package::ChunkEntry chunk = package::readStreamHeader(header).take().chunks[1];
  for (uint32_t i = chunk.bytes / 4; i < chunk.bytes / 2; ++i) file[chunk.offset + i] ^= uint8_t(i * 37);
  rehash(character);
  SimulatedEdge edge(character, {});
  edge.player->sliceDecoding({.steps = 1});
  ASSERT_TRUE(edge.load());
  edge.player->seekFrame(39);
  EXPECT_TRUE(edge.runUntil([&] { return !edge.errors.empty(); }));
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::StreamInvalid);
}

TEST(DecodeSlices, SurfacesComeRowByRow) {
  SimulatedEdge edge(fakeCameraCharacter(), {});
  edge.player->sliceDecoding({.steps = 1});
  ASSERT_TRUE(edge.load());
  const uint64_t rows = edge.player->stats().decoded.rows;
  edge.player->seekFrame(6);
  edge.step(0.02);
  EXPECT_LE(edge.player->stats().decoded.rows - rows, 2u);
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.player->frame(), 6u);
  edge.player->play();
  EXPECT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown >= 20; }));
  EXPECT_TRUE(edge.errors.empty());
}
