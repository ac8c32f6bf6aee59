// SPDX-License-Identifier: Apache-2.0
// Selection of a rendition, and switches between renditions on a network of varying throughput.
#include "player/parts/ladder.h"

#include <gtest/gtest.h>

#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

// Renditions of 1, 2 and 5 Mbit/s including geometry, with 256, 512 and 1024 texels.
package::Sequence rungs() {
  package::Sequence s;
  s.frame_count = 250;
  s.fps = 25;
  s.stream_bytes = 625'000;
  for (const auto& [bytes, texels] : {std::pair{625'000, 256}, {1'875'000, 512}, {5'625'000, 1024}}) {
    package::Rendition r;
    r.video_bytes = uint64_t(bytes);
    r.layers = {{0, 0, texels, texels}};
    s.renditions.push_back(r);
  }
  return s;
}

Ladder carrying(double bits_per_s, uint32_t quality = kAutomaticRendition) {
  Ladder ladder(quality);
  for (int i = 0; i < 500; ++i) ladder.measure(uint64_t(bits_per_s / 8 * 0.016), 0.016, true);
  return ladder;
}

}  // namespace

TEST(Ladder, BeginsWithWhatTheEdgeHasMeasuredAndForgetsIt) {
  Ladder ladder(kAutomaticRendition);
  ladder.expect(9e6);
  EXPECT_EQ(ladder.choose(rungs(), 0), 2u);
  for (int i = 0; i < 800; ++i) ladder.measure(uint64_t(0.5e6 / 8 * 0.016), 0.016, true);
  EXPECT_NEAR(ladder.throughput_bps(), 0.5e6, 0.3e6);
  EXPECT_EQ(ladder.choose(rungs(), 2), 0u);
}

TEST(Ladder, BeginsLowAndTakesWhatTheNetworkCarries) {
  EXPECT_EQ(Ladder(kAutomaticRendition).choose(rungs(), 0), 0u);
  EXPECT_NEAR(carrying(3e6).throughput_bps(), 3e6, 3e4);
  EXPECT_EQ(carrying(0.8e6).choose(rungs(), 0), 0u) << "the lowest, whatever";
  EXPECT_EQ(carrying(3e6).choose(rungs(), 0), 1u);
  EXPECT_EQ(carrying(8e6).choose(rungs(), 0), 2u);
}

TEST(Ladder, KeepsARenditionThatItWouldNotGoUpTo) {
  EXPECT_EQ(carrying(6e6).choose(rungs(), 0), 1u);
  EXPECT_EQ(carrying(6e6).choose(rungs(), 2), 2u);
  EXPECT_EQ(carrying(5e6).choose(rungs(), 2), 1u);
}

TEST(Ladder, CountsTheGeometryThatGoesWithARendition) {
  package::Sequence s = rungs();  // the lowest: 0.5 Mbit/s of video, and 0.5 of geometry
  EXPECT_EQ(carrying(1.2e6).choose(s, 1), 0u);
  s.coarse_renditions = 2;
  s.coarse_bytes = 125'000;
  s.stream_bytes += s.coarse_bytes;
  EXPECT_EQ(carrying(1.9e6).choose(s, 1), 1u) << "1.6 Mbit/s with 0.1 of geometry";
  EXPECT_EQ(carrying(7.3e6).choose(s, 0), 2u) << "the highest does not pay for coarse geometry";
}

TEST(Ladder, TriesTheNextOneWhenPlentyIsHeld) {
  Ladder ladder = carrying(1.5e6);
  EXPECT_EQ(ladder.choose(rungs(), 0, 3), 0u);
  EXPECT_EQ(ladder.choose(rungs(), 0, 5), 1u);
  EXPECT_EQ(carrying(3e6).choose(rungs(), 0, 5), 1u) << "one at a time";
  EXPECT_EQ(carrying(3e6).choose(rungs(), 1, 5), 2u);
  EXPECT_EQ(carrying(0.9e6).choose(rungs(), 0, 5), 0u) << "not what cannot be";
  EXPECT_EQ(carrying(0.9e6).choose(rungs(), 2, 5), 2u) << "kept as long as plenty is held";
  EXPECT_EQ(carrying(0.9e6).choose(rungs(), 2, 3), 0u);
  ladder.rest();
  EXPECT_EQ(ladder.choose(rungs(), 0, 5), 0u);
  for (int i = 0; i < 250; ++i) ladder.measure(0, 0.1, false);
  EXPECT_EQ(ladder.choose(rungs(), 0, 5), 1u);
}

TEST(Ladder, ForgetsWithTime) {
  Ladder ladder = carrying(8e6);
  for (int i = 0; i < 500; ++i) ladder.measure(uint64_t(2e6 / 8 * 0.016), 0.016, true);
  EXPECT_LT(ladder.throughput_bps(), 3.2e6);
  for (int i = 0; i < 500; ++i) ladder.measure(0, 0.016, false);
  EXPECT_LT(ladder.throughput_bps(), 3.2e6) << "a pause says nothing";
}

TEST(Ladder, LimitsAndNamedRenditions) {
  Ladder ladder = carrying(50e6);
  ladder.setQuality(kAutomaticRendition, 600);
  EXPECT_EQ(ladder.choose(rungs(), 0), 1u);
  ladder.setQuality(kAutomaticRendition, 100);
  EXPECT_EQ(ladder.choose(rungs(), 0), 0u);
  ladder.setQuality(kAutomaticRendition, 0);
  EXPECT_TRUE(ladder.leaveOut(rungs(), 2));
  EXPECT_EQ(ladder.choose(rungs(), 0), 1u);
  EXPECT_TRUE(ladder.leaveOut(rungs(), 0));
  EXPECT_EQ(ladder.choose(rungs(), 0), 1u);
  EXPECT_EQ(Ladder(ladder).highest(rungs()), 1u);
  EXPECT_FALSE(ladder.leaveOut(rungs(), 1)) << "none is left";
  Ladder slow = carrying(1);
  EXPECT_TRUE(slow.leaveOut(rungs(), 0));
  EXPECT_EQ(slow.choose(rungs(), 0), 1u) << "the lowest that can be decoded";
  EXPECT_EQ(carrying(1, 1).choose(rungs(), 0), 1u);
  EXPECT_EQ(carrying(1, 9).choose(rungs(), 0), 2u);
  EXPECT_EQ(carrying(1, kHighestRendition).choose(rungs(), 0), 2u);
}

TEST(Ladder, GoesBelowWhatIsNotDecodedInTimeAndTriesAgainLater) {
  Ladder ladder = carrying(50e6);
  const auto play = [&](uint32_t rendition, double seconds, double late_share) {
    double late = 0;
    for (int i = 0; i < int(seconds / 0.016); ++i) {
      late += late_share;
      ladder.measure(0, 0.016, false);
      ladder.measureDecoding(rendition, 0.016, late >= 1);
      if (late >= 1) --late;
    }
  };
  play(2, 60, 0.05);
  EXPECT_EQ(ladder.choose(rungs(), 2), 2u) << "a picture late now and then";
  ladder.measureDecoding(2, 0.9, true);
  EXPECT_EQ(ladder.choose(rungs(), 2), 2u) << "the page was asleep";
  play(2, 2.5, 0.33);
  EXPECT_EQ(ladder.choose(rungs(), 2), 1u);
  EXPECT_EQ(ladder.highest(rungs()), 1u);
  play(2, 2.5, 0.33);
  EXPECT_EQ(ladder.choose(rungs(), 1), 1u) << "what is left of the rung above says nothing about this one";
  play(1, 20, 0);
  EXPECT_EQ(ladder.choose(rungs(), 1), 1u);
  play(1, 10, 0);
  EXPECT_EQ(ladder.choose(rungs(), 1), 2u) << "after half a minute";
  play(2, 2.5, 0.33);
  play(1, 50, 0);
  EXPECT_EQ(ladder.choose(rungs(), 1), 1u) << "the wait is twice as long";
  play(1, 2.5, 0.5);
  EXPECT_EQ(ladder.choose(rungs(), 1), 0u);
  play(0, 20, 0.5);
  EXPECT_EQ(ladder.choose(rungs(), 0), 0u) << "there is none below";
  ladder.setQuality(2, 0);
  EXPECT_EQ(ladder.choose(rungs(), 0), 2u) << "named";
}

TEST(Ladder, LeavesOutWhatTheEdgeExpectsToFailAndStaysBelowWhatIsNotSmooth) {
  const package::Sequence s = rungs(), other = rungs();
  Ladder ladder = carrying(50e6);
  ladder.judge(s, 2, true);
  EXPECT_EQ(ladder.choose(s, 0), 1u);
  EXPECT_EQ(ladder.choose(other, 0), 2u) << "another sequence's";
  ladder.judge(s, 1, false);
  EXPECT_EQ(ladder.choose(s, 0), 0u);
  ladder.setQuality(2, 0);
  EXPECT_EQ(ladder.choose(s, 0), 2u) << "named";
  ladder.setQuality(1, 0);
  EXPECT_EQ(ladder.choose(s, 0), 0u) << "it cannot be decoded";
  ladder.judge(s, 2, false);
  ladder.judge(s, 0, false);
  EXPECT_FALSE(ladder.allOut(s)) << "the decoder says whether it is right";
}

TEST(Renditions, SwitchAtGopsWithoutAWrongPairOrAStall) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 900, 12, 25, true, 192, 16, {}, 3, 0, true}});
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  options.player.encoded_budget_bytes = 60'000;
  options.bits_per_s = 600'000;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  const package::Sequence& s = *edge.player->sequence();
  const double rate = 8 * double(s.renditions[0].video_bytes + s.stream_bytes) / s.duration_s();
  edge.player->play();
  std::vector<int> widths;
  for (int i = 0; i < 11'000; ++i) {
    edge.step(0.008);
    const double at_s = i * 0.008;
    edge.options.bits_per_s = at_s > 25 && at_s < 50 ? 1.05 * rate : 6 * rate;
    if (i % 5) continue;
    const auto drawn = edge.draw();
    ASSERT_EQ(drawn.picture_frame, drawn.geometry_frame);
    if (widths.empty() || widths.back() != drawn.picture_width) widths.push_back(drawn.picture_width);
  }
  EXPECT_GE(edge.player->stats().frames_shown, 2'000u);
  EXPECT_EQ(edge.player->stats().barcode_mismatches, 0u);
  EXPECT_EQ(edge.events[EventKind::Waiting], 0);
  EXPECT_TRUE(edge.errors.empty());
  EXPECT_EQ(widths, (std::vector<int>{160, 192, 176, 160, 176, 192})) << "lowest, highest, lowest, highest";
  EXPECT_LT(edge.max_bytes_held, 120'000u);
}

// Ten times the highest bitrate, mostly unused because of latency: answers are small.
TEST(Renditions, ALatencyDoesNotHoldThemDown) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 900, 12, 25, true, 192, 16, {}, 3, 0, true}});
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  options.player.encoded_budget_bytes = 60'000;
  options.bits_per_s = 2'000'000;
  options.fetch_latency_s = 0.6;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  int highest = 0, waits = 0;
  for (int i = 0; i < 8'000; ++i) {
    edge.step(0.008);
    if (i == 4'000) waits = edge.events[EventKind::Waiting];
    if (i >= 4'000 && i % 5 == 0) highest += edge.draw().picture_width == 192;
  }
  EXPECT_GT(highest, 700) << "of 800";
  EXPECT_EQ(edge.events[EventKind::Waiting], waits);
}

TEST(Renditions, CoarseGeometryMakesWayWhereALoopIsHeldWhole) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 24, 12, 25, true, 192, 16, {}, 2, 1}});
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  options.bits_per_s = 400'000;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  EXPECT_GT(std::abs(edge.draw().member), 0.005) << "vertex 1 is off by a step at least";
  edge.player->play();
  int coarse = 0, fine_after_coarse = 0;
  for (int i = 0; i < 1500; ++i) {
    edge.step(0.008);
    const auto drawn = edge.draw();
    ASSERT_EQ(drawn.picture_frame, drawn.geometry_frame);
    const bool fine = std::abs(drawn.member) < 1e-4;
    coarse += !fine;
    fine_after_coarse += fine;
    EXPECT_TRUE(fine || fine_after_coarse <= 400) << i;
  }
  EXPECT_GT(coarse, 30);
  EXPECT_GT(fine_after_coarse, 500);
  EXPECT_EQ(edge.draw().picture_width, 192);
  EXPECT_EQ(edge.events[EventKind::Waiting], 0);
  EXPECT_TRUE(edge.errors.empty());
}

