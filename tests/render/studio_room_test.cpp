// SPDX-License-Identifier: Apache-2.0
// Captures in the studio's furnished room: reproducible, without mattes of their own; compares the mattes that the
// reader makes from the plates with the true ones, with the actor's hard shadow and 2 % sensor noise. Writes pictures
// into room_mattes/ of the current folder: picture, plate, matte, and the differences between matte and truth (red: too
// much, cyan: too little).
#include "capture/capture.h"
#include "capture/pictures.h"
#include "lab/measure/matte_score.h"
#include "mattes/frame_reader.h"
#include "platform/ffmpeg_video.h"
#include "studio_fixture.h"

namespace fourdvt::studio {
namespace {

constexpr double kTwoPercent = 0.02 * 255;

class StudioRoomTest : public StudioTest {
 protected:
  // Two frames of four cameras. The key's constants were chosen on other rooms (seeds 7, 11 and 21).
  StudioOptions room(int plates) const {
    StudioOptions o;
    o.folder = folder_ + "/capture";
    o.sequences = {"run"};
    o.cameras = 4;
    o.fps = 3;
    o.test_every = 100;
    o.truth_at.clear();
    o.images = true;
    o.room = true;
    o.plates = plates;
    o.knobs.noise_levels = kTwoPercent;
    return o;
  }
  void make(const StudioOptions& options) {
    auto made = runStudio(options, {device.get(), {}, nullptr});
    ASSERT_TRUE(made) << made.error().message;
  }
  void expectTrueMattes(const StudioOptions& options, const std::string& sheets);
};

Image row(const Image& picture, const Image& plate, const Image& truth) {
  Image out(4 * plate.width, plate.height, 3);
  for (int y = 0; y < plate.height; ++y)
    for (int x = 0; x < plate.width; ++x) {
      const uint8_t alpha = picture.at(x, y)[3], real = *truth.at(x, y);
      std::copy_n(picture.at(x, y), 3, out.at(x, y));
      std::copy_n(plate.at(x, y), 3, out.at(x + plate.width, y));
      std::fill_n(out.at(x + 2 * plate.width, y), 3, alpha);
      const uint8_t difference[3] = {alpha, real, real};
      std::copy_n(difference, 3, out.at(x + 3 * plate.width, y));
    }
  return out;
}

void StudioRoomTest::expectTrueMattes(const StudioOptions& options, const std::string& sheets) {
  make(options);
  auto capture = mattes::openCapture(options.folder, platform::openVideoFile);
  ASSERT_TRUE(capture) << capture.error().message;
  const auto& sequence = capture.value().sequences[0];
  auto reader = mattes::FrameReader::open(capture.value(), sequence, platform::openVideoFile);
  ASSERT_TRUE(reader) << reader.error().message;
  const size_t cameras = capture.value().cameras.size();
  fs::create_directories("room_mattes");
  auto frame = reader.value()->next();
  ASSERT_TRUE(frame) << frame.error().message;
  for (size_t c = 0; c < cameras; ++c) {
    const std::string& name = capture.value().cameras[c].pinhole.name;
    const std::string matte = "/mattes_true/run/" + capture::matteStem(name) + "/000000.png";
    const Image truth = capture::readPicture(options.folder + matte, 1).take();
    const Image& picture = frame.value().pictures[c];
    const std::string plate = options.folder + "/background/" + name;
    const Image first = capture::readPicture(options.plates > 1 ? plate + "/000000.png" : plate + ".png", 3).take();
    EXPECT_TRUE(platform::writeImage("room_mattes/" + sheets + "_" + name + ".png", row(picture, first, truth)));
  }
  const auto scores =
      measure::scoreMattes(capture.value(), options.folder + "/mattes_true", platform::openVideoFile).take();
  ASSERT_EQ(scores.size(), cameras);
  for (const measure::MatteScore& score : scores) EXPECT_GE(score.agreement.iou(), 0.97) << score.camera;
  std::printf("%s, %d plates\n%s", sheets.c_str(), options.plates, measure::matteTable(scores).c_str());
}

TEST_F(StudioRoomTest, MattesFromOnePlateAreTheTrueOnes) { expectTrueMattes(room(1), "one_plate"); }

TEST_F(StudioRoomTest, MattesFromSeveralPlatesAreTheTrueOnes) { expectTrueMattes(room(5), "five_plates"); }

TEST_F(StudioRoomTest, MattesOfVideosAreTheTrueOnes) {
  StudioOptions o = room(1);
  make(o);
  o.folder = folder_ + "/videos";
  o.images = false;
  make(o);
  const auto first = [&](const std::string& folder) {
    auto capture = mattes::openCapture(folder, platform::openVideoFile);
    EXPECT_TRUE(capture) << capture.error().message;
    auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile);
    return reader.value()->next().take();
  };
  const mattes::CaptureFrame images = first(folder_ + "/capture"), videos = first(o.folder);
  for (size_t c = 0; c < images.pictures.size(); ++c) {
    Image matte(images.pictures[c].width, images.pictures[c].height, 1);
    for (size_t i = 0; i < matte.pixels.size(); ++i) matte.pixels[i] = images.pictures[c].pixels[4 * i + 3];
    measure::MatteAgreement agreement;
    agreement.add(videos.pictures[c], matte);
    EXPECT_GE(agreement.iou(), 0.97) << c;
  }
}

std::string bytesOf(const std::string& path) {
  std::stringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

TEST_F(StudioRoomTest, IsReproducibleAndHasNoMattesOfItsOwn) {
  StudioOptions o = room(2);
  o.width = 96;
  o.height = 128;
  o.cameras = 2;
  make(o);
  std::vector<std::string> files;
  for (const char* name :
       {"/capture.json", "/background/cam00/000000.png", "/background/cam00/000001.png", "/background/cam01/000001.png",
        "/run/cam01/000001.png", "/mattes_true/run/mask01/000001.png"}) {
    files.push_back(bytesOf(o.folder + name));
    EXPECT_FALSE(files.back().empty()) << name;
  }
  EXPECT_NE(files[1], files[2]);
  EXPECT_FALSE(fs::exists(o.folder + "/run/mask00"));
  EXPECT_EQ(files[0].find("\"mask\""), std::string::npos);
  EXPECT_NE(files[0].find("background/camNN/%06d.png"), std::string::npos);
  make(o);
  EXPECT_EQ(files[0], bytesOf(o.folder + "/capture.json"));
  EXPECT_EQ(files[2], bytesOf(o.folder + "/background/cam00/000001.png"));
  EXPECT_EQ(files[4], bytesOf(o.folder + "/run/cam01/000001.png"));
}

}  // namespace
}  // namespace fourdvt::studio
