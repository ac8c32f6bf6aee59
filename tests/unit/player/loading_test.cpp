// SPDX-License-Identifier: Apache-2.0
// Loading in isolation: requests and their order, rejections, damage, progress, and the memory budget.
#include "player/parts/loading.h"

#include <gtest/gtest.h>

#include <set>

#include "player_fixture.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

FakeCharacter twoSequences() {
  return FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}, {"pickup", 23, 9, 30, false, 128, 32}});
}

// Loading, with files that the test delivers on demand.
struct Shelf {
  explicit Shelf(FakeCharacter made = twoSequences(), uint64_t budget_bytes = 1 << 20,
                 uint32_t rendition = kHighestRendition)
      : character(std::move(made)), loading(outbox, budget_bytes, rendition) {
    EXPECT_TRUE(loading.readManifest(character.manifest).ok());
  }
  std::vector<FetchRange> asked() {
    std::vector<FetchRange> ranges;
    for (Request request; outbox.nextRequest(request);) ranges.push_back(std::get<FetchRange>(request));
    return ranges;
  }
  Arrival answer(const FetchRange& range) {
    const std::vector<uint8_t>& file = character.files.at(range.uri);
    return loading.receive(range.id, std::span(file).subspan(range.offset, range.bytes));
  }
  // Answers requests until there are none.
  void fill(const Need& need, const std::function<void(const FetchRange&)>& on_range = {}) {
    for (loading.requestMissing({&need, 1}, -1);; loading.requestMissing({&need, 1}, -1)) {
      const std::vector<FetchRange> ranges = asked();
      if (ranges.empty()) return;
      for (const FetchRange& range : ranges) {
        if (on_range) on_range(range);
        EXPECT_TRUE(answer(range).status.ok());
      }
    }
  }
  FrameGeometry geometry(int sequence, uint32_t frame) {
    FrameGeometry found;
    EXPECT_TRUE(loading.geometry(sequence, frame, true, found).ok());
    return found;
  }

  FakeCharacter character;
  Outbox outbox;
  Loading loading;
};

std::vector<std::string> names(const std::vector<FetchRange>& ranges) {
  std::vector<std::string> uris;
  for (const FetchRange& range : ranges) uris.push_back(range.uri);
  return uris;
}

using Uris = std::vector<std::string>;

}  // namespace

TEST(PlayerLoading, AsksForTheMostUrgentFirstAndOnlyOnce) {
  Shelf shelf;
  const Need need{0, 12, true, {}};
  shelf.loading.requestMissing({&need, 1}, 1);
  std::vector<FetchRange> ranges = shelf.asked();
  ASSERT_EQ(names(ranges), (Uris{"mesh.bin", "walk.bin", "pickup.bin"})) << "mesh, its header, the next one's";
  shelf.loading.requestMissing({&need, 1}, 1);
  EXPECT_TRUE(shelf.asked().empty());
  EXPECT_EQ(shelf.answer(ranges[1]).what, Arrival::What::Header);
  EXPECT_TRUE(shelf.loading.playable(0));
  shelf.loading.requestMissing({&need, 1}, 1);
  ranges = shelf.asked();
  ASSERT_EQ(names(ranges), (Uris{"walk.bin", "walk.mp4"})) << "its GOP, alone until there is a picture";
  const package::StreamIndex& index = shelf.loading.index(0);
  EXPECT_EQ(ranges[0].offset, index.chunks[1].offset) << "frame 12 lies in the second";
  for (const FetchRange& range : ranges) shelf.answer(range);
  shelf.loading.requestMissing({&need, 1}, 1);
  ranges = shelf.asked();
  ASSERT_EQ(names(ranges), (Uris{"walk.bin", "walk.mp4"})) << "then the next";
  EXPECT_EQ(ranges[0].offset, index.chunks[2].offset);
}

