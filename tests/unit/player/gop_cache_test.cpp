// SPDX-License-Identifier: Apache-2.0
// The playback clock and the cache of GOPs in isolation: GOPs to hold, GOPs to evict.
#include "player/parts/gop_cache.h"

#include <gtest/gtest.h>

#include "player/parts/playback.h"

using namespace fourdvt;

namespace {

package::StreamIndex threeGops() {
  package::StreamIndex index;
  index.frame_count = 25;
  index.chunks = {{0, 10, 0, 1}, {10, 10, 1, 1}, {20, 5, 2, 1}};
  return index;
}

void fill(GopCache& cache, GopKey key, size_t bytes) {
  Gop& gop = cache.touch(key);
  gop.video.resize(bytes / 2);
  gop.chunk.resize(bytes - bytes / 2);
  gop.video_state = gop.chunk_state = PartState::Present;
}

}  // namespace

// A decoded GOP of 100 bytes.
class SomeFrames final : public package::ChunkDecoder {
 public:
  SomeFrames() { frames_.labels.resize(100); }
  Status decodeTo(uint32_t) override { return {}; }
  Status step() override { return {}; }
  uint32_t decodedCount() const override { return 0; }
  const package::ChunkFrames& frames() const override { return frames_; }
  package::ChunkFrames take() override { return {}; }

 private:
  package::ChunkFrames frames_;
};

TEST(PlaybackClock, RunsAtItsRateAndOnlyWhenRunning) {
  PlaybackClock clock;
  clock.advance(100);
  clock.advance(100.1);
  EXPECT_EQ(clock.position(), 0);
  clock.setRunning(true);
  clock.advance(100.2);
  EXPECT_NEAR(clock.position(), 0.1, 1e-9);
  clock.setRate(2);
  clock.advance(100.3);
  EXPECT_NEAR(clock.position(), 0.3, 1e-9);
  clock.setRunning(false);
  clock.advance(100.4);
  EXPECT_NEAR(clock.position(), 0.3, 1e-9);
}

TEST(PlaybackClock, TheFirstTimeIsNoStep) {
  PlaybackClock clock;
  clock.setRunning(true);
  clock.advance(5000);
  EXPECT_EQ(clock.position(), 0);
}

TEST(PlaybackClock, ASleepingTabIsOneShortStepAndTimeNeverGoesBack) {
  PlaybackClock clock;
  clock.setRunning(true);
  clock.advance(0);
  clock.advance(3600);
  EXPECT_NEAR(clock.position(), 0.25, 1e-9);
  clock.advance(10);
  EXPECT_NEAR(clock.position(), 0.25, 1e-9);
  clock.advance(3600.1);
  EXPECT_NEAR(clock.position(), 0.35, 1e-9);
}

TEST(PlaybackClock, HoldsAtALimitAndJumps) {
  PlaybackClock clock;
  clock.setRunning(true);
  clock.jump(3);
  clock.holdAt(4);
  EXPECT_EQ(clock.position(), 3);
  clock.holdAt(2.5);
  EXPECT_EQ(clock.position(), 2.5);
}

TEST(NeededGops, NearestFirstAndWrapOnlyWhenLooping) {
  const package::StreamIndex index = threeGops();
  EXPECT_EQ(neededGops(index, 0, true, 1), (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(neededGops(index, 19, false, 1), (std::vector<uint32_t>{1, 2}));
  EXPECT_EQ(neededGops(index, 24, true, 1), (std::vector<uint32_t>{2, 0}));
  EXPECT_EQ(neededGops(index, 24, false, 1), (std::vector<uint32_t>{2}));
  EXPECT_EQ(neededGops(index, 0, true, 20), (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(neededGops(index, 0, true, 21), (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(neededGops(index, 5, true, 90), (std::vector<uint32_t>{0, 1, 2}));
}

TEST(GopCache, EvictsTheLeastRecentlyUsedWithinTheBudget) {
  GopCache cache(250);
  for (uint32_t g = 0; g < 3; ++g) fill(cache, {0, g}, 100);
  cache.touch({0, 0});
  cache.trim({});
  EXPECT_EQ(cache.encodedBytes(), 200u);
  EXPECT_NE(cache.find({0, 0}), nullptr);
  EXPECT_EQ(cache.find({0, 1}), nullptr);
  EXPECT_NE(cache.find({0, 2}), nullptr);
}

TEST(GopCache, NeverEvictsWhatIsKeptOrBeingFetched) {
  GopCache cache(50);
  fill(cache, {0, 0}, 100);
  fill(cache, {0, 1}, 100);
  cache.find({0, 1})->chunk_state = PartState::Fetching;
  fill(cache, {1, 0}, 100);
  cache.trim({{0, 0}});
  EXPECT_NE(cache.find({0, 0}), nullptr);
  EXPECT_NE(cache.find({0, 1}), nullptr);
  EXPECT_EQ(cache.find({1, 0}), nullptr);
  cache.dropSequence(0);
  EXPECT_EQ(cache.encodedBytes(), 0u);
}

TEST(GopCache, DecodedGeometryIsKeptWithinItsBudget) {
  GopCache cache(1000, 300);
  for (uint32_t g = 0; g < 5; ++g) {
    fill(cache, {0, g}, 10);
    cache.find({0, g})->geometry = std::make_unique<SomeFrames>();
  }
  cache.touch({0, 0});
  cache.trim({{0, 1}, {0, 2}});
  EXPECT_EQ(cache.decodedBytes(), 300u);
  EXPECT_NE(cache.find({0, 0})->geometry, nullptr) << "used last";
  EXPECT_EQ(cache.find({0, 3})->geometry, nullptr);
  cache.trim({{0, 1}, {0, 2}, {0, 3}, {0, 4}});
  EXPECT_EQ(cache.decodedCount(), 3u);
  EXPECT_EQ(cache.encodedBytes(), 50u) << "its bytes stay";
}

TEST(GopCache, KeptGeometryMayExceedItsBudget) {
  GopCache cache(1000, 100);
  for (uint32_t g = 0; g < 3; ++g) {
    fill(cache, {0, g}, 10);
    cache.find({0, g})->geometry = std::make_unique<SomeFrames>();
  }
  cache.trim({{0, 0}, {0, 1}});
  EXPECT_EQ(cache.decodedCount(), 2u);
  EXPECT_EQ(cache.find({0, 2})->geometry, nullptr);
}
