// SPDX-License-Identifier: Apache-2.0
// Metadata of videos: display matrices, non-square pixels, fields, and colour spaces other than BT.709.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "platform/ffmpeg_handles.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::platform {
namespace {

struct Description {
  AVPixelFormat format = AV_PIX_FMT_GBRP10;
  AVColorPrimaries primaries = AVCOL_PRI_BT709;
  AVColorTransferCharacteristic transfer = AVCOL_TRC_BT709;
  AVColorSpace matrix = AVCOL_SPC_RGB;
  AVColorRange range = AVCOL_RANGE_JPEG;
  AVRational aspect{1, 1};
  std::array<int, 4> display{1, 0, 0, 1};  // a, b, c, d of the display matrix
};

// File of 32x16 pixels, removed with the object: lossless FFV1 in Matroska, or in QuickTime if it has a display matrix.
class MarkedVideo {
 public:
  using Paint = std::function<void(AVFrame&, int number)>;

  MarkedVideo(const Description& description, int frames, const Paint& paint)
      : path_((std::filesystem::path(testing::TempDir()) / ("fourdvt_marked_" + std::to_string(::getpid()) + ".mov"))
                  .string()) {
    AVFormatContext* format = nullptr;
    avformat_alloc_output_context2(&format, nullptr, nullptr, path_.c_str());
    AvCodec codec(avcodec_alloc_context3(avcodec_find_encoder(AV_CODEC_ID_FFV1)));
    describe(description, *codec);
    EXPECT_GE(avcodec_open2(codec.get(), nullptr, nullptr), 0);
    AVStream* stream = avformat_new_stream(format, nullptr);
    avcodec_parameters_from_context(stream->codecpar, codec.get());
    stream->time_base = codec->time_base;
    stream->sample_aspect_ratio = description.aspect;
    turn(description.display, *stream);
    EXPECT_GE(avio_open(&format->pb, path_.c_str(), AVIO_FLAG_WRITE), 0);
    format->strict_std_compliance = FF_COMPLIANCE_EXPERIMENTAL;
    EXPECT_GE(avformat_write_header(format, nullptr), 0);
    for (int i = 0; i < frames; ++i) encode(*format, *codec, i, paint);
    av_write_trailer(format);
    avio_closep(&format->pb);
    avformat_free_context(format);
  }
  ~MarkedVideo() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  static void describe(const Description& d, AVCodecContext& codec) {
    codec.width = 32, codec.height = 16;
    codec.pix_fmt = d.format;
    codec.color_primaries = d.primaries, codec.color_trc = d.transfer;
    codec.colorspace = d.matrix, codec.color_range = d.range;
    codec.sample_aspect_ratio = d.aspect;
    codec.time_base = {1, 25};
    codec.strict_std_compliance = FF_COMPLIANCE_EXPERIMENTAL;
  }
  static void turn(const std::array<int, 4>& display, AVStream& stream) {
    auto* matrix =
        reinterpret_cast<int32_t*>(av_stream_new_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(int32_t)));
    const int32_t values[9] = {display[0] << 16, display[1] << 16, 0, display[2] << 16, display[3] << 16, 0, 0, 0,
                               1 << 30};
    std::memcpy(matrix, values, sizeof values);
  }
  static void encode(AVFormatContext& format, AVCodecContext& codec, int number, const Paint& paint) {
    const AvFrame frame(av_frame_alloc());
    const AvPacket packet(av_packet_alloc());
    frame->format = codec.pix_fmt, frame->width = codec.width, frame->height = codec.height;
    av_frame_get_buffer(frame.get(), 0);
    frame->pts = number;
    paint(*frame, number);
    EXPECT_GE(avcodec_send_frame(&codec, frame.get()), 0);
    while (avcodec_receive_packet(&codec, packet.get()) == 0) {
      packet->duration = 1;
      av_packet_rescale_ts(packet.get(), codec.time_base, format.streams[0]->time_base);
      EXPECT_GE(av_interleaved_write_frame(&format, packet.get()), 0);
    }
  }

  std::string path_;
};

