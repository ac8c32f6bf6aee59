// SPDX-License-Identifier: Apache-2.0
// GOPs → mp4 → sample table → decoder: every picture carries its own frame's barcode.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "encode/mp4.h"
#include "encode/tile.h"
#include "package/barcode.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"

namespace fourdvt::encode {
namespace {

constexpr uint32_t kFrames = 29;

// Name of the parameter, printed by GoogleTest.
std::string nameOf(const testing::TestParamInfo<Codec>& info) { return infoOf(info.param).name; }

struct EncodeTest : testing::TestWithParam<Codec> {
  TileLayout layout = makeTileLayout(1, 512);
  EncodeSettings settings{layout.width, layout.height, 25, 30, GetParam(), fastPreset(GetParam())};
  std::vector<uint32_t> first = planGops(kFrames, 8);  // 7 or 8 frames each
  std::string folder =
      testing::TempDir() + "fourdvt_encode_test_" + infoOf(GetParam()).name + "_" + std::to_string(getpid());
  std::string path = folder + "/test.mp4";
  void SetUp() override { ASSERT_TRUE(platform::makeFolder(folder).ok()); }
  void TearDown() override { platform::removeFolder(folder); }

  static const char* fastPreset(Codec codec) {
    return codec == Codec::H264 ? "medium" : codec == Codec::Vp9 ? "5" : "7";
  }

