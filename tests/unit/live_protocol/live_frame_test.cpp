// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "package/live_stream.h"

namespace fourdvt::package {
namespace {

const std::vector<uint8_t> kChunk{1, 2, 3}, kSample{4, 5};

std::vector<uint8_t> frameBytes(bool key = true) { return writeLiveFrame({9, key, 1790000000123456, kChunk, kSample}); }

void expectRefused(const std::vector<uint8_t>& bytes, ErrorId id = ErrorId::StreamInvalid) {
  const auto read = readLiveFrame(bytes);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().id, id);
}

TEST(LiveFrame, ComesBackAsItWas) {
  for (const bool key : {false, true}) {
    const auto bytes = frameBytes(key);
    const auto read = readLiveFrame(bytes);
    ASSERT_TRUE(read.ok());
    const LiveFrame& f = read.value();
    EXPECT_EQ(f.number, 9u);
    EXPECT_EQ(f.key, key);
    EXPECT_EQ(f.captured_us, 1790000000123456);
    EXPECT_EQ(std::vector<uint8_t>(f.chunk.begin(), f.chunk.end()), kChunk);
    EXPECT_EQ(std::vector<uint8_t>(f.sample.begin(), f.sample.end()), kSample);
  }
}

TEST(LiveFrame, IsRefusedWhereLengthsDoNotAddUp) {
  auto bytes = frameBytes();
  for (size_t end = 0; end < bytes.size(); ++end) expectRefused({bytes.begin(), bytes.begin() + long(end)});
  bytes.push_back(0);
  expectRefused(bytes);
  expectRefused(writeLiveFrame({1, true, 1, {}, kSample}));
  expectRefused(writeLiveFrame({1, true, 1, kChunk, {}}));
  auto huge = frameBytes();
  huge[20] = huge[21] = huge[22] = huge[23] = 0xff;  // the chunk's length
  expectRefused(huge);
}

TEST(LiveFrame, IsRefusedWithOtherMarksAndVersions) {
  auto magic = frameBytes(), version = frameBytes(), flags = frameBytes();
  ++magic[0];
  expectRefused(magic);
  ++version[4];
  expectRefused(version, ErrorId::Unsupported);
  flags[6] = 2;
  expectRefused(flags);
}

TEST(LiveFrame, IsRefusedBeyondTheMost) {
  const std::vector<uint8_t> fill(kMaxLiveFrameBytes - frameBytes().size() + kSample.size());
  EXPECT_TRUE(readLiveFrame(writeLiveFrame({1, true, 1, kChunk, fill})).ok());
  const std::vector<uint8_t> more(fill.size() + 1);
  expectRefused(writeLiveFrame({1, true, 1, kChunk, more}));
}

}  // namespace
}  // namespace fourdvt::package
