// SPDX-License-Identifier: Apache-2.0
// A camera whose video shows a moving disc: its messages, by the clock.
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <opencv2/imgcodecs.hpp>

#include "capture_fixture.h"
#include "live/camera/camera_worker.h"
#include "live/camera/source.h"
#include "platform/video_input.h"
#include "platform/video_writer.h"
#include "stage_fixture.h"

namespace fourdvt::live {
namespace {

using capture::TempFolder;
using namespace fourdvt::live::testing;

constexpr int kWidth = 160, kHeight = 120, kPictures = 20;
constexpr double kRadius_px = 18;
constexpr std::chrono::seconds kPatience{100};  // timeout for a busy machine

glm::dvec2 centreOf(int number) { return {30.0 + 5 * number, 60}; }

class Stage : public TempFolder {
 public:
  explicit Stage(double fps = 25, const std::string& model = "PINHOLE 160 120 150 150 80 60") {
    write("cameras/cameras.txt", "1 " + model + "\n");
    write("cameras/images.txt", std::string("1 1 0 0 0 0 0 3 1 cam00.png\n\n2 0.7 0 0.7 0 0 0 3 1 cam01.png\n\n"));
    write("background/cam00.png", wallPlate(kWidth, kHeight));
    write("background/cam01.png", wallPlate(kWidth, kHeight));
    write("RIG.json",
          "{\"fps\": " + std::to_string(fps) +
              ", \"bounds\": {\"min\": [-1,-1,-1], \"max\": [1,1,1]}, \"sources\": {\"cam00\": \"v.mp4\"}}");
    auto video = platform::VideoWriter::create(*this / "v.mp4", {kWidth, kHeight, 3, fps, 14});
    EXPECT_TRUE(video.ok());
    for (int i = 0; i < kPictures; ++i) {
      Image picture = wallPlate(kWidth, kHeight);
      paintDisc(picture, centreOf(i), kRadius_px, {170, 40, 45});
      EXPECT_TRUE(video.value()->write(picture).ok());
    }
    EXPECT_TRUE(video.value()->finish().ok());
  }
  Rig rig() const {
    auto rig = readRig(*this / "RIG.json");
    EXPECT_TRUE(rig.ok()) << rig.error().message;
    return rig.take();
  }
};

// Received messages, and an error.
struct Received {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<CameraPicture> pictures;
  std::optional<Error> error;

