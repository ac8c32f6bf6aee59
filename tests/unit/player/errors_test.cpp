// SPDX-License-Identifier: Apache-2.0
// Damaged or missing parts: one error event with its ID, no further requests for what is broken, and the player goes on
// with what is whole.
#include <functional>

#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

FakeCharacter twoSequences() {
  return FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}, {"pickup", 23, 9, 30, false, 128, 32}});
}

std::string field(const std::string& name) { return std::string("/extensions/") + package::kExtensionName + name; }

// Plays "walk" until an error; then "pickup" must still play. `damage` spoils walk's files.
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
  expectBrokenWalk([](FakeCharacter& c) { c.files["walk.bin"][0] ^= 1; }, ErrorId::StreamInvalid);
  expectBrokenWalk([](FakeCharacter& c) { c.files["walk.bin"][13] = 200; }, ErrorId::StreamInvalid);
}

TEST(PlayerErrors, DamagedChunk) {
  expectBrokenWalk(
      [](FakeCharacter& c) {
        c.files["walk.bin"].back() ^= 0xff, c.files["walk.bin"].resize(c.files["walk.bin"].size() - 200),
            c.files["walk.bin"].resize(c.files["walk.bin"].size() + 200);
      },
      ErrorId::StreamInvalid);
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
  // The manifest lies: the decoder delivers 192 × 16.
  expectBrokenWalk([](FakeCharacter& c) { c.manifest.set(field("/sequences/0/renditions/0/width"), 256.0); },
                   ErrorId::VideoInvalid);
}

TEST(PlayerErrors, DecoderFailureBreaksOneSequence) {
  for (const auto& [reason, id] :
       {std::pair{"unsupported: avc1", ErrorId::DecoderUnsupported}, {"bad sample", ErrorId::VideoInvalid}}) {
    const FakeCharacter character = twoSequences();
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.load());
    edge.player->onDecoderFailed(0, reason);
    edge.step(0.01);
    ASSERT_EQ(edge.errors.size(), 1u);
    EXPECT_EQ(edge.errors[0].id, id);
    ASSERT_TRUE(edge.player->selectSequence("pickup").ok());
    EXPECT_TRUE(edge.runUntilShown());
    edge.expectPaired();
  }
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

TEST(PlayerErrors, FetchesAreRetriedTwice) {
  const FakeCharacter character = twoSequences();
  int broken = 0;
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.fetch_failure = 0.1;  // three failures in a row: one in a thousand
    SimulatedEdge edge(character, options);
    ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
    edge.player->play();
    edge.runUntil([&] { return edge.player->stats().frames_shown > 60 || !edge.errors.empty(); });
    broken += !edge.errors.empty();
  }
  EXPECT_LE(broken, 2);
}

TEST(PlayerErrors, BaseMeshDamagedOrOfAnotherCharacter) {
  for (int kind = 0; kind < 3; ++kind) {
    FakeCharacter character = twoSequences();
    if (kind == 0) character.files["mesh.bin"][3] ^= 1;
    if (kind == 1) character.manifest.set(field("/vertexCount"), 9.0);
    if (kind == 2) character.files.erase("mesh.bin");
    SimulatedEdge edge(character, {});
    ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
    ASSERT_TRUE(edge.runUntil([&] { return !edge.errors.empty(); }));
    const ErrorId id = edge.errors[0].id;
    // With wrong counts in the manifest either the mesh or the stream is compared with it first.
    EXPECT_TRUE(id == (kind == 2 ? ErrorId::FetchFailed : ErrorId::MeshDataInvalid) ||
                (kind == 1 && id == ErrorId::StreamInvalid))
        << edge.errors[0].message;
    edge.player->play();
    edge.player->seekFrame(5);
    edge.runUntil([] { return false; }, 2);
    EXPECT_FALSE(edge.player->hasFrame());
    EXPECT_LE(edge.errors.size(), id == ErrorId::StreamInvalid ? 2u : 1u);  // one sequence's, then everybody's
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
  edge.player->onDecoderFailed(0, "early");
  edge.player->onDecoderFailed(7, "unknown");
  EXPECT_EQ(edge.player->acquireSlot(0, 0), -2);
  edge.player->commitSlot(0);
  edge.player->commitSlot(-1);
  edge.player->commitSlot(99);
  edge.player->uploadI420(99, {});
  EXPECT_EQ(edge.player->slotTexture(99), 0u);
  ASSERT_TRUE(edge.load());
}
