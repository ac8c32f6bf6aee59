// SPDX-License-Identifier: Apache-2.0
// Alpha channels of videos: encoded here by FFmpeg's encoders, read by openVideoFile.
#include "platform/video_alpha.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "platform/ffmpeg_video.h"

namespace fourdvt::platform {
namespace {

constexpr int kSide = 64, kFrames = 3;

// Alpha of the pictures: a ramp, or constant.
uint8_t rampAt(int x, int y) { return uint8_t(y < 8 ? 0 : 4 * x); }

// Video file with an alpha channel and one grey as colour.
class AlphaFile {
 public:
  AlphaFile(const std::string& encoder, AVPixelFormat format, const std::string& ending, int constant = -1) {
    quietFfmpeg();
    path_ =
        (std::filesystem::path(testing::TempDir()) / ("fourdvt_alpha_" + std::to_string(::getpid()) + ending)).string();
    AVFormatContext* raw = nullptr;
    avformat_alloc_output_context2(&raw, nullptr, nullptr, path_.c_str());
    const AVCodec* codec = avcodec_find_encoder_by_name(encoder.c_str());
    written_ = raw && codec && write(*raw, *codec, format, constant);
    if (raw && raw->pb) avio_closep(&raw->pb);
    avformat_free_context(raw);
  }
  ~AlphaFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }
  bool written() const { return written_; }

  Image read(int channels) const {
    auto video = openVideoFile(path_, channels);
    EXPECT_TRUE(video.ok()) << (video.ok() ? "" : video.error().message);
    if (!video.ok()) return Image(kSide, kSide, channels);
    EXPECT_TRUE(video.value()->hasAlpha());
    auto picture = video.value()->next();
    EXPECT_TRUE(picture.ok() && picture.value());
    return *picture.value();
  }

 private:
  static void fill(AVFrame& frame, int constant) {
    const AVPixFmtDescriptor& format = *av_pix_fmt_desc_get(AVPixelFormat(frame.format));
    const int alpha = format.nb_components - 1, width = format.comp[alpha].depth > 8 ? 2 : 1;
    for (int c = 0; c < format.nb_components; ++c) {
      const AVComponentDescriptor& part = format.comp[c];
      const int rows = c == 1 || c == 2 ? AV_CEIL_RSHIFT(kSide, format.log2_chroma_h) : kSide;
      const int columns = c == 1 || c == 2 ? AV_CEIL_RSHIFT(kSide, format.log2_chroma_w) : kSide;
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
          uint8_t* at = frame.data[part.plane] + y * frame.linesize[part.plane] + x * part.step + part.offset;
          const int value = c != alpha ? 128 : constant >= 0 ? constant : rampAt(x, y);
          if (width == 1)
            *at = uint8_t(value);
          else
            *reinterpret_cast<uint16_t*>(at) = uint16_t(value * ((1 << part.depth) - 1) / 255);
        }
    }
  }

  bool write(AVFormatContext& file, const AVCodec& codec, AVPixelFormat format, int constant) {
    AvCodec encoder(avcodec_alloc_context3(&codec));
    encoder->width = encoder->height = kSide;
    encoder->pix_fmt = format;
    encoder->time_base = {1, 25};
    if (file.oformat->flags & AVFMT_GLOBALHEADER) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "auto-alt-ref", "0", 0);
    av_dict_set(&options, "crf", "4", 0);
    if (codec.id == AV_CODEC_ID_PRORES) av_dict_set(&options, "profile", "4444", 0);
    const bool opened = avcodec_open2(encoder.get(), &codec, &options) >= 0;
    av_dict_free(&options);
    AVStream* stream = avformat_new_stream(&file, nullptr);
    avcodec_parameters_from_context(stream->codecpar, encoder.get());
    stream->time_base = encoder->time_base;
    if (!opened || avio_open(&file.pb, path_.c_str(), AVIO_FLAG_WRITE) < 0) return false;
    if (avformat_write_header(&file, nullptr) < 0) return false;
    AvFrame frame(av_frame_alloc());
    frame->width = frame->height = kSide;
    frame->format = format;
    av_frame_get_buffer(frame.get(), 0);
    for (int i = 0; i <= kFrames; ++i) {
      if (i < kFrames) {
        av_frame_make_writable(frame.get());
        fill(*frame, constant);
        frame->pts = i;
      }
      avcodec_send_frame(encoder.get(), i < kFrames ? frame.get() : nullptr);
      AvPacket packet(av_packet_alloc());
      while (avcodec_receive_packet(encoder.get(), packet.get()) == 0) {
        packet->stream_index = 0;
        av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
        av_interleaved_write_frame(&file, packet.get());
      }
    }
    return av_write_trailer(&file) == 0;
  }

  std::string path_;
  bool written_ = false;
};

struct Kind {
  const char* encoder;
  AVPixelFormat format;
  const char* ending;
  int tolerance;
};
const Kind kKinds[] = {{"ffv1", AV_PIX_FMT_YUVA420P, ".mkv", 0},        {"png", AV_PIX_FMT_RGBA, ".mov", 0},
                       {"qtrle", AV_PIX_FMT_ARGB, ".mov", 0},           {"png", AV_PIX_FMT_YA8, ".mov", 0},
                       {"prores_ks", AV_PIX_FMT_YUVA444P10, ".mov", 2}, {"libvpx-vp9", AV_PIX_FMT_YUVA420P, ".webm", 8},
                       {"libvpx", AV_PIX_FMT_YUVA420P, ".webm", 12}};

