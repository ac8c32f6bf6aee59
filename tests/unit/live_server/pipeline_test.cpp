// SPDX-License-Identifier: Apache-2.0
#include "live/server/pipeline.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "live/server/tiles.h"
#include "live_fixture.h"
#include "mattes/frame_reader.h"
#include "package/barcode.h"
#include "package/live_stream.h"
#include "package/surface_chunk.h"
#include "platform/ffmpeg_video.h"
#include "reconstruct/mesh_checks.h"

namespace fourdvt::live {
namespace {

constexpr int kFrames = 15;
constexpr auto kLongest = std::chrono::seconds(60);

int64_t timeNow_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

struct Made {
  std::vector<uint8_t> bytes;
  bool key;
};

// A pipeline with its outputs.
class Stage {
 public:
  explicit Stage(PipelineOptions options, Rig stage_rig = ballRig()) : rig(std::move(stage_rig)) {
    options.wait_s = 5;  // avoids incomplete instants on a slow machine
    options.lost_s = 100;
    PipelineEvents events;
    events.on_frame = [this](std::shared_ptr<const std::vector<uint8_t>> frame, bool key) {
      const std::lock_guard lock(mutex);
      frames.push_back({*frame, key});
      came.notify_all();
    };
    events.on_settings = [this](size_t camera, const CameraSettings& settings) {
      const std::lock_guard lock(mutex);
      told[camera] = settings;
    };
    events.on_warning = [this](const std::string& line) {
      const std::lock_guard lock(mutex);
      warnings.push_back(line);
    };
    auto started = Pipeline::start(rig, options, events);
    if (!started.ok()) {
      ADD_FAILURE() << started.error().message;
      return;
    }
    pipeline = started.take();
    for (size_t c = 0; c < rig.cameras.size(); ++c) {
      pipeline->setConnected(c, true);
      const int64_t now = timeNow_us();
      pipeline->onClock(c, {now - 1000, now - 500 + offset_us(c)}, now);
      pictures.push_back(ballPicture(rig.cameras[c].camera.pinhole));
    }
    began_us = timeNow_us();
  }

  static int64_t offset_us(size_t camera) { return int64_t(camera) * 3'000'000 - 7'000'000; }

  // Sends all cameras' pictures of the next instant.
  void send() {
    const int64_t time_us = began_us + std::llround(1e6 / rig.fps * double(++sent));
    std::this_thread::sleep_until(std::chrono::system_clock::time_point(std::chrono::microseconds(time_us)));
    for (size_t c = 0; c < pictures.size(); ++c) {
      CameraPicture picture = pictures[c];
      picture.captured_us = time_us + offset_us(c);
      pipeline->onPicture(c, std::move(picture), 5000, timeNow_us());
    }
  }

  bool await(size_t count) {
    std::unique_lock lock(mutex);
    return came.wait_for(lock, kLongest, [&] { return frames.size() >= count; });
  }

  void run(int count) {
    for (int f = 0; f < count; ++f) {
      const size_t before = frames.size();
      send();
      ASSERT_TRUE(await(before + 1)) << "frame " << f;
    }
  }

