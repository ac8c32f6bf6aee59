// SPDX-License-Identifier: Apache-2.0
// Geometry decoded by a worker: the jobs and their order, equality of returned frames with local decoding, fallback to
// local decoding on damage or silence, and matching of every picture with its mesh during playback.
#include "player_edge.h"
#include "simulated_worker.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr double kLong_s = 1000;

FakeCharacter twoSequences() {
  return FakeBuilder().build(
      {{"walk", 28, 10, 25, true, 192, 16, {}, 2, 1}, {"go", 40, 20, 30, true, 224, 16, {{1, 1, {}}, {2, 1, {}}}}});
}

// Loading with all fetches answered, and a slice without a limit.
struct Held {
  explicit Held(uint32_t rendition = kHighestRendition)
      : character(twoSequences()), loading(outbox, 1 << 20, rendition) {
    EXPECT_TRUE(loading.readManifest(character.manifest).ok());
    loading.sliceDecoding({.steps = 1000});
  }
  void fill(const Need& need) {
    for (bool more = true; more;) {
      loading.requestMissing({&need, 1}, -1);
      more = false;
      for (Request request; outbox.nextRequest(request); more = true) {
        if (!std::holds_alternative<FetchRange>(request)) continue;
        const FetchRange& range = std::get<FetchRange>(request);
        const std::span<const uint8_t> file = character.files.at(range.uri);
        EXPECT_TRUE(loading.receive(range.id, file.subspan(range.offset, range.bytes)).status.ok());
      }
    }
  }
  void want(const Need& need) {
    fill(need);
    loading.decodeAhead({&need, 1}, false);
  }
  // Decoder of the most urgent job.
  std::unique_ptr<package::ChunkDecoder> openJob() {
    const DecodeJob job = *loading.decodeJob(0);
    return package::ChunkDecoder::open(job.chunk, *job.index, job.gop, loading.chunkMesh()).take();
  }
  std::vector<uint32_t> gops() {
    std::vector<uint32_t> out;
    while (const auto job = loading.decodeJob(out.size())) out.push_back(job->gop);
    return out;
  }
  void work(double seconds = kLong_s) {
    now_s += seconds;
    worker.work(loading, loading.chunkMesh(), now_s);
    worker.answer(loading, now_s + kLong_s);
  }
  // Decoded frame; empty: not available.
  std::vector<int> frame(int sequence, uint32_t number) {
    FrameGeometry found;
    EXPECT_TRUE(loading.geometry(sequence, number, true, found).ok());
    if (!found) return {};
    const package::ChunkFrames& f = *found.frames;
    std::vector<int> out;
    const size_t positions = size_t(f.member_count) * f.vertex_count;
    const size_t labels = size_t(f.member_count) * f.layer_count * f.face_count;
    for (size_t i = 0; i < positions; ++i)
      for (int k = 0; k < 3; ++k) out.push_back(f.positions[found.row * positions + i][k]);
    for (size_t i = 0; i < labels; ++i) out.push_back(f.labels[found.row * labels + i]);
    for (uint32_t m = 0; m < f.member_count; ++m)
      for (int k = 0; k < 3; ++k) out.push_back(int(1e4 * f.root[found.row * f.member_count + m][k]));
    return out;
  }
  FakeCharacter character;
  Outbox outbox;
  Loading loading;
  SimulatedWorker worker;
  double now_s = 0;
};

using Gops = std::vector<uint32_t>;

}  // namespace

TEST(DecodeElsewhere, GopsAreJobsNearestFirstUntilTheyAreDone) {
  Held held;
  const Need need{0, 25, true, {}};
  held.want(need);
  EXPECT_EQ(held.gops(), Gops{}) << "not before it is on";
  Held other;
  other.loading.decodeElsewhere(true);
  other.want(need);
  EXPECT_EQ(other.gops(), (Gops{2, 0})) << "its own, and the next one round the loop";
  EXPECT_EQ(other.loading.decodeStats().rows, 0u);
  EXPECT_TRUE(other.frame(0, 25).empty());
  other.work();
  other.loading.decodeAhead({&need, 1}, false);
  EXPECT_EQ(other.gops(), Gops{});
  EXPECT_EQ(other.loading.decodeStats().elsewhere, 18u) << "whole GOPs";
  EXPECT_EQ(other.worker.begun, 2u);
  EXPECT_EQ(other.worker.refused, 0u);
}

TEST(DecodeElsewhere, FramesAreThoseThatDecodingHereGives) {
  for (int sequence : {0, 1}) {
    Held here, there;
    there.loading.decodeElsewhere(true);
    for (uint32_t first : {0u, 10u, 20u}) {
      const Need need{sequence, first, true, {}};
      for (Held* held : {&here, &there}) {
        held->want(need);
        held->work();
      }
      for (uint32_t f = first; f < first + 8; ++f) {
        ASSERT_FALSE(there.frame(sequence, f).empty()) << f;
        EXPECT_EQ(there.frame(sequence, f), here.frame(sequence, f)) << f;
      }
    }
    EXPECT_EQ(here.loading.decodeStats().elsewhere, 0u);
    EXPECT_EQ(there.loading.decodeStats().rows, there.loading.decodeStats().elsewhere);
  }
}

