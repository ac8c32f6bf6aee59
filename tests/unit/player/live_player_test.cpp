// SPDX-License-Identifier: Apache-2.0
// The live player, with an edge that returns a picture for every sample immediately, or when the test requests it.
#include "player/live_player.h"

#include <gtest/gtest.h>

#include "live_stream_fixture.h"
#include "package/barcode.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

struct Sample {
  int64_t timestamp_us;
  uint32_t number;
};

struct LiveEdge {
  explicit LiveEdge(int slots = 4) {
    auto recipe = render::Recipe::create(*device);
    EXPECT_TRUE(recipe.ok());
    player = LivePlayer::create(*device, recipe.take(), {.picture_slots = slots}).take();
    EXPECT_TRUE(player->loadManifest(liveManifest(), {}).ok());
    player->play();
  }
  void send(uint32_t number, bool key = false) {
    const Status status = player->onLiveFrame(liveMessage(number, key));
    EXPECT_TRUE(status.ok()) << number;
  }
  void serve() {
    for (Request request; player->nextRequest(request);) {
      if (const auto* configured = std::get_if<ConfigureDecoder>(&request)) {
        EXPECT_EQ(configured->codec, "avc1.42C01F");
        EXPECT_TRUE(configured->description.empty()) << "Annex B";
        EXPECT_EQ(configured->width, 192);
        ++configures, open = needs_key = true;
        samples.clear();
      } else if (const auto* sample = std::get_if<DecodeSample>(&request)) {
        EXPECT_TRUE(open);
        EXPECT_TRUE(sample->key || !needs_key) << "sample before a key";
        needs_key = false;
        ASSERT_EQ(sample->bytes.size(), 4u);
        const uint8_t* b = sample->bytes.data();
        samples.push_back({sample->timestamp_us, uint32_t(b[0]) << 24 | b[1] << 16 | b[2] << 8 | b[3]});
      } else if (std::get_if<ResetDecoder>(&request)) {
        ++resets, needs_key = true;
        samples.clear();
      } else if (std::get_if<CloseDecoder>(&request)) {
        ++closes, open = false;
        samples.clear();
      }
    }
  }
  // Puts the sample's picture into a slot; `barcode`: of another frame than its own.
  int answer(const Sample& sample, std::optional<uint32_t> barcode = {}, int width = 192) {
    const int slot = player->acquireSlot(0, sample.timestamp_us);
    if (slot < 0) return slot;
    const auto planes = std::make_shared<std::vector<uint8_t>>(size_t(width) * 64, 128);
    uint8_t* luma = planes->data();
    package::drawBarcode({{0, 4, 128, 4}, 4}, barcode.value_or(sample.number), luma, width);
    player->uploadI420(slot, {width, 64, luma, luma, luma, width, width / 2, width / 2}, planes);
    player->commitSlot(slot);
    return slot;
  }
  void decode() {
    serve();
    for (const Sample& sample : std::exchange(samples, {})) answer(sample);
  }
  void tick() {
    now_s += 0.016;
    player->tick(now_s);
    for (Event event; player->nextEvent(event);) {
      ++events[event.kind];
      if (event.kind == EventKind::Error) errors.push_back(event.error);
    }
  }
  void play(uint32_t number, bool key = false) {
    send(number, key);
    decode();
    tick();
  }
  // Expects this frame on screen, with its surface.
  void expectShown(uint32_t number) {
    ASSERT_TRUE(player->hasFrame());
    EXPECT_EQ(player->frame(), number);
    EXPECT_EQ(player->capturedUs(), capturedUsOf(number));
    const auto figure = player->figure();
    ASSERT_TRUE(figure.ok());
    EXPECT_EQ(figure.value().model->face_count, facesOf(number));
    EXPECT_NE(figure.value().cameras, nullptr);
    EXPECT_EQ(device->takeErrors(), "");
  }
  uint64_t late() const { return player->stats().frames_late; }

  std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  std::unique_ptr<LivePlayer> player;
  std::vector<Sample> samples;
  std::map<EventKind, int> events;
  std::vector<Error> errors;
  bool open = false, needs_key = true;
  int configures = 0, resets = 0, closes = 0;
  double now_s = 0;
};