TEST(PlayerLoading, FetchesTheChosenRenditionOrTheHighestThereIs) {
  const std::pair<uint32_t, Uris> cases[] = {{0, {"walk.0.mp4", "pickup.mp4"}},
                                             {1, {"walk.1.mp4", "pickup.mp4"}},
                                             {2, {"walk.mp4", "pickup.mp4"}},
                                             {kHighestRendition, {"walk.mp4", "pickup.mp4"}}};
  for (const auto& [rendition, uris] : cases) {
    Shelf shelf(
        FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 3}, {"pickup", 23, 9, 30, false, 128, 32}}),
        1 << 20, rendition);
    for (int sequence : {0, 1}) {
      const Need need{sequence, 12, true, {}};
      std::set<std::string> videos;
      shelf.fill(need, [&](const FetchRange& range) {
        if (range.uri.ends_with(".mp4")) videos.insert(range.uri);
      });
      EXPECT_EQ(videos, std::set<std::string>{uris[size_t(sequence)]});
      EXPECT_EQ((*shelf.loading.video(sequence, 1))[9], shelf.loading.renditionOf(sequence, 1));
    }
  }
}

TEST(PlayerLoading, ARefusalIsFinalAndNamesTheFile) {
  Shelf shelf;
  const Need need{0, 0, true, {}};
  shelf.loading.requestMissing({&need, 1}, -1);
  const FetchRange header = shelf.asked()[1];
  const Arrival failed = shelf.loading.refuse(header.id, "HTTP 404");
  ASSERT_FALSE(failed.status.ok());
  EXPECT_EQ(failed.status.error().id, ErrorId::FetchFailed);
  EXPECT_EQ(failed.sequence, 0);
  EXPECT_NE(failed.status.error().message.find("walk.bin"), std::string::npos);
  EXPECT_TRUE(shelf.loading.refuse(header.id, "HTTP 404").status.ok()) << "it is settled";
  EXPECT_EQ(shelf.answer(header).what, Arrival::What::Nothing);
}

TEST(PlayerLoading, BytesOfAnotherBakeAreRefusedWhateverTheyAre) {
  const Need need{0, 0, true, {}};
  for (const std::string part : {"mesh", "header", "chunk", "video"}) {
    FakeCharacter character = twoSequences();
    const bool of_gop = part == "chunk" || part == "video";
    Shelf shelf(std::move(character));
    shelf.loading.requestMissing({&need, 1}, -1);
    std::vector<FetchRange> ranges = shelf.asked();
    if (of_gop) {
      for (const FetchRange& range : ranges) ASSERT_TRUE(shelf.answer(range).status.ok());
      shelf.loading.requestMissing({&need, 1}, -1);
      ranges = shelf.asked();
    }
    const FetchRange& range = ranges[part == "mesh" || part == "chunk" ? 0 : 1];
    std::vector<uint8_t> bytes(range.bytes);
    std::copy_n(shelf.character.files.at(range.uri).begin() + long(range.offset), range.bytes, bytes.begin());
    bytes.back() ^= 0x40;
    const Arrival arrival = shelf.loading.receive(range.id, bytes);
    ASSERT_FALSE(arrival.status.ok()) << part;
    EXPECT_EQ(arrival.status.error().id, ErrorId::FilesDiffer) << part;
    EXPECT_NE(arrival.status.error().message.find(range.uri), std::string::npos);
    EXPECT_EQ(arrival.sequence, part == "mesh" ? -1 : 0);
    EXPECT_FALSE(shelf.geometry(0, 0));
    EXPECT_EQ(shelf.loading.video(0, 0), nullptr);
  }
}

TEST(PlayerLoading, WhatFailedIsAskedForAgainWhenItIsRevived) {
  const Need need{0, 0, true, {}};
  const auto spoil = [](std::vector<uint8_t> bytes) { return bytes[0] ^= 1, bytes; };
  for (int part = 0; part < 2; ++part) {  // mesh, header
    for (bool refused : {true, false}) {
      Shelf shelf;
      EXPECT_FALSE(shelf.loading.revive(0)) << "it is well";
      shelf.loading.requestMissing({&need, 1}, -1);
      const FetchRange range = shelf.asked()[size_t(part)];
      const std::vector<uint8_t> damaged = spoil(shelf.character.files.at(range.uri));
      const Arrival failed = refused ? shelf.loading.refuse(range.id, "HTTP 404")
                                     : shelf.loading.receive(range.id, std::span(damaged).first(range.bytes));
      ASSERT_FALSE(failed.status.ok());
      EXPECT_TRUE(shelf.loading.markBroken(failed.sequence));
      shelf.loading.requestMissing({&need, 1}, -1);
      EXPECT_TRUE(shelf.asked().empty()) << "not by itself";
      EXPECT_TRUE(shelf.loading.revive(0));
      shelf.loading.requestMissing({&need, 1}, -1);
      const std::vector<FetchRange> again = shelf.asked();
      ASSERT_EQ(again.size(), 1u) << "what is on its way is not asked for twice";
      EXPECT_EQ(again[0].uri, range.uri);
      EXPECT_TRUE(shelf.answer(again[0]).status.ok());
      EXPECT_EQ(shelf.loading.hasHeader(0), part == 1);
    }
  }
}