// Picture of one colour, R, G, B given in 8 bits; coded in 10 bits.
MarkedVideo::Paint rgb(int r, int g, int b) {
  return [=](AVFrame& frame, int) {
    const int levels[3] = {g, b, r};  // planes of GBRP
    for (int plane = 0; plane < 3; ++plane)
      for (int i = 0; i < frame.linesize[plane] / 2 * frame.height; ++i)
        reinterpret_cast<uint16_t*>(frame.data[plane])[i] = uint16_t(std::lround(levels[plane] * 1023 / 255.0));
  };
}

// Grey of 10 bits in YUV 4:2:0.
MarkedVideo::Paint grey10(int luma) {
  return [=](AVFrame& frame, int) {
    for (int plane = 0; plane < 3; ++plane)
      for (int i = 0; i < frame.linesize[plane] / 2 * (plane ? frame.height / 2 : frame.height); ++i)
        reinterpret_cast<uint16_t*>(frame.data[plane])[i] = uint16_t(plane ? 512 : luma);
  };
}

std::unique_ptr<VideoSource> opened(const MarkedVideo& video, int channels = 3) {
  auto source = openVideoFile(video.path(), channels);
  EXPECT_TRUE(source.ok()) << (source.ok() ? "" : source.error().message);
  return source.take();
}

std::array<int, 3> colourOf(const MarkedVideo& video) {
  const Image image = *opened(video)->next().value();
  const uint8_t* p = image.at(10, 5);
  return {p[0], p[1], p[2]};
}

void expectNear(const std::array<int, 3>& colour, const std::array<double, 3>& expected, double tolerance) {
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(colour[c], expected[c], tolerance) << "channel " << c;
}

TEST(VideoMarks, DisplayMatricesTurnAndMirror) {
  const struct {
    std::array<int, 4> display;
    bool mirrored;
    int quarter_turns;
  } kAll[] = {{{1, 0, 0, 1}, false, 0},  {{0, 1, -1, 0}, false, 1}, {{-1, 0, 0, -1}, false, 2},
              {{0, -1, 1, 0}, false, 3}, {{-1, 0, 0, 1}, true, 0},  {{1, 0, 0, -1}, true, 2},
              {{0, 1, 1, 0}, true, 3},   {{0, -1, -1, 0}, true, 1}};
  for (const auto& c : kAll) {
    const MarkedVideo video({.display = c.display}, 1, rgb(10, 20, 30));
    const PictureMarks marks = opened(video)->marks();
    EXPECT_EQ(marks.mirrored, c.mirrored) << c.display[0] << c.display[1];
    EXPECT_EQ(marks.quarter_turns, c.quarter_turns) << c.display[0] << c.display[1];
    EXPECT_EQ(marks.pixel_aspect, 1);
  }
}

TEST(VideoMarks, AMatrixBetweenQuartersIsRefused) {
  const MarkedVideo video({.display = {1, 1, -1, 1}}, 1, rgb(10, 20, 30));
  const auto source = openVideoFile(video.path(), 3);
  ASSERT_FALSE(source.ok());
  EXPECT_NE(source.error().message.find(video.path() + ": its display matrix"), std::string::npos);
}

TEST(VideoMarks, PixelsThatAreNotSquare) {
  const MarkedVideo video({.aspect = {4, 3}}, 1, rgb(10, 20, 30));
  EXPECT_NEAR(opened(video)->marks().pixel_aspect, 4.0 / 3, 1e-6);
}

TEST(VideoMarks, Bt709IsLeftAsItIs) {
  const MarkedVideo video({}, 1, rgb(200, 100, 50));
  const auto source = opened(video);
  expectNear(colourOf(video), {200, 100, 50}, 1);  // 10 bits → 8
  ASSERT_TRUE(source->next().ok());
  EXPECT_TRUE(source->conversions().empty());
}

// Light of a BT.709 signal on a display (BT.1886), and back.
double lightOf(double level) { return std::pow(level, 2.4); }
double levelOf(double light) { return std::pow(light, 1 / 2.4); }

TEST(VideoMarks, P3BecomesBt709) {
  const double r = lightOf(200 / 255.0), g = lightOf(120 / 255.0), b = lightOf(90 / 255.0);
  const std::array<double, 3> expected{255 * levelOf(1.2249 * r - 0.2247 * g), 255 * levelOf(-0.0420 * r + 1.0419 * g),
                                       255 * levelOf(-0.0197 * r - 0.0786 * g + 1.0979 * b)};
  const MarkedVideo video({.primaries = AVCOL_PRI_SMPTE432}, 1, rgb(200, 120, 90));
  expectNear(colourOf(video), expected, 2);
}

