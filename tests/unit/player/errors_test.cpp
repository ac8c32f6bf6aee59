// SPDX-License-Identifier: Apache-2.0
// Damaged or missing parts: one error event with its ID, no further requests for the broken part, and playback of the
// intact parts.
#include <functional>

#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

FakeCharacter twoSequences() {
  return FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}, {"pickup", 23, 9, 30, false, 128, 32}});
}

std::string field(const std::string& name) { return std::string("/extensions/") + package::kExtensionName + name; }

// Plays "walk" until an error; then "pickup" must still play. `damage` modifies walk's files.
void expectBrokenWalk(const std::function<void(FakeCharacter&)>& damage, ErrorId id, EdgeOptions options = {}) {
  FakeCharacter character = twoSequences();
  damage(character);
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return !edge.errors.empty(); }));
  EXPECT_EQ(edge.errors[0].id, id) << edge.errors[0].message;
  EXPECT_NE(edge.errors[0].message.find("walk."), std::string::npos) << "names the file: " << edge.errors[0].message;
  edge.runUntil([] { return false; }, 1);
  edge.requests_after_error = 0;
  edge.runUntil([] { return false; }, 3);
  EXPECT_EQ(edge.requests_after_error, 0);
  EXPECT_EQ(edge.errors.size(), 1u) << "reported once";
  edge.options.wrong_picture_every = 0;
  ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
  ASSERT_TRUE(
      edge.runUntil([&] { return edge.player->hasFrame() && !edge.player->seeking() && edge.player->frame() > 3; }));
  edge.expectPaired();
}

}  // namespace

TEST(PlayerErrors, DamagedStreamHeader) {
  for (size_t place : {0, 13}) {
    for (bool forged : {false, true}) {
      expectBrokenWalk(
          [&](FakeCharacter& c) {
            c.files["walk.bin"][place] ^= 0xc1;
            if (forged) rehash(c);
          },
          forged ? ErrorId::StreamInvalid : ErrorId::FilesDiffer);
    }
  }
}

TEST(PlayerErrors, DamagedChunk) {
  for (bool forged : {false, true}) {
    expectBrokenWalk(
        [&](FakeCharacter& c) {
          const size_t bytes = c.files["walk.bin"].size();
          c.files["walk.bin"].resize(bytes - 200), c.files["walk.bin"].resize(bytes);
          if (forged) rehash(c);
        },
        forged ? ErrorId::StreamInvalid : ErrorId::FilesDiffer);
  }
}

TEST(PlayerErrors, TruncatedFiles) {
  expectBrokenWalk([](FakeCharacter& c) { c.files["walk.mp4"].resize(600); }, ErrorId::FetchFailed);
  expectBrokenWalk([](FakeCharacter& c) { c.files["walk.bin"].resize(20); }, ErrorId::FetchFailed);
  expectBrokenWalk([](FakeCharacter& c) { c.files.erase("walk.mp4"); }, ErrorId::FetchFailed);
}

TEST(PlayerErrors, SampleTableBeyondTheVideo) {
  expectBrokenWalk([](FakeCharacter& c) { c.manifest.set(field("/sequences/0/renditions/0/byteLength"), 700.0); },
                   ErrorId::StreamInvalid);
}

TEST(PlayerErrors, PicturesOfAnotherSize) {
  // Wrong size in the manifest: the decoder delivers 192 × 16.
  expectBrokenWalk([](FakeCharacter& c) { c.manifest.set(field("/sequences/0/renditions/0/width"), 256.0); },
                   ErrorId::VideoInvalid);
}

TEST(PlayerErrors, ADecoderThatKeepsFailingBreaksOneSequence) {
  struct Case {
    DecoderFault fault;
    int failures;  // consecutive, until it is given up
    ErrorId id;
  };
  for (const Case& c : {Case{DecoderFault::Unsupported, 1, ErrorId::DecoderUnsupported},
                        {DecoderFault::Samples, 4, ErrorId::VideoInvalid},
                        {DecoderFault::TakenAway, 4, ErrorId::DecoderLost}}) {
    const FakeCharacter character = twoSequences();
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.load());
    edge.player->play();
    for (int i = 0; i < c.failures; ++i) {
      EXPECT_TRUE(edge.errors.empty()) << i;
      edge.loseDecoder(0, c.fault);
    }
    edge.step(0.01);
    ASSERT_EQ(edge.errors.size(), 1u);
    EXPECT_EQ(edge.errors[0].id, c.id);
    EXPECT_TRUE(edge.player->failed());
    ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
    EXPECT_TRUE(edge.runUntilShown());
    EXPECT_FALSE(edge.player->failed());
    edge.expectPaired();
  }
}