TEST(Renditions, ATransitionDoesNotWaitForARaise) {
  FakeCharacter character = FakeBuilder().build(
      {{"walk", 24, 12, 25, true, 192, 16, {}, 2, 1, true}, {"run", 24, 12, 25, true, 192, 16, {}, 2, 1, true}});
  FakeBuilder::addGraph(character, [](uint32_t, uint32_t, uint32_t) { return motion::Entry{.fade_frames = 4}; });
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  options.bits_per_s = 40'000;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  const auto fetches = [&](const std::string& uri) {
    const std::vector<FetchRange> pending = edge.pendingFetches();
    return std::any_of(pending.begin(), pending.end(), [&](const FetchRange& r) { return r.uri == uri; });
  };
  ASSERT_TRUE(edge.runUntil([&] { return fetches("walk.mp4"); }, 60));
  ASSERT_TRUE(edge.player->goTo("run").ok());
  ASSERT_TRUE(edge.runUntil([&] { return fetches("run.bin"); }, 5));
  EXPECT_FALSE(fetches("walk.mp4"));
  ASSERT_TRUE(
      edge.runUntil([&] { return edge.player->sequence()->name == "run" && !edge.player->inTransition(); }, 60));
  ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; }, 60)) << "then that is raised";
  EXPECT_TRUE(edge.errors.empty());
}