TEST(PlayerLoading, ARevivedSequenceFetchesItsPicturesAgain) {
  Shelf shelf;
  const Need need{0, 0, true, {}};
  shelf.fill(need);
  EXPECT_TRUE(shelf.loading.markBroken(0));
  EXPECT_TRUE(shelf.loading.revive(0));
  EXPECT_EQ(shelf.loading.video(0, 0), nullptr);
  shelf.fill(need);
  EXPECT_NE(shelf.loading.video(0, 0), nullptr);
  EXPECT_TRUE(shelf.geometry(0, 3));
}

TEST(PlayerLoading, ABrokenSequenceIsNotAskedForAndTheOtherStays) {
  Shelf shelf;
  shelf.fill({0, 0, true, {}});
  shelf.fill({1, 0, false, {}});
  ASSERT_TRUE(shelf.geometry(0, 3) && shelf.geometry(1, 3));
  EXPECT_TRUE(shelf.loading.markBroken(0));
  EXPECT_FALSE(shelf.loading.markBroken(0)) << "known";
  EXPECT_FALSE(shelf.loading.playable(0));
  EXPECT_FALSE(shelf.geometry(0, 3));
  EXPECT_EQ(shelf.loading.video(0, 0), nullptr) << "its bytes are freed";
  EXPECT_TRUE(shelf.geometry(1, 3));
  const Need needs[] = {{0, 15, true, {}}, {1, 15, false, {}}};
  shelf.loading.requestMissing(needs, -1);
  for (const FetchRange& range : shelf.asked()) EXPECT_EQ(range.uri.substr(0, 6), "pickup");
  EXPECT_TRUE(shelf.loading.markBroken(-1)) << "the other one is news";
  EXPECT_TRUE(shelf.loading.broken(1));
}

TEST(PlayerLoading, AHeaderThatTheManifestContradictsIsRefused) {
  const std::string walk = std::string("/extensions/") + package::kExtensionName + "/sequences/0";
  for (const char* field : {"/frameCount", "/stream/byteLength", "/renditions/0/byteLength"}) {
    FakeCharacter character = twoSequences();
    const double stated = std::string(field) == "/frameCount" ? 27 : 700;
    character.manifest.set(walk + field, stated);
    Shelf shelf(std::move(character));
    const Need need{0, 0, true, {}};
    shelf.loading.requestMissing({&need, 1}, -1);
    const Arrival arrival = shelf.answer(shelf.asked()[1]);
    ASSERT_FALSE(arrival.status.ok()) << field;
    EXPECT_EQ(arrival.status.error().id, ErrorId::StreamInvalid);
    EXPECT_FALSE(shelf.loading.hasHeader(0));
  }
}