TEST(PlayerErrors, ADecoderThatIsLostNowAndThenIsFedAgainFromItsKeySample) {
  for (DecoderFault fault : {DecoderFault::Samples, DecoderFault::TakenAway}) {
    const FakeCharacter character = twoSequences();
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.load());
    edge.player->play();
    for (int i = 0; i < 12; ++i) {
      const uint64_t shown = edge.player->stats().frames_shown;
      edge.loseDecoder(0, fault);
      // A picture of a later GOP shows that the samples were valid.
      ASSERT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown > shown + 25; })) << i;
      edge.expectPaired();
    }
    EXPECT_TRUE(edge.errors.empty());
    EXPECT_EQ(edge.player->stats().frames_late, 0u) << "the clock waits";
  }
}

TEST(PlayerErrors, APausedDecoderIsNotAskedForAgainBeforeItIsNeeded) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 7; }));
  edge.player->pause();
  edge.loseDecoder(0, DecoderFault::TakenAway);
  edge.runUntil([] { return false; }, 1);
  EXPECT_FALSE(edge.isOpen(0));
  EXPECT_EQ(edge.player->frame(), 7u);
  edge.player->seekFrame(12);
  ASSERT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.player->frame(), 12u);
  edge.loseDecoder(0, DecoderFault::TakenAway);
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() > 14; }));
  edge.expectPaired();
  EXPECT_TRUE(edge.errors.empty());
}

TEST(PlayerErrors, OutOfSightNoDecoderIsHeldAndPlayingGoesOn) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 11; }));
  edge.player->setInSight(false);
  edge.runUntil([] { return false; }, 0.2);
  EXPECT_EQ(edge.openDecoders(), 0);
  EXPECT_EQ(edge.player->frame(), 11u);
  edge.player->setInSight(true);
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 13; }, 1));
  EXPECT_EQ(edge.openDecoders(), 1);
  edge.expectPaired();
  // A motion selected while out of sight is available when the page becomes visible.
  edge.player->setInSight(false);
  ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
  edge.runUntil([] { return false; }, 1);
  EXPECT_EQ(edge.openDecoders(), 0);
  EXPECT_TRUE(edge.player->seeking());
  edge.player->setInSight(true);
  EXPECT_TRUE(edge.runUntilShown());
  edge.expectPaired();
}

TEST(PlayerErrors, ASequenceThatHasEndedLosesItsDecoderAndLoops) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() == 22; }));
  edge.loseDecoder(0, DecoderFault::TakenAway);
  edge.player->setLoop(1);
  EXPECT_TRUE(edge.runUntil([&] { return edge.player->frame() == 3; }));
}

TEST(PlayerErrors, WrongPicturesAreCountedAndNeverShown) {
  const FakeCharacter character = twoSequences();
  EdgeOptions options;
  options.wrong_picture_every = 7;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
  edge.player->play();
  for (int i = 0; i < 3000 && edge.errors.empty(); ++i) {
    edge.step(0.008);
    if (edge.player->hasFrame()) edge.expectPaired();
  }
  EXPECT_GT(edge.player->stats().barcode_mismatches, 20u);
  EXPECT_GT(edge.player->stats().frames_shown, 200u);
}

TEST(PlayerErrors, PicturesOfOtherFramesOnlyAreAnError) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown > 5; }));
  edge.options.wrong_picture_every = 1;
  ASSERT_TRUE(edge.runUntil([&] { return !edge.errors.empty(); }));
  EXPECT_EQ(edge.errors[0].id, ErrorId::VideoInvalid);
}

TEST(PlayerErrors, AMotionWhoseFilesAreBackIsPlayedWhenItIsChosenAgain) {
  for (bool by_graph : {false, true}) {
    FakeCharacter character = twoSequences();
    FakeBuilder::addGraph(character, [](uint32_t, uint32_t frame, uint32_t) { return motion::Entry{frame % 3, 0, 2}; });
    const std::vector<uint8_t> video = std::exchange(character.files["pickup.mp4"], {});
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.load());
    edge.player->play();
    ASSERT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown > 20; }));
    const auto choose = [&] { return by_graph ? edge.player->goTo("pickup") : edge.player->selectSequence("pickup"); };
    for (size_t tries = 1; tries < 3; ++tries) {
      ASSERT_TRUE(choose().ok());
      ASSERT_TRUE(edge.runUntil([&] { return edge.errors.size() == tries; })) << "each try reports";
      EXPECT_EQ(edge.errors.back().id, ErrorId::FetchFailed);
    }
    edge.replaceFile("pickup.mp4", video);
    ASSERT_TRUE(choose().ok());
    ASSERT_TRUE(edge.runUntil([&] { return edge.player->sequence()->name == "pickup" && !edge.player->seeking(); }));
    edge.expectPaired();
    EXPECT_EQ(edge.errors.size(), 2u);
  }
}

