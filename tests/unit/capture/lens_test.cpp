// SPDX-License-Identifier: Apache-2.0
// Lens models with more coefficients, fisheyes and skew; COLMAP's binary model. Formulas are reimplemented from the
// documentation of OpenCV and COLMAP.
#include <cmath>

#include "base/bytes.h"
#include "capture/undistort.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

CaptureCamera lens(const std::string& model) {
  auto cameras = parseColmapText("7 " + model + "\n", "1 1 0 0 0 0 0 0 7 cam00.png\n", "test");
  EXPECT_TRUE(cameras.ok()) << (cameras.ok() ? "" : cameras.error().message);
  return cameras.ok() ? cameras.value().front() : CaptureCamera{};
}

// Pixel of the ray (x, y, 1) in a pinhole with fx 500, fy 510, cx 320, cy 240.
glm::dvec2 pixelOf(double x, double y) { return {500 * x + 320, 510 * y + 240}; }

void expectPixel(const glm::dvec2& got, double u, double v) {
  EXPECT_NEAR(got.x, u, 1e-6);
  EXPECT_NEAR(got.y, v, 1e-6);
}

TEST(Lens, RationalModelIsOpenCvs) {
  const double k1 = 0.3, k2 = -0.2, p1 = 0.004, p2 = -0.003, k3 = 0.05, k4 = 0.25, k5 = -0.1, k6 = 0.02;
  const CaptureCamera camera = lens("FULL_OPENCV 640 480 500 510 320 240 0.3 -0.2 0.004 -0.003 0.05 0.25 -0.1 0.02");
  for (const auto& [x, y] : {std::pair{0.4, 0.3}, {-0.5, 0.1}, {0.0, -0.4}}) {
    const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
    const double ratio = (1 + k1 * r2 + k2 * r4 + k3 * r6) / (1 + k4 * r2 + k5 * r4 + k6 * r6);
    const double xd = x * ratio + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
    const double yd = y * ratio + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    expectPixel(filmedPixel(camera, pixelOf(x, y)), 500 * xd + 320, 510 * yd + 240);
  }
}

TEST(Lens, FisheyeIsEquidistant) {
  const CaptureCamera plain = lens("OPENCV_FISHEYE 640 480 500 510 320 240 0 0 0 0");
  EXPECT_TRUE(plain.distortion.any());
  // 45° off axis lies π/4 focal lengths off the centre.
  expectPixel(filmedPixel(plain, pixelOf(1, 0)), 320 + 500 * std::atan(1), 240);
  expectPixel(filmedPixel(plain, pixelOf(0, 0)), 320, 240);
  const CaptureCamera bent = lens("OPENCV_FISHEYE 640 480 500 510 320 240 0.1 -0.05 0.02 -0.01");
  const double t = std::atan(0.5);
  const double td =
      t * (1 + 0.1 * std::pow(t, 2) - 0.05 * std::pow(t, 4) + 0.02 * std::pow(t, 6) - 0.01 * std::pow(t, 8));
  expectPixel(filmedPixel(bent, pixelOf(0.3, 0.4)), 320 + 500 * td * 0.6, 240 + 510 * td * 0.8);
  const double r = std::atan(0.5), rd = r * (1 + 0.1 * r * r);
  expectPixel(filmedPixel(lens("SIMPLE_RADIAL_FISHEYE 640 480 500 320 240 0.1"), {320 + 250, 240}), 320 + 500 * rd,
              240);
  const double rd2 = r * (1 + 0.1 * r * r - 0.2 * r * r * r * r);
  expectPixel(filmedPixel(lens("RADIAL_FISHEYE 640 480 500 320 240 0.1 -0.2"), {320, 240 - 250}), 320, 240 - 500 * rd2);
}

// Expects the same lens after writing and reading it as COLMAP text.
void expectKept(const CaptureCamera& camera) {
  const ColmapText text = colmapText({camera}, 1);
  auto again = parseColmapText(text.cameras, text.images, "again");
  ASSERT_TRUE(again.ok()) << again.error().message;
  for (const auto& [x, y] : {std::pair{0.4, 0.3}, {-0.5, 0.1}}) {
    const glm::dvec2 expected = filmedPixel(camera, pixelOf(x, y));
    expectPixel(filmedPixel(again.value()[0], pixelOf(x, y)), expected.x, expected.y);
    const glm::dvec2 back = pinholePixel(camera, expected);
    EXPECT_NEAR(glm::length(back - pixelOf(x, y)), 0, 1e-3);
  }
}

