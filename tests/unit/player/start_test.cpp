// SPDX-License-Identifier: Apache-2.0
// The start file: the first picture without a fetch, then the stream; mismatched start files, in the player and as
// bytes.
#include <gtest/gtest.h>

#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

FakeCharacter twoSequences() {
  return FakeBuilder().build({{"walk", 30, 8, 25, true, 192, 8, {}, 2}, {"run", 20, 8, 25, true, 224, 8, {}, 2}});
}

// True if the start file shows frame 0 while fetches get no answer.
bool showsOffline(SimulatedEdge& edge, const FakeCharacter& character, std::span<const uint8_t> start) {
  edge.offline = true;
  return edge.player->loadManifest(character.manifest, start).ok() &&
         edge.runUntil([&] { return edge.player->hasFrame(); }, 2);
}

TEST(StartFile, ShowsFrame0InTheLowestRenditionBeforeAnyFetch) {
  FakeCharacter character = twoSequences();
  const std::vector<uint8_t> start = FakeBuilder::addStart(character);
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(showsOffline(edge, character, start));
  const auto drawn = edge.draw();
  EXPECT_EQ(drawn.picture_frame, 0);
  EXPECT_EQ(drawn.geometry_frame, 0);
  EXPECT_EQ(drawn.picture_width, character.sequences[0].widthOf(0));
  EXPECT_EQ(edge.player->sequence()->name, "walk");
  EXPECT_EQ(edge.player->sequence()->frame_count, 30u) << "the sequence itself, not the start file's";
  EXPECT_TRUE(edge.player->seeking());
  EXPECT_EQ(edge.events[EventKind::CanPlay], 0) << "nothing can play yet";
}

TEST(StartFile, TheStreamFollowsAndPlays) {
  FakeCharacter character = twoSequences();
  const std::vector<uint8_t> start = FakeBuilder::addStart(character);
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(showsOffline(edge, character, start));
  edge.player->play();
  edge.offline = false;
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.events[EventKind::CanPlay], 1);
  EXPECT_EQ(edge.events[EventKind::SequenceChanged], 0);
  for (int i = 0; i < 300; ++i) {
    edge.step(0.008);
    edge.expectPaired();
  }
  EXPECT_GT(edge.player->stats().frames_shown, 30u);
  EXPECT_EQ(edge.player->stats().barcode_mismatches, 0u);
  EXPECT_TRUE(edge.errors.empty());
}

TEST(StartFile, ItsStreamHeaderIsNotFetchedAgainAndTheFirstGopComesAlone) {
  for (const bool with_header : {false, true}) {
    FakeCharacter character = twoSequences();
    const std::vector<uint8_t> start = FakeBuilder::addStart(character, with_header);
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(showsOffline(edge, character, start));
    const std::vector<FetchRange> asked = edge.pendingFetches();
    const bool header = std::any_of(asked.begin(), asked.end(), [](const FetchRange& r) { return r.offset == 0; });
    EXPECT_EQ(header, !with_header);
    EXPECT_EQ(asked.size(), with_header ? 2u : 1u) << "chunk and samples of one GOP";
    edge.offline = false;
    edge.player->play();
    ASSERT_TRUE(edge.runUntilShown());
    for (int i = 0; i < 300; ++i) {
      edge.step(0.008);
      edge.expectPaired();
    }
    EXPECT_TRUE(edge.errors.empty());
  }
}

TEST(StartFile, WhatFollowsComesInTheRenditionThatTheNetworkCarries) {
  for (const bool plays : {false, true}) {
    FakeCharacter character = twoSequences();
    const std::vector<uint8_t> start = FakeBuilder::addStart(character);
    EdgeOptions options;
    options.player.rendition = kAutomaticRendition;
    SimulatedEdge edge(character, options);
    edge.player->expectThroughput(1e9);
    if (plays) edge.player->play();
    ASSERT_TRUE(showsOffline(edge, character, start));
    EXPECT_EQ(edge.draw().picture_width, character.sequences[0].widthOf(0));
    edge.offline = false;
    ASSERT_TRUE(edge.runUntilShown());
    EXPECT_EQ(edge.draw().picture_width, character.sequences[0].widthOf(1));
    EXPECT_EQ(edge.uris.count("walk.0.mp4"), 0u) << "no rendition is fetched twice";
    EXPECT_EQ(edge.events[EventKind::Sharper], plays ? 0 : 1);
  }
}