TEST(PlayerLoading, TheSampleTableOfEveryRenditionIsChecked) {
  for (bool beyond : {false, true}) {
    FakeCharacter character = twoSequences();
    std::vector<uint8_t>& file = character.files["walk.bin"];
    const std::string walk = std::string("/extensions/") + package::kExtensionName + "/sequences/0";
    const auto header_bytes = size_t(*character.manifest.number(walk + "/stream/headerLength"));
    package::StreamIndex index = package::readStreamHeader(std::span(file).first(header_bytes)).take();
    index.renditions.push_back(index.renditions[0]);
    if (beyond) index.renditions[1].samples.back().bytes += 1;
    const size_t grown = package::writeStreamHeader(index).size() - header_bytes;
    for (package::ChunkEntry& chunk : index.chunks) chunk.offset += grown;
    std::vector<uint8_t> stream = package::writeStreamHeader(index);
    stream.insert(stream.end(), file.begin() + long(header_bytes), file.end());
    character.manifest.set(walk + "/stream/headerLength", double(header_bytes + grown));
    character.manifest.set(walk + "/stream/headerHash", hashText(std::span(stream).first(header_bytes + grown)));
    character.manifest.set(walk + "/stream/byteLength", double(stream.size()));
    file = std::move(stream);
    for (const char* field : {"/uri", "/codec"})
      character.manifest.set(walk + "/renditions/1" + field,
                             *character.manifest.string(walk + "/renditions/0" + field));
    for (const char* field :
         {"/byteLength", "/width", "/height", "/layers/0/0", "/layers/0/1", "/layers/0/2", "/layers/0/3",
          "/barcode/rect/0", "/barcode/rect/1", "/barcode/rect/2", "/barcode/rect/3", "/barcode/cellSize"})
      character.manifest.set(walk + "/renditions/1" + field,
                             *character.manifest.number(walk + "/renditions/0" + field));
    Shelf shelf(std::move(character));
    const Need need{0, 0, true, {}};
    shelf.loading.requestMissing({&need, 1}, -1);
    EXPECT_EQ(shelf.answer(shelf.asked()[1]).status.ok(), !beyond);
  }
}

TEST(PlayerLoading, GeometryIsThatOfItsFrame) {
  Shelf shelf;
  EXPECT_FALSE(shelf.geometry(0, 0)) << "nothing there yet";
  shelf.fill({0, 10, false, {}});
  for (uint32_t frame : {10u, 13u, 27u}) {
    const FrameGeometry found = shelf.geometry(0, frame);
    ASSERT_TRUE(found);
    EXPECT_EQ(found.frames->positions[found.row * found.frames->vertex_count].x, int(frame) * kFrameStride);
  }
  EXPECT_FALSE(shelf.geometry(0, 0)) << "not needed, not fetched";
}

TEST(PlayerLoading, KeepsWithinItsBudgetWhatIsNeeded) {
  Shelf shelf(twoSequences(), 1);
  shelf.fill({0, 0, false, {}});
  const uint64_t all_gops = shelf.loading.encodedBytesHeld();
  EXPECT_GT(all_gops, 1u) << "what is needed is kept";
  shelf.fill({0, 10, false, {}});
  EXPECT_EQ(shelf.loading.video(0, 0), nullptr);
  EXPECT_NE(shelf.loading.video(0, 2), nullptr);
  shelf.fill({0, 10, false, {0u}});
  EXPECT_NE(shelf.loading.video(0, 0), nullptr) << "it is being fed";
}

TEST(PlayerLoading, ProgressEndsWithTheFirstPictureAndTheGraphFollows) {
  FakeCharacter character = twoSequences();
  FakeBuilder::addGraph(character, [](uint32_t, uint32_t, uint32_t) { return motion::Entry{}; });
  Shelf shelf(std::move(character));
  const Need need{0, 0, true, {}};
  shelf.fill(need);
  Event last{}, event{};
  int reports = 0;
  for (; shelf.outbox.nextEvent(event); last = event) ++reports;
  EXPECT_EQ(reports, 8) << "mesh, header, three GOPs of two parts";
  EXPECT_EQ(last.kind, EventKind::Progress);
  EXPECT_EQ(last.loaded_bytes, last.total_bytes);
  EXPECT_EQ(last.loaded_bytes, shelf.loading.bytesFetched());
  EXPECT_EQ(shelf.loading.graph(), nullptr);
  shelf.loading.onFirstPicture();
  shelf.fill(need);
  EXPECT_FALSE(shelf.outbox.nextEvent(event));
  ASSERT_NE(shelf.loading.graph(), nullptr);
  EXPECT_FALSE(shelf.loading.lacksGraph());
}

