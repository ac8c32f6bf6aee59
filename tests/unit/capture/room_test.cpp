// SPDX-License-Identifier: Apache-2.0
// The optional room in capture.json, and the plates for its texture.
#include "capture_fixture.h"
#include "mattes/plate_key.h"

namespace fourdvt::capture {
namespace {

class RoomCapture : public SmallCapture {
 public:
  void declare(const std::string& room, const std::string& units = "metre") const {
    write("capture.json", "{\"room\": " + room + ", " + json("", units).substr(1));
  }
};

TEST(CaptureRoom, IsInMetres) {
  RoomCapture files;
  EXPECT_FALSE(files.open().value().room.has_value());
  files.declare(R"({"min": [-300, 0, -250.5], "max": [300, 280, 250]})", "centimetre");
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  ASSERT_TRUE(capture.value().room.has_value());
  EXPECT_NEAR(glm::distance(capture.value().room->min, glm::vec3(-3, 0, -2.505f)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(capture.value().room->max, glm::vec3(3, 2.8f, 2.5f)), 0, 1e-6);
}

TEST(CaptureRoom, WrongOnesAreNamed) {
  RoomCapture files;
  for (const char* room : {"7", "[]", "{}", R"({"min": [0, 0, 0]})", R"({"min": [0, 0], "max": [1, 1]})",
                           R"({"min": [0, 0, "a"], "max": [1, 1, 1]})", R"({"min": [0, 0, 0], "max": [1, 0, 1]})",
                           R"({"min": [0, 0, 0], "max": [1, -1, 1]})", R"({"min": [0, 0, 0], "max": [1, 1e40, 1]})"}) {
    files.declare(room);
    expectError(files.open(), ErrorId::CaptureJson, files / "capture.json: \"room\"");
  }
}

TEST(CaptureRoom, PlatesAreAveragedAndSayWhereTheyReach) {
  SmallCapture files;
  files.write("background/cam00/000000.png", SmallCapture::grey(40));
  files.write("background/cam00/000001.png", SmallCapture::grey(60));
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok());
  CaptureCamera camera = capture.value().cameras[0];
  const auto plate = mattes::readRoomPlate(capture.value(), camera);
  ASSERT_TRUE(plate.ok()) << plate.error().message;
  ASSERT_EQ(plate.value().channels, 4);
  EXPECT_EQ(plate.value().at(8, 6)[0], 50);
  EXPECT_EQ(plate.value().at(0, 0)[3], 255);
  camera.distortion.k1 = 0.5;  // corners of the pinhole picture lie outside the lens's
  const auto pincushion = mattes::readRoomPlate(capture.value(), camera);
  ASSERT_TRUE(pincushion.ok());
  EXPECT_EQ(pincushion.value().at(8, 6)[3], 255);
  EXPECT_LT(pincushion.value().at(0, 0)[3], 255);
}

TEST(CaptureRoom, MissingPlatesSayWhyTheyAreNeeded) {
  SmallCapture files;
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok());
  const auto plate = mattes::readRoomPlate(capture.value(), capture.value().cameras[0]);
  expectError(plate, ErrorId::FileMissing, files / "background/cam00.png");
  EXPECT_NE(plate.error().message.find("\"room\""), std::string::npos);
}

}  // namespace
}  // namespace fourdvt::capture
