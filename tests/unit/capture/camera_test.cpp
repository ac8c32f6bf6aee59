// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "capture/undistort.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

CaptureCamera single(const std::string& model, const std::string& pose = "1 0 0 0 0 0 0") {
  auto cameras = parseColmapText("7 " + model + "\n", "1 " + pose + " 7 cam00.png\n", "test");
  EXPECT_TRUE(cameras.ok()) << (cameras.ok() ? "" : cameras.error().message);
  return cameras.ok() ? cameras.value().front() : CaptureCamera{};
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_LT(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

// Half a turn about x: the camera stands at z = 4, looks along -z, and world up is up in the picture.
TEST(CaptureCamera, QuaternionProjectsAnalytically) {
  const PinholeCamera camera = single("PINHOLE 640 480 500 510 320 240", "0 1 0 0 0 1 4").pinhole;
  expectNear(camera.centreInWorld(), {0, 1, 4});
  expectNear(camera.forwardInWorld(), {0, 0, -1});
  expectNear(camera.project({0, 1, 0}), {320, 240, 4});
  expectNear(camera.project({0.4, 1, 0}), {370, 240, 4});
  expectNear(camera.project({0, 1.4, 0}), {320, 189, 4});
}

TEST(CaptureCamera, TestCamerasAreInMetresAsTheOthers) {
  SmallCapture files;
  files.write("capture.json", SmallCapture::json("", "millimetre"));
  std::filesystem::copy(files / "cameras", files / "cameras_test");
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto cameras = readTestCameras(capture.value());
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  ASSERT_EQ(cameras.value().size(), 2u);
  expectNear(cameras.value()[0].centreInWorld(), {0, 0, -0.003});
  expectNear(cameras.value()[1].centreInWorld(), capture.value().cameras[1].pinhole.centreInWorld());
}

TEST(CaptureCamera, QuaternionIsNormalised) {
  const PinholeCamera a = single("PINHOLE 64 48 50 50 32 24", "0.6 0 0.8 0 1 2 3").pinhole;
  const PinholeCamera b = single("PINHOLE 64 48 50 50 32 24", "1.2 0 1.6 0 1 2 3").pinhole;
  expectNear(a.centreInWorld(), b.centreInWorld());
  // w = 0.6, y = 0.8: turn of 2 acos 0.6 about y.
  const double angle = 2 * std::acos(0.6);
  EXPECT_NEAR(a.cam_from_world[0][0], std::cos(angle), 1e-12);
  EXPECT_NEAR(a.cam_from_world[2][0], std::sin(angle), 1e-12);
}

TEST(CaptureCamera, ModelsMapToDistortion) {
  const CaptureCamera radial = single("SIMPLE_RADIAL 64 48 50 32 24 -0.25");
  EXPECT_EQ(radial.pinhole.fx, 50);
  EXPECT_EQ(radial.pinhole.fy, 50);
  EXPECT_EQ(radial.distortion.k1, -0.25);
  const CaptureCamera opencv = single("OPENCV 64 48 50 51 32 24 0.1 0.2 0.3 0.4");
  EXPECT_EQ(opencv.pinhole.fy, 51);
  EXPECT_EQ(opencv.distortion.k2, 0.2);
  EXPECT_EQ(opencv.distortion.p1, 0.3);
  EXPECT_EQ(opencv.distortion.p2, 0.4);
  EXPECT_FALSE(single("PINHOLE 64 48 50 51 32 24").distortion.any());
}

TEST(CaptureCamera, AByteOrderMarkMayStandBeforeTheLists) {
  const std::string mark = "\xef\xbb\xbf";
  auto cameras =
      parseColmapText(mark + "1 PINHOLE 64 48 50 50 32 24\n", mark + "# list\n1 1 0 0 0 0 0 3 1 cam00.png\n", "test");
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  EXPECT_EQ(cameras.value()[0].pinhole.name, "cam00");
}

TEST(CaptureCamera, PointLinesAndNamesAreUnderstood) {
  auto cameras = parseColmapText("1 PINHOLE 64 48 50 50 32 24\n",
                                 "# list\n1 1 0 0 0 0 0 3 1 b/000000.png\n1.5 2.5 -1 3 4 17\n2 1 0 0 0 0 0 3 1 a.jpg\n"
                                 "3 1 0 0 0 0 0 3 1 c\n",
                                 "test");
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  ASSERT_EQ(cameras.value().size(), 3u);
  EXPECT_EQ(cameras.value()[0].pinhole.name, "b");
  EXPECT_EQ(cameras.value()[1].pinhole.name, "a");
  EXPECT_EQ(cameras.value()[2].pinhole.name, "c");
  expectError(parseColmapText("1 PINHOLE 64 48 50 50 32 24\n", "1 1 0 0 0 0 0 3 1 a\n\n2 1 0 0 0 0 0 3 1 a\n", "test"),
              ErrorId::CameraPose, "test/images.txt:3");
}

double pattern(double x, double y) { return 128 + 60 * std::sin(x * 0.11) + 60 * std::cos(y * 0.13); }

// Recovers a smooth pattern of the pinhole picture from its forward distortion.
TEST(CaptureCamera, UndistortionRestoresASyntheticPattern) {
  for (const char* model :
       {"SIMPLE_RADIAL 160 120 150 83 57 -0.15", "OPENCV 160 120 150 140 83 57 -0.15 0.05 0.003 -0.004"}) {
    const CaptureCamera camera = single(model);
    const PinholeCamera& p = camera.pinhole;
    const Distortion& d = camera.distortion;
    Image captured(p.width, p.height, 3), matte(p.width, p.height, 1, 255);
    for (int j = 0; j < p.height; ++j) {
      for (int i = 0; i < p.width; ++i) {
        const double xd = (i + 0.5 - p.cx) / p.fx, yd = (j + 0.5 - p.cy) / p.fy;
        double x = xd, y = yd;  // inverse by fixed-point iteration
        for (int k = 0; k < 50; ++k) {
          const double r2 = x * x + y * y, radial = 1 + r2 * (d.k1 + r2 * d.k2);
          x = (xd - 2 * d.p1 * x * y - d.p2 * (r2 + 2 * x * x)) / radial;
          y = (yd - d.p1 * (r2 + 2 * y * y) - 2 * d.p2 * x * y) / radial;
        }
        const double value = pattern(p.cx + p.fx * x, p.cy + p.fy * y);
        for (int c = 0; c < 3; ++c) captured.at(i, j)[c] = static_cast<uint8_t>(std::lround(value));
      }
    }
    const Undistorter undistorter(camera);
    const Image restored = undistorter.apply(captured);
    double worst = 0, before = 0;
    for (int j = 10; j < p.height - 10; ++j) {
      for (int i = 10; i < p.width - 10; ++i) {
        const double expected = pattern(i + 0.5, j + 0.5);
        worst = std::max(worst, std::abs(restored.at(i, j)[1] - expected));
        before = std::max(before, std::abs(captured.at(i, j)[1] - expected));
      }
    }
    EXPECT_LT(worst, 2.5) << model;
    EXPECT_GT(before, 10.0) << model;  // the pattern is distinctive
    EXPECT_EQ(*undistorter.apply(matte).at(80, 60), 255);
  }
}

TEST(CaptureCamera, UndistortedMatteIsEmptyOutsideTheCapture) {
  const CaptureCamera camera = single("SIMPLE_RADIAL 160 120 100 80 60 0.4");  // the corners look past the picture
  const Undistorter undistorter(camera);
  const Image matte = undistorter.apply(Image(160, 120, 1, 255));
  EXPECT_EQ(*matte.at(0, 0), 0);
  EXPECT_EQ(*matte.at(80, 60), 255);
  EXPECT_EQ(undistorter.apply(Image(160, 120, 3, 77)).at(0, 0)[0], 77);
}

TEST(CaptureCamera, SampleRingLooksAtThePerformer) {
  auto cameras = readColmapCameras(kSample + "/cameras");
  ASSERT_TRUE(cameras.ok());
  ASSERT_EQ(cameras.value().size(), 8u);
  for (const CaptureCamera& camera : cameras.value()) {
    const glm::dvec3 pixel = camera.pinhole.project({0, 0.87, 0});
    EXPECT_NEAR(pixel.x, 360, 20);
    EXPECT_NEAR(pixel.y, 480, 20);
    EXPECT_GT(pixel.z, 3);
  }
  EXPECT_EQ(readColmapCameras(kSample + "/cameras_test").value().size(), 3u);
}

}  // namespace
}  // namespace fourdvt::capture
