// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include "platform/audio_input.h"

namespace fourdvt::platform {
namespace {

namespace fs = std::filesystem;

struct AudioTest : testing::Test {
  fs::path file = fs::path(testing::TempDir()) / ("audio_test_" + std::to_string(getpid()) + ".wav");
  void TearDown() override { fs::remove(file); }

  // Writes 16-bit samples; frame(i, channel) in -1..1.
  void writeWav(uint32_t rate, uint16_t channels, uint32_t samples, const auto& frame) const {
    std::string data;
    for (uint32_t i = 0; i < samples; ++i)
      for (uint16_t c = 0; c < channels; ++c) {
        const auto v = int16_t(std::lround(32767 * frame(i, c)));
        data += {char(v & 255), char(v >> 8 & 255)};
      }
    const auto number = [](uint32_t v, int bytes) {
      std::string out;
      for (int b = 0; b < bytes; ++b) out += char(v >> (8 * b) & 255);
      return out;
    };
    std::ofstream(file, std::ios::binary)
        << "RIFF" << number(36 + uint32_t(data.size()), 4) << "WAVEfmt " << number(16, 4) << number(1, 2)
        << number(channels, 2) << number(rate, 4) << number(rate * channels * 2, 4) << number(channels * 2, 2)
        << number(16, 2) << "data" << number(uint32_t(data.size()), 4) << data;
  }
};

TEST_F(AudioTest, ReadsInPartsWhatTheFileHolds) {
  writeWav(48000, 2, 10'000, [](uint32_t i, uint16_t c) { return c == 0 ? i / 20'000.0 : -0.25; });
  auto reader = AudioReader::open(file.string(), 48000);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  EXPECT_EQ(reader.value()->channels(), 2);
  uint32_t at = 0;
  for (const size_t part : {1u, 5000u, 3000u}) {
    std::vector<float> out(2 * part);
    ASSERT_EQ(reader.value()->read(out).value(), part);
    for (size_t i = 0; i < part; ++i, ++at) {
      EXPECT_NEAR(out[2 * i], at / 20'000.0, 1e-4);
      EXPECT_NEAR(out[2 * i + 1], -0.25, 1e-4);
    }
  }
  std::vector<float> rest(2 * 5000);
  EXPECT_EQ(reader.value()->read(rest).value(), 10'000u - at);
  EXPECT_EQ(reader.value()->read(rest).value(), 0u);
}

TEST_F(AudioTest, ResamplesAndMixesDown) {
  // 440 Hz in the centre channel of six.
  writeWav(44100, 6, 44'100, [](uint32_t i, uint16_t c) {
    return c == 2 ? 0.5 * std::sin(2 * std::numbers::pi * 440 * i / 44100) : 0.0;
  });
  auto reader = AudioReader::open(file.string(), 48000);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  ASSERT_EQ(reader.value()->channels(), 2);
  std::vector<float> out(2 * 60'000);
  const size_t count = reader.value()->read(out).value();
  EXPECT_NEAR(double(count), 48'000, 20);
  int crossings = 0;
  float most = 0;
  for (size_t i = 1; i < count; ++i) {
    crossings += out[2 * i - 2] < 0 && out[2 * i] >= 0;
    most = std::max(most, out[2 * i]);
    EXPECT_NEAR(out[2 * i], out[2 * i + 1], 1e-4);
  }
  EXPECT_NEAR(crossings, 440, 2);
  EXPECT_GT(most, 0.15f);
}

TEST_F(AudioTest, SaysWhatIsWrong) {
  const auto missing = AudioReader::open((file.string() + ".none"), 48000);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().id, ErrorId::FileMissing);
  EXPECT_NE(missing.error().message.find(".wav.none"), std::string::npos);
  std::ofstream(file) << "this is no sound";
  EXPECT_EQ(AudioReader::open(file.string(), 48000).error().id, ErrorId::FileUnreadable);
  // A playlist that refers to another file is rejected.
  std::ofstream(file) << "ffconcat version 1.0\nfile /etc/passwd\n";
  EXPECT_EQ(AudioReader::open(file.string(), 48000).error().id, ErrorId::FileUnreadable);
  std::ofstream(file, std::ios::trunc).close();
  EXPECT_EQ(AudioReader::open(file.string(), 48000).error().id, ErrorId::FileUnreadable);
}

}  // namespace
}  // namespace fourdvt::platform
