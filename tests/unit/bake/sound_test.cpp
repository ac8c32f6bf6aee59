// SPDX-License-Identifier: Apache-2.0
// Encoded segments, decoded by a decoder other than a browser's.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "bake/sound/segment_encoder.h"
#include "platform/audio_input.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

// Interleaved silence with bursts of 3 ms, louder on the left than on the right.
std::vector<float> clicks(size_t count, int channels, const std::vector<size_t>& at) {
  std::vector<float> out(count * size_t(channels), 0);
  for (const size_t first : at)
    for (size_t i = 0; i < 144; ++i)
      for (int c = 0; c < channels; ++c)
        out[(first + i) * size_t(channels) + size_t(c)] = float((c == 0 ? 0.8 : 0.2) * std::sin(0.3 * double(i) + 1));
  return out;
}

std::vector<size_t> onsets(const std::vector<float>& samples, int channels, float threshold) {
  std::vector<size_t> out;
  size_t quiet = 1 << 20;
  for (size_t i = 0; i < samples.size() / size_t(channels); ++i) {
    const bool loud = std::abs(samples[i * size_t(channels)]) > threshold;
    if (loud && quiet > 2000) out.push_back(i);
    quiet = loud ? 0 : quiet + 1;
  }
  return out;
}

struct SoundTest : testing::TestWithParam<std::tuple<SoundCodec, int>> {
  SoundCodec codec = std::get<0>(GetParam());
  int channels = std::get<1>(GetParam());
  fs::path file = fs::path(testing::TempDir()) / ("sound_test_" + std::to_string(getpid()) + infoOf(codec).extension);
  void TearDown() override { fs::remove(file); }
};

TEST_P(SoundTest, SegmentsDecodeToTheirSamplesAtTheirTime) {
  const std::vector<size_t> at = {0, 10'000, 40'000};
  for (const size_t count : {size_t(45'000), size_t(45'001), size_t(48'000)}) {
    const auto encoded = encodeSegment(codec, clicks(count, channels, at), channels);
    ASSERT_TRUE(encoded.ok()) << encoded.error().message;
    EXPECT_GE(encoded.value().samples, count);
    EXPECT_LE(encoded.value().samples, count + kMaxPadding);
    ASSERT_TRUE(platform::writeFileAtomic(file.string(), encoded.value().bytes).ok());
    auto reader = platform::AudioReader::open(file.string(), kSoundRate);
    ASSERT_TRUE(reader.ok()) << reader.error().message;
    ASSERT_EQ(reader.value()->channels(), channels);
    std::vector<float> read(size_t(channels) * 100'000);
    const auto got = reader.value()->read(read);
    ASSERT_TRUE(got.ok()) << got.error().message;
    EXPECT_EQ(got.value(), encoded.value().samples) << "without priming, and without padding";
    read.resize(got.value() * size_t(channels));
    const auto found = onsets(read, channels, 0.25f);
    ASSERT_EQ(found.size(), at.size());
    for (size_t i = 0; i < at.size(); ++i) EXPECT_NEAR(double(found[i]), double(at[i]), 96) << "2 ms";
  }
}

TEST_P(SoundTest, SameSamplesGiveTheSameBytes) {
  const auto samples = clicks(20'000, channels, {500, 9'000});
  EXPECT_EQ(encodeSegment(codec, samples, channels).value().bytes,
            encodeSegment(codec, samples, channels).value().bytes);
}

INSTANTIATE_TEST_SUITE_P(All, SoundTest,
                         testing::Combine(testing::Values(SoundCodec::Opus, SoundCodec::Aac), testing::Values(1, 2)));

}  // namespace
}  // namespace fourdvt::bake