// A loop, and a sequence too long to be held whole.
TEST(Renditions, APictureThatStandsComesAgainInTheHighest) {
  for (const uint32_t frames : {30u, 400u}) {
    const FakeCharacter character = FakeBuilder().build({{"walk", frames, 10, 25, true, 192, 16, {}, 3, 2}});
    EdgeOptions options;
    options.player.rendition = kAutomaticRendition;
    SimulatedEdge edge(character, options);
    ASSERT_TRUE(edge.load());
    EXPECT_EQ(edge.draw().picture_width, 160);
    edge.player->seekFrame(13);
    ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 13 && edge.draw().picture_width == 192; }, 5));
    EXPECT_FALSE(edge.player->seeking());
    EXPECT_NEAR(edge.draw().member, 0, 1e-4) << "with the fine geometry";
    EXPECT_EQ(edge.draw().geometry_frame, 13);
    EXPECT_EQ(edge.events[EventKind::Seeked], 1) << "of the seek alone";
    EXPECT_GE(edge.events[EventKind::Sharper], 1);
    const int before = edge.events[EventKind::Sharper];
    for (int i = 0; i < 200; ++i) edge.step(0.008);
    EXPECT_EQ(edge.events[EventKind::Sharper], before) << "no more than that";
    edge.player->play();
    ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 20; }, 5));
    EXPECT_EQ(edge.draw().picture_frame, edge.draw().geometry_frame);
    EXPECT_TRUE(edge.errors.empty());
  }
}

