// SPDX-License-Identifier: Apache-2.0
// Pictures that exist on the GPU only: their numbers are read back a few ticks late. From decoders like WebCodecs', and
// from paced ones that skip pictures and report neighbours, like <video> elements.
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr auto kRgba = render::PictureTextures::Kind::Rgba;

FakeCharacter threeSequences() {
  return FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 3},
                              {"pickup", 23, 9, 30, false, 144, 32, {}, 2},
                              {"turn", 60, 12, 25, true, 160, 16, {}, 1}});
}

struct Played {
  int shown = 0, unpaired = 0;
  uint64_t late = 0, checked = 0, mismatches = 0;
};

// Plays at random rates with seeks, other sequences and other renditions until this many frames have been shown.
// Compares the frame of every picture on screen with that of its geometry.
Played playAtRandom(SimulatedEdge& edge, int frames) {
  Played played;
  const char* names[] = {"walk", "pickup", "turn"};
  uint64_t shown_before = edge.player->stats().frames_shown;
  edge.player->setLoop(1);
  edge.player->play();
  while (played.shown < frames && edge.errors.empty() && edge.now_s < 4000) {
    edge.step(0.004 + edge.uniform(0.012));
    switch (edge.below(400)) {
      case 0:
        edge.player->seekFrame(edge.below(60));
        break;
      case 1:
        EXPECT_TRUE(edge.player->selectSequence(names[edge.below(3)]).ok());
        break;
      case 2:
        edge.player->setQuality(edge.below(3), 0);
        break;
      case 3:
        edge.player->setRate(0.5 + edge.uniform(1.5));
        break;
      case 4:
        edge.player->pause();
        break;
      default:
        break;
    }
    if (edge.player->paused() && edge.below(20) == 0) edge.player->play();
    const uint64_t shown = edge.player->stats().frames_shown;
    if (shown == shown_before || !edge.player->hasFrame()) continue;
    played.shown += int(shown - shown_before);
    shown_before = shown;
    const TaggingDevice::Drawn drawn = edge.draw();
    played.unpaired += drawn.picture_frame != drawn.geometry_frame || drawn.picture_frame != int(edge.player->frame());
  }
  const PlayerStats stats = edge.player->stats();
  played.late = stats.frames_late;
  played.checked = stats.barcode_checked;
  played.mismatches = stats.barcode_mismatches;
  return played;
}

EdgeOptions paced(uint32_t seed) {
  EdgeOptions options{.seed = seed, .min_decoded = 4};
  options.player.picture_kind = kRgba;
  options.player.paced = true;
  return options;
}

}  // namespace

TEST(GpuPictures, EveryPictureIsPairedWithItsGeometry) {
  const FakeCharacter character = threeSequences();
  EdgeOptions options;
  options.player.picture_kind = kRgba;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  const Played played = playAtRandom(edge, 2000);
  EXPECT_GE(played.shown, 2000);
  EXPECT_EQ(played.unpaired, 0);
  EXPECT_EQ(played.mismatches, 0u);
  EXPECT_GE(played.checked, 2000u);
}

TEST(GpuPictures, WhereTexturesCannotBeReadPicturesCountByTheirTimestamps) {
  const FakeCharacter character = threeSequences();
  EdgeOptions options;
  options.player.picture_kind = kRgba;
  options.player.readable = false;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  const Played played = playAtRandom(edge, 500);
  EXPECT_GE(played.shown, 500);
  EXPECT_EQ(played.unpaired, 0);
  EXPECT_EQ(played.checked, 0u);
}

TEST(GpuPictures, WrongPicturesAreLeftOut) {
  const FakeCharacter character = threeSequences();
  EdgeOptions options{.wrong_picture_every = 37};
  options.player.picture_kind = kRgba;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->play();
  for (int i = 0; i < 2000 && edge.errors.empty(); ++i) {
    edge.step(0.01);
    edge.expectPaired();
  }
  EXPECT_GT(edge.player->stats().barcode_mismatches, 5u);
}

TEST(GpuPictures, PicturesOfAnotherSizeAreRefused) {
  const FakeCharacter character = threeSequences();
  EdgeOptions options;
  options.player.picture_kind = kRgba;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.player->commitSlot(0, 7, 7);  // not a slot being filled
  EXPECT_TRUE(edge.errors.empty());
  edge.wrong_sizes = true;
  edge.player->seekFrame(20);
  edge.runUntil([&] { return !edge.errors.empty(); }, 5);
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::VideoInvalid);
  EXPECT_NE(edge.errors[0].message.find("the manifest says"), std::string::npos) << edge.errors[0].message;
}

TEST(GpuPictures, ADroppedPlayerForgetsWhatItReads) {
  const FakeCharacter character = threeSequences();
  EdgeOptions options;
  options.player.picture_kind = kRgba;
  SimulatedEdge edge(character, options);
  ASSERT_TRUE(edge.load());
  edge.device.polls_of_reads = 1'000'000;
  edge.player->play();
  edge.runUntil([&] { return edge.device.openReads() > 2; }, 5);
  EXPECT_GT(edge.device.openReads(), 2u);
  edge.player.reset();
  EXPECT_EQ(edge.device.openReads(), 0u);
}

TEST(PacedDecoders, PlayEveryFrameInOrderOverLoops) {
  const FakeCharacter character = threeSequences();
  SimulatedEdge edge(character, paced(3));
  ASSERT_TRUE(edge.load());
  edge.player->play();
  edge.expectEveryFrame(28, 10);
  EXPECT_LT(edge.now_s, 280 / 25.0 * 1.1 + 1) << "at the sequence's rate";
}

TEST(PacedDecoders, SeekToEveryFrameExactly) {
  const FakeCharacter character = threeSequences();
  SimulatedEdge edge(character, paced(4));
  ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
  edge.expectExactSeeks();
  EXPECT_EQ(edge.player->stats().barcode_mismatches, 0u);
}

// Pictures match their geometry even if every seventh is reported as a neighbour, every tenth is missing, and a third
// of the sought ones are offered too early.
TEST(PacedDecoders, TenThousandFramesArePaired) {
  const FakeCharacter character = threeSequences();
  int shown = 0;
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    EdgeOptions options = paced(seed);
    options.misnamed = 0.15;
    options.left_out = 0.1;
    options.early_seeks = 0.3;
    SimulatedEdge edge(character, options);
    ASSERT_TRUE(edge.load()) << seed;
    const Played played = playAtRandom(edge, 1000);
    EXPECT_GE(played.shown, 1000) << seed << ": " << (edge.errors.empty() ? "stuck" : edge.errors[0].message);
    EXPECT_EQ(played.unpaired, 0) << seed;
    shown += played.shown;
  }
  RecordProperty("frames", shown);
}

TEST(PacedDecoders, StandWhilePaused) {
  const FakeCharacter character = threeSequences();
  SimulatedEdge edge(character, paced(5));
  ASSERT_TRUE(edge.load());
  EXPECT_EQ(edge.player->pace(0), 0);
  EXPECT_EQ(edge.player->pace(1), 0);
  edge.player->play();
  edge.runUntil([&] { return edge.player->stats().frames_shown > 20; });
  EXPECT_NEAR(edge.player->pace(0), 25, 25 * 0.16);
  edge.player->setRate(2);
  edge.step(0.01);
  EXPECT_NEAR(edge.player->pace(0), 50, 50 * 0.16);
  edge.player->pause();
  EXPECT_EQ(edge.player->pace(0), 0);
}
