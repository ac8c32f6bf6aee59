// SPDX-License-Identifier: Apache-2.0
// The sample as a stage: its numbers survive coding, keying and the camera's messages.
#include "lab/stage/stage.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/pictures.h"
#include "capture_fixture.h"
#include "lab/stage/counter.h"
#include "lab/stage/fit.h"
#include "live/camera/keyer.h"
#include "live/camera/outline_message.h"
#include "live/rig/rig.h"
#include "mattes/frame_reader.h"
#include "platform/video_input.h"

namespace fourdvt::stage {
namespace {

using capture::expectError;
using capture::kSample;
using capture::TempFolder;

Result<capture::Capture> sample() {
  return mattes::openCapture(kSample, platform::openVideoFile, {"run"}, capture::MeshNeed::Nothing);
}

TEST(Counter, ComesBackAtEveryPlace) {
  for (const uint32_t number : {0u, 1u, 999u, 4095u, 5000u})
    for (const int cell_px : {4, 5, 12}) {
      Image rgb(120, 90, 3, 128);
      drawCounter(rgb, {21, 13}, cell_px, number);
      EXPECT_EQ(readCounter(rgb, {21, 13}, cell_px), number % 4096);
    }
  EXPECT_FALSE(readCounter(Image(20, 20, 3, 128), {10, 0}, 4));  // does not fit
}

TEST(Counter, LiesWithinTheMatteNearItsMiddle) {
  Image matte(80, 60, 1);
  for (int y = 10; y < 50; ++y)
    for (int x = 20; x < 60; ++x) *matte.at(x, y) = 255;
  const auto corner = counterPlace(matte, 4);
  ASSERT_TRUE(corner);
  EXPECT_EQ(*corner, glm::ivec2(32, 22));
  Image thin(80, 60, 1);
  for (int y = 10; y < 50; ++y)
    for (int x = 20; x < 43; ++x) *thin.at(x, y) = 255;  // a pixel too narrow
  EXPECT_FALSE(counterPlace(thin, 4));
  EXPECT_FALSE(counterPlace(Image(80, 60, 1), 4));
}

TEST(Fit, KeepsRaysWhereTheyWere) {
  PinholeCamera camera;
  camera.width = 720, camera.height = 960, camera.fx = 1700, camera.fy = 1690, camera.cx = 350, camera.cy = 490;
  const Fit fit = fitInto(720, 960, 320, 240);
  EXPECT_EQ(fit.inner_width, 180);
  EXPECT_EQ(fit.left, 70);
  const PinholeCamera small = fitted(camera, fit);
  const glm::dvec3 point(0.3, -0.2, 4), before = camera.project(point), after = small.project(point);
  EXPECT_NEAR(after.x, before.x / 4 + 70, 1e-9);
  EXPECT_NEAR(after.y, before.y / 4, 1e-9);
}

TEST(Stage, IsARigWhosePicturesAreCounted) {
  const TempFolder folder;
  const auto capture = sample();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  constexpr int kPictures = 40;
  const Status written = writeStage(
      capture.value(), {folder.path(), 320, 240, "run", {"cam01", "cam02"}, true, kPictures}, platform::openVideoFile);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const auto rig = live::readRig(folder / "RIG.json");
  ASSERT_TRUE(rig.ok()) << rig.error().message;
  ASSERT_EQ(rig.value().cameras.size(), 2u);
  EXPECT_EQ(rig.value().fps, 25);
  const auto bytes = platform::readFile(folder / "counter.json");
  ASSERT_TRUE(bytes.ok());
  const auto counter = nlohmann::json::parse(bytes.value());
  EXPECT_EQ(counter.at("pictures"), kPictures);

  for (const live::RigCamera& camera : rig.value().cameras) {
    auto plate = capture::readPlates(rig.value().asCapture(), camera.camera, "");
    ASSERT_TRUE(plate.ok());
    auto keyer = live::Keyer::create(plate.value().pictures);
    auto video = platform::VideoInput::open({camera.source->url, "", {}});
    ASSERT_TRUE(keyer.ok() && video.ok());
    ASSERT_EQ(video.value()->pictures(), uint32_t(kPictures));
    Image rgb;
    for (const int number : {0, 1, 18, 19, 20, 39}) {
      ASSERT_TRUE(video.value()->decode(uint32_t(number)).ok() && video.value()->convert(rgb).ok());
      const auto& place =
          counter.at("cameras").at(camera.camera.pinhole.name).at(number % counter.at("frames").get<int>());
      const glm::ivec2 corner(place.at(0).get<int>(), place.at(1).get<int>());
      EXPECT_EQ(readCounter(rgb, corner, 4), uint32_t(number));

      const Image& coverage = *keyer.value()->key(rgb).value();
      for (int y = corner.y; y < corner.y + 16; ++y)
        for (int x = corner.x; x < corner.x + 16; ++x) ASSERT_GE(*coverage.at(x, y), 128) << number;
      const package::Rect crop = live::cropOf(coverage, {});
      const cv::Mat read = cv::imdecode(live::jpegOf(rgb, crop, 75), cv::IMREAD_COLOR);
      Image sent(read.cols, read.rows, 3);
      std::copy_n(read.data, sent.pixels.size(), sent.pixels.data());
      EXPECT_EQ(readCounter(sent, corner - glm::ivec2(crop.x, crop.y), 4), uint32_t(number));
    }
  }
}

TEST(Stage, RefusesWhatItCannotMake) {
  const TempFolder folder;
  const auto capture = sample();
  ASSERT_TRUE(capture.ok());
  const auto write = [&](const StageOptions& options) {
    return writeStage(capture.value(), options, platform::openVideoFile);
  };
  expectError(write({folder.path(), 321, 240}), ErrorId::InvalidArgument, "--size");
  expectError(write({folder.path(), 320, 240, "jump"}), ErrorId::InvalidArgument, "jump");
  expectError(write({folder.path(), 320, 240, "run", {"cam77"}}), ErrorId::InvalidArgument, "--cameras");
  expectError(write({folder.path(), 320, 240, "run", {}, true, 5000}), ErrorId::InvalidArgument, "--pictures");
  expectError(write({"/proc/none", 320, 240}), ErrorId::WriteFailed, "/proc/none");
}

}  // namespace
}  // namespace fourdvt::stage