  Rig rig;
  std::vector<CameraPicture> pictures;
  std::mutex mutex;
  std::condition_variable came;
  std::vector<Made> frames;
  std::map<size_t, CameraSettings> told;
  std::vector<std::string> warnings;
  int64_t began_us = 0;
  int sent = 0;
  std::unique_ptr<Pipeline> pipeline;  // last member: its threads end first
};

nlohmann::json extensionOf(const std::string& manifest) {
  return nlohmann::json::parse(manifest)["extensions"][package::kExtensionName];
}

package::Rect rectOf(const nlohmann::json& j) { return {j[0], j[1], j[2], j[3]}; }

TEST(LivePipeline, MakesFramesThatAReaderTakes) {
  PipelineOptions options;
  options.max_gop = 5;
  Stage stage(options);
  ASSERT_TRUE(stage.pipeline);
  stage.run(kFrames);
  const auto extension = extensionOf(stage.pipeline->manifest());
  EXPECT_EQ(extension["version"], 4);
  const auto live = extension["live"];
  package::Character character;
  character.appearance = package::AppearanceKind::Cameras;
  for (const RigCamera& camera : stage.rig.cameras) character.cameras.push_back(camera.camera.pinhole);
  package::Sequence sequence;
  sequence.layout_width = live["layout"][0], sequence.layout_height = live["layout"][1];
  package::BarcodeStrip barcode;
  barcode.rect = rectOf(live["barcode"]["rect"]), barcode.cell_size = live["barcode"]["cellSize"];
  package::StreamIndex index;
  index.frame_count = 1, index.vertex_count = extension["vertexCount"], index.face_count = extension["faceCount"];
  index.position_origin = {live["origin"][0], live["origin"][1], live["origin"][2]};
  index.position_step_m = live["step"];
  index.chunks = {{0, 1, 0, 0, 0}};

  std::vector<uint32_t> numbers, shown;
  auto decoder = platform::SampleDecoder::create(live["codec"], {}, [&](const I420View& picture, int64_t) {
    EXPECT_EQ(picture.width, live["width"]);
    EXPECT_EQ(picture.height, live["height"]);
    shown.push_back(package::readBarcode(barcode, picture).value_or(99999));
  });
  ASSERT_TRUE(decoder.ok()) << decoder.error().message;
  uint32_t last = 0;
  int64_t last_us = 0;
  for (size_t f = 0; f < stage.frames.size(); ++f) {
    const auto frame = package::readLiveFrame(stage.frames[f].bytes);
    ASSERT_TRUE(frame.ok());
    EXPECT_GT(frame.value().number, last);
    EXPECT_GT(frame.value().captured_us, last_us);
    last = frame.value().number, last_us = frame.value().captured_us;
    numbers.push_back(last % 4096);
    EXPECT_EQ(frame.value().key, stage.frames[f].key);
    EXPECT_EQ(frame.value().key, f % 5 == 0) << f;
    index.chunks[0].bytes = uint32_t(frame.value().chunk.size());
    const auto chunk = package::SurfaceChunk::open(frame.value().chunk, index, 0, character, sequence);
    ASSERT_TRUE(chunk.ok()) << chunk.error().message;
    ASSERT_TRUE(chunk.value()->decodeTo(0).ok());
    const package::Surface surface = chunk.value()->surface(0);
    const TriangleMesh mesh{{surface.positions.begin(), surface.positions.end()},
                            {surface.faces.begin(), surface.faces.end()}};
    const double ball_m3 = 4.0 / 3 * 3.14159265 * std::pow(kBall_m, 3);
    EXPECT_NEAR(reconstruct::checkMesh(mesh, 1e-3).volume_m3, 1.08 * ball_m3, 0.1 * ball_m3) << "hulls are larger";
    for (const package::CameraTile& tile : chunk.value()->tiles()) EXPECT_FALSE(tile.empty());
    ASSERT_TRUE(decoder.value()->decode(frame.value().sample, int64_t(f) * 40000, frame.value().key).ok());
  }
  ASSERT_TRUE(decoder.value()->flush().ok());
  EXPECT_EQ(shown, numbers);
  const PipelineStatus status = stage.pipeline->status();
  EXPECT_EQ(status.frames, uint64_t(kFrames));
  EXPECT_EQ(status.incomplete, 0u);
  EXPECT_EQ(status.failed, 0u);
  ASSERT_EQ(status.cameras.size(), 6u);
  for (size_t c = 0; c < 6; ++c) {
    EXPECT_NEAR(status.cameras[c].clock_offset_ms, double(Stage::offset_us(c)) / 1e3, 1);
    EXPECT_EQ(status.cameras[c].pictures, uint64_t(kFrames));
  }
  EXPECT_TRUE(stage.warnings.empty()) << stage.warnings[0];
}

TEST(LivePipeline, ViewersWhoJoinGetAKey) {
  Stage stage({});
  ASSERT_TRUE(stage.pipeline);
  stage.run(4);
  stage.pipeline->wantKey();
  stage.run(2);
  std::vector<bool> keys;
  for (const Made& made : stage.frames) keys.push_back(made.key);
  EXPECT_EQ(keys, (std::vector<bool>{true, false, false, false, true, false}));
}

TEST(LivePipeline, TellsCamerasWhereToLookAndHowFinely) {
  Stage stage({});
  ASSERT_TRUE(stage.pipeline);
  EXPECT_EQ(stage.pipeline->settings(0).region.width, 0);
  stage.pipeline->setTolerance(4);
  stage.run(3);
  const std::lock_guard lock(stage.mutex);
  ASSERT_EQ(stage.told.size(), 6u);
  for (size_t c = 0; c < 6; ++c) {
    const CameraSettings& told = stage.told[c];
    EXPECT_EQ(told.tolerance_px, 4);
    const Rig& rig = stage.rig;
    const package::Rect ball = projectedBox(rig.cameras[c].camera.pinhole, {{0, 0.5f, 0}, {0, -0.5f, 0}});
    EXPECT_EQ(common(told.region, ball).height, ball.height);
    EXPECT_LT(told.region.width, 320);
    EXPECT_EQ(stage.pipeline->settings(c).region.width, told.region.width);
  }
}

TEST(LivePipeline, AnEmptyStageIsAFrameWithNothingToSee) {
  Stage stage({});
  ASSERT_TRUE(stage.pipeline);
  stage.run(2);
  for (CameraPicture& picture : stage.pictures) picture.rings = {{{0, 0}, {0, 3840}, {5120, 3840}, {5120, 0}}};
  stage.run(3);
  EXPECT_EQ(stage.pipeline->status().failed, 3u);
  EXPECT_LT(package::readLiveFrame(stage.frames[4].bytes).value().chunk.size(), 400u);
}

TEST(LivePipeline, GoesOnWithoutACameraAndWithoutItsPicture) {
  Stage stage({});
  ASSERT_TRUE(stage.pipeline);
  stage.run(2);
  stage.pipeline->setConnected(5, false);
  stage.pictures.pop_back();
  stage.pictures[1].jpeg.assign(50, 9);           // damaged
  stage.pictures[2].crop = {300, 200, 320, 240};  // outside of the camera's picture
  stage.run(2);
  EXPECT_EQ(stage.pipeline->status().incomplete, 0u);
  EXPECT_FALSE(stage.pipeline->status().cameras[5].connected);
  ASSERT_FALSE(stage.warnings.empty());
  EXPECT_NE(stage.warnings[0].find("cam01"), std::string::npos);
}

TEST(LivePipeline, PicturesBeforeTheClockIsKnownAreNotUsed) {
  Stage stage({});
  ASSERT_TRUE(stage.pipeline);
  stage.pipeline->setConnected(0, false);
  stage.pipeline->setConnected(0, true);  // resets its clock offset
  stage.send();
  EXPECT_EQ(stage.pipeline->lastPicture(0).rings, stage.pictures[0].rings);
  const int64_t now = timeNow_us();
  stage.pipeline->onClock(0, {now, now + Stage::offset_us(0)}, now);
  stage.run(1);
  EXPECT_EQ(stage.pipeline->status().incomplete, 0u);
}

TEST(LivePipeline, RefusesWhatCannotWork) {
  const auto refused = [](Rig rig, PipelineOptions options) {
    auto started = Pipeline::start(rig, options, {});
    return !started.ok() && started.error().id == ErrorId::InvalidArgument;
  };
  Rig one = ballRig();
  one.cameras.resize(1);
  EXPECT_TRUE(refused(one, {}));
  Rig inside = ballRig();
  inside.bounds = {glm::vec3(-4), glm::vec3(4)};
  EXPECT_TRUE(refused(inside, {}));
  PipelineOptions options;
  options.picture_share = 0;
  EXPECT_TRUE(refused(ballRig(), options));
  options = {};
  options.min_tolerance_px = 20;
  EXPECT_TRUE(refused(ballRig(), options));
}

// --- recording ---

class Folder {
 public:
  Folder() : path((std::filesystem::temp_directory_path() / "fourdvt_live_record").string()) {
    std::filesystem::remove_all(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  const std::string path;
};

TEST(LivePipeline, RecordsTakesThatACaptureReaderOpens) {
  const Folder folder;
  PipelineOptions options;
  options.record_folder = folder.path;
  Stage stage(options);
  ASSERT_TRUE(stage.pipeline);
  stage.run(8);  // a take
  stage.pipeline->setConnected(5, false);
  const CameraPicture last = stage.pictures.back();
  stage.pictures.pop_back();
  stage.run(2);
  stage.pictures.push_back(last);
  stage.pipeline->setConnected(5, true);
  const int64_t now = timeNow_us();
  stage.pipeline->onClock(5, {now, now + Stage::offset_us(5)}, now);
  stage.run(6);  // another
  ++stage.sent;  // an instant that nobody took
  stage.run(3);  // too short
  const std::vector<PinholeCamera> cameras = [&] {
    std::vector<PinholeCamera> out;
    for (const auto& camera : stage.rig.cameras) out.push_back(camera.camera.pinhole);
    return out;
  }();
  stage.pipeline.reset();
  EXPECT_TRUE(stage.warnings.empty()) << stage.warnings[0];
  const auto capture = mattes::openCapture(folder.path, platform::openVideoFile, {}, capture::MeshNeed::Nothing);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().fps, 25);
  EXPECT_EQ(capture.value().ground_y_m, -0.5);
  ASSERT_EQ(capture.value().cameras.size(), 6u);
  EXPECT_NEAR(capture.value().cameras[3].pinhole.centreInWorld().x, cameras[3].centreInWorld().x, 1e-6);
  ASSERT_EQ(capture.value().sequences.size(), 2u);
  EXPECT_EQ(capture.value().sequences[0].frame_count, 8u);
  EXPECT_EQ(capture.value().sequences[1].frame_count, 6u);
  auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[1], platform::openVideoFile);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  for (int f = 0; f < 6; ++f) {
    const auto frame = reader.value()->next();
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    for (size_t c = 0; c < 6; ++c) {
      const Image& picture = frame.value().pictures[c];
      const Image truth = reconstruct::coverageOf(cameras[c], reconstruct::ballShape(glm::dvec3(0), kBall_m));
      double off = 0;
      for (size_t i = 0; i < truth.pixels.size(); ++i) off += std::abs(picture.pixels[4 * i + 3] - truth.pixels[i]);
      EXPECT_LT(off / double(truth.pixels.size()), 2) << c;
      const glm::dvec3 middle = cameras[c].project(glm::dvec3(0));
      const uint8_t* ball = picture.at(int(middle.x), int(middle.y));
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(ball[k], kBallColour[k], 5) << c;
    }
  }
}

TEST(LivePipeline, DoesNotRecordIntoAFolderThatHoldsSomething) {
  const Folder folder;
  std::filesystem::create_directories(folder.path + "/cameras");
  PipelineOptions options;
  options.record_folder = folder.path;
  const auto started = Pipeline::start(ballRig(), options, {});
  ASSERT_FALSE(started.ok());
  EXPECT_EQ(started.error().id, ErrorId::WriteFailed);
  EXPECT_NE(started.error().message.find("empty folder"), std::string::npos);
}

}  // namespace
}  // namespace fourdvt::live