TEST(Renditions, APictureThatPlaysIsNotSoughtAgain) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 30, 10, 25, true, 192, 16, {}, 3, 2}});
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; }, 20));
  EXPECT_EQ(edge.events[EventKind::Sharper], 0);
}

TEST(Renditions, TheHighestNeverFetchesCoarseGeometry) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 24, 12, 25, true, 192, 16, {}, 3, 2}});
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  EXPECT_NEAR(edge.draw().member, 0, 1e-4);
  edge.player->setQuality(1, 0);
  ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 176; }));
  EXPECT_NEAR(edge.draw().member, 0, 1e-4) << "what is held is played";
}

TEST(Renditions, TheHighestBringsItsGeometryWhileASeekWaits) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 30, 10, 25, true, 192, 16, {}, 3, 2}});
  EdgeOptions options;
  options.player.rendition = 1;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->seekFrame(13);
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_GT(std::abs(edge.draw().member), 0.005);
  edge.player->setQuality(kHighestRendition, 0);
  ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; }));
  EXPECT_NEAR(edge.draw().member, 0, 1e-4);
  EXPECT_EQ(edge.draw().geometry_frame, 13);
}

TEST(Renditions, OneThatIsNamedReplacesThePictureOnScreen) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 30, 10, 25, true, 192, 16, {}, 3}});
  EdgeOptions options;
  options.player.rendition = 0;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->seekFrame(13);
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.draw().picture_width, 160);
  edge.player->setQuality(kHighestRendition, 0);
  ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; }));
  EXPECT_EQ(edge.draw().picture_frame, 13);
  EXPECT_EQ(edge.player->frame(), 13u);
}

TEST(Renditions, OneThatCannotBeDecodedIsLeftOut) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 30, 10, 25, true, 192, 16, {}, 3}});
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  EXPECT_EQ(edge.draw().picture_width, 192);
  edge.player->play();
  for (const int width : {176, 160}) {
    edge.loseDecoder(0, DecoderFault::Unsupported);
    ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == width; })) << width;
  }
  EXPECT_TRUE(edge.errors.empty());
  edge.loseDecoder(0, DecoderFault::Unsupported);
  edge.step(0.008);
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::DecoderUnsupported);
}