TEST(Lens, ThinPrismFisheyeIsColmaps) {
  const double k1 = 0.1, k2 = -0.05, p1 = 0.004, p2 = -0.003, k3 = 0.02, k4 = -0.01, sx = 0.002, sy = -0.005;
  const CaptureCamera camera =
      lens("THIN_PRISM_FISHEYE 640 480 500 510 320 240 0.1 -0.05 0.004 -0.003 0.02 -0.01 0.002 -0.005");
  for (const auto& [x, y] : {std::pair{0.4, 0.3}, {-0.5, 0.1}, {0.0, -0.4}}) {
    const double r = std::sqrt(x * x + y * y), t = std::atan(r), u = t / r * x, v = t / r * y, t2 = t * t;
    const double radial = k1 * t2 + k2 * t2 * t2 + k3 * std::pow(t2, 3) + k4 * std::pow(t2, 4);
    const double xd = u + u * radial + 2 * p1 * u * v + p2 * (t2 + 2 * u * u) + sx * t2;
    const double yd = v + v * radial + 2 * p2 * u * v + p1 * (t2 + 2 * v * v) + sy * t2;
    expectPixel(filmedPixel(camera, pixelOf(x, y)), 500 * xd + 320, 510 * yd + 240);
  }
  expectKept(camera);
}

TEST(Lens, FovIsColmaps) {
  const CaptureCamera camera = lens("FOV 640 480 500 510 320 240 0.9");
  for (const auto& [x, y] : {std::pair{0.4, 0.3}, {-0.5, 0.1}, {0.0, -0.4}}) {
    const double r = std::sqrt(x * x + y * y), factor = std::atan(r * 2 * std::tan(0.45)) / (r * 0.9);
    expectPixel(filmedPixel(camera, pixelOf(x, y)), 500 * factor * x + 320, 510 * factor * y + 240);
  }
  expectPixel(filmedPixel(camera, pixelOf(0, 0)), 320, 240);
  expectKept(camera);
  EXPECT_FALSE(lens("FOV 640 480 500 510 320 240 0").distortion.any());
}

TEST(Lens, SkewShiftsRows) {
  CaptureCamera camera = lens("PINHOLE 640 480 500 510 320 240");
  camera.distortion.skew = 20;
  EXPECT_TRUE(camera.distortion.any());
  expectPixel(filmedPixel(camera, pixelOf(0.1, 0.25)), 500 * 0.1 + 20 * 0.25 + 320, 510 * 0.25 + 240);
}

double wave(double x, double y) { return 128 + 60 * std::sin(x * 0.11) + 60 * std::cos(y * 0.13); }

// Expects a wave over the pinhole's picture to be recovered through the lens, which is inverted by Newton's method on
// filmedPixel; the tests above verify that function.
void expectRestored(const CaptureCamera& camera) {
  const PinholeCamera& p = camera.pinhole;
  Image filmed(p.width, p.height, 3);
  for (int j = 0; j < p.height; ++j) {
    for (int i = 0; i < p.width; ++i) {
      const glm::dvec2 wanted(i + 0.5, j + 0.5);
      glm::dvec2 at = wanted;
      for (int k = 0; k < 30; ++k) {
        const glm::dvec2 error = filmedPixel(camera, at) - wanted;
        const glm::dvec2 dx = filmedPixel(camera, at + glm::dvec2(0.01, 0)) - filmedPixel(camera, at);
        const glm::dvec2 dy = filmedPixel(camera, at + glm::dvec2(0, 0.01)) - filmedPixel(camera, at);
        at -= glm::inverse(glm::dmat2(dx * 100.0, dy * 100.0)) * error;
      }
      for (int c = 0; c < 3; ++c) filmed.at(i, j)[c] = static_cast<uint8_t>(std::lround(wave(at.x, at.y)));
    }
  }
  const Image restored = Undistorter(camera).apply(filmed);
  double worst = 0, before = 0;
  for (int j = 20; j < p.height - 20; ++j) {
    for (int i = 20; i < p.width - 20; ++i) {
      worst = std::max(worst, std::abs(restored.at(i, j)[1] - wave(i + 0.5, j + 0.5)));
      before = std::max(before, std::abs(filmed.at(i, j)[1] - wave(i + 0.5, j + 0.5)));
    }
  }
  EXPECT_LT(worst, 3);
  EXPECT_GT(before, 10);  // the pattern is distinctive
}

