// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "platform/ffmpeg_handles.h"
#include "platform/ffmpeg_video.h"
#include "platform/video_writer.h"

namespace fourdvt::platform {
namespace {

const std::string kSample = std::string(FOURDVT_SOURCE_DIR) + "/site/sample/actor_a";

// Uncompressed 4:2:0 video of one colour; `tags` in YUV4MPEG2's syntax.
class RawVideo {
 public:
  RawVideo(const std::string& tags, uint8_t y, uint8_t u, uint8_t v, int frames = 1, int height = 16) {
    path_ =
        (std::filesystem::path(testing::TempDir()) / ("fourdvt_raw_" + std::to_string(::getpid()) + ".y4m")).string();
    std::ofstream out(path_, std::ios::binary);
    out << "YUV4MPEG2 W32 H" << height << " F25:1 Ip A1:1 C420mpeg2" << tags << "\n";
    for (int i = 0; i < frames; ++i) {
      out << "FRAME\n"
          << std::string(size_t(32 * height), char(y)) << std::string(size_t(8 * height), char(u))
          << std::string(size_t(8 * height), char(v));
    }
  }
  ~RawVideo() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

Image first(const std::string& path, int channels) {
  auto video = openVideoFile(path, channels);
  EXPECT_TRUE(video.ok()) << (video.ok() ? "" : video.error().message);
  auto picture = video.value()->next();
  EXPECT_TRUE(picture.ok() && picture.value());
  return *picture.value();
}

double clamp255(double v) { return std::fmin(255, std::fmax(0, v)); }

// Weights of red and blue in luma, by recommendation.
struct Matrix {
  double red, blue;
};
constexpr Matrix kBt601{0.299, 0.114}, kBt709{0.2126, 0.0722};

void expectColour(const Image& image, const Matrix& m, int y, int u, int v, bool full) {
  const double luma = full ? y : (y - 16) * 255.0 / 219, scale = full ? 1 : 255.0 / 224;
  const double cb = (u - 128) * scale, cr = (v - 128) * scale, green = 1 - m.red - m.blue;
  const double red = luma + 2 * (1 - m.red) * cr, blue = luma + 2 * (1 - m.blue) * cb;
  const uint8_t* p = image.at(10, 5);
  EXPECT_NEAR(p[0], clamp255(red), 1.5);
  EXPECT_NEAR(p[1], clamp255((luma - m.red * red - m.blue * blue) / green), 1.5);
  EXPECT_NEAR(p[2], clamp255(blue), 1.5);
}

TEST(PlatformVideo, UnspecifiedColourIsLimitedAndOfItsDefinition) {
  for (auto [y, u, v] : {std::array{16, 128, 128}, {235, 128, 128}, {120, 90, 170}, {63, 102, 240}, {173, 42, 26}}) {
    expectColour(first(RawVideo("", y, u, v).path(), 3), kBt601, y, u, v, false);
    expectColour(first(RawVideo("", y, u, v, 1, 576).path(), 3), kBt601, y, u, v, false);
    expectColour(first(RawVideo("", y, u, v, 1, 578).path(), 3), kBt709, y, u, v, false);
  }
}

TEST(PlatformVideo, FullRangeIsRead) {
  expectColour(first(RawVideo(" XCOLORRANGE=FULL", 120, 90, 170).path(), 3), kBt601, 120, 90, 170, true);
  EXPECT_EQ(*first(RawVideo(" XCOLORRANGE=FULL", 120, 90, 170).path(), 1).at(3, 3), 120);
}

TEST(PlatformVideo, GrayOfLimitedLumaIsStretched) {
  EXPECT_EQ(*first(RawVideo("", 16, 128, 128).path(), 1).at(3, 3), 0);
  EXPECT_EQ(*first(RawVideo("", 235, 128, 128).path(), 1).at(3, 3), 255);
  EXPECT_EQ(*first(RawVideo("", 120, 128, 128).path(), 1).at(3, 3), 121);
}

TEST(PlatformVideo, SampleVideoHasAllItsPictures) {
  auto video = openVideoFile(kSample + "/walk/cam00.mp4", 3);
  ASSERT_TRUE(video.ok());
  EXPECT_EQ(video.value()->list().value().pictures, 28u);
  int count = 0;
  for (auto picture = video.value()->next(); picture.ok() && picture.value(); picture = video.value()->next()) {
    EXPECT_EQ(picture.value()->width, 720);
    EXPECT_EQ(picture.value()->height, 960);
    ++count;
  }
  EXPECT_EQ(count, 28);
}

TEST(PlatformVideo, SampleMatteIsCoverage) {
  auto video = openVideoFile(kSample + "/walk/mask00.mkv", 1);
  ASSERT_TRUE(video.ok());
  EXPECT_EQ(video.value()->list().value().pictures, 28u);
  const Image matte = *video.value()->next().value();
  EXPECT_EQ(matte.channels, 1);
  EXPECT_EQ(*matte.at(2, 2), 0);
  EXPECT_EQ(*matte.at(360, 420), 255);  // the chest
}

TEST(PlatformVideo, BadFilesAreErrors) {
  EXPECT_EQ(openVideoFile("/nonexistent/a.mp4", 3).error().id, ErrorId::FileMissing);
  EXPECT_EQ(openVideoFile(kSample + "/README.md", 3).error().id, ErrorId::FileUnreadable);
  EXPECT_EQ(openVideoFile(kSample + "/walk/cam00.mp4", 2).error().id, ErrorId::InvalidArgument);
}

// Text file in the temporary folder, removed with the object.
class TextFile {
 public:
  TextFile(const std::string& name, const std::string& text)
      : path_((std::filesystem::path(testing::TempDir()) / (std::to_string(::getpid()) + name)).string()) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TextFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// A playlist could read files that its author cannot, or call an address.
TEST(PlatformVideo, PlaylistsAreRefused) {
  const RawVideo other("", 120, 90, 170);
  const std::string name = std::filesystem::path(other.path()).filename().string();
  const TextFile copy("_secret.mp4", [] {
    std::ifstream in(kSample + "/walk/cam00.mp4", std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }());
  const std::string hls = "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:10\n#EXTINF:1.0,\n",
                    end = "\n#EXT-X-ENDLIST\n";
  for (const std::string& list :
       {"ffconcat version 1.0\nfile " + name + "\n", hls + copy.path() + end, hls + "http://127.0.0.1:9/x.mp4" + end}) {
    const TextFile video("_list.mp4", list);
    const auto opened = openVideoFile(video.path(), 3);
    ASSERT_FALSE(opened.ok()) << list;
    EXPECT_EQ(opened.error().id, ErrorId::FileUnreadable);
    EXPECT_NE(opened.error().message.find(video.path()), std::string::npos) << opened.error().message;
  }
}

TEST(PlatformVideo, AColonInANameIsNoProtocol) {
  const TextFile video("_take:1.y4m", "YUV4MPEG2 W2 H2 F25:1 Ip A1:1 C420mpeg2\nFRAME\n" + std::string(6, 'x'));
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(testing::TempDir());
  EXPECT_TRUE(openVideoFile(std::filesystem::path(video.path()).filename().string(), 3).ok());
  std::filesystem::current_path(here);
}

TEST(PlatformVideo, HugePicturesAreRefused) {
  const TextFile video("_huge.y4m", "YUV4MPEG2 W20000 H8000 F25:1 Ip A1:1 C420mpeg2\nFRAME\n" + std::string(4096, 'x'));
  const auto opened = openVideoFile(video.path(), 3);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().id, ErrorId::FileUnreadable);
  EXPECT_NE(opened.error().message.find("16384x8192"), std::string::npos) << opened.error().message;
}

struct Samples {
  std::vector<uint8_t> description;
  struct Sample {
    std::vector<uint8_t> bytes;
    int64_t timestamp_us;
    bool key;
  };
  std::vector<Sample> samples;
};

// Encoded samples of a file, like those that a character's sample index describes.
Samples demux(const std::string& path) {
  Samples out;
  AVFormatContext* raw = nullptr;
  EXPECT_EQ(avformat_open_input(&raw, path.c_str(), nullptr, nullptr), 0);
  AvFormat format(raw);
  const AVStream& stream = *raw->streams[0];
  out.description.assign(stream.codecpar->extradata, stream.codecpar->extradata + stream.codecpar->extradata_size);
  AvPacket packet(av_packet_alloc());
  while (av_read_frame(raw, packet.get()) == 0) {
    out.samples.push_back({{packet->data, packet->data + packet->size},
                           av_rescale_q(packet->pts, stream.time_base, {1, 1000000}),
                           (packet->flags & AV_PKT_FLAG_KEY) != 0});
    av_packet_unref(packet.get());
  }
  return out;
}

TEST(PlatformSampleDecoder, PicturesComeInOrderWithTheirTimes) {
  const Samples s = demux(kSample + "/run/cam00.mp4");
  ASSERT_EQ(s.samples.size(), 19u);
  std::vector<int64_t> times;
  std::vector<uint8_t> lumas;
  auto decoder = SampleDecoder::create("avc1.64001f", s.description, [&](const I420View& view, int64_t timestamp_us) {
    EXPECT_EQ(view.width, 720);
    EXPECT_EQ(view.height, 960);
    times.push_back(timestamp_us);
    lumas.push_back(view.y[400 * view.stride_y + 360]);
  });
  ASSERT_TRUE(decoder.ok()) << decoder.error().message;
  for (int round = 0; round < 2; ++round) {  // again after flush, from the key sample
    times.clear();
    lumas.clear();
    for (const auto& sample : s.samples) {
      ASSERT_TRUE(decoder.value()->decode(sample.bytes, sample.timestamp_us, sample.key).ok());
    }
    ASSERT_TRUE(decoder.value()->flush().ok());
    ASSERT_EQ(times.size(), 19u);
    for (size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i] - times[0], 40000.0 * i, 1) << i;
  }
  auto video = openVideoFile(kSample + "/run/cam00.mp4", 1);
  for (size_t i = 0; i < lumas.size(); ++i) {
    const Image picture = *video.value()->next().value();
    EXPECT_EQ(*picture.at(360, 400), std::lround(clamp255((lumas[i] - 16) * 255.0 / 219))) << i;
  }
}

TEST(PlatformSampleDecoder, StartsOnlyAtAKeySample) {
  const Samples s = demux(kSample + "/run/cam00.mp4");
  int pictures = 0;
  auto decoder = SampleDecoder::create("avc1.64001f", s.description, [&](const I420View&, int64_t) { ++pictures; });
  ASSERT_TRUE(decoder.ok());
  auto feed = [&](size_t i) {
    return decoder.value()->decode(s.samples[i].bytes, s.samples[i].timestamp_us, s.samples[i].key);
  };
  EXPECT_EQ(feed(1).error().id, ErrorId::VideoInvalid);
  EXPECT_TRUE(feed(0).ok());
  decoder.value()->reset();
  EXPECT_EQ(feed(1).error().id, ErrorId::VideoInvalid);
  EXPECT_TRUE(decoder.value()->flush().ok());  // nothing pending
  EXPECT_EQ(pictures, 0);
}

TEST(PlatformSampleDecoder, DamagedSamplesAreErrors) {
  const Samples s = demux(kSample + "/run/cam00.mp4");
  auto decoder = SampleDecoder::create("avc1.64001f", s.description, [](const I420View&, int64_t) {});
  ASSERT_TRUE(decoder.ok());
  auto decode = [&](std::vector<uint8_t> bytes) {
    decoder.value()->reset();
    Status status = decoder.value()->decode(bytes, 0, true);
    return status.ok() ? decoder.value()->flush() : status;
  };
  EXPECT_TRUE(decode(s.samples[0].bytes).ok());
  EXPECT_EQ(decode({}).error().id, ErrorId::VideoInvalid);
  EXPECT_EQ(decode(std::vector<uint8_t>(500, 0xff)).error().id, ErrorId::VideoInvalid);
  auto half = s.samples[0].bytes;
  half.resize(half.size() / 2);
  EXPECT_EQ(decode(half).error().id, ErrorId::VideoInvalid);
  auto scrambled = s.samples[0].bytes;
  for (size_t i = scrambled.size() / 2; i < scrambled.size(); i += 97) scrambled[i] ^= 0x5a;
  EXPECT_EQ(decode(scrambled).error().id, ErrorId::VideoInvalid);
}

TEST(PlatformSampleDecoder, PicturesLargerThanACharactersAreErrors) {
  for (const int side : {4096, 4112}) {
    const TextFile file("_side.mp4", "");
    auto writer = VideoWriter::create(file.path(), {.width = side, .height = side, .crf = 40, .preset = "ultrafast"});
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer.value()->write(Image(side, side, 3, 90)).ok() && writer.value()->finish().ok());
    const Samples s = demux(file.path());
    int pictures = 0;
    auto decoder = SampleDecoder::create("avc1.640033", s.description, [&](const I420View&, int64_t) { ++pictures; });
    ASSERT_TRUE(decoder.ok());
    Status status = decoder.value()->decode(s.samples[0].bytes, 0, true);
    if (status.ok()) status = decoder.value()->flush();
    EXPECT_EQ(status.ok(), side == 4096);
    EXPECT_EQ(pictures, side == 4096 ? 1 : 0);
  }
}

TEST(PlatformSampleDecoder, UnknownCodecAndBadDescription) {
  EXPECT_EQ(SampleDecoder::create("hvc1.1.6.L93", {}, nullptr).error().id, ErrorId::DecoderUnsupported);
  EXPECT_EQ(SampleDecoder::create("", {}, nullptr).error().id, ErrorId::DecoderUnsupported);
  EXPECT_TRUE(SampleDecoder::create("vp09.00.10.08", {}, nullptr).ok());
  EXPECT_TRUE(SampleDecoder::create("av01.0.04M.08", {}, nullptr).ok());
}

// Picture numbers are the same whether earlier pictures are decoded or skipped.
TEST(VideoFile, SkipsToThePictureThatFollows) {
  const std::string path = kSample + "/pickup/cam00.mp4";
  std::vector<Image> all;
  auto sequential = openVideoFile(path, 3);
  ASSERT_TRUE(sequential.ok());
  for (auto picture = sequential.value()->next(); picture.ok() && picture.value(); picture = sequential.value()->next())
    all.push_back(*picture.value());
  ASSERT_GT(all.size(), 20u);
  for (const uint32_t first : {0u, 3u}) {
    auto video = openVideoFile(path, 3);
    ASSERT_TRUE(video.ok());
    for (uint32_t i = 0; i < first; ++i) ASSERT_TRUE(video.value()->next().ok());
    ASSERT_TRUE(video.value()->skip(12).ok());
    const auto picture = video.value()->next();
    ASSERT_TRUE(picture.ok() && picture.value());
    EXPECT_EQ(picture.value()->pixels, all[first + 12].pixels);
  }
  auto video = openVideoFile(path, 3);
  ASSERT_TRUE(video.value()->skip(uint32_t(all.size())).ok());
  EXPECT_FALSE(video.value()->next().value().has_value()) << "at the end";
}

// Copies a video and delays all pictures from one on by three intervals, like a camera that dropped three frames.
void copyWithGap(const std::string& path, const std::string& copy, int picture) {
  AVFormatContext *in = nullptr, *out = nullptr;
  ASSERT_EQ(avformat_open_input(&in, path.c_str(), nullptr, nullptr), 0);
  ASSERT_GE(avformat_find_stream_info(in, nullptr), 0);
  ASSERT_GE(avformat_alloc_output_context2(&out, nullptr, nullptr, copy.c_str()), 0);
  const AVStream& from = *in->streams[0];
  AVStream* to = avformat_new_stream(out, nullptr);
  ASSERT_GE(avcodec_parameters_copy(to->codecpar, from.codecpar), 0);
  to->codecpar->codec_tag = 0;
  to->time_base = from.time_base;
  ASSERT_GE(avio_open(&out->pb, copy.c_str(), AVIO_FLAG_WRITE), 0);
  ASSERT_GE(avformat_write_header(out, nullptr), 0);
  const int64_t interval = av_rescale_q(1, {1, 25}, from.time_base);
  const int64_t gap_at = (from.start_time == AV_NOPTS_VALUE ? 0 : from.start_time) + picture * interval;
  AvPacket packet(av_packet_alloc());
  while (av_read_frame(in, packet.get()) >= 0) {
    for (int64_t* stamp : {&packet->pts, &packet->dts})
      if (*stamp != AV_NOPTS_VALUE && *stamp >= gap_at - interval / 2) *stamp += 3 * interval;
    av_packet_rescale_ts(packet.get(), from.time_base, to->time_base);
    packet->stream_index = 0;
    packet->pos = -1;
    ASSERT_EQ(av_interleaved_write_frame(out, packet.get()), 0);
  }
  ASSERT_EQ(av_write_trailer(out), 0);
  avio_closep(&out->pb);
  avformat_free_context(out);
  avformat_close_input(&in);
}

// 560 frames with B pictures and key pictures at 0, 250 and 500.
std::string videoOfThreeGops(const std::string& path) {
  auto writer = VideoWriter::create(path, {.width = 32, .height = 32, .preset = "medium"});
  EXPECT_TRUE(writer.ok());
  Image picture(32, 32, 3);
  for (int f = 0; f < 560; ++f) {
    for (size_t i = 0; i < picture.pixels.size(); ++i)
      picture.pixels[i] = static_cast<uint8_t>(128 + 100 * std::sin(0.05 * f + 0.01 * double(i)));
    EXPECT_TRUE(writer.value()->write(picture).ok());
  }
  EXPECT_TRUE(writer.value()->finish().ok());
  return path;
}

// Compares pictures after skips with those of the whole video at the same positions.
void expectSeeksAreExact(const std::string& path) {
  constexpr int kFrames = 560;
  std::vector<Image> all;
  auto sequential = openVideoFile(path, 3);
  for (auto next = sequential.value()->next(); next.ok() && next.value(); next = sequential.value()->next())
    all.push_back(*next.value());
  ASSERT_EQ(all.size(), size_t(kFrames)) << path;
  for (const auto& [read, wanted] : {std::pair(0, 61), {0, 255}, {1, 249}, {0, 250}, {5, 505}, {100, 520}, {0, 559}}) {
    auto video = openVideoFile(path, 3);
    for (int i = 0; i < read; ++i) ASSERT_TRUE(video.value()->next().ok());
    ASSERT_TRUE(video.value()->skip(uint32_t(wanted - read)).ok());
    for (int f = wanted; f < std::min(wanted + 3, kFrames); ++f) {
      const auto next = video.value()->next();
      ASSERT_TRUE(next.ok() && next.value()) << path << " " << f;
      EXPECT_EQ(next.value()->pixels, all[f].pixels) << path << " " << f;
    }
  }
  auto video = openVideoFile(path, 3);
  ASSERT_TRUE(video.value()->skip(kFrames + 100).ok());
  EXPECT_FALSE(video.value()->next().value().has_value()) << path << " after the end";
}

std::string ofThisTest(const std::string& name) {
  return (std::filesystem::path(testing::TempDir()) / ("fourdvt_" + std::to_string(::getpid()) + name)).string();
}

// MP4 has an index; Matroska requires reading the packets.
TEST(VideoFile, SeeksToTheSamePictures) {
  for (const char* extension : {".mp4", ".mkv"}) {
    const std::string path = videoOfThreeGops(ofThisTest(std::string("_seek") + extension));
    expectSeeksAreExact(path);
    std::filesystem::remove(path);
  }
}

// Picture numbers follow their order, whatever their time gaps.
TEST(VideoFile, SeeksOverLostPictures) {
  for (const char* extension : {".mp4", ".mkv"}) {
    const std::string whole = videoOfThreeGops(ofThisTest(std::string("_whole") + extension));
    for (const int gap_at : {57, 200, 503}) {
      const std::string path = ofThisTest(std::string("_gap") + extension);
      copyWithGap(whole, path, gap_at);
      expectSeeksAreExact(path);
      std::filesystem::remove(path);
    }
    std::filesystem::remove(whole);
  }
}

uint64_t bytesRead() {
  std::ifstream io("/proc/self/io");
  std::string name;
  uint64_t bytes = 0;
  io >> name >> bytes;  // rchar
  return bytes;
}

// With a stored list of time stamps a skip reads only what it decodes.
TEST(VideoFile, KeptStampsSpareReadingAVideoToItsEnd) {
  namespace fs = std::filesystem;
  const std::string path = ofThisTest("_kept.mkv"), folder = ofThisTest("_index");
  fs::remove_all(folder);
  fs::create_directory(folder);
  auto writer = VideoWriter::create(path, {.width = 64, .height = 64, .channels = 1});
  ASSERT_TRUE(writer.ok());
  Image noise(64, 64, 1);
  uint32_t state = 1;
  for (int f = 0; f < 500; ++f) {
    for (uint8_t& value : noise.pixels) value = uint8_t((state = state * 1664525 + 1013904223) >> 24);
    noise.pixels[0] = uint8_t(f), noise.pixels[1] = uint8_t(f >> 8);
    ASSERT_TRUE(writer.value()->write(noise).ok());
  }
  ASSERT_TRUE(writer.value()->finish().ok());
  const auto readAt = [&](const std::string& index) {
    const uint64_t before = bytesRead();
    auto video = openIndexedVideo(path, 1, index);
    EXPECT_TRUE(video.value()->skip(300).ok());
    const auto picture = video.value()->next();
    EXPECT_TRUE(picture.ok() && picture.value());
    EXPECT_EQ(picture.value()->pixels[0] + 256 * picture.value()->pixels[1], 300);
    return bytesRead() - before;
  };
  const uint64_t all = fs::file_size(path);
  EXPECT_GT(readAt(""), all);
  ASSERT_TRUE(indexVideo(path, folder).ok());
  EXPECT_LT(readAt(folder), all / 3);
  ASSERT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  const fs::path kept = fs::directory_iterator(folder)->path();
  fs::resize_file(kept, fs::file_size(kept) - 8);
  EXPECT_GT(readAt(folder), all) << "a damaged list is made again";
  EXPECT_LT(readAt(folder), all / 3);
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(5));
  EXPECT_GT(readAt(folder), all) << "of another file";
  EXPECT_GT(readAt(folder + "/none"), all) << "no folder to keep it in";
  fs::remove_all(folder);
  fs::remove(path);
}

}  // namespace
}  // namespace fourdvt::platform
