// SPDX-License-Identifier: Apache-2.0
// Contents of a container listed without decoding: displayed pictures only; headers may count others.
#include <unistd.h>

#include <fstream>

#include "clip_files.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::platform {
namespace {

struct VideoList : testing::Test {
  const std::string folder =
      (std::filesystem::path(testing::TempDir()) / ("fourdvt_listing_" + std::to_string(::getpid()))).string();
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::string file(const std::string& name) const { return folder + "/" + name; }
  static VideoListing list(const std::string& path) {
    auto video = openVideoFile(path, 3);
    EXPECT_TRUE(video.ok()) << (video.ok() ? "" : video.error().message);
    if (!video.ok()) return {};
    auto listing = video.value()->list();
    EXPECT_TRUE(listing.ok());
    return listing.ok() ? listing.take() : VideoListing();
  }
  static std::vector<int> greys(const std::string& path) {
    std::vector<int> out;
    auto video = openVideoFile(path, 3);
    EXPECT_TRUE(video.value()->list().ok()) << "goes back to the first picture";
    for (auto next = video.value()->next(); next.ok() && next.value(); next = video.value()->next())
      out.push_back(next.value()->at(3, 3)[0]);
    return out;
  }
};

TEST_F(VideoList, TimesOfPicturesWithAGap) {
  for (const char* ending : {".mp4", ".mkv", ".mov"}) {
    const std::string path = file(std::string("gap") + ending);
    writeClip(path, {.pictures = 8, .time_s = [](int i) { return (i < 3 ? i : i + 2) / 25.0; }});
    const VideoListing listing = list(path);
    EXPECT_EQ(listing.pictures, 8u) << path;
    ASSERT_EQ(listing.times_s.size(), 8u) << path;
    EXPECT_NEAR(listing.times_s[2], 0.08, 0.001) << path;
    EXPECT_NEAR(listing.times_s[3], 0.20, 0.001) << path;
    EXPECT_FALSE(listing.cut_off) << path;
  }
}

// Cutting without encoding keeps earlier pictures in the file, which the decoder needs.
TEST_F(VideoList, PicturesBeforeACutAreNotCounted) {
  const std::string path = file("cut.mp4");
  writeClip(path, {.pictures = 16, .time_s = [](int i) { return (i - 6) / 25.0; }});
  const VideoListing listing = list(path);
  EXPECT_EQ(listing.pictures, 10u);
  EXPECT_EQ(listing.announced, 16u);
  EXPECT_FALSE(listing.cut_off);
  const std::vector<int> shown = greys(path);
  ASSERT_EQ(shown.size(), 10u);
  EXPECT_NEAR(shown[0], 60, 3);
  writeClip(path, {.pictures = 16, .time_s = [](int i) { return (i < 12 ? i - 6 : i - 4) / 25.0; }});
  EXPECT_EQ(list(path).pictures, 10u) << "with a gap, from the packets";
}

TEST_F(VideoList, SeeksCountNoHiddenPictures) {
  const std::string path = file("long.mp4");
  const auto grey = [](int i) { return 40 + i; };
  writeClip(path, {.pictures = 160, .time_s = [](int i) { return (i - 20) / 25.0; }, .grey = grey});
  auto video = openVideoFile(path, 3);
  ASSERT_TRUE(video.value()->skip(100).ok());
  const auto picture = video.value()->next();
  ASSERT_TRUE(picture.ok() && picture.value());
  EXPECT_NEAR(picture.value()->at(3, 3)[0], 160, 2);
  EXPECT_EQ(list(path).pictures, 140u);
}

TEST_F(VideoList, CutOffFilesEndWithTheirLastWholePicture) {
  for (const char* ending : {".mp4", ".mkv"}) {
    const std::string whole = file(std::string("whole") + ending), path = file(std::string("short") + ending);
    writePlainClip(whole, {.pictures = 40, .width = 64, .height = 48});  // its MP4 has the index first
    std::filesystem::copy_file(whole, path);
    std::filesystem::resize_file(path, std::filesystem::file_size(whole) * 3 / 4);
    const VideoListing listing = list(path);
    EXPECT_TRUE(listing.cut_off) << path;
    EXPECT_LT(listing.pictures, 40u) << path;
    EXPECT_GT(listing.pictures, 4u) << path;
    EXPECT_EQ(greys(path).size(), listing.pictures) << path;
    EXPECT_FALSE(list(whole).cut_off) << whole;
    EXPECT_EQ(list(whole).pictures, 40u) << whole;
  }
}

TEST_F(VideoList, FilesWithoutTheirIndexAreErrors) {
  const std::string path = file("moov.mp4");
  writeClip(path, {.pictures = 8});  // has the index last
  std::filesystem::resize_file(path, 600);
  const auto opened = openVideoFile(path, 3);
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message.find(path), std::string::npos);
  EXPECT_NE(opened.error().message.find("cut off"), std::string::npos) << opened.error().message;
}

// The header's number is behind "strh", 32 bytes on.
TEST_F(VideoList, AviMayCountOneTooMany) {
  const std::string path = file("many.avi");
  writeClip(path, {.pictures = 8, .channels = 1});
  std::string bytes;
  {
    std::ifstream in(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const size_t header = bytes.find("strh");
  ASSERT_NE(header, std::string::npos);
  ASSERT_EQ(bytes[header + 8 + 32], 8);
  bytes[header + 8 + 32] = 9;
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_EQ(list(path).pictures, 8u);
  EXPECT_EQ(greys(path).size(), 8u);
}

TEST_F(VideoList, TimecodesAndCreationTimes) {
  const std::string path = file("coded.mov");
  writeClip(path, {.pictures = 8, .timecode = "10:00:01:05", .created = "2024-05-01T10:00:00.000000Z"});
  const VideoListing listing = list(path);
  ASSERT_TRUE(listing.timecode_s.has_value());
  EXPECT_NEAR(*listing.timecode_s, 36001.2, 1e-9);
  EXPECT_EQ(listing.created.substr(0, 19), "2024-05-01T10:00:00");
  writeClip(file("plain.mp4"), {.pictures = 8});
  EXPECT_FALSE(list(file("plain.mp4")).timecode_s.has_value());
}

// A depth track is not read as colour, although it is larger.
TEST_F(VideoList, TheDefaultTrackIsReadAndTheOtherOneListed) {
  writePlainClip(file("colour.mp4"), {.pictures = 8, .grey = [](int) { return 50; }});
  writePlainClip(file("depth.mkv"), {.pictures = 8, .channels = 1, .grey = [](int) { return 200; }});
  for (const char* name : {"both.mkv", "both.mov", "swapped.mov"}) {
    const bool swapped = std::string(name) == "swapped.mov";  // MOV marks both as enabled
    std::vector<std::string> tracks{file("colour.mp4"), file("depth.mkv")};
    if (swapped) std::swap(tracks[0], tracks[1]);
    if (std::string(name).ends_with(".mov")) {
      writePlainClip(file("depth.mp4"), {.pictures = 8, .grey = [](int) { return 200; }});
      tracks[swapped ? 0 : 1] = file("depth.mp4");
    }
    writeTracks(file(name), tracks, {.pictures = 8});
    const VideoListing listing = list(file(name));
    ASSERT_EQ(listing.other_tracks.size(), 1u) << name;
    EXPECT_EQ(listing.pictures, 8u) << name;
    EXPECT_NEAR(greys(file(name))[0], swapped ? 200 : 50, 3) << name << ": the first one";
    EXPECT_NE(listing.other_tracks[0].find("16x12"), std::string::npos) << listing.other_tracks[0];
  }
}

}  // namespace
}  // namespace fourdvt::platform