  // Moving disc, so that B-frames save bits.
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

TEST_P(EncodeTest, EveryDecodedPictureIsTheFrameThatTheTableSays) {
  const auto load = [&](uint32_t gop) { return encode(gop); };
  const Status written = writeMp4(path, settings, uint32_t(first.size()), load);
  ASSERT_TRUE(written.ok()) << written.error().message;
  auto samples = readMp4Samples(path, 25, first, kFrames);
  ASSERT_TRUE(samples.ok()) << samples.error().message;
  const package::SampleTable& table = samples.value().table;
  auto file = platform::readFile(path);
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
  EXPECT_EQ(reordered, GetParam() == Codec::H264) << "no B-frames: the test would prove nothing";
  EXPECT_EQ(table.decoder_description.empty(), GetParam() != Codec::H264);
  ASSERT_EQ(barcode_of.size(), kFrames);
  for (const auto& [frame, barcode] : barcode_of) EXPECT_EQ(barcode, frame);
}

TEST_P(EncodeTest, SameInputGivesSameBytes) {
  auto a = encode(1), b = encode(1);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a.value().parameter_sets, b.value().parameter_sets);
  ASSERT_EQ(a.value().packets.size(), b.value().packets.size());
  for (size_t i = 0; i < a.value().packets.size(); ++i)
    EXPECT_EQ(a.value().packets[i].bytes, b.value().packets[i].bytes);
}

TEST_P(EncodeTest, FolderThatCannotBeWrittenIsOneClearError) {
  const Status written = writeMp4(folder + "/absent/test.mp4", settings, 1, [&](uint32_t gop) { return encode(gop); });
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().id, ErrorId::WriteFailed);
  EXPECT_NE(written.error().message.find("absent/test.mp4"), std::string::npos);
}

// Codec string for WebCodecs: 8 bits, 4:2:0, BT.709, limited range.
TEST_P(EncodeTest, CodecStringIsComplete) {
  const auto load = [&](uint32_t gop) { return encode(gop); };
  ASSERT_TRUE(writeMp4(path, settings, uint32_t(first.size()), load).ok());
  auto samples = readMp4Samples(path, 25, first, kFrames);
  ASSERT_TRUE(samples.ok()) << samples.error().message;
  const std::string& codec = samples.value().codec;
  if (GetParam() == Codec::H264) {
    EXPECT_EQ(codec, "avc1.64001e");  // High, level 3.0: 1056 macroblocks at 25 Hz
  }
  // 512 × 528 is above level 2.1's 245760 luma samples.
  if (GetParam() == Codec::Vp9) {
    EXPECT_EQ(codec, "vp09.00.30.08.01.01.01.01.00");
  }
  if (GetParam() == Codec::Av1) {
    ASSERT_EQ(codec.size(), std::string("av01.0.04M.08.0.110.01.01.01.0").size()) << codec;
    EXPECT_EQ(codec.substr(0, 7), "av01.0.");
    EXPECT_EQ(codec.substr(9), "M.08.0.110.01.01.01.0");
    EXPECT_GE(codec.substr(7, 2), "01");  // level 2.1 holds 278784 luma samples, 2.0 does not
    EXPECT_LE(codec.substr(7, 2), "08");
  }
}

// Two members at web quality, 28 phases in 0.94 s: 12384 macroblocks are too many for H.264's level 4.2, 3.2 million
// luma samples for VP9's and AV1's 4.1.
TEST_P(EncodeTest, LevelFitsTheLargePictureOfAClass) {
  const TileLayout large = makeTileLayout(3, 1024, false, 2);
  settings.width = large.width;
  settings.height = large.height;
  settings.fps = 28 / 0.94;
  const Status written = writeMp4(path, settings, 1, [&](uint32_t) -> Result<EncodedGop> {
    auto encoder = GopEncoder::create(settings);
    if (!encoder) return encoder.error();
    for (uint32_t f = 0; f < 2; ++f) {
      I420Picture out(large.width, large.height);
      tileFrame(large, std::vector<Image>(), f, out);
      FOURDVT_TRY(encoder.value()->push(out.view()));
    }
    return encoder.value()->finish();
  });
  ASSERT_TRUE(written.ok()) << written.error().message;
  auto samples = readMp4Samples(path, settings.fps, {0}, 2);
  ASSERT_TRUE(samples.ok()) << samples.error().message;
  const std::string level = GetParam() == Codec::H264  ? "avc1.640032"
                            : GetParam() == Codec::Vp9 ? "vp09.00.50."
                                                       : "av01.0.12M.";
  EXPECT_EQ(samples.value().codec.substr(0, level.size()), level) << samples.value().codec;
}

TEST_P(EncodeTest, GopOfOneFrame) {
  auto encoder = GopEncoder::create(settings);
  ASSERT_TRUE(encoder.ok()) << encoder.error().message;
  ASSERT_TRUE(encoder.value()->push(picture(3).view()).ok());
  auto gop = encoder.value()->finish();
  ASSERT_TRUE(gop.ok()) << gop.error().message;
  ASSERT_EQ(gop.value().packets.size(), 1u);
  EXPECT_TRUE(gop.value().packets[0].key);
}

INSTANTIATE_TEST_SUITE_P(Codecs, EncodeTest, testing::Values(Codec::H264, Codec::Vp9, Codec::Av1), nameOf);

// VP9 hides alternate reference pictures in superframes (last byte 110xxxxx): still a packet a frame.
TEST(Vp9, HiddenPicturesShareAPacketWithAShownOne) {
  EncodeSettings settings{192, 192, 25, 40, Codec::Vp9, "2"};
  auto encoder = GopEncoder::create(settings);
  ASSERT_TRUE(encoder.ok()) << encoder.error().message;
  I420Picture picture(192, 192);
  constexpr uint32_t kLong = 20;
  for (uint32_t f = 0; f < kLong; ++f) {
    for (int y = 0; y < 192; ++y)
      for (int x = 0; x < 192; ++x)
        picture.y[y * 192 + x] = uint8_t(126 + 90 * std::sin((x + 2.0 * f) * 0.11) * std::cos(y * 0.13));
    ASSERT_TRUE(encoder.value()->push(picture.view()).ok());
  }
  auto gop = encoder.value()->finish();
  ASSERT_TRUE(gop.ok()) << gop.error().message;
  ASSERT_EQ(gop.value().packets.size(), kLong);
  int superframes = 0;
  for (const EncodedPacket& packet : gop.value().packets) superframes += (packet.bytes.back() & 0xe0) == 0xc0;
  EXPECT_GT(superframes, 0) << "no hidden picture: the test would prove nothing";
}

TEST(Presets, AreCheckedWithTheRemedy) {
  EXPECT_TRUE(knowsPreset(Codec::H264, "slow"));
  EXPECT_TRUE(knowsPreset(Codec::Av1, "aom-6"));
  for (const Codec codec : {Codec::H264, Codec::Vp9, Codec::Av1}) {
    EXPECT_TRUE(knowsPreset(codec, ""));
    EXPECT_TRUE(knowsPreset(codec, infoOf(codec).default_preset));
    EXPECT_TRUE(checkEncoder(codec, "").ok());
    for (const char* wrong : {"8", "-1", "fastest", "aom-9", "6 "}) {
      EXPECT_FALSE(knowsPreset(codec, wrong)) << infoOf(codec).name << " " << wrong;
      const Status status = checkEncoder(codec, wrong);
      ASSERT_FALSE(status.ok());
      EXPECT_EQ(status.error().id, ErrorId::InvalidArgument);
      EXPECT_NE(status.error().message.find(infoOf(codec).presets), std::string::npos);
    }
  }
}

TEST(Codecs, NamesRoundTrip) {
  for (const Codec codec : {Codec::H264, Codec::Vp9, Codec::Av1}) {
    Codec parsed = Codec::H264;
    EXPECT_TRUE(parseCodec(infoOf(codec).name, parsed));
    EXPECT_EQ(parsed, codec);
  }
  EXPECT_STREQ(infoOf(Codec::H264).name, "h264");
  EXPECT_STREQ(infoOf(Codec::Vp9).name, "vp9");
  EXPECT_STREQ(infoOf(Codec::Av1).name, "av1");
  Codec unchanged = Codec::Vp9;
  EXPECT_FALSE(parseCodec("hevc", unchanged));
  EXPECT_EQ(unchanged, Codec::Vp9);
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
}  // namespace fourdvt::encode
