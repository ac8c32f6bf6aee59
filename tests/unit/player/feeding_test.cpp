// SPDX-License-Identifier: Apache-2.0
// Feeding and picture slots in isolation: mapping of serial numbers to presentations over loops and seeks, and
// selection of the picture to show.
#include <gtest/gtest.h>

#include <set>

#include "player/parts/pictures.h"
#include "player/parts/playback.h"

using namespace fourdvt;

namespace {

// Three GOPs of 4, 4 and 2 frames in the order I P B …; a sample's only byte is its frame.
struct Stream {
  Stream() {
    sequence.frame_count = index.frame_count = 10;
    sequence.renditions.resize(1);
    sequence.renditions[0].width = sequence.renditions[0].height = 16;
    package::SampleTable& table = index.renditions.emplace_back();
    for (uint32_t first : {0u, 4u, 8u}) {
      const uint32_t count = std::min(4u, 10 - first);
      index.chunks.push_back({first, count, 0, 0});
      table.chunk_first_sample.push_back(first);
      std::vector<uint8_t>& bytes = video.emplace_back();
      for (uint32_t i = 0; i < count; ++i) {
        const uint32_t frame = first + (i == 1 && count > 2 ? 2 : i == 2 ? 1 : i);
        table.samples.push_back({100 + first + i, 1, frame, i == 0});
        bytes.push_back(uint8_t(frame));
      }
    }
    table.chunk_first_sample.push_back(10);
  }
  FedSequence fed(bool loops) const { return {0, &sequence, &index, loops}; }

  package::Sequence sequence;
  package::StreamIndex index;
  std::vector<std::vector<uint8_t>> video;  // by GOP
};

struct Feeder {
  explicit Feeder(bool loops_too) : loops(loops_too) {}
  template <class T>
  std::optional<T> next(int free_slots = 100) {
    Request request;
    if (!feeding.next(stream.fed(loops), &stream.video[feeding.gop()], free_slots, request)) return std::nullopt;
    const T* asked = std::get_if<T>(&request);
    return asked ? std::optional<T>(*asked) : std::nullopt;
  }
  void restart(int64_t k) {
    feeding.restart(stream.fed(loops), k, outbox);
    if (!configured) {
      EXPECT_TRUE(next<ConfigureDecoder>());
    }
    configured = true;
  }
  Stream stream;
  Outbox outbox;
  Feeding feeding{1};
  bool loops, configured = false;
};

}  // namespace

TEST(PlayerFeeding, SerialsLeadToFramesOverLoops) {
  Feeder f(true);
  f.restart(0);
  std::set<int64_t> presentations, timestamps;
  for (int i = 0; i < 25; ++i) {
    const auto sample = f.next<DecodeSample>();
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->decoder, 1);
    const auto k = f.feeding.presentationOf(sample->timestamp_us);
    ASSERT_TRUE(k);
    EXPECT_EQ(*k % 10, sample->bytes[0]) << "the sample's frame, however often the loop wraps";
    EXPECT_EQ(sample->key, *k % 10 == 0 || *k % 10 == 4 || *k % 10 == 8);
    presentations.insert(*k);
    timestamps.insert(sample->timestamp_us);
    f.feeding.take(sample->timestamp_us);
    EXPECT_FALSE(f.feeding.presentationOf(sample->timestamp_us)) << "only once";
  }
  EXPECT_EQ(timestamps.size(), 25u);
  EXPECT_EQ(presentations.size(), 25u);
  EXPECT_EQ(*presentations.rbegin(), 24) << "every presentation once";
}

TEST(PlayerFeeding, PicturesBeforeTheSoughtOneAreDropped) {
  Feeder f(true);
  f.restart(16);  // frame 6 of the second pass
  std::vector<int> dropped, kept;
  for (int i = 0; i < 4; ++i) {
    const auto sample = f.next<DecodeSample>();
    (f.feeding.presentationOf(sample->timestamp_us) ? kept : dropped).push_back(sample->bytes[0]);
  }
  EXPECT_EQ(dropped, (std::vector<int>{4, 5})) << "from the GOP's key sample on";
  EXPECT_EQ(kept, (std::vector<int>{6, 7}));
}

TEST(PlayerFeeding, NobodyWaitsForPicturesFromBeforeASeek) {
  Feeder f(true);
  f.restart(0);
  const int64_t before = f.next<DecodeSample>()->timestamp_us;
  f.restart(0);
  Request request;
  ASSERT_TRUE(f.outbox.nextRequest(request));
  EXPECT_EQ(std::get<ResetDecoder>(request).decoder, 1);
  EXPECT_FALSE(f.feeding.presentationOf(before));
  const int64_t after = f.next<DecodeSample>()->timestamp_us;
  EXPECT_GT(after, before) << "timestamps never repeat";
  EXPECT_EQ(f.feeding.presentationOf(after), 0);
}