TEST(LivePlayer, BeginsWithAKeyAndShowsEachFrameWithItsSurface) {
  LiveEdge edge;
  edge.tick();
  EXPECT_EQ(edge.events[EventKind::LoadedMetadata], 1);
  edge.play(98);
  EXPECT_EQ(edge.configures, 0) << "nothing decodes before a key";
  EXPECT_FALSE(edge.player->figure().ok());
  edge.play(99, true);
  edge.expectShown(99);
  EXPECT_EQ(edge.events[EventKind::CanPlay], 1);
  EXPECT_EQ(edge.events[EventKind::Playing], 1);
  for (uint32_t number = 100; number < 130; ++number) {
    edge.play(number);
    edge.expectShown(number);
  }
  EXPECT_EQ(edge.configures, 1);
  EXPECT_EQ(edge.player->stats().frames_shown, 31u);
  EXPECT_EQ(edge.player->stats().barcode_checked, 31u);
  EXPECT_EQ(edge.player->stats().encoded_bytes_held, 0u);
  EXPECT_NEAR(edge.player->currentTime(), 30 * 0.04, 1e-9);
  EXPECT_TRUE(edge.errors.empty());
}

TEST(LivePlayer, TheNewestFrameIsShownAndOlderOnesAreLate) {
  LiveEdge edge;
  edge.send(1, true), edge.send(2), edge.send(3), edge.send(4);
  edge.serve();
  ASSERT_EQ(edge.samples.size(), 4u);
  edge.answer(edge.samples[0]), edge.answer(edge.samples[2]), edge.answer(edge.samples[1]);
  edge.tick();
  edge.expectShown(3);
  EXPECT_EQ(edge.late(), 2u);
  EXPECT_GE(edge.answer(edge.samples[3]), 0);
  edge.tick();
  edge.expectShown(4);
  EXPECT_EQ(edge.answer(edge.samples[1]), -2) << "nobody waits for a picture of the past";
  EXPECT_EQ(edge.player->acquireSlot(1, edge.samples[3].timestamp_us), -2);
  EXPECT_EQ(edge.player->acquireSlot(0, -1), -2);
}

TEST(LivePlayer, AfterAGapOfNumbersItWaitsForAKey) {
  LiveEdge edge;
  edge.play(1, true), edge.play(2), edge.play(4), edge.play(5);
  edge.expectShown(2);
  EXPECT_EQ(edge.late(), 2u);
  edge.play(9, true);
  edge.expectShown(9);
  edge.play(10);
  edge.expectShown(10);
  EXPECT_EQ(edge.configures, 1);
  EXPECT_EQ(edge.resets, 0) << "what is in the decoder is still good";
}

TEST(LivePlayer, NumbersGoOnBeyond32Bits) {
  LiveEdge edge;
  edge.play(0xfffffffe, true), edge.play(0xffffffff), edge.play(0), edge.play(1);
  edge.expectShown(1);
  EXPECT_EQ(edge.late(), 0u);
  for (uint32_t number : {1u, 0u, 0x80000001u})
    EXPECT_EQ(edge.player->onLiveFrame(liveMessage(number, true)).error().id, ErrorId::StreamInvalid) << number;
}

TEST(LivePlayer, APictureOfAnotherFrameIsCountedAndNotShown) {
  LiveEdge edge;
  edge.play(1, true);
  edge.send(2);
  edge.serve();
  edge.answer(edge.samples[0], 3);
  edge.tick();
  edge.expectShown(1);
  EXPECT_EQ(edge.player->stats().barcode_mismatches, 1u);
  edge.samples.clear();
  edge.play(3);
  edge.expectShown(3);
  edge.samples.clear();
  edge.send(4100, true);
  edge.serve();
  edge.answer(edge.samples[0], 4);
  edge.tick();
  edge.expectShown(4100);
}

// Eight consecutive wrong pictures: the decoder is out of step and is recreated. Three such series end in one error.
TEST(LivePlayer, ADecoderThatGivesOnlyWrongPicturesIsGivenUp) {
  LiveEdge edge;
  edge.play(1, true);
  uint32_t number = 1;
  for (int row = 1; row <= 3; ++row) {
    EXPECT_EQ(edge.errors.size(), 0u) << row;
    for (int i = 0; i < 8; ++i) {
      edge.send(++number, i == 0);
      edge.serve();
      for (const Sample& sample : std::exchange(edge.samples, {})) edge.answer(sample, sample.number + 7);
      edge.tick();
    }
    edge.serve();
    EXPECT_EQ(edge.closes, row);
  }
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::VideoInvalid);
  EXPECT_TRUE(edge.player->failed());
  edge.expectShown(1);
}

