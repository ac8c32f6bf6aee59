// SPDX-License-Identifier: Apache-2.0
// GOPs → mp4 → sample table → decoder: every picture carries its own frame's barcode.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "bake/job.h"
#include "bake/mp4.h"
#include "bake/output.h"
#include "package/barcode.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::bake {
namespace {

constexpr uint32_t kFrames = 29;

struct EncodeTest : testing::Test {
  TileLayout layout = makeTileLayout(1, 512);
  EncodeSettings settings{layout.width, layout.height, 25, 30};
  std::vector<uint32_t> first = planGops(kFrames, 8);  // 7 or 8 frames each
  std::string folder = testing::TempDir() + "fourdvt_encode_test";
  std::string path = folder + "/test.mp4";
  void SetUp() override { ASSERT_TRUE(makeFolder(folder).ok()); }
  void TearDown() override { removeFolder(folder); }

  // A disc that moves, so that B-frames pay.
  I420Picture picture(uint32_t frame) const {
    Image layer(512, 512, 4, 255);
    for (int y = 0; y < 512; ++y)
      for (int x = 0; x < 512; ++x) {
        const bool disc = std::hypot(x - 100 - 8.0 * frame, y - 256.0) < 60;
        layer.at(x, y)[0] = disc ? 220 : static_cast<uint8_t>(128 + 60 * std::sin(x * 0.05) * std::cos(y * 0.07));
      }
    I420Picture out(layout.width, layout.height);
    tileFrame(layout, {layer}, frame, out);
    return out;
  }

  Result<EncodedGop> encode(uint32_t gop) const {
    auto encoder = GopEncoder::create(settings);
    if (!encoder) return encoder.error();
    const uint32_t end = gop + 1 < first.size() ? first[gop + 1] : kFrames;
    for (uint32_t f = first[gop]; f < end; ++f) FOURDVT_TRY(encoder.value()->push(picture(f).view()));
    return encoder.value()->finish();
  }
};

TEST_F(EncodeTest, EveryDecodedPictureIsTheFrameThatTheTableSays) {
  const auto load = [&](uint32_t gop) { return encode(gop); };
  const Status written = writeMp4(path, settings, uint32_t(first.size()), load);
  ASSERT_TRUE(written.ok()) << written.error().message;
  auto samples = readMp4Samples(path, 25, first, kFrames);
  ASSERT_TRUE(samples.ok()) << samples.error().message;
  const package::SampleTable& table = samples.value().table;
  auto file = readFile(path);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(samples.value().file_bytes, file.value().size());

  std::map<uint32_t, uint32_t> barcode_of;
  auto decoder = platform::SampleDecoder::create(
      samples.value().codec, table.decoder_description, [&](const I420View& view, int64_t timestamp_us) {
        barcode_of[uint32_t(timestamp_us / 1000)] = package::readBarcode(layout.barcode, view).value_or(9999);
      });
  ASSERT_TRUE(decoder.ok()) << decoder.error().message;
  bool reordered = false;
  for (size_t i = 0; i < table.samples.size(); ++i) {
    const package::VideoSample& s = table.samples[i];
    reordered |= i > 0 && s.frame < table.samples[i - 1].frame;
    const std::span<const uint8_t> bytes(file.value().data() + s.offset, s.bytes);
    ASSERT_TRUE(decoder.value()->decode(bytes, int64_t(s.frame) * 1000, s.key).ok()) << i;
  }
  ASSERT_TRUE(decoder.value()->flush().ok());
  EXPECT_TRUE(reordered) << "no B-frames: the test would prove nothing";
  ASSERT_EQ(barcode_of.size(), kFrames);
  for (const auto& [frame, barcode] : barcode_of) EXPECT_EQ(barcode, frame);
}

TEST_F(EncodeTest, SameInputGivesSameBytes) {
  auto a = encode(1), b = encode(1);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a.value().parameter_sets, b.value().parameter_sets);
  ASSERT_EQ(a.value().packets.size(), b.value().packets.size());
  for (size_t i = 0; i < a.value().packets.size(); ++i)
    EXPECT_EQ(a.value().packets[i].bytes, b.value().packets[i].bytes);
}

TEST_F(EncodeTest, FolderThatCannotBeWrittenIsOneClearError) {
  const Status written = writeMp4(folder + "/absent/test.mp4", settings, 1, [&](uint32_t gop) { return encode(gop); });
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().id, ErrorId::WriteFailed);
  EXPECT_NE(written.error().message.find("absent/test.mp4"), std::string::npos);
}

TEST(PlanGops, LengthsDifferByOneAtMost) {
  for (uint32_t frames : {1u, 19u, 20u, 21u, 28u, 40u, 41u, 280u}) {
    const std::vector<uint32_t> first = planGops(frames, 20);
    uint32_t shortest = frames, longest = 0;
    for (size_t g = 0; g < first.size(); ++g) {
      const uint32_t length = (g + 1 < first.size() ? first[g + 1] : frames) - first[g];
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    EXPECT_EQ(first[0], 0u);
    EXPECT_LE(longest, 20u);
    EXPECT_LE(longest - shortest, 1u) << frames;
  }
}

}  // namespace
}  // namespace fourdvt::bake