TEST(PlayerLoading, AGraphThatCannotBeHadIsNoError) {
  for (bool damaged : {false, true}) {
    FakeCharacter character = twoSequences();
    FakeBuilder::addGraph(character, [](uint32_t, uint32_t, uint32_t) { return motion::Entry{}; });
    if (damaged) character.files["graph.bin"][4] ^= 9;
    Shelf shelf(std::move(character));
    shelf.loading.requestGraph();
    const FetchRange range = shelf.asked()[0];
    if (damaged) {
      EXPECT_TRUE(shelf.answer(range).status.ok());
    } else {
      for (int i = 0; i < 3; ++i) EXPECT_TRUE(shelf.loading.refuse(range.id, "offline").status.ok());
    }
    EXPECT_TRUE(shelf.loading.graphFailed());
    EXPECT_TRUE(shelf.loading.lacksGraph());
  }
}

TEST(PlayerLoading, HoldsSixSecondsAheadAndAsksForTwoGopsAtATime) {
  Shelf shelf(FakeBuilder().build({{"walk", 500, 10, 25, true, 192, 16}}));
  const Need need{0, 0, true, {}};
  shelf.loading.requestMissing({&need, 1}, -1);
  for (const FetchRange& range : shelf.asked()) shelf.answer(range);  // mesh and header
  shelf.loading.onFirstPicture();
  shelf.loading.requestMissing({&need, 1}, -1);
  EXPECT_EQ(shelf.asked().size(), 4u) << "chunk and video of two GOPs";
  Shelf other(FakeBuilder().build({{"walk", 500, 10, 25, true, 192, 16}}));
  size_t videos = 0;
  other.fill(need, [&](const FetchRange& range) { videos += range.uri == "walk.mp4"; });
  EXPECT_EQ(videos, 15u) << "6 s of 10 frames each";
}

TEST(PlayerLoading, CallsOffWhatASeekMadeUseless) {
  Shelf shelf(FakeBuilder().build({{"walk", 500, 10, 25, false, 192, 16}}));
  Need need{0, 0, false, {}};
  shelf.loading.requestMissing({&need, 1}, -1);
  for (const FetchRange& range : shelf.asked()) shelf.answer(range);
  shelf.loading.onFirstPicture();
  shelf.loading.requestMissing({&need, 1}, -1);
  const std::vector<FetchRange> useless = shelf.asked();
  need.frame = 300;
  shelf.loading.requestMissing({&need, 1}, -1);
  size_t called_off = 0, asked = 0;
  for (Request request; shelf.outbox.nextRequest(request);) {
    called_off += std::holds_alternative<CancelFetch>(request);
    asked += std::holds_alternative<FetchRange>(request);
  }
  EXPECT_EQ(called_off, useless.size());
  EXPECT_EQ(asked, 4u);
  EXPECT_EQ(shelf.answer(useless[0]).what, Arrival::What::Nothing) << "a late answer is dropped";
}

TEST(PlayerLoading, ALoopThatIsHeldWholeIsRaised) {
  Shelf shelf(FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 3}}), 1 << 20, kAutomaticRendition);
  std::vector<std::string> videos;
  shelf.fill({0, 0, true, {}}, [&](const FetchRange& range) {
    if (range.uri.ends_with(".mp4")) videos.push_back(range.uri);
  });
  const std::string low = "walk.0.mp4", high = "walk.mp4";
  EXPECT_EQ(videos, (std::vector<std::string>{low, low, low, high, high, high}));
  EXPECT_EQ((*shelf.loading.video(0, 1))[9], 0) << "until its next first sample is fed";
  shelf.loading.takeBetter(0, 1);
  EXPECT_EQ((*shelf.loading.video(0, 1))[9], 2);
  EXPECT_EQ(shelf.loading.renditionOf(0, 1), 2u);
  EXPECT_EQ(shelf.loading.renditionOf(0, 0), 0u);
}