TEST(LivePlayer, PicturesOfAnotherSizeAreNotUploaded) {
  LiveEdge edge;
  edge.send(1, true);
  edge.serve();
  edge.answer(edge.samples[0], {}, 128);
  edge.tick();
  EXPECT_FALSE(edge.player->hasFrame());
  EXPECT_EQ(edge.device->takeErrors(), "");
}

TEST(LivePlayer, ALostDecoderIsMadeAnewAtTheNextKey) {
  LiveEdge edge;
  edge.play(1, true), edge.play(2);
  for (int row = 0; row < 5; ++row) {  // a good picture ends the series
    const uint32_t first = 3 + 4 * row;
    edge.send(first);
    edge.serve();
    edge.player->onDecoderFailed(0, DecoderFault::Samples, "simulated");
    edge.samples.clear();
    edge.play(first + 1), edge.play(first + 2);
    edge.expectShown(first - 1);
    edge.play(first + 3, true);
    edge.expectShown(first + 3);
    EXPECT_EQ(edge.configures, row + 2);
  }
  EXPECT_TRUE(edge.errors.empty());
}

TEST(LivePlayer, ThreeLossesInARowAreOneErrorUntilItIsPlayedAgain) {
  LiveEdge edge;
  for (uint32_t number = 1; number < 9; ++number) {
    edge.send(number, true);
    edge.serve();
    if (edge.open) edge.player->onDecoderFailed(0, DecoderFault::TakenAway, "simulated");
    edge.open = false;
    edge.tick();
    EXPECT_EQ(edge.errors.size(), number < 3 ? 0u : 1u) << number;
  }
  EXPECT_EQ(edge.errors[0].id, ErrorId::DecoderLost);
  EXPECT_EQ(edge.configures, 3);
  edge.player->pause();
  edge.player->play();
  edge.play(9, true);
  edge.expectShown(9);
}

TEST(LivePlayer, AnUnknownCodecIsAnErrorAtOnce) {
  LiveEdge edge;
  edge.send(1, true);
  edge.serve();
  edge.player->onDecoderFailed(0, DecoderFault::Unsupported, "none");
  edge.tick();
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::DecoderUnsupported);
}

TEST(LivePlayer, AfterAnInterruptionItBeginsWithAKeyAndAnyNumber) {
  LiveEdge edge;
  edge.play(50, true);
  edge.send(51), edge.send(52);
  edge.serve();
  const std::vector<Sample> before = edge.samples;
  edge.player->onLiveGap();
  edge.serve();
  EXPECT_EQ(edge.resets, 1);
  EXPECT_EQ(edge.answer(before[0]), -2);
  edge.play(53);
  edge.expectShown(50);
  edge.player->onLiveGap();
  edge.play(7, true);
  edge.expectShown(7);
  edge.play(8);
  edge.expectShown(8);
}

TEST(LivePlayer, OutOfSightItClosesItsDecoderWhenTheStreamStops) {
  LiveEdge edge;
  edge.play(1, true);
  edge.player->setInSight(false);
  edge.play(2);
  EXPECT_EQ(edge.closes, 0) << "it may be back in a moment";
  edge.player->onLiveGap();
  edge.serve();
  EXPECT_EQ(edge.closes, 1);
  edge.player->setInSight(true);
  edge.play(90, true);
  edge.expectShown(90);
  EXPECT_EQ(edge.configures, 2);
}

TEST(LivePlayer, WhatWaitsIsBoundedWhereTheEdgeDoesNotKeepUp) {
  LiveEdge edge;
  const uint64_t max_bytes = 8 * liveMessage(6, false).size();
  for (uint32_t number = 0; number < 100; ++number) {
    edge.send(number, number % 50 == 0);
    EXPECT_LE(edge.player->stats().encoded_bytes_held, max_bytes);
  }
  edge.decode();
  edge.tick();
  edge.play(100, true);
  edge.expectShown(100);
}