TEST(PlayerFeeding, EndsWithOneFlushUnlessItLoops) {
  Feeder f(false);
  f.restart(8);
  EXPECT_TRUE(f.next<DecodeSample>());
  EXPECT_TRUE(f.next<DecodeSample>());
  EXPECT_TRUE(f.feeding.done());
  EXPECT_TRUE(f.next<FlushDecoder>());
  EXPECT_FALSE(f.next<FlushDecoder>());
}

TEST(PlayerFeeding, TheDecoderHoldsFewSamplesMoreThanThereAreSlots) {
  Feeder f(true);
  f.restart(0);
  int sent = 0;
  while (f.next<DecodeSample>(2)) ++sent;
  EXPECT_EQ(sent, 2 + 4);
  for (int i = 0; i < 60; ++i) f.feeding.noteIdlePoll(0);
  EXPECT_FALSE(f.next<DecodeSample>(2));
  f.feeding.noteIdlePoll(2);
  EXPECT_FALSE(f.next<DecodeSample>(2)) << "there are pictures to show";
  f.feeding.noteIdlePoll(1);
  while (f.next<DecodeSample>(2)) ++sent;
  EXPECT_EQ(sent, 2 + 8) << "it keeps back more than expected";
}

TEST(PlayerFeeding, AsksForNothingWithoutSamplesOrAfterAStop) {
  Feeder f(true);
  f.restart(0);
  Request request;
  EXPECT_FALSE(f.feeding.next(f.stream.fed(true), nullptr, 4, request)) << "not fetched yet";
  const auto sample = f.next<DecodeSample>();
  f.feeding.stop();
  EXPECT_FALSE(f.next<DecodeSample>());
  EXPECT_FALSE(f.feeding.presentationOf(sample->timestamp_us));
  f.feeding.close(f.outbox);
  ASSERT_TRUE(f.outbox.nextRequest(request));
  EXPECT_TRUE(std::get_if<CloseDecoder>(&request));
  f.feeding.close(f.outbox);
  EXPECT_FALSE(f.outbox.nextRequest(request)) << "closed already";
}

namespace {

struct Slots {
  int put(int64_t k) {
    const int slot = slots.findFree();
    EXPECT_GE(slot, 0);
    EXPECT_TRUE(slots.prepare(*device, slot, rendition()).ok());
    slots.fill(slot, k, 0);
    return slot;
  }
  int ready(int64_t k) {
    const int slot = put(k);
    slots.commit(slot, true);
    return slot;
  }
  static package::Rendition rendition() {
    package::Rendition made;
    made.width = made.height = 16;
    return made;
  }
  std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  PictureSlots slots{3, render::PictureTextures::Kind::I420};
};

}  // namespace

TEST(PlayerPictureSlots, APictureOfAnEarlierEpochIsNeverReady) {
  Slots s;
  const int ready = s.ready(5), filling = s.put(6);
  s.slots.beginEpoch();
  EXPECT_EQ(s.slots.findReady(5), -1);
  EXPECT_FALSE(s.slots.awaits(filling));
  s.slots.commit(filling, true);
  EXPECT_EQ(s.slots.findReady(6), -1);
  EXPECT_EQ(s.slots.freeCount(), 3);
  EXPECT_EQ(s.ready(6), ready) << "free again";
  EXPECT_EQ(s.slots.findReady(6), ready);
}

TEST(PlayerPictureSlots, ARejectedPictureIsFreedOnCommit) {
  Slots s;
  const int slot = s.put(5);
  s.slots.reject(slot);
  s.slots.commit(slot, true);
  EXPECT_EQ(s.slots.findReady(5), -1);
  EXPECT_EQ(s.slots.freeCount(), 3);
  EXPECT_EQ(s.ready(7), slot);
  EXPECT_EQ(s.slots.findReady(7), slot) << "the next picture in it is not";
}

TEST(PlayerPictureSlots, ShowingFreesTheShownAndTheOvertaken) {
  Slots s;
  const int first = s.ready(1);
  s.slots.show(first);
  const int second = s.ready(2), third = s.ready(3);
  EXPECT_EQ(s.slots.newestReady(2, 2), second);
  EXPECT_EQ(s.slots.newestReady(2, 9), third);
  s.slots.beginEpoch();
  EXPECT_EQ(s.slots.usedCount(), 1) << "what is on screen stays";
  const int fourth = s.ready(4), fifth = s.ready(5);
  s.slots.show(fifth);
  EXPECT_EQ(s.slots.usedCount(), 1);
  EXPECT_EQ(s.slots.findReady(4), -1) << fourth << " is overtaken";
}

TEST(PlayerPictureSlots, TexturesAreFreedWhenClosed) {
  Slots s;
  s.slots = PictureSlots(3, render::PictureTextures::Kind::Rgba);
  const uint64_t textures = s.device->counters().live_textures;
  s.ready(1);
  const int filling = s.put(2);
  EXPECT_EQ(s.device->counters().live_textures, textures + 2);
  s.slots.beginEpoch();
  s.slots.close();
  EXPECT_EQ(s.device->counters().live_textures, textures + 1) << "one is being filled";
  s.slots.commit(filling, false);
  EXPECT_EQ(s.device->counters().live_textures, textures);
}