TEST(VideoAlpha, IsReadAsTheMatte) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(std::string(kind.encoder) + kind.ending);
    const AlphaFile file(kind.encoder, kind.format, kind.ending);
    ASSERT_TRUE(file.written());
    const Image matte = file.read(1), rgba = file.read(4), rgb = file.read(3);
    ASSERT_EQ(matte.channels, 1);
    ASSERT_EQ(rgba.channels, 4);
    for (const auto& [x, y] : {std::pair{2, 30}, {30, 30}, {61, 40}, {40, 3}}) {
      EXPECT_NEAR(*matte.at(x, y), rampAt(x, y), kind.tolerance) << x << " " << y;
      EXPECT_EQ(rgba.at(x, y)[3], *matte.at(x, y));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgba.at(x, y)[c], rgb.at(x, y)[c], 2);
    }
  }
}

TEST(VideoAlpha, ThatIsOpaqueIsNoMatte) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(std::string(kind.encoder) + kind.ending);
    const AlphaFile file(kind.encoder, kind.format, kind.ending, 255);
    ASSERT_TRUE(file.written());
    const Image matte = file.read(1), rgb = file.read(3);
    EXPECT_NEAR(*matte.at(30, 30), rgb.at(30, 30)[1], 2) << "its grey";
    EXPECT_EQ(file.read(4).at(30, 30)[3], 255);
  }
}

TEST(VideoAlpha, VideosWithoutItAreOpaque) {
  const std::string path = std::string(FOURDVT_SOURCE_DIR) + "/site/sample/actor_a/walk/cam00.mp4";
  auto video = openVideoFile(path, 4);
  ASSERT_TRUE(video.ok()) << video.error().message;
  EXPECT_FALSE(video.value()->hasAlpha());
  const Image rgba = *video.value()->next().value();
  const Image rgb = *openVideoFile(path, 3).value()->next().value();
  ASSERT_EQ(rgba.channels, 4);
  for (size_t i = 0; i < rgb.pixels.size() / 3; ++i) {
    ASSERT_EQ(rgba.pixels[4 * i], rgb.pixels[3 * i]);
    ASSERT_EQ(rgba.pixels[4 * i + 3], 255);
  }
}

// hvcC: 22 bytes, the number of arrays, and arrays of NAL units with their sizes; here a parameter set and an SEI unit.
std::vector<uint8_t> hevcConfig(const std::vector<uint8_t>& messages) {
  std::vector<uint8_t> out(22, 1);
  out.insert(out.end(), {2, 0x20, 0, 1, 0, 4, 0x40, 1, 12, 1});
  out.insert(out.end(), {0x80 | 39, 0, 1, 0, uint8_t(2 + messages.size()), 39 << 1, 1});
  out.insert(out.end(), messages.begin(), messages.end());
  return out;
}

TEST(VideoAlpha, AlphaLayerOfHevcIsRecognised) {
  const auto alpha = hevcConfig({165, 2, 0x10, 0x80, 0x80});
  EXPECT_TRUE(hevcConfigHasAlpha(alpha));
  EXPECT_TRUE(hevcConfigHasAlpha(hevcConfig({5, 3, 1, 2, 3, 165, 1, 0, 0x80})));  // after another message
  EXPECT_FALSE(hevcConfigHasAlpha(hevcConfig({5, 3, 1, 165, 3, 0x80})));          // inside of one
  EXPECT_FALSE(hevcConfigHasAlpha(hevcConfig({255, 165, 1, 0, 0x80})));           // type 420
  EXPECT_FALSE(hevcConfigHasAlpha({}));
  for (size_t length = 0; length + 5 < alpha.size(); ++length)
    EXPECT_FALSE(hevcConfigHasAlpha({alpha.data(), length})) << length;
  EXPECT_TRUE(hevcConfigHasAlpha(alpha));
}

TEST(VideoAlpha, ThatDoesNotDecodeIsRefusedByName) {
  AVFormatContext* file = avformat_alloc_context();
  AVStream* stream = avformat_new_stream(file, nullptr);
  stream->codecpar->codec_id = AV_CODEC_ID_HEVC;
  const AVCodec* usual = avcodec_find_decoder(AV_CODEC_ID_HEVC);
  EXPECT_EQ(alphaKindOf(*stream), AlphaKind::None);
  EXPECT_EQ(decoderWithAlpha(*stream, usual, "a.mov").value(), usual);
  const auto config = hevcConfig({165, 2, 0x10, 0x80, 0x80});
  stream->codecpar->extradata = static_cast<uint8_t*>(av_mallocz(config.size() + AV_INPUT_BUFFER_PADDING_SIZE));
  std::copy(config.begin(), config.end(), stream->codecpar->extradata);
  stream->codecpar->extradata_size = int(config.size());
  EXPECT_EQ(alphaKindOf(*stream), AlphaKind::HevcLayer);
  const auto decoder = decoderWithAlpha(*stream, usual, "a.mov");
  ASSERT_FALSE(decoder.ok());
  EXPECT_EQ(decoder.error().id, ErrorId::FileUnreadable);
  EXPECT_NE(decoder.error().message.find("a.mov: HEVC with an alpha channel"), std::string::npos);
  avformat_free_context(file);
}

}  // namespace
}  // namespace fourdvt::platform