TEST(LivePlayer, ADecoderThatGivesNothingIsNotFedForEver) {
  LiveEdge edge;
  for (uint32_t number = 0; number < 200; ++number) {
    edge.send(number, number % 10 == 0);
    edge.serve();
    EXPECT_LE(edge.player->stats().encoded_bytes_held, 8 * liveMessage(6, false).size());
  }
  EXPECT_LE(edge.samples.size(), 12u);
  edge.player->onLiveGap();
  edge.play(200, true);
  edge.expectShown(200);
}

// Without ticks, off-screen, decoding continues, so that the newest frame can be shown at once afterwards.
TEST(LivePlayer, WithoutTicksTheNewestPicturesStay) {
  LiveEdge edge;
  edge.play(0, true);
  for (uint32_t number = 1; number < 40; ++number) {
    edge.send(number);
    edge.decode();
  }
  edge.tick();
  edge.expectShown(39);
}

TEST(LivePlayer, PausedItHoldsTheShownFrame) {
  LiveEdge edge;
  edge.player->pause();
  edge.play(0, true);
  edge.expectShown(0);
  for (uint32_t number = 1; number < 20; ++number) edge.play(number);
  edge.expectShown(0);
  EXPECT_EQ(edge.late(), 0u);
  edge.player->play();
  edge.tick();
  edge.expectShown(19);
  EXPECT_EQ(edge.events[EventKind::Playing], 1);
}

TEST(LivePlayer, ASurfaceThatDoesNotDecodeIsAnErrorOfTheStream) {
  LiveEdge edge;
  edge.play(0, true);
  std::vector<uint8_t> chunk = liveChunk(1);
  chunk.resize(chunk.size() - 3);
  EXPECT_TRUE(edge.player->onLiveFrame(liveMessage(1, false, chunk)).ok());
  edge.decode();
  edge.tick();
  ASSERT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::StreamInvalid);
  edge.expectShown(0);
  edge.play(2);
  edge.expectShown(0);
  edge.play(3, true);
  edge.expectShown(3);
}

TEST(LivePlayer, WaitingIsReportedWhileNothingComes) {
  LiveEdge edge;
  edge.play(0, true);
  for (int i = 0; i < 60; ++i) edge.tick();
  EXPECT_EQ(edge.events[EventKind::Waiting], 1);
  edge.play(1);
  EXPECT_EQ(edge.events[EventKind::Playing], 2);
  EXPECT_GE(edge.events[EventKind::TimeUpdate], 2);
}

TEST(LivePlayer, ThereIsNothingToSeekOrChoose) {
  LiveEdge edge;
  edge.player->seek(3);
  edge.tick();
  EXPECT_EQ(edge.events[EventKind::Seeked], 0);
  edge.play(0, true);
  edge.player->seekFrame(7);
  edge.tick();
  EXPECT_EQ(edge.events[EventKind::Seeked], 1);
  edge.expectShown(0);
  EXPECT_TRUE(edge.player->selectSequence("live").ok());
  EXPECT_EQ(edge.player->goTo("walk").error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(edge.player->setParameter("speed_mps", 1, true).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(edge.player->loadManifest(liveManifest(), {}).error().id, ErrorId::InvalidArgument);
  edge.player->setPlacement({{1, 2}, 0});
  EXPECT_EQ(edge.player->figure().value().world_from_character[3], glm::vec4(1, 0, 2, 1));
}

TEST(LivePlayer, NothingIsTakenBeforeTheManifest) {
  std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  std::shared_ptr<render::Recipe> recipe = render::Recipe::create(*device).take();
  EXPECT_FALSE(LivePlayer::create(*device, recipe, {.picture_slots = 1}).ok());
  auto player = LivePlayer::create(*device, recipe, {}).take();
  EXPECT_FALSE(player->onLiveFrame(liveMessage(1, true)).ok());
  EXPECT_FALSE(player->loadManifest({}, {}).ok());
  player->onDecoderFailed(0, DecoderFault::Samples, "");
  player->tick(0);
  Request request;
  EXPECT_FALSE(player->nextRequest(request));
  EXPECT_EQ(player->acquireSlot(0, 0), -2);
  EXPECT_EQ(player->sequence(), nullptr);
}

}  // namespace