TEST(DecodeElsewhere, AGopThatWasBegunHereStaysWhileItIsDueAndIsHandedOverElse) {
  Held held;
  const Need need{0, 0, true, {}};
  held.want(need);
  const uint64_t rows = held.loading.decodeStats().rows;
  EXPECT_EQ(rows, 13u) << "this frame and twelve more";
  held.loading.decodeElsewhere(true);
  const Need next{0, 5, true, {}};
  held.loading.decodeAhead({&next, 1}, false);
  EXPECT_EQ(held.gops(), Gops{1});
  EXPECT_EQ(held.loading.decodeStats().rows, rows) << "the due GOP is there whole";
  EXPECT_EQ(held.frame(0, 12)[0], 12 * kFrameStride) << "its rows stay";
  EXPECT_TRUE(held.frame(0, 13).empty());
  held.work();
  EXPECT_EQ(held.loading.decodeStats().elsewhere, 7u) << "the missing ones";
  for (int f = 10; f < 20; ++f) EXPECT_EQ(held.frame(0, uint32_t(f))[0], f * kFrameStride);
}

TEST(DecodeElsewhere, PartsOfARowAreDroppedAtAHandOver) {
  Held held;
  held.loading.sliceDecoding({.steps = 1 + 20 + 1 + 3});  // ten rows of two steps, then one row and a half
  const Need need{0, 0, true, {}};
  held.want(need);
  EXPECT_EQ(held.loading.decodeStats().rows, 11u);
  held.loading.decodeElsewhere(true);
  const Need next{0, 2, true, {}};
  held.loading.decodeAhead({&next, 1}, false);
  held.work();
  for (int f = 10; f < 20; ++f) EXPECT_EQ(held.frame(0, uint32_t(f))[0], f * kFrameStride) << f;
}

TEST(DecodeElsewhere, OnlyTheNextFrameOfAWantedJobIsTaken) {
  Held held;
  held.loading.decodeElsewhere(true);
  const Need need{0, 0, true, {}};
  held.want(need);
  ASSERT_EQ(held.gops().size(), 2u);
  const uint32_t id = held.loading.decodeJob(0)->id;
  auto decoder = held.openJob();
  std::vector<std::vector<uint8_t>> frames(3);
  for (uint32_t f = 0; f < 3; ++f) {
    ASSERT_TRUE(decoder->decodeTo(f).ok());
    package::writeDecodedFrame(decoder->take(), frames[f]);
  }
  EXPECT_FALSE(held.loading.takeDecoded(id + 7, 0, frames[0], 0));
  EXPECT_TRUE(held.loading.takeDecoded(id, 1, frames[1], 0)) << "too early: ignored";
  EXPECT_TRUE(held.frame(0, 0).empty());
  EXPECT_TRUE(held.loading.takeDecoded(id, 0, frames[0], 0));
  EXPECT_TRUE(held.loading.takeDecoded(id, 0, frames[2], 0)) << "again: ignored";
  EXPECT_TRUE(held.loading.takeDecoded(id, 1, frames[1], 0));
  EXPECT_EQ(held.frame(0, 0)[0], 0);
  EXPECT_EQ(held.frame(0, 1)[0], kFrameStride);
  EXPECT_TRUE(held.frame(0, 2).empty()) << "nothing is decoded here though it is due";
  EXPECT_EQ(held.loading.decodeStats().rows, 2u);
}

TEST(DecodeElsewhere, WhatDoesNotDecodeThereIsDecodedHere) {
  for (const size_t bytes : {size_t(0), size_t(5)}) {
    Held held;
    held.loading.decodeElsewhere(true);
    const Need need{0, 3, true, {}};
    held.want(need);
    const std::vector<uint8_t> nothing(bytes);
    EXPECT_FALSE(held.loading.takeDecoded(held.loading.decodeJob(0)->id, 0, nothing, 0));
    held.loading.decodeAhead({&need, 1}, false);
    EXPECT_EQ(held.gops(), Gops{1}) << "the other one is still wanted";
    EXPECT_EQ(held.frame(0, 3)[0], 3 * kFrameStride);
  }
}

TEST(DecodeElsewhere, ARootThatIsNoNumberIsRefused) {
  Held held;
  held.loading.decodeElsewhere(true);
  const Need need{0, 0, true, {}};
  held.want(need);
  auto decoder = held.openJob();
  std::vector<uint8_t> frame;
  ASSERT_TRUE(decoder->decodeTo(0).ok());
  package::ChunkFrames decoded = decoder->take();
  decoded.root[0].y = std::nanf("");
  package::writeDecodedFrame(decoded, frame);
  EXPECT_FALSE(held.loading.takeDecoded(held.loading.decodeJob(0)->id, 0, frame, 0));
}