TEST(Lens, PicturesComeBackFromEveryModel) {
  expectRestored(lens("FULL_OPENCV 160 120 150 140 83 57 -0.15 0.05 0.003 -0.004 0.02 0.05 -0.03 0.01"));
  expectRestored(lens("OPENCV_FISHEYE 160 120 150 140 83 57 0.05 0.01 -0.01 0.005"));
  expectRestored(lens("THIN_PRISM_FISHEYE 160 120 150 140 83 57 0.05 0.01 0.003 -0.004 -0.01 0.005 0.002 -0.003"));
  expectRestored(lens("FOV 160 120 150 140 83 57 0.8"));
  CaptureCamera skewed = lens("OPENCV 160 120 150 140 83 57 -0.05 0.05 0.003 -0.004");
  skewed.distortion.skew = 30;
  expectRestored(skewed);
}

TEST(Lens, EveryModelSurvivesColmapText) {
  for (const char* model :
       {"FULL_OPENCV 640 480 500 510 320 240 0.3 -0.2 0.004 -0.003 0.05 0.25 -0.1 0.02",
        "OPENCV_FISHEYE 640 480 500 510 320 240 0.1 -0.05 0.02 -0.01", "OPENCV_FISHEYE 640 480 500 510 320 240 0 0 0 0",
        "OPENCV 640 480 500 510 320 240 0.1 0.2 0.3 0.4"}) {
    const CaptureCamera camera = lens(model);
    const ColmapText text = colmapText({camera}, 1);
    EXPECT_NE(text.cameras.find(std::string(model).substr(0, std::string(model).find(' ')) + " 640"), std::string::npos)
        << text.cameras;
    auto again = parseColmapText(text.cameras, text.images, "again");
    ASSERT_TRUE(again.ok()) << again.error().message;
    for (const glm::dvec2 pixel : {glm::dvec2(600, 400), glm::dvec2(20, 300)}) {
      const glm::dvec2 expected = filmedPixel(camera, pixel);
      expectPixel(filmedPixel(again.value()[0], pixel), expected.x, expected.y);
    }
  }
}

TEST(Lens, UnknownModelsAreRefused) {
  expectError(parseColmapText("1 RAD_TAN_THIN_PRISM_FISHEYE 64 48 50 50 32 24 0.1\n", "1 1 0 0 0 0 0 0 1 a\n", "test"),
              ErrorId::CameraModel, "RAD_TAN_THIN_PRISM_FISHEYE");
  for (const char* fov : {"nan", "-1", "3.2"}) {
    expectError(parseColmapText(std::string("1 FOV 64 48 50 50 32 24 ") + fov + "\n", "1 1 0 0 0 0 0 0 1 a\n", "test"),
                ErrorId::CameraPose, "cameras.txt:1");
  }
  expectError(parseColmapText("1 FULL_OPENCV 64 48 50 50 32 24 0.1\n", "1 1 0 0 0 0 0 0 1 a\n", "test"),
              ErrorId::CameraPose, "needs 12 numbers");
  expectError(parseColmapText("1 FULL_OPENCV 64 48 50 50 32 24 0 0 0 0 0 nan 0 0\n", "1 1 0 0 0 0 0 0 1 a\n", "test"),
              ErrorId::CameraPose, "finite");
}