// HLG (BT.2100): a signal of one half is a twelfth of the scene's light; a display of 1000 cd/m² shows this to the
// power of 1.2. White, at 203 cd/m² (BT.2408), is a signal of three quarters.
TEST(VideoMarks, HlgAndPqBecomeBt709) {
  const Description hlg{AV_PIX_FMT_YUV420P10, AVCOL_PRI_BT2020, AVCOL_TRC_ARIB_STD_B67, AVCOL_SPC_BT2020_NCL,
                        AVCOL_RANGE_MPEG};
  const double half = 255 * levelOf(1000 * std::pow(1.0 / 12, 1.2) / 203);
  const MarkedVideo grey(hlg, 1, grey10(64 + 876 / 2));
  expectNear(colourOf(grey), {half, half, half}, 3);
  const auto source = opened(grey);
  ASSERT_TRUE(source->next().ok());
  ASSERT_EQ(source->conversions().size(), 1u);
  EXPECT_EQ(source->conversions()[0], "HLG, BT.2020 → BT.709");
}

TEST(VideoMarks, WhiteOfHlgAndPqIsNearlyWhite) {
  Description wide{AV_PIX_FMT_YUV420P10, AVCOL_PRI_BT2020, AVCOL_TRC_ARIB_STD_B67, AVCOL_SPC_BT2020_NCL,
                   AVCOL_RANGE_MPEG};
  expectNear(colourOf(MarkedVideo(wide, 1, grey10(64 + 876 * 3 / 4))), {250, 250, 250}, 6);
  wide.transfer = AVCOL_TRC_SMPTE2084;
  expectNear(colourOf(MarkedVideo(wide, 1, grey10(64 + int(876 * 0.5806)))), {250, 250, 250}, 6);  // 203 cd/m²
}

// Interlaced video with YUV4MPEG2's marks; light grows by a constant step from field to field.
class Fields {
 public:
  explicit Fields(int frames)
      : path_((std::filesystem::path(testing::TempDir()) / ("fourdvt_fields_" + std::to_string(::getpid()) + ".y4m"))
                  .string()) {
    std::ofstream out(path_, std::ios::binary);
    out << "YUV4MPEG2 W32 H16 F25:1 It A1:1 C420mpeg2\n";
    for (int n = 0; n < frames; ++n) {
      out << "FRAME\n";
      for (int y = 0; y < 16; ++y) out << std::string(32, char(lumaAt(2 * n + y % 2)));
      out << std::string(size_t(2 * 16 * 8), char(128));
    }
  }
  ~Fields() { std::filesystem::remove(path_); }
  static int lumaAt(int field) { return 40 + field % 100; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(VideoMarks, PicturesOfTwoFieldsShowTheFirstOnesInstant) {
  constexpr int kFrames = 90;
  const Fields video(kFrames);
  auto whole = openVideoFile(video.path(), 1).take();
  int n = 0;
  for (auto picture = whole->next(); picture.ok() && picture.value(); picture = whole->next(), ++n) {
    if (n == 0 || n >= 48) continue;  // the first has no predecessor; at field 100 light falls
    const double expected = (Fields::lumaAt(2 * n) - 16) * 255.0 / 219;
    for (int y = 2; y < 14; ++y) EXPECT_NEAR(*picture.value()->at(7, y), expected, 1.5) << n << ", row " << y;
  }
  EXPECT_EQ(n, kFrames);
  EXPECT_EQ(whole->conversions(), std::vector<std::string>{"interlaced: the first field of each picture"});
}

TEST(VideoMarks, PicturesOfFieldsAreSkippedToTheSamePicture) {
  const Fields video(90);
  auto whole = openVideoFile(video.path(), 1).take(), skipping = openVideoFile(video.path(), 1).take();
  Image expected;
  for (int i = 0; i <= 75; ++i) expected = *whole->next().value();
  ASSERT_TRUE(skipping->skip(75).ok());
  EXPECT_EQ(skipping->next().value()->pixels, expected.pixels);
}

}  // namespace
}  // namespace fourdvt::platform