  auto onPicture() {
    return [this](CameraPicture picture) {
      const std::lock_guard lock(mutex);
      pictures.push_back(std::move(picture));
      changed.notify_all();
    };
  }
  auto onEnd() {
    return [this](const Error& e) {
      const std::lock_guard lock(mutex);
      error = e;
      changed.notify_all();
    };
  }
  // Returns the messages once `enough` returns true for them; none on timeout.
  std::vector<CameraPicture> wait(const std::function<bool(const std::vector<CameraPicture>&)>& enough) {
    std::unique_lock lock(mutex);
    const bool came = changed.wait_for(lock, kPatience, [&] { return error || enough(pictures); });
    EXPECT_TRUE(came && !error) << (error ? error->message : "no pictures");
    return pictures;
  }
};

// Mean point of the ring round the performer.
glm::dvec2 middleOf(const CameraPicture& picture) {
  double twice_area = 0;
  glm::dvec2 sum(0);
  for (const Ring16& ring : picture.rings) {
    const auto corner = [](const Point16& p) { return p.x == 0 && p.y == 0; };
    if (std::any_of(ring.begin(), ring.end(), corner)) continue;  // along the picture's border
    for (size_t i = 0; i < ring.size(); ++i) {
      const glm::dvec2 p(ring[i].x / 16.0, ring[i].y / 16.0),
          q(ring[(i + 1) % ring.size()].x / 16.0, ring[(i + 1) % ring.size()].y / 16.0);
      const double twice = p.x * q.y - p.y * q.x;
      twice_area += twice;
      sum += (p + q) * twice / 3.0;
    }
  }
  return sum / twice_area;
}

TEST(Slots, BeginWhereTheyAreFound) {
  for (const double fps : {25.0, 30000.0 / 1001, 24.0, 59.94, 7.0})
    for (int64_t now_us = 1790000000000000; now_us < 1790000000300000; now_us += 777) {
      const int64_t slot = slotAt(now_us, fps);
      EXPECT_LE(slotBegin_us(slot, fps), now_us);
      EXPECT_GT(slotBegin_us(slot + 1, fps), now_us);
      EXPECT_EQ(slotAt(slotBegin_us(slot, fps), fps), slot);
    }
}

TEST(VideoInput, DecodesPicturesByTheirNumber) {
  const Stage stage;
  auto input = platform::VideoInput::open({stage / "v.mp4", "", {}});
  ASSERT_TRUE(input.ok()) << input.error().message;
  EXPECT_EQ(input.value()->pictures(), uint32_t(kPictures));
  Image rgb;
  for (const int number : {0, 1, 2, 7, 19, 3, 3, 18, 0, 12}) {
    ASSERT_TRUE(input.value()->decode(uint32_t(number)).ok());
    ASSERT_TRUE(input.value()->convert(rgb).ok());
    const glm::ivec2 centre(centreOf(number));
    EXPECT_NEAR(rgb.at(centre.x, centre.y)[0], 170, 12) << number;
    const int behind = centre.x - int(kRadius_px) - 3;  // the disc's place one picture earlier
    EXPECT_NEAR(rgb.at(behind, 60)[1], wallPlate(kWidth, kHeight).at(behind, 60)[1], 16) << number;
  }
  EXPECT_FALSE(input.value()->decode(kPictures).ok());
}

TEST(VideoInput, RefusesWhatIsNoVideo) {
  const TempFolder folder;
  folder.write("text.mp4", "not a video");
  folder.write("list.m3u8", "#EXTM3U\n#EXTINF:1,\nother.ts\n");
  const auto open = [&](const std::string& url, const std::string& format) {
    return platform::VideoInput::open({url, format, {}});
  };
  capture::expectError(open(folder / "none.mp4", ""), ErrorId::FileMissing, "none.mp4");
  capture::expectError(open(folder / "text.mp4", ""), ErrorId::FileUnreadable, "text.mp4");
  capture::expectError(open(folder / "list.m3u8", ""), ErrorId::FileUnreadable, "list.m3u8");
  capture::expectError(open("/dev/video77", "no_such_format"), ErrorId::Unsupported, "no_such_format");
  capture::expectError(open("tcp://127.0.0.1:1/", ""), ErrorId::FileUnreadable, "tcp://127.0.0.1:1/");
}

TEST(CameraWorker, SendsWhatItsVideoShowsAtTheTime) {
  const Stage stage;
  Received received;
  auto worker = CameraWorker::start(stage.rig(), "cam00", received.onPicture(), received.onEnd());
  ASSERT_TRUE(worker.ok()) << worker.error().message;
  EXPECT_EQ(worker.value()->hello().camera, "cam00");
  EXPECT_EQ(worker.value()->hello().width, kWidth);
  const auto pictures = received.wait([](const auto& all) { return all.size() >= 6; });
  EXPECT_GE(worker.value()->stats().pictures, pictures.size());
  worker.value().reset();
  uint32_t last = 0;
  for (const CameraPicture& p : pictures) {
    EXPECT_GT(p.number, last);
    last = p.number;
    const int64_t slot = slotAt(p.captured_us, 25);
    EXPECT_EQ(slotBegin_us(slot, 25), p.captured_us);
    EXPECT_LE(p.captured_us, systemNow_us());
    const glm::dvec2 centre = centreOf(int(slot % kPictures)), middle = middleOf(p);
    EXPECT_LT(glm::length(middle - centre), 0.5) << middle.x << " " << centre.x;
    EXPECT_LE(p.crop.x, centre.x - kRadius_px);
    EXPECT_GE(p.crop.x + p.crop.width, centre.x + kRadius_px);
    const cv::Mat jpeg = cv::imdecode(p.jpeg, cv::IMREAD_COLOR);
    ASSERT_EQ(jpeg.size(), cv::Size(p.crop.width, p.crop.height));
    EXPECT_NEAR(jpeg.at<cv::Vec3b>(60 - p.crop.y, int(centre.x) - p.crop.x)[2], 170, 15);
    EXPECT_TRUE(readFromCamera(writeFromCamera(p)).ok());
  }
}

TEST(CameraWorker, ObeysItsSettings) {
  const Stage stage;
  Received received;
  auto worker = CameraWorker::start(stage.rig(), "cam00", received.onPicture(), received.onEnd());
  ASSERT_TRUE(worker.ok());
  worker.value()->set({6, 85, {}});
  const auto points = [](const CameraPicture& p) {
    size_t count = 0;
    for (const Ring16& ring : p.rings) count += ring.size();
    return count;
  };
  received.wait([&](const auto& all) { return !all.empty() && points(all.back()) < 14; });
  worker.value()->set({1, 85, {0, 0, 16, 16}});  // a corner that the performer never enters
  const auto pictures = received.wait([](const auto& all) { return !all.empty() && all.back().jpeg.empty(); });
  ASSERT_FALSE(pictures.empty());
  EXPECT_EQ(pictures.back().crop.width, 0);
  EXPECT_EQ(pictures.back().rings.size(), 1u);  // nothing but background
}

TEST(CameraWorker, LeavesPicturesOutWhereNoOneTakesThem) {
  const Stage stage(200);
  Received received;
  auto worker = CameraWorker::start(
      stage.rig(), "cam00",
      [&, take = received.onPicture()](CameraPicture picture) {
        take(std::move(picture));
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
      },
      received.onEnd());
  ASSERT_TRUE(worker.ok());
  received.wait([&](const auto& all) { return all.size() > 4 && worker.value()->stats().left_out > 0; });
}

TEST(CameraWorker, UndistortsAndSeesNoBackgroundBeyondTheLens) {
  const Stage stage(25, "OPENCV 160 120 150 150 80 60 0.35 0 0 0");  // the pinhole sees more than was filmed
  Received received;
  auto worker = CameraWorker::start(stage.rig(), "cam00", received.onPicture(), received.onEnd());
  ASSERT_TRUE(worker.ok()) << worker.error().message;
  const auto pictures = received.wait([](const auto& all) { return !all.empty(); });
  ASSERT_FALSE(pictures.empty());
  for (const Ring16& ring : pictures.back().rings)
    for (const Point16& p : ring) EXPECT_FALSE(p.x == 0 && p.y == 0);
}

TEST(CameraWorker, SaysWhyItDoesNotStart) {
  const Stage stage;
  const auto start = [&](const Rig& rig, const std::string& camera) {
    return CameraWorker::start(
        rig, camera, [](CameraPicture) {}, [](const Error&) {});
  };
  capture::expectError(start(stage.rig(), "cam07"), ErrorId::InvalidArgument, "cam07");
  capture::expectError(start(stage.rig(), "cam01"), ErrorId::InvalidArgument, "cam01");
  Rig rig = stage.rig();
  stage.remove("v.mp4");
  capture::expectError(start(rig, "cam00"), ErrorId::FileMissing, "v.mp4");
  auto video = platform::VideoWriter::create(stage / "v.mp4", {80, 60, 3, 25});
  ASSERT_TRUE(video.ok() && video.value()->write(Image(80, 60, 3, 99)).ok() && video.value()->finish().ok());
  capture::expectError(start(rig, "cam00"), ErrorId::FrameSize, "v.mp4");
  stage.remove("background/cam00.png");
  capture::expectError(start(rig, "cam00"), ErrorId::FileMissing, "cam00.png");
}

}  // namespace
}  // namespace fourdvt::live