namespace {

// Two members, one above the other, each with a layer of 8 x 8 and one of 4 x 4 texels beside it.
package::Rendition twoMembers() {
  package::Rendition made;
  made.width = 12;
  made.height = 18;
  made.layers = {{0, 0, 8, 8}, {8, 0, 4, 4}, {0, 9, 8, 8}, {8, 9, 4, 4}};
  return made;
}

int readyPlanes(Slots& s, int64_t k, const PictureBytes& bytes, bool interleaved) {
  const int slot = s.put(k);
  const auto* plane = static_cast<const uint8_t*>(bytes.get());
  s.slots.hold(slot, {12, 18, plane, plane, interleaved ? nullptr : plane, 12, interleaved ? 12 : 6, 6}, bytes);
  s.slots.commit(slot, true);
  return slot;
}

}  // namespace

TEST(PlayerPictureSlots, OnlyWhatIsDrawnOfAPictureIsUploaded) {
  for (const bool interleaved : {false, true}) {
    Slots s;
    const auto bytes = [] {
      return PictureBytes(new std::array<uint8_t, 512>{},
                          [](const void* p) { delete static_cast<const std::array<uint8_t, 512>*>(p); });
    };
    const PictureBytes first = bytes(), second = bytes();
    const package::Rendition rendition = twoMembers();
    auto uploaded = [&, before = uint64_t{0}]() mutable {
      const uint64_t now = s.device->counters().uploaded_bytes;
      return now - std::exchange(before, now);
    };
    const int shown = readyPlanes(s, 1, first, interleaved);
    EXPECT_EQ(uploaded(), 0u) << "nothing while it waits";
    s.slots.show(shown);
    ASSERT_TRUE(s.slots.stage(*s.device, shown, rendition, 2, 0b01).ok());
    EXPECT_EQ(uploaded(), 12u * 8 * 3 / 2) << "one member's box";
    ASSERT_TRUE(s.slots.stage(*s.device, shown, rendition, 2, 0b01).ok());
    EXPECT_EQ(uploaded(), 0u) << "once";
    EXPECT_EQ(first.use_count(), 2) << "the other member may be wanted";
    ASSERT_TRUE(s.slots.stage(*s.device, shown, rendition, 2, 0b11).ok());
    EXPECT_EQ(uploaded(), 12u * 10 * 3 / 2) << "the other one, with the rows that share its chroma";
    EXPECT_EQ(first.use_count(), 1) << "all of it is there";
    const gpu::TextureId before = s.slots.picture(shown).y.id();
    const int next = readyPlanes(s, 2, second, interleaved);
    EXPECT_EQ(s.slots.picture(shown).y.id(), before);
    s.slots.show(next);
    ASSERT_TRUE(s.slots.stage(*s.device, next, rendition, 2, 0b10).ok());
    EXPECT_NE(s.slots.picture(next).y.id(), before) << "the GPU may still read the one before";
    const int third = readyPlanes(s, 3, first, interleaved);
    s.slots.show(third);
    EXPECT_EQ(second.use_count(), 1);
    ASSERT_TRUE(s.slots.stage(*s.device, third, rendition, 2, 0b11).ok());
    EXPECT_EQ(s.slots.picture(third).y.id(), before) << "two take turns";
    EXPECT_EQ(s.device->counters().live_textures, interleaved ? 4u : 6u);
    EXPECT_EQ(bool(s.slots.picture(third).v), !interleaved);
    s.slots.close();
    EXPECT_EQ(s.device->counters().live_textures, 0u);
    EXPECT_EQ(s.device->takeErrors(), "");
  }
}

TEST(PlayerPlayhead, ShowsTheNewestPictureThatIsDueAndWaitsForTheNext) {
  Slots s;
  Playhead head;
  head.select(0);
  head.seek(4, 25);
  EXPECT_TRUE(head.seeking());
  s.ready(3);
  EXPECT_EQ(head.choose(s.slots, 25), -1) << "not the one before it";
  const int fifth = s.ready(5), fourth = s.ready(4);
  EXPECT_EQ(head.choose(s.slots, 25), fourth) << "exactly the sought one";
  s.slots.show(fourth);
  head.show(fourth, 4);
  head.finishSeek(25);
  EXPECT_EQ(head.choose(s.slots, 25), -1) << "the next is not due";
  head.setRunning(true);
  head.advance(0, 1, 0.25);
  head.advance(0.05, 1, 0.25);
  EXPECT_EQ(head.choose(s.slots, 25), fifth);
  EXPECT_TRUE(head.isLate(25));
  head.advance(0.25, 1, 0.25);
  head.holdAtNewest(s.slots, 25);
  EXPECT_NEAR(head.clockFrames(25), 6, 1e-9) << "the end of the newest ready picture";
  s.slots.show(fifth);
  head.show(fifth, 5);
  EXPECT_TRUE(head.pastShown(25));
  head.seekShown();
  EXPECT_EQ(head.wantedK(), 5);
  EXPECT_TRUE(head.seeking());
}
