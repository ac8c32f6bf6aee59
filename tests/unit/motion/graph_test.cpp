// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>

#include "motion/motion_graph.h"

namespace fourdvt::motion {
namespace {

enum { kLocomotion, kPickup, kWave };  // states; wave has no transitions

struct Fixture {
  package::Character character;
  std::vector<GraphState> states;
  std::vector<std::vector<Entry>> tables;

  Fixture() {
    character.sequences = {sequence(10, true, 2), sequence(6, false, 1), sequence(4, true, 1)};
    states = {{10, {{1, 0}, {0.5f, 0.5f}, {0, 1}}}, {6, {{1}}}, {4, {{1}}}};
    tables.resize(9);
    // Cost 100, except 1 at frames 2 and 8 of the middle row, 50 at frame 5.
    std::vector<Entry>& to_pickup = tables[kLocomotion * 3 + kPickup];
    for (uint32_t r = 0; r < 3; ++r) {
      for (uint32_t f = 0; f < 10; ++f) {
        const bool good = r == 1 && (f == 2 || f == 8);
        to_pickup.push_back({f / 2, 0, 10 + f, good ? 1.f : f == 5 ? 50.f : 100.f, {0.1f * float(f), float(r), -1}});
      }
    }
    for (uint32_t f = 0; f < 6; ++f)
      tables[kPickup * 3 + kLocomotion].push_back({9 - f, 2, 8, f == 5 ? 3.f : f == 0 ? 0.5f : 90.f, {0, 0, 0}});
  }
  static package::Sequence sequence(uint32_t frames, bool loop, size_t members) {
    package::Sequence out;
    out.frame_count = frames;
    out.loop = loop;
    out.members.resize(members);
    return out;
  }
  std::vector<uint8_t> bytes() const { return writeMotionGraph(states, tables); }
  MotionGraph graph() const {
    auto read = MotionGraph::read(bytes(), character);
    EXPECT_TRUE(read.ok()) << read.error().message;
    return read.ok() ? read.take() : MotionGraph{};
  }
};

const std::vector<float> kMiddle = {0.55f, 0.45f};

TEST(MotionGraph, ReadsWhatWasWritten) {
  const Fixture f;
  const MotionGraph graph = f.graph();
  ASSERT_EQ(graph.states().size(), 3u);
  EXPECT_EQ(graph.states()[0].weight_rows, f.states[0].weight_rows);
  for (uint32_t r = 0; r < 3; ++r) {
    for (uint32_t frame = 0; frame < 10; ++frame) {
      const Entry* read = graph.entry(kLocomotion, frame, r, kPickup);
      const Entry& written = f.tables[kPickup][r * 10 + frame];
      ASSERT_NE(read, nullptr);
      EXPECT_EQ(read->frame, written.frame);
      EXPECT_EQ(read->fade_frames, written.fade_frames);
      EXPECT_EQ(read->cost, written.cost);
      EXPECT_EQ(read->shift, written.shift);
    }
  }
  EXPECT_EQ(graph.entry(kPickup, 0, 0, kLocomotion)->weight_row, 2u);
  EXPECT_EQ(graph.entry(kLocomotion, 0, 0, kWave), nullptr);
  EXPECT_EQ(graph.entry(kLocomotion, 10, 0, kPickup), nullptr);
  EXPECT_EQ(graph.entry(kLocomotion, 0, 3, kPickup), nullptr);
  EXPECT_EQ(graph.entry(7, 0, 0, kPickup), nullptr);
}

TEST(MotionGraph, PlansTheBestExitWithinTheLatency) {
  const MotionGraph graph = Fixture().graph();
  const auto best = graph.plan({kLocomotion, 5, kMiddle, 10}, kPickup, {0, 0.4, 20});
  ASSERT_TRUE(best);
  EXPECT_EQ(best->exit_frame, 8u);
  EXPECT_EQ(best->wait_frames, 3u);
  EXPECT_EQ(best->entry.frame, 4u);
  EXPECT_EQ(best->source, int(kLocomotion));
  EXPECT_EQ(best->target, int(kPickup));
  // At other weights no frame is better than frame 5.
  EXPECT_EQ(graph.plan({kLocomotion, 5, std::vector<float>{1, 0}, 10}, kPickup, {0, 0.4, 20})->exit_frame, 5u);
}

TEST(MotionGraph, KeepsTheLatencyBound) {
  const MotionGraph graph = Fixture().graph();
  EXPECT_EQ(graph.plan({kLocomotion, 5, kMiddle, 10}, kPickup, {0, 0.29, 20})->exit_frame, 5u);
  EXPECT_EQ(graph.plan({kLocomotion, 5, kMiddle, 10}, kPickup, {0, 0.3, 20})->exit_frame, 8u);
  EXPECT_EQ(graph.plan({kLocomotion, 5, kMiddle, 5}, kPickup, {0, 0.4, 20})->exit_frame, 5u);
  EXPECT_EQ(graph.plan({kLocomotion, 5, kMiddle, 10}, kPickup, {0, 0, 20})->exit_frame, 5u);
}

TEST(MotionGraph, WaitingHasAPrice) {
  const MotionGraph graph = Fixture().graph();
  EXPECT_EQ(graph.plan({kLocomotion, 5, kMiddle, 10}, kPickup, {0, 0.4, 200})->exit_frame, 5u);  // 50 against 1 + 60
}

TEST(MotionGraph, BeginsNoSoonerThanItCan) {
  const MotionGraph graph = Fixture().graph();
  EXPECT_EQ(graph.plan({kLocomotion, 1, kMiddle, 10}, kPickup, {0.1, 0.4, 20})->exit_frame, 2u);
  EXPECT_EQ(graph.plan({kLocomotion, 1, kMiddle, 10}, kPickup, {0.11, 0.4, 20})->exit_frame, 5u) << "2 is over by then";
  // If none is within the bound: the earliest.
  EXPECT_EQ(graph.plan({kLocomotion, 1, kMiddle, 10}, kPickup, {0.55, 0.4, 20})->wait_frames, 6u);
  EXPECT_EQ(graph.plan({kLocomotion, 1, kMiddle, 10}, kPickup, {0.25, -1, 20})->wait_frames, 3u);
  EXPECT_EQ(graph.plan({kPickup, 3, std::vector<float>{1}, 25}, kLocomotion, {9, 9, 20})->exit_frame, 5u) << "its last";
  const auto late = graph.plan({kLocomotion, 1, kMiddle, 10}, kPickup, {9, 0.4, 20});
  EXPECT_GE(late->wait_frames, 90u) << "a loop goes round";
  EXPECT_EQ(late->exit_frame, (1 + late->wait_frames) % graph.states()[kLocomotion].frame_count);
}

TEST(MotionGraph, FadesBeginAboveNothingAndEndAtAll) {
  for (const uint32_t frames : {1u, 2u, 10u, 20u}) {
    EXPECT_GT(fadeWeight(0, frames), 0);
    EXPECT_EQ(fadeWeight(frames, frames), 1);
    EXPECT_EQ(fadeWeight(frames + 3.5, frames), 1);
    EXPECT_NEAR(fadeWeight(0.5 * frames - 0.5, frames), 0.5, 1e-6) << "even";
    for (double at = 0; at < frames; at += 0.1)
      EXPECT_LE(fadeWeight(at + 0.1, frames) - fadeWeight(at, frames), 0.1 * 1.5 / (frames + 1) + 1e-6);
  }
}

TEST(MotionGraph, LoopsWrap) {
  const MotionGraph graph = Fixture().graph();
  const auto best = graph.plan({kLocomotion, 9, kMiddle, 10}, kPickup, {0, 0.4, 20});
  EXPECT_EQ(best->exit_frame, 2u);
  EXPECT_EQ(best->wait_frames, 3u);
}

TEST(MotionGraph, SequencesThatEndWaitForTheirLastFrameOnly) {
  const MotionGraph graph = Fixture().graph();
  const auto best = graph.plan({kPickup, 3, std::vector<float>{1}, 25}, kLocomotion, {0, 0.4, 20});
  EXPECT_EQ(best->exit_frame, 5u);
  EXPECT_EQ(best->wait_frames, 2u);
  const auto at_end = graph.plan({kPickup, 5, std::vector<float>{1}, 25}, kLocomotion, {0, 0.4, 20});
  EXPECT_EQ(at_end->exit_frame, 5u);
  EXPECT_EQ(at_end->wait_frames, 0u);
}

TEST(MotionGraph, NoTransitionWithoutATable) {
  const MotionGraph graph = Fixture().graph();
  EXPECT_FALSE(graph.plan({kLocomotion, 0, kMiddle, 25}, kWave));
  EXPECT_FALSE(graph.plan({kLocomotion, 0, kMiddle, 25}, kLocomotion));
  EXPECT_FALSE(graph.plan({9, 0, kMiddle, 25}, kPickup));
}

void expectInvalid(const std::vector<uint8_t>& bytes, const package::Character& character) {
  const auto read = MotionGraph::read(bytes, character);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().id, ErrorId::StreamInvalid);
}

void put(std::vector<uint8_t>& bytes, size_t at, uint32_t value) { std::memcpy(bytes.data() + at, &value, 4); }

TEST(MotionGraph, EveryTruncationIsRejected) {
  const Fixture f;
  const std::vector<uint8_t> whole = f.bytes();
  for (size_t size = 0; size < whole.size(); ++size) {
    std::vector<uint8_t> cut(whole.begin(), whole.begin() + long(size));
    expectInvalid(cut, f.character);
    if (size < 12) continue;
    put(cut, 8, uint32_t(size));  // declares the cut size
    expectInvalid(cut, f.character);
  }
  std::vector<uint8_t> longer = whole;
  longer.push_back(0);
  put(longer, 8, uint32_t(longer.size()));
  expectInvalid(longer, f.character);
}

TEST(MotionGraph, ForeignCharactersAndBadValuesAreRejected) {
  Fixture f;
  f.character.sequences[1].frame_count = 7;
  expectInvalid(f.bytes(), f.character);
  const auto broken = [](auto change) {
    Fixture fixture;
    change(fixture);
    expectInvalid(fixture.bytes(), fixture.character);
  };
  broken([](Fixture& b) { b.character.sequences.pop_back(); });
  broken([](Fixture& b) { b.states[0].weight_rows[1] = {0.5f, 0.6f}; });
  broken([](Fixture& b) { b.states[0].weight_rows[1] = {-0.5f, 1.5f}; });
  broken([](Fixture& b) { b.tables[kPickup][4].frame = 6; });
  broken([](Fixture& b) { b.tables[kPickup][4].weight_row = 1; });
  broken([](Fixture& b) { b.tables[kPickup][4].fade_frames = 0; });
  broken([](Fixture& b) { b.tables[kPickup][4].cost = -1; });
  broken([](Fixture& b) { b.tables[kPickup][4].cost = std::nanf(""); });
  broken([](Fixture& b) { b.tables[kPickup][4].shift.y = INFINITY; });
  broken([](Fixture& b) { b.tables[kPickup].pop_back(); });
  broken([](Fixture& b) { b.tables[0].resize(30); });
}

}  // namespace
}  // namespace fourdvt::motion