TEST(StartFile, AnotherSequenceOrFrameLeavesItAtOnce) {
  for (const bool other : {false, true}) {
    FakeCharacter character = twoSequences();
    const std::vector<uint8_t> start = FakeBuilder::addStart(character);
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.player->loadManifest(character.manifest, start).ok());
    if (other)
      ASSERT_TRUE(edge.player->selectSequence("run").ok());
    else
      edge.player->seekFrame(13);
    ASSERT_TRUE(edge.runUntilShown());
    EXPECT_EQ(edge.player->sequence()->name, other ? "run" : "walk");
    EXPECT_EQ(edge.player->frame(), other ? 0u : 13u);
    edge.expectPaired();
  }
}

TEST(StartFile, ASequenceThatBreaksBeforeItsFirstPictureHasFailedAtOnce) {
  FakeCharacter character = twoSequences();
  const std::vector<uint8_t> start = FakeBuilder::addStart(character);
  SimulatedEdge edge(character, {});
  edge.offline = true;
  ASSERT_TRUE(edge.player->loadManifest(character.manifest, start).ok());
  edge.step(1e-4);
  ASSERT_FALSE(edge.player->hasFrame()) << "the start file is still being decoded";
  for (const FetchRange& range : edge.pendingFetches()) edge.player->onRangeFailed(range.id, "HTTP 404");
  EXPECT_TRUE(edge.player->failed());
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->hasFrame(); }, 2)) << "its first picture can be shown";
  EXPECT_TRUE(edge.player->failed()) << "but no other one";
  EXPECT_EQ(edge.events[EventKind::CanPlay], 0);
  edge.offline = false;
  ASSERT_TRUE(edge.player->selectSequence("walk").ok());
  EXPECT_FALSE(edge.player->failed());
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.events[EventKind::CanPlay], 1);
}

TEST(StartFile, OneThatDoesNotBelongIsNotUsed) {
  FakeCharacter character = twoSequences();
  const std::vector<uint8_t> start = FakeBuilder::addStart(character);
  std::vector<uint8_t> other = start;
  other[other.size() / 2] ^= 1;
  for (const auto& bytes : {std::vector<uint8_t>{}, other, std::vector<uint8_t>(start.begin(), start.end() - 1)}) {
    SimulatedEdge offline(character, {});
    EXPECT_FALSE(showsOffline(offline, character, bytes));
    SimulatedEdge edge(character, {});
    EXPECT_TRUE(edge.load(bytes));
    edge.expectPaired();
    EXPECT_TRUE(edge.errors.empty());
  }
}

TEST(StartFile, OneThatCannotBeDecodedIsLeftForTheStream) {
  FakeCharacter character = twoSequences();
  const std::vector<uint8_t> start = FakeBuilder::addStart(character);
  for (const DecoderFault fault : {DecoderFault::Unsupported, DecoderFault::Samples}) {
    EdgeOptions options;
    options.player.rendition = kAutomaticRendition;
    SimulatedEdge edge(character, options);
    edge.offline = true;
    ASSERT_TRUE(edge.player->loadManifest(character.manifest, start).ok());
    edge.step(1e-4);
    ASSERT_FALSE(edge.player->hasFrame());
    edge.loseDecoder(0, fault);
    edge.offline = false;
    ASSERT_TRUE(edge.runUntilShown());
    EXPECT_EQ(edge.draw().picture_width, character.sequences[0].widthOf(fault == DecoderFault::Unsupported ? 1 : 0));
    EXPECT_TRUE(edge.errors.empty());
  }
}

TEST(StartFile, EveryTruncationAndWrongCountIsRefused) {
  FakeCharacter character = twoSequences();
  const std::vector<uint8_t> start = FakeBuilder::addStart(character);
  ASSERT_TRUE(package::readStartFile(start).ok());
  for (size_t size = 0; size < start.size(); ++size)
    EXPECT_FALSE(package::readStartFile(std::span(start).first(size)).ok()) << size;
  std::vector<uint8_t> longer = start;
  longer.push_back(0);
  EXPECT_FALSE(package::readStartFile(longer).ok());
  for (const size_t at : {0, 4, 6, 8, 12, 16, 20}) {
    std::vector<uint8_t> changed = start;
    changed[at] ^= 1;
    EXPECT_FALSE(package::readStartFile(changed).ok()) << at;
  }
}

}  // namespace
