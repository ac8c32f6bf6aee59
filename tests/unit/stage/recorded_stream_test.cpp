// SPDX-License-Identifier: Apache-2.0
// Reads the numbers on a counted stage's pictures after keying, hulls, packing and coding.
#include "lab/stage/recorded_stream.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>

#include "capture_fixture.h"
#include "lab/stage/stage.h"
#include "live/camera/camera_worker.h"
#include "live/camera/source.h"
#include "live/rig/rig.h"
#include "live/server/pipeline.h"
#include "mattes/frame_reader.h"

namespace fourdvt::stage {
namespace {

using capture::expectError;
using capture::kSample;
using capture::TempFolder;

constexpr int kPictures = 60;
constexpr double kFps = 4;  // slow enough for any machine
constexpr size_t kFrames = 8;
const std::vector<std::string> kCameras = {"cam00", "cam01", "cam02", "cam04", "cam05", "cam07"};

// Records a stage's messages, as a viewer receives them.
class Recording {
 public:
  Recording(const live::Rig& rig, const std::string& folder) {
    live::PipelineOptions options;
    options.wait_s = 2;
    options.lost_s = 100;
    live::PipelineEvents events;
    events.on_frame = [this](std::shared_ptr<const std::vector<uint8_t>> frame, bool) {
      const std::lock_guard lock(mutex_);
      for (int i = 0; i < 4; ++i) bytes_.push_back(uint8_t(frame->size() >> (8 * i)));
      bytes_.insert(bytes_.end(), frame->begin(), frame->end());
      ++count_;
      came_.notify_all();
    };
    pipeline_ = live::Pipeline::start(rig, options, events).take();
    for (size_t c = 0; c < rig.cameras.size(); ++c) {
      const int64_t now_us = live::systemNow_us();
      pipeline_->setConnected(c, true);
      pipeline_->onClock(c, {now_us, now_us}, now_us);
      auto worker = live::CameraWorker::start(
          rig, rig.cameras[c].camera.pinhole.name,
          [this, c](live::CameraPicture picture) {
            pipeline_->onPicture(c, std::move(picture), 1000, live::systemNow_us());
          },
          [](const Error& error) { ADD_FAILURE() << error.message; });
      EXPECT_TRUE(worker.ok()) << worker.error().message;
      if (worker.ok()) workers_.push_back(worker.take());
    }
    {
      std::unique_lock lock(mutex_);
      EXPECT_TRUE(came_.wait_for(lock, std::chrono::seconds(60), [this] { return count_ >= kFrames; }));
    }
    workers_.clear();
    const std::string manifest = pipeline_->manifest();
    pipeline_.reset();
    EXPECT_TRUE(platform::writeFileAtomic(folder + "/manifest.json", manifest).ok());
    EXPECT_TRUE(platform::writeFileAtomic(folder + "/frames.bin", bytes_).ok());
  }

  std::vector<uint8_t> takeBytes() { return std::move(bytes_); }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<uint8_t> bytes_;
  size_t count_ = 0;
  std::unique_ptr<live::Pipeline> pipeline_;
  std::vector<std::unique_ptr<live::CameraWorker>> workers_;
};

TEST(RecordedStream, TellsWhichPicturesItShows) {
  const TempFolder folder;  // stage and recording
  const auto capture = mattes::openCapture(kSample, platform::openVideoFile, {"run"}, capture::MeshNeed::Nothing);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const Status written =
      writeStage(capture.value(), {folder.path(), 320, 240, "run", kCameras, true, kPictures}, platform::openVideoFile);
  ASSERT_TRUE(written.ok()) << written.error().message;
  auto rig = live::readRig(folder / "RIG.json");
  ASSERT_TRUE(rig.ok()) << rig.error().message;
  rig.value().fps = kFps;
  std::vector<uint8_t> bytes = Recording(rig.value(), folder.path()).takeBytes();

  const auto stream = readRecordedStream(folder.path(), folder.path());
  ASSERT_TRUE(stream.ok()) << stream.error().message;
  EXPECT_EQ(stream.value().cameras, kCameras);
  ASSERT_GE(stream.value().frames.size(), kFrames);
  size_t shown = 0, read = 0, surfaces = 0;
  for (const RecordedFrame& frame : stream.value().frames) {
    const auto slot = std::llround(double(frame.captured_us) * kFps / 1e6);
    EXPECT_EQ(frame.barcode, frame.number % 4096);
    EXPECT_GT(frame.triangles, 100u);
    EXPECT_LT(frame.surface_bytes + frame.picture_bytes, frame.bytes);
    for (const auto& camera : frame.cameras) {
      shown += camera.shown, read += camera.counter.has_value();
      EXPECT_EQ(camera.counter.value_or(slot % kPictures), uint32_t(slot % kPictures)) << "frame " << frame.number;
    }
  }
  EXPECT_GE(shown, 5 * kFrames);
  EXPECT_GE(double(read), 0.6 * double(shown));  // some frames hardly have room for the cells
  ASSERT_EQ(stream.value().surfaces.size(), 19u);
  for (const TriangleMesh& surface : stream.value().surfaces) surfaces += !surface.faces.empty();
  EXPECT_GE(surfaces, kFrames / 2);

  bytes.pop_back();
  ASSERT_TRUE(platform::writeFileAtomic(folder / "frames.bin", bytes).ok());
  expectError(readRecordedStream(folder.path(), folder.path()), ErrorId::StreamInvalid, "frames.bin");
  expectError(readRecordedStream(folder.path(), folder / "none"), ErrorId::FileMissing, "counter.json");
  ASSERT_TRUE(platform::writeFileAtomic(folder / "counter.json", std::string("{\"cell_px\": 4}")).ok());
  expectError(readRecordedStream(folder.path(), folder.path()), ErrorId::ManifestInvalid, "counter.json");
}

}  // namespace
}  // namespace fourdvt::stage
