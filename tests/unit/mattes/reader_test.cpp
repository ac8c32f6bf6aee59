// SPDX-License-Identifier: Apache-2.0
#include "capture/pictures.h"
#include "capture_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::mattes {

using namespace capture;

namespace {

TEST(CaptureReader, ReadsASmallCapture) {
  SmallCapture files;
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const Capture& c = capture.value();
  ASSERT_EQ(c.sequences.size(), 1u);
  EXPECT_EQ(c.fps, 25);
  EXPECT_TRUE(c.sequences[0].loop);
  EXPECT_EQ(c.sequences[0].root_velocity_mps.z, 1.5);
  EXPECT_EQ(c.topology.faceCount(), 2u);
  ASSERT_NE(c.find("walk"), nullptr);
  EXPECT_EQ(c.find("run"), nullptr);
  auto reader = FrameReader::open(c, c.sequences[0], platform::openVideoFile);
  ASSERT_TRUE(reader.ok());
  for (uint32_t k = 0; k < 3; ++k) {
    auto frame = reader.value()->next();
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame.value().index, k);
    ASSERT_EQ(frame.value().pictures.size(), 2u);
    EXPECT_EQ(frame.value().pictures[1].channels, 4);
    EXPECT_EQ(frame.value().pictures[1].at(3, 4)[0], 10 * k + 1);
    EXPECT_EQ(frame.value().pictures[1].at(3, 4)[3], 255);
    EXPECT_NEAR(frame.value().positions[0].z, 0.1 * k, 1e-6);
  }
  expectError(reader.value()->next(), ErrorId::InvalidArgument, "walk");
}

TEST(CaptureReader, StartsInTheMiddle) {
  SmallCapture files;
  auto capture = files.open();
  ASSERT_TRUE(capture.ok());
  auto reader = FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile, 2);
  ASSERT_TRUE(reader.ok());
  auto frame = reader.value()->next();
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame.value().index, 2u);
  EXPECT_EQ(frame.value().pictures[0].at(0, 0)[0], 20);
}

TEST(CaptureReader, UnitsBecomeMetres) {
  SmallCapture files;
  files.write("capture.json", SmallCapture::json("", "centimetre"));
  auto capture = files.open();
  ASSERT_TRUE(capture.ok());
  EXPECT_NEAR(capture.value().cameras[1].pinhole.cam_from_world[3].x, 0.005, 1e-12);
  EXPECT_NEAR(capture.value().sequences[0].root_velocity_mps.z, 0.015, 1e-12);
  EXPECT_NEAR(readMeshFrame(capture.value(), capture.value().sequences[0], 0).value()[1].x, 0.01, 1e-7);
}

// White pictures with a shape in the alpha channel, pictures in the performer's colours, and empty ones.
TEST(CaptureReader, AMatteIsTheAlphaOfAPictureThatIsNotOpaque) {
  SmallCapture files;
  for (const int colour : {255, 40}) {
    Image cut_out(16, 12, 4, uint8_t(colour)), empty(16, 12, 4, uint8_t(colour)), opaque(16, 12, 4, uint8_t(colour));
    for (int i = 0; i < 16 * 12; ++i) {
      cut_out.at(i % 16, i / 16)[3] = i % 16 < 8 ? 255 : 0;
      empty.at(i % 16, i / 16)[3] = 0;
      opaque.at(i % 16, i / 16)[3] = 255;
    }
    for (const auto& [picture, left, right] : {std::tuple{cut_out, 255, 0}, {empty, 0, 0}, {opaque, colour, colour}}) {
      files.write("matte.png", picture);
      const auto matte = readPicture(files / "matte.png", 1);
      ASSERT_TRUE(matte.ok());
      ASSERT_EQ(matte.value().channels, 1);
      EXPECT_EQ(*matte.value().at(3, 4), left);
      EXPECT_EQ(*matte.value().at(12, 4), right);
    }
  }
}