struct BinaryModel {
  ByteWriter cameras, images;
  BinaryModel() {
    cameras.u64(1);
    cameras.u32(3);
    cameras.u32(5);  // OPENCV_FISHEYE
    cameras.u64(640);
    cameras.u64(480);
    for (double v : {500.0, 510.0, 320.0, 240.0, 0.1, 0.2, 0.3, 0.4}) cameras.f64(v);
    images.u64(2);
    for (const char* name : {"left.png", "right/000000.png"}) {
      images.u32(name[0]);
      for (double v : {0.5, 0.5, 0.5, 0.5, 1.0, 2.0, 3.0}) images.f64(v);  // a third of a turn about (1, 1, 1)
      images.u32(3);
      for (const char* c = name; *c; ++c) images.u8(static_cast<uint8_t>(*c));
      images.u8(0);
      images.u64(1);
      for (double v : {7.0, 8.0}) images.f64(v);
      images.u64(9);
    }
  }
  static std::string text(const ByteWriter& bytes) { return {bytes.data().begin(), bytes.data().end()}; }
};

TEST(ColmapBinary, IsReadWhereThereIsNoText) {
  const BinaryModel model;
  TempFolder files;
  files.write("cameras.bin", BinaryModel::text(model.cameras));
  files.write("images.bin", BinaryModel::text(model.images));
  auto cameras = readColmapCameras(files.path());
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  ASSERT_EQ(cameras.value().size(), 2u);
  const CaptureCamera& right = cameras.value()[1];
  EXPECT_EQ(cameras.value()[0].pinhole.name, "left");
  EXPECT_EQ(right.pinhole.name, "right");
  EXPECT_TRUE(right.distortion.fisheye);
  EXPECT_EQ(right.distortion.k4, 0.4);
  // x → y → z → x, then the translation: (4, 5, 6) comes to (6 + 1, 4 + 2, 5 + 3).
  const glm::dvec3 pixel = right.pinhole.project({4, 5, 6});
  EXPECT_NEAR(pixel.x, 500 * 7.0 / 8 + 320, 1e-9);
  EXPECT_NEAR(pixel.y, 510 * 6.0 / 8 + 240, 1e-9);
}

TEST(ColmapBinary, DamageIsAnError) {
  const BinaryModel model;
  const std::string cameras = BinaryModel::text(model.cameras), images = BinaryModel::text(model.images);
  for (size_t kept = 0; kept < images.size(); ++kept)
    EXPECT_FALSE(parseColmapBinary(cameras, images.substr(0, kept), "test").ok()) << kept;
  for (size_t kept = 0; kept < cameras.size(); ++kept)
    EXPECT_FALSE(parseColmapBinary(cameras.substr(0, kept), images, "test").ok()) << kept;
  std::string other = cameras;
  other[12] = 11;  // RAD_TAN_THIN_PRISM_FISHEYE
  expectError(parseColmapBinary(other, images, "test"), ErrorId::CameraModel, "number 11");
  std::string many = images;
  for (size_t i = 0; i < 8; ++i) many[i] = '\xff';
  EXPECT_FALSE(parseColmapBinary(cameras, many, "test").ok());
  std::string stranger = images;
  stranger[8 + 4 + 56] = 4;
  expectError(parseColmapBinary(cameras, stranger, "test"), ErrorId::CameraPose, "cameras.bin does not list");
}

TEST(CaptureSkew, IsAppliedByName) {
  SmallCapture files;
  std::string json = SmallCapture::json();
  json.insert(json.find('{') + 1, R"("calibration": {"ring": "cameras", "skew": {"cam01": 0.5}}, )");
  files.write("capture.json", json);
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().cameras[0].distortion.skew, 0);
  EXPECT_EQ(capture.value().cameras[1].distortion.skew, 0.5);
  for (const auto& [wrong, named] :
       {std::pair{R"({"cam07": 1})", "cam07"}, {R"({"cam01": "1"})", "skew"}, {"3", "skew"}}) {
    std::string broken = SmallCapture::json();
    broken.insert(broken.find('{') + 1, std::string("\"calibration\": {\"skew\": ") + wrong + "}, ");
    files.write("capture.json", broken);
    expectError(files.open(), ErrorId::CaptureJson, named);
  }
}

}  // namespace
}  // namespace fourdvt::capture