TEST(DecodeElsewhere, SwitchedOffWhatIsUnfinishedIsDecodedHere) {
  Held held;
  held.loading.decodeElsewhere(true);
  const Need need{0, 4, true, {}};
  held.want(need);
  held.work(0.004);
  EXPECT_EQ(held.loading.decodeStats().elsewhere, 2u);
  held.loading.decodeElsewhere(false);
  held.loading.decodeAhead({&need, 1}, false);
  EXPECT_EQ(held.gops(), Gops{});
  EXPECT_EQ(held.frame(0, 4)[0], 4 * kFrameStride);
  held.work();
  EXPECT_EQ(held.frame(0, 4)[0], 4 * kFrameStride) << "late answers change nothing";
}

TEST(DecodeElsewhere, AnotherChunkIsAnotherJob) {
  Held held(0);
  held.loading.decodeElsewhere(true);
  const Need need{0, 5, true, {}};
  held.want(need);
  const auto coarse = held.loading.decodeJob(0);
  ASSERT_TRUE(coarse);
  EXPECT_TRUE(coarse->index->renditions.empty()) << "the index of the coarse chunks";
  held.work();
  held.loading.ladder().setQuality(1, 0);
  const Need again{0, 4, true, {}};  // a pass that starts anew uses the fine chunk
  held.want(again);
  const auto fine = held.loading.decodeJob(0);
  ASSERT_TRUE(fine);
  EXPECT_NE(fine->id, coarse->id);
  EXPECT_FALSE(fine->index->renditions.empty());
  EXPECT_TRUE(held.frame(0, 4).empty());
  held.work();
  EXPECT_EQ(held.frame(0, 4)[0], 4 * kFrameStride);
}

TEST(DecodeElsewhere, ThousandsOfFramesWithoutAMismatch) {
  const FakeCharacter character = twoSequences();
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    EdgeOptions options;
    options.seed = seed;
    options.fetch_latency_s = 0.02 * seed;
    options.player.encoded_budget_bytes = 6000;  // GOPs are evicted and decoded again
    SimulatedEdge edge(character, options);
    SimulatedWorker worker(seed);
    worker.frame_s = 0.001 * seed;
    worker.latency_s = 0.004 * seed;
    worker.damaged_every = seed % 3 == 0 ? 40 : 0;
    edge.player->sliceDecoding({.steps = 4});
    ASSERT_TRUE(edge.load());
    edge.player->decodeElsewhere(true);
    edge.player->play();
    for (int i = 0; i < 6000; ++i) {
      worker.answer(*edge.player, edge.now_s);
      edge.step(edge.uniform(0.03));
      worker.work(*edge.player, *edge.player->chunkMesh(), edge.now_s);
      const TaggingDevice::Drawn drawn = edge.draw();  // of either rendition
      EXPECT_EQ(drawn.picture_frame, drawn.geometry_frame);
      edge.command();
      if (edge.below(80) == 0) edge.player->setQuality(edge.below(2), 0);
      ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << seed;
    }
    EXPECT_TRUE(edge.errors.empty());
    const PlayerStats stats = edge.player->stats();
    EXPECT_GT(stats.frames_shown, 500u) << seed;
    EXPECT_GT(stats.decoded.elsewhere, 200u) << seed;
  }
}

TEST(DecodeElsewhere, SeeksAreExactAndNothingIsDecodedHere) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  SimulatedWorker worker;
  edge.player->sliceDecoding({.steps = 1});
  ASSERT_TRUE(edge.load());
  edge.player->decodeElsewhere(true);
  const uint64_t here = edge.player->stats().decoded.rows;
  for (uint32_t i = 0; i < 28; ++i) {
    edge.player->seekFrame(i * 11 % 28);
    for (int tick = 0; tick < 2000 && (tick == 0 || edge.player->seeking()); ++tick) {
      worker.answer(*edge.player, edge.now_s);
      edge.step(0.008);
      worker.work(*edge.player, *edge.player->chunkMesh(), edge.now_s);
    }
    ASSERT_EQ(edge.player->frame(), i * 11 % 28);
    edge.expectPaired();
  }
  const DecodeStats decoded = edge.player->stats().decoded;
  EXPECT_LE(decoded.rows - decoded.elsewhere, here + 10) << "the GOP that was begun before";
}

// Follows web/src/decode/geometry-decoding.ts where nothing comes.
TEST(DecodeElsewhere, ASilentWorkerIsReplacedByDecodingHere) {
  const FakeCharacter character = twoSequences();
  SimulatedEdge edge(character, {});
  SimulatedWorker worker;
  worker.silent = true;
  edge.player->sliceDecoding({.steps = 4});
  ASSERT_TRUE(edge.load());
  edge.player->decodeElsewhere(true);
  edge.player->seekFrame(25);
  EXPECT_FALSE(edge.runUntilShown());
  edge.player->decodeElsewhere(false);
  EXPECT_TRUE(edge.runUntilShown());
  EXPECT_EQ(edge.player->frame(), 25u);
  edge.expectPaired();
}