TEST(CaptureReader, KeysAgainstThePlateWithoutMattes) {
  SmallCapture files;
  files.remove("walk/mask01");
  Image plate(16, 12, 3), picture;
  for (int i = 0; i < 16 * 12; ++i) plate.at(i % 16, i / 16)[1] = 180;
  picture = plate;
  for (int y = 4; y < 9; ++y) {
    for (int x = 4; x < 12; ++x) picture.at(x, y)[0] = 200, picture.at(x, y)[1] = 150, picture.at(x, y)[2] = 140;
  }
  files.write("background/cam01.png", plate);
  for (int k = 0; k < 3; ++k) files.write("walk/cam01/" + numbered(k, ".png"), picture);
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader = FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile);
  auto frame = reader.value()->next();
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame.value().pictures[1].at(7, 6)[3], 255);
  EXPECT_EQ(frame.value().pictures[1].at(7, 6)[0], 200);
  EXPECT_EQ(frame.value().pictures[1].at(1, 1)[3], 0);
}

TEST(CaptureReader, PackedPositionsAreScaled) {
  SmallCapture files;
  files.write("capture.json", SmallCapture::json(R"(, "mesh": {"topology": "walk/mesh/000000.obj", "positions": "p.i16",
                                           "units_per_metre": 100})"));
  std::string bytes(3 * 4 * 6, '\0');
  const size_t at = (2 * 4 + 3) * 6 + 2;  // frame 2, vertex 3, y
  bytes[at] = '\x38';
  bytes[at + 1] = '\xff';  // -200
  files.write("p.i16", bytes);
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const auto positions = readMeshFrame(capture.value(), capture.value().sequences[0], 2);
  ASSERT_TRUE(positions.ok());
  EXPECT_EQ(positions.value()[3], glm::vec3(0, -2, 0));
}

TEST(CaptureReader, OpensTheSample) {
  auto capture = openCapture(kSample, platform::openVideoFile);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const Capture& c = capture.value();
  EXPECT_EQ(c.cameras.size(), 8u);
  ASSERT_EQ(c.sequences.size(), 3u);
  EXPECT_EQ(c.topology.vertex_count, 3999u);
  EXPECT_EQ(c.topology.faceCount(), 8000u);
  EXPECT_EQ(c.sequences[2].frame_count, 40u);
  EXPECT_EQ(c.sequences[0].test_frames.size(), 4u);
  EXPECT_NE(c.credit.find("mocap.cs.cmu.edu"), std::string::npos);
  const auto walk0 = readMeshFrame(c, c.sequences[0], 0);
  ASSERT_TRUE(walk0.ok());
  EXPECT_EQ(walk0.value()[0], glm::vec3(-0.1292f, 0.8370f, -0.1328f));
}

// True near the matte: the surface lies one or two millimetres outside the performer, hence some pixels at the outline.
bool onMatte(const Image& picture, double x, double y) {
  for (int dy = -4; dy <= 4; dy += 4) {
    for (int dx = -4; dx <= 4; dx += 4) {
      if (picture.at(static_cast<int>(x) + dx, static_cast<int>(y) + dy)[3] >= 128) return true;
    }
  }
  return false;
}

// The projected mesh must lie on the matte, which checks calibration, mesh and video together.
TEST(CaptureReader, SampleMeshProjectsOntoItsMattes) {
  auto capture = openCapture(kSample, platform::openVideoFile, {"run"});
  ASSERT_TRUE(capture.ok());
  const Capture& c = capture.value();
  auto reader = FrameReader::open(c, c.sequences[0], platform::openVideoFile, 17);
  ASSERT_TRUE(reader.ok());
  for (int k = 17; k < 19; ++k) {
    auto frame = reader.value()->next();
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    for (size_t camera = 0; camera < c.cameras.size(); ++camera) {
      const Image& picture = frame.value().pictures[camera];
      ASSERT_EQ(picture.width, 720);
      size_t inside = 0;
      for (const glm::vec3& p : frame.value().positions) {
        const glm::dvec3 pixel = c.cameras[camera].pinhole.project(p);
        ASSERT_TRUE(pixel.x > 4 && pixel.x < 715 && pixel.y > 4 && pixel.y < 955);
        inside += onMatte(picture, pixel.x, pixel.y);
      }
      EXPECT_GT(inside, frame.value().positions.size() * 99 / 100) << "camera " << camera;
    }
  }
}

}  // namespace
}  // namespace fourdvt::mattes
