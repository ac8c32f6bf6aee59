// SPDX-License-Identifier: Apache-2.0
#include "live/rig/rig.h"

#include <gtest/gtest.h>

#include "capture_fixture.h"
#include "look_at.h"

namespace fourdvt::live {
namespace {

using capture::expectError;
using capture::TempFolder;

class RigFolder : public TempFolder {
 public:
  RigFolder() {
    write("cameras/cameras.txt", std::string("1 PINHOLE 16 12 20 20 8 6\n"));
    write("cameras/images.txt", std::string("1 1 0 0 0 0 0 3 1 cam00.png\n\n2 1 0 0 0 0.5 0 3 1 cam01.png\n\n"));
    for (const char* camera : {"cam00", "cam01"}) write(std::string("background/") + camera + ".png", Image(16, 12, 3));
    write("videos/cam00.mp4", std::string("a video"));
  }
  Result<Rig> read(const std::string& fields) const {
    write("RIG.json", "{\"fps\": 25" + (fields.empty() ? "" : ", " + fields) + "}");
    return readRig(*this / "RIG.json");
  }
};

const std::string kBounds = R"("bounds": {"min": [-1, 0, -2], "max": [1, 2, 2]})";

TEST(Rig, ReadsEveryField) {
  const RigFolder folder;
  const auto rig = folder.read(
      R"("name": "stage", "units": "centimetre", "ground_y": 10, "bounds": {"min": [-100, 0, -200], "max": [100, 200, 200]},
         "sources": {"cam00": "videos/cam00.mp4",
                     "cam01": {"open": "/dev/video9", "format": "v4l2", "options": {"video_size": "640x480", "framerate": 25}}})");
  ASSERT_TRUE(rig.ok()) << rig.error().message;
  const Rig& r = rig.value();
  EXPECT_EQ(r.name, "stage");
  EXPECT_EQ(r.fps, 25);
  EXPECT_NEAR(r.ground_y_m, 0.1, 1e-9);
  EXPECT_NEAR(r.bounds.min.z, -2, 1e-6);
  EXPECT_NEAR(r.bounds.max.y, 2, 1e-6);
  ASSERT_EQ(r.cameras.size(), 2u);
  EXPECT_NEAR(r.cameras[0].camera.pinhole.centreInWorld().z, -0.03, 1e-9);
  ASSERT_TRUE(r.find("cam00")->source);
  EXPECT_EQ(r.find("cam00")->source->url, folder / "videos/cam00.mp4");
  ASSERT_TRUE(r.find("cam01")->source);
  EXPECT_EQ(r.find("cam01")->source->url, "/dev/video9");
  EXPECT_EQ(r.find("cam01")->source->format, "v4l2");
  EXPECT_EQ(r.find("cam01")->source->options.at("video_size"), "640x480");
  EXPECT_EQ(r.find("cam01")->source->options.at("framerate"), "25");
  EXPECT_EQ(r.find("cam02"), nullptr);
  const capture::Capture c = r.asCapture();
  EXPECT_EQ(c.fps, 25);
  EXPECT_EQ(c.cameras.size(), 2u);
  EXPECT_EQ(c.background_folder, folder / "background");
}

TEST(Rig, FillsInWhatIsNotSaid) {
  const RigFolder folder;
  const auto rig = folder.read(kBounds + R"(, "sources": {"cam01": null})");
  ASSERT_TRUE(rig.ok()) << rig.error().message;
  EXPECT_FALSE(rig.value().cameras[0].source);
  EXPECT_FALSE(rig.value().cameras[1].source);
  EXPECT_EQ(rig.value().ground_y_m, 0);
  EXPECT_FALSE(rig.value().name.empty());
}

TEST(Rig, ReducesPicturesPlatesAndCalibration) {
  RigFolder folder;
  Image plate(16, 12, 3);
  for (int y = 0; y < plate.height; ++y)
    for (int x = 0; x < plate.width; ++x) std::fill_n(plate.at(x, y), 3, uint8_t(x % 2 ? 100 : 20));
  folder.write("background/cam01.png", plate);
  const auto read = folder.read(kBounds + R"(, "reduce": 2)");
  ASSERT_TRUE(read.ok()) << read.error().message;
  const RigCamera& camera = *read.value().find("cam01");
  EXPECT_EQ(camera.filmed.pinhole.width, 16);
  EXPECT_EQ(camera.camera.pinhole.width, 8);
  EXPECT_EQ(camera.camera.pinhole.height, 6);
  EXPECT_DOUBLE_EQ(camera.camera.pinhole.fx, 10);
  EXPECT_DOUBLE_EQ(camera.camera.pinhole.cx, 4);
  const auto plates = readRigPlates(read.value(), camera, "");
  ASSERT_TRUE(plates.ok()) << plates.error().message;
  ASSERT_EQ(plates.value()[0].width, 8);
  for (const uint8_t level : plates.value()[0].pixels) EXPECT_EQ(level, 60) << "the mean of four pixels";
  for (const char* wrong : {"0", "17", "1.5", "\"2\""})
    expectError(folder.read(kBounds + R"(, "reduce": )" + wrong), ErrorId::CaptureJson, "reduce");
  expectError(folder.read(kBounds + R"(, "reduce": 5)"), ErrorId::FrameSize, "3x2 pixels");
}

TEST(Rig, RefusesWhatItCannotUse) {
  const RigFolder folder;
  expectError(readRig(folder / "none.json"), ErrorId::FileMissing, "none.json");
  expectError(readRig(folder.path()), ErrorId::FileMissing, folder.path());
  const std::pair<const char*, const char*> wrong[] = {
      {R"("fpss": 25)", "fpss"},
      {R"("fps": 0)", "fps"},
      {R"("fps": "25")", "fps"},
      {R"("name": 3)", "name"},
      {R"("units": "inch")", "units"},
      {R"("units": 1)", "units"},
      {R"("ground_y": "low")", "ground_y"},
      {R"("cameras": 1)", "cameras"},
      {R"("background": [])", "background"},
      {R"("bounds": [1, 2])", "bounds"},
      {R"("bounds": {"min": [0, 0, 0], "max": [1, 1]})", "bounds"},
      {R"("bounds": {"min": [0, 0, 0], "max": [1, 0, 1]})", "bounds"},
      {R"("bounds": {"min": [0, 0, 0], "max": [1, 1e9, 1]})", "bounds"},
  };
  for (const auto& [fields, named] : wrong) {
    const auto rig = folder.read(fields);
    expectError(rig, ErrorId::CaptureJson, "RIG.json");
    ASSERT_FALSE(rig.ok());
    EXPECT_NE(rig.error().message.find(named), std::string::npos) << rig.error().message;
  }
  folder.write("RIG.json", "{\"fps\": ");
  expectError(readRig(folder / "RIG.json"), ErrorId::CaptureJson, "RIG.json");
}

TEST(Rig, RefusesSourcesThatItCannotUse) {
  const RigFolder folder;
  const std::pair<const char*, const char*> wrong[] = {
      {R"([])", "sources"},
      {R"({"cam07": "videos/cam00.mp4"})", "cam07"},
      {R"({"cam00": 7})", "cam00"},
      {R"({"cam00": ""})", "cam00"},
      {R"({"cam00": {"format": "v4l2"}})", "cam00"},
      {R"({"cam00": {"open": "/dev/video0", "format": 3}})", "cam00"},
      {R"({"cam00": {"open": "/dev/video0", "options": {"video_size": [640, 480]}}})", "video_size"},
  };
  for (const auto& [sources, named] : wrong) {
    const auto rig = folder.read(kBounds + ", \"sources\": " + sources);
    expectError(rig, ErrorId::CaptureJson, "RIG.json");
    ASSERT_FALSE(rig.ok());
    EXPECT_NE(rig.error().message.find(named), std::string::npos) << rig.error().message;
  }
  expectError(folder.read(kBounds + R"(, "sources": {"cam00": "videos/none.mp4"})"), ErrorId::FileMissing, "none.mp4");
}

TEST(Rig, NamesMissingAndWrongFiles) {
  const RigFolder folder;
  expectError(folder.read(kBounds + R"(, "cameras": "elsewhere")"), ErrorId::FileMissing, "elsewhere");
  expectError(folder.read(kBounds + R"(, "background": "elsewhere")"), ErrorId::FileMissing, "elsewhere");
  folder.remove("background/cam01.png");
  expectError(folder.read(kBounds), ErrorId::FileMissing, "background/cam01.png");
  folder.write("background/cam01/000000.png", Image(16, 12, 3));
  EXPECT_TRUE(folder.read(kBounds).ok());
  folder.write("background/cam01/000000.png", Image(12, 16, 3));
  expectError(folder.read(kBounds), ErrorId::FrameSize, "background/cam01/000000.png");
  folder.write("cameras/cameras.txt", std::string("1 PINHOLE 5000 12 20 20 8 6\n"));
  expectError(folder.read(kBounds), ErrorId::FrameSize, "cam00");
}

TEST(Rig, NeedsBoundsWhereNoSpaceIsSeenByAll) {
  const RigFolder folder;
  folder.write("cameras/images.txt",
               std::string("1 1 0 0 0 0 0 3 1 cam00.png\n\n2 0 0 1 0 0 0 -4 1 cam01.png\n\n"));  // back to back
  expectError(folder.read(""), ErrorId::CaptureJson, "bounds");
}

// Eight cameras on a ring of 4 m that look at a point 1 m above the ground.
std::vector<capture::CaptureCamera> ring(double distance_m) {
  std::vector<capture::CaptureCamera> cameras;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * 0.7853981634;
    capture::CaptureCamera c;
    c.pinhole = testing::lookAt(glm::dvec3(distance_m * std::sin(angle), 1.5, distance_m * std::cos(angle)),
                                glm::dvec3(0, 1, 0), 640, 480, 700);
    cameras.push_back(c);
  }
  return cameras;
}

TEST(CommonView, HoldsWhatAllCamerasSee) {
  const auto cameras = ring(4);
  const auto box = commonView(cameras, 0);
  ASSERT_TRUE(box);
  // A ray at the picture's side has the slope 320 / 700 to the optical axis; the ring of cameras turns this into a
  // round column.
  const double reach_m = 4 * std::sin(std::atan(320.0 / 700));
  EXPECT_NEAR(box->max.x, reach_m, 0.25);
  EXPECT_NEAR(box->min.x, -reach_m, 0.25);
  EXPECT_NEAR(box->max.z, reach_m, 0.25);
  EXPECT_GT(box->max.y, 1.8);
  EXPECT_LT(box->max.y, 3);
  EXPECT_LE(box->min.y, 0.2);
  EXPECT_GE(box->min.y, -0.05);
  for (const auto& c : cameras) {
    const glm::vec3 at(c.pinhole.centreInWorld());
    EXPECT_TRUE(glm::any(glm::lessThan(at, box->min)) || glm::any(glm::greaterThan(at, box->max)));
  }
}

TEST(CommonView, ScalesWithTheRig) {
  auto cameras = ring(4);
  const auto box = commonView(cameras, 0);
  capture::scaleToMetres(cameras, 0.001);
  const auto small = commonView(cameras, 0);
  ASSERT_TRUE(box && small);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(small->max[axis], 0.001 * box->max[axis], 1e-5);
}

}  // namespace
}  // namespace fourdvt::live