// A file is missing on the server, or belongs to another bake.
TEST(Renditions, OneWhoseFileFailsIsLeftOutAndTheOthersPlayOn) {
  const FakeCharacter character =
      FakeBuilder().build({{"walk", 30, 10, 25, true, 192, 16, {}, 3}, {"run", 30, 10, 25, true, 192, 16, {}, 3}});
  for (const bool gone : {true, false}) {
    const auto spoilt = [&](const std::string& uri) {
      return std::vector<uint8_t>(gone ? 0 : character.files.at(uri).size(), 0xee);
    };
    EdgeOptions options;
    options.player.rendition = kAutomaticRendition;
    SimulatedEdge edge(character, options);
    edge.replaceFile("walk.mp4", spoilt("walk.mp4"));
    ASSERT_TRUE(edge.load());
    edge.player->play();
    ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 176; })) << "the highest that is there";
    EXPECT_FALSE(edge.runUntil([&] { return edge.events[EventKind::Error] > 0; }, 3));
    EXPECT_EQ(edge.draw().picture_frame, edge.draw().geometry_frame);
    ASSERT_EQ(edge.warnings.size(), 1u) << "once, not for every GOP";
    EXPECT_EQ(edge.warnings[0].id, gone ? ErrorId::FetchFailed : ErrorId::FilesDiffer);
    EXPECT_NE(edge.warnings[0].message.find("walk.mp4"), std::string::npos);
    ASSERT_TRUE(edge.player->selectSequence("run").ok());
    ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; })) << "its own file is there";
    EXPECT_EQ(edge.events[EventKind::Waiting], 0);
  }
}

TEST(Renditions, ASequenceOfWhichNoneCanBeFetchedIsBroken) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 30, 10, 25, true, 192, 16, {}, 3}});
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  SimulatedEdge edge(character, options);
  for (const char* uri : {"walk.0.mp4", "walk.1.mp4"}) edge.replaceFile(uri, {});
  ASSERT_TRUE(edge.load()) << "the lowest are not there";
  EXPECT_EQ(edge.draw().picture_width, 192);
  EXPECT_EQ(edge.warnings.size(), 2u);
  SimulatedEdge none(character, options);
  for (const char* uri : {"walk.0.mp4", "walk.1.mp4", "walk.mp4"}) none.replaceFile(uri, {});
  ASSERT_TRUE(none.player->loadManifest(character.manifest).ok());
  ASSERT_TRUE(none.runUntil([&] { return none.player->failed(); }));
  ASSERT_EQ(none.errors.size(), 1u);
  EXPECT_EQ(none.errors[0].id, ErrorId::FetchFailed);
  none.replaceFile("walk.mp4", character.files.at("walk.mp4"));
  none.errors.clear();
  ASSERT_TRUE(none.player->selectSequence("walk").ok());
  ASSERT_TRUE(none.runUntilShown()) << "asked for again";
}

// A decoder that takes 10, 20 or 60 ms per picture, at 25 pictures a second, for a long motion, and for a loop that is
// held whole and upgraded.
TEST(Renditions, ASlowDecoderGetsALowerOneAndAFastOneNever) {
  for (const uint32_t frames : {900u, 28u}) {
    const FakeCharacter character = FakeBuilder().build({{"walk", frames, 14, 25, true, 192, 16, {}, 3}});
    for (const double highest_s : {0.06, 0.02}) {
      EdgeOptions options;
      options.player.rendition = kAutomaticRendition;
      options.bits_per_s = 1e6;
      options.decode_s = {0.01, 0.02, highest_s};
      SimulatedEdge edge(character, options);
      ASSERT_TRUE(edge.load());
      edge.player->play();
      ASSERT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; })) << "it goes up at first";
      edge.runUntil([] { return false; }, 8);
      const uint64_t before = edge.player->stats().frames_shown;
      std::vector<int> widths;
      for (int i = 0; i < 1'250; ++i) {
        edge.step(0.008);
        const auto drawn = edge.draw();
        ASSERT_EQ(drawn.picture_frame, drawn.geometry_frame);
        if (widths.empty() || widths.back() != drawn.picture_width) widths.push_back(drawn.picture_width);
      }
      EXPECT_EQ(widths, std::vector<int>{highest_s > 0.04 ? 176 : 192}) << frames;
      EXPECT_NEAR(double(edge.player->stats().frames_shown - before), 250, 3) << frames << " " << highest_s;
      EXPECT_TRUE(edge.errors.empty());
    }
  }
}

TEST(Renditions, ASlowNetworkIsNotTakenForASlowDecoder) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 900, 14, 25, true, 192, 16, {}, 3}});
  EdgeOptions options;
  options.player.rendition = kAutomaticRendition;
  options.player.encoded_budget_bytes = 60'000;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  for (int i = 0; i < 30; ++i) {
    edge.offline = i % 3 == 1;
    edge.runUntil([] { return false; }, edge.offline ? 12 : 3);
  }
  EXPECT_GT(edge.events[EventKind::Waiting], 3);
  EXPECT_TRUE(edge.runUntil([&] { return edge.draw().picture_width == 192; }, 10)) << "once the network is back";
}