TEST(PlayerErrors, TheNetworkMayBeAwayForAnyTime) {
  FakeCharacter character = twoSequences();
  FakeBuilder::addGraph(character, [](uint32_t, uint32_t frame, uint32_t) { return motion::Entry{frame % 3, 0, 2}; });
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown > 60; }));
  edge.offline = true;
  ASSERT_TRUE(edge.player->goTo("pickup").ok());
  const uint64_t shown = edge.player->stats().frames_shown;
  edge.runUntil([] { return false; }, 60);
  EXPECT_EQ(edge.player->sequence()->name, "walk") << "what is there plays on";
  EXPECT_GT(edge.player->stats().frames_shown, shown + 60 * 24);
  edge.offline = false;
  ASSERT_TRUE(
      edge.runUntil([&] { return edge.player->sequence()->name == "pickup" && !edge.player->inTransition(); }, 5));
  EXPECT_TRUE(edge.errors.empty());
  edge.expectPaired();
}

TEST(PlayerErrors, AMotionThatIsCutToAndDoesNotComeMakesThePlayerWait) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  ASSERT_TRUE(edge.runUntil([&] { return edge.player->frame() > 3; }));
  edge.offline = true;
  const int playing = edge.events[EventKind::Playing];
  ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
  edge.runUntil([] { return false; }, 1);
  EXPECT_EQ(edge.events[EventKind::Waiting], 1);
  EXPECT_EQ(edge.events[EventKind::Playing], playing);
  edge.offline = false;
  ASSERT_TRUE(edge.runUntilShown());
  edge.runUntil([] { return false; }, 1);
  EXPECT_EQ(edge.events[EventKind::Playing], playing + 1) << "once";
  EXPECT_EQ(edge.events[EventKind::Waiting], 1);
}

TEST(PlayerErrors, BaseMeshDamagedOrOfAnotherCharacter) {
  for (int kind = 0; kind < 4; ++kind) {
    FakeCharacter character = twoSequences();
    if (kind == 0 || kind == 3) character.files["mesh.bin"][3] ^= 1;
    if (kind == 0) rehash(character);
    if (kind == 1) character.manifest.set(field("/vertexCount"), 9.0);
    if (kind == 2) character.files.erase("mesh.bin");
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
    ASSERT_TRUE(edge.runUntil([&] { return !edge.errors.empty(); }));
    const ErrorId id = edge.errors[0].id;
    // With wrong counts in the manifest, either the mesh or the stream is compared with it first.
    EXPECT_TRUE(id == (kind == 2   ? ErrorId::FetchFailed
                       : kind == 3 ? ErrorId::FilesDiffer
                                   : ErrorId::MeshDataInvalid) ||
                (kind == 1 && id == ErrorId::StreamInvalid))
        << edge.errors[0].message;
    edge.player->play();
    edge.player->seekFrame(5);
    edge.runUntil([] { return false; }, 2);
    EXPECT_FALSE(edge.player->hasFrame());
    EXPECT_LE(edge.errors.size(), id == ErrorId::StreamInvalid ? 2u : 1u);  // the sequence's, then the character's
    EXPECT_FALSE(edge.player->draw({}, {}, 0).ok());
  }
}

TEST(PlayerErrors, ManifestRefused) {
  FakeCharacter character = twoSequences();
  character.manifest.set(field("/layerCount"), 9.0);
  SimulatedEdge edge(character, {});
  EXPECT_EQ(edge.player->loadManifest(character.manifest).error().id, ErrorId::ManifestInvalid);
  edge.player->play();
  edge.player->seek(1);
  edge.player->pause();
  edge.step(0.1);
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.player->character(), nullptr);
  EXPECT_EQ(edge.player->sequence(), nullptr);
}

TEST(PlayerErrors, AnswersNobodyAskedForAreIgnored) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  const std::vector<uint8_t> bytes(10);
  edge.player->onRangeReceived(77, bytes);
  edge.player->onRangeFailed(78, "x");
  edge.player->onDecoderFailed(0, DecoderFault::Samples, "early");
  edge.player->onDecoderFailed(7, DecoderFault::Samples, "unknown");
  edge.player->setInSight(false);
  edge.player->setInSight(true);
  EXPECT_EQ(edge.player->acquireSlot(0, 0), -2);
  edge.player->commitSlot(0);
  edge.player->commitSlot(-1);
  edge.player->commitSlot(99);
  edge.player->uploadI420(99, {}, {});
  EXPECT_EQ(edge.player->slotTexture(99), 0u);
  ASSERT_TRUE(edge.load());
}