TEST(PlayerLoading, ALoopIsRaisedByStepsWhereTheHighestWouldTakeLong) {
  FakeCharacter character = FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 3, 0, true}});
  const double middle_bytes = double(character.files.at("walk.1.mp4").size());
  for (const bool fast : {false, true}) {
    Shelf shelf(character, 1 << 20, kAutomaticRendition);
    shelf.loading.ladder().expect(8 * middle_bytes / 1.5 * (fast ? 2 : 1.01));
    std::vector<std::string> videos;
    shelf.fill({0, 0, true, {}}, [&](const FetchRange& range) {
      if (range.uri.ends_with(".mp4")) videos.push_back(range.uri);
    });
    const std::string low = "walk.0.mp4", next = fast ? "walk.mp4" : "walk.1.mp4";
    EXPECT_EQ(videos, (std::vector<std::string>{low, low, low, next, next, next}));
  }
}

TEST(PlayerLoading, AStandingPictureComesAsHighAsItsOwnGopCanInTwoSeconds) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 500, 10, 25, true, 192, 16, {}, 3, 0, true}});
  const auto first = [&](double bits_per_s, bool stands, bool shown) {
    Shelf shelf(character, 1 << 20, kAutomaticRendition);
    if (shown) shelf.loading.onFirstPicture();
    shelf.loading.ladder().expect(bits_per_s);
    std::string found;
    Need need{0, 0, true, {}};
    need.stands = stands;
    shelf.fill(need, [&](const FetchRange& range) {
      if (found.empty() && range.uri.ends_with(".mp4")) found = range.uri;
    });
    return found;
  };
  // Rates that bring the GOP with its geometry in two seconds; far below the rate of continuous playback.
  Shelf shelf(character);
  shelf.fill({0, 0, true, {}});
  const auto& index = shelf.loading.index(0);
  const auto rate = [&](size_t r) {
    return 8 * double(index.renditions[r].videoOf(0).bytes + index.chunks[0].bytes) / 2 + 1;
  };
  EXPECT_EQ(first(rate(2), true, true), "walk.mp4");
  EXPECT_EQ(first(rate(1), true, true), "walk.1.mp4");
  EXPECT_EQ(first(rate(0), true, true), "walk.0.mp4");
  EXPECT_EQ(first(rate(2), false, true), "walk.0.mp4") << "what plays must come as fast as it plays";
  EXPECT_EQ(first(rate(2), true, false), "walk.0.mp4") << "nothing is shown before it";
}

TEST(PlayerLoading, ANamedRenditionReplacesWhatIsThereAndWhatIsOnItsWay) {
  Shelf shelf(FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16, {}, 3}}), 1 << 20, kAutomaticRendition);
  const Need need{0, 0, true, {}};
  shelf.fill(need);  // the lowest, and also the highest
  shelf.loading.ladder().setQuality(1, 0);
  shelf.loading.dropOtherRenditions();
  shelf.loading.takeBetter(0, 0);
  EXPECT_EQ(shelf.loading.video(0, 0), nullptr) << "neither the lowest nor the highest";
  shelf.loading.requestMissing({&need, 1}, -1);
  const std::vector<FetchRange> middle = shelf.asked();
  shelf.loading.ladder().setQuality(0, 0);
  shelf.loading.dropOtherRenditions();
  for (const FetchRange& range : middle) EXPECT_EQ(shelf.answer(range).what, Arrival::What::Nothing) << range.uri;
  for (Request request; shelf.outbox.nextRequest(request);) EXPECT_TRUE(std::holds_alternative<CancelFetch>(request));
  shelf.fill(need);
  EXPECT_EQ((*shelf.loading.video(0, 0))[9], 0);
}

TEST(PlayerLoading, ALoopThatIsNotHeldWholeIsNotRaisedWhateverElseIsHeld) {
  Shelf shelf(
      FakeBuilder().build({{"walk", 500, 10, 25, true, 192, 16, {}, 3}, {"run", 400, 10, 25, true, 192, 16, {}, 3}}),
      1 << 24, kAutomaticRendition);
  const std::array<Need, 2> needs{Need{0, 0, true, {}}, Need{1, 0, true, {}}};
  for (std::vector<FetchRange> ranges;;) {
    shelf.loading.requestMissing(needs, -1);
    if ((ranges = shelf.asked()).empty()) break;
    for (const FetchRange& range : ranges) {
      EXPECT_TRUE(shelf.answer(range).status.ok());
      EXPECT_TRUE(range.uri != "walk.mp4" && range.uri != "run.mp4") << range.uri;
    }
  }
}
