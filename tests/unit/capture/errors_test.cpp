// SPDX-License-Identifier: Apache-2.0
// Users' mistakes: one message that names the file, when the capture is opened.
#include "capture_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

TEST(CaptureErrors, MissingCaptureJson) {
  SmallCapture capture;
  capture.remove("capture.json");
  expectError(capture.open(), ErrorId::FileMissing, capture / "capture.json");
}

TEST(CaptureErrors, BrokenCaptureJson) {
  SmallCapture capture;
  for (const std::string text :
       {R"({"fps": 25,)",
        "",
        "[]",
        "null",
        R"({"fps": "x", "sequences": []})",
        R"({"fps": 25, "sequences": []})",
        R"({"fps": 25, "sequences": [7]})",
        R"({"fps": 25, "units": "inch", "sequences": [{"name": "walk", "frames": 3}]})",
        R"({"fps": 25, "sequences": [{"name": "", "frames": 3}]})",
        R"({"fps": 25, "sequences": [{"name": "a/b", "frames": 3}]})",
        R"({"fps": 25, "sequences": [{"name": "walk", "frames": 0}]})",
        R"({"fps": 25, "sequences": [{"name": "walk", "frames": 2.5}]})",
        R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3, "mesh": "x.obj"}]})",
        R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3, "test_frames": [3]}]})",
        R"({"fps": 25, "calibration": 3, "sequences": [{"name": "walk", "frames": 3}]})",
        R"({"fps": 25, "orientation": "marked", "sequences": [{"name": "walk", "frames": 3}]})",
        R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3, "loop": "yes"}]})",
        R"({"fps": 25, "up_axis": "Z", "sequences": [{"name": "walk", "frames": 3}]})",
        R"({"fps": 25, "sequences": [{"name": "w", "frames": 3}, {"name": "w", "frames": 3}]})",
        "\xff\xfe{}"}) {
    capture.write("capture.json", text);
    expectError(capture.open(), ErrorId::CaptureJson, capture / "capture.json");
  }
}

// JSON has no infinity, but a division can produce one.
TEST(CaptureErrors, NumbersThatMakePositionsInfinite) {
  const SmallCapture capture;
  const std::string walk = R"("sequences": [{"name": "walk", "frames": 3)";
  for (const auto& [fields, named] :
       {std::pair<std::string, const char*>{R"("ground_y": -1e300, )" + walk + "}]}", "ground_y"},
        {walk + R"(, "root_velocity": [0, 1e300, 0]}]})", "root_velocity"},
        {walk + R"(, "mesh": {"topology": "q.obj", "positions": "p.i16", "units_per_metre": 1e-300}}]})",
         "units_per_metre"}}) {
    capture.write("capture.json", R"({"fps": 25, )" + fields);
    expectError(capture.open(), ErrorId::CaptureJson, named);
  }
}

// Paths that leave the folder; the message names their field.
TEST(CaptureErrors, PathsThatLeaveTheFolder) {
  const SmallCapture capture;
  const auto packed = [](const char* topology, const char* positions) {
    return std::string(R"("sequences": [{"name": "walk", "frames": 3, "mesh": {"topology": ")") + topology +
           R"(", "positions": ")" + positions + R"(", "units_per_metre": 100}}]})";
  };
  const std::string walk = R"("sequences": [{"name": "walk", "frames": 3)";
  for (const auto& [fields, named] :
       {std::pair<std::string, const char*>{R"("calibration": {"ring": "../rig"}, )" + walk + "}]}",
                                            "\"calibration\" leads out"},
        {R"("calibration": {"ring": "/rig"}, )" + walk + "}]}", "\"calibration\" leads out"},
        {R"("background": "../plates/camNN.png", )" + walk + "}]}", "\"background\" leads out"},
        {R"("background": {"plates": "/plates/camNN/%06d.png"}, )" + walk + "}]}", "\"background\" leads out"},
        {R"("background": "a/../../camNN.png", )" + walk + "}]}", "\"background\" leads out"},
        {walk + R"(, "mesh": "../scans/%06d.obj"}]})", "\"mesh\" of \"walk\" leads out"},
        {walk + R"(, "mesh": "/scans/%06d.obj"}]})", "\"mesh\" of \"walk\" leads out"},
        {packed("../quad.obj", "p.i16"), "\"mesh\" of \"walk\" leads out"},
        {packed("quad.obj", "walk/../../p.i16"), "\"mesh\" of \"walk\" leads out"}}) {
    capture.write("capture.json", R"({"fps": 25, )" + fields);
    expectError(capture.open(), ErrorId::CaptureJson, capture / "capture.json: " + named);
  }
  capture.write("capture.json", R"({"fps": 25, "calibration": {"ring": "walk/../cameras/"}, )" + walk + "}]}");
  EXPECT_TRUE(capture.open().ok()) << "stays inside";
}

TEST(CaptureErrors, CameraNamesThatLeaveTheFolder) {
  const SmallCapture capture;
  capture.write("cameras/images.txt", std::string("1 1 0 0 0 0 0 3 1 ../cam00.png\n\n"));
  expectError(capture.open(), ErrorId::CameraPose, capture / "cameras/images.txt");
}

TEST(CaptureErrors, LinksInTheFolderAreFollowed) {
  const SmallCapture capture;
  std::filesystem::rename(capture / "cameras", capture.path() + "_cameras");
  std::filesystem::create_directory_symlink(capture.path() + "_cameras", capture / "cameras");
  EXPECT_TRUE(capture.open().ok());
  std::filesystem::remove_all(capture.path() + "_cameras");
}

TEST(CaptureErrors, DeepCaptureJson) {
  const SmallCapture capture;
  const auto nested = [](size_t depth) {
    return "{\"note\": " + std::string(depth, '[') + std::string(depth, ']') + ", " + SmallCapture::json().substr(1);
  };
  capture.write("capture.json", nested(60));
  EXPECT_TRUE(capture.open().ok());
  capture.write("capture.json", nested(100'000));
  expectError(capture.open(), ErrorId::CaptureJson, "nested deeper than 64");
}

TEST(CaptureErrors, UnknownSequenceAsked) {
  SmallCapture capture;
  expectError(mattes::openCapture(capture.path(), platform::openVideoFile, {"jump"}), ErrorId::InvalidArgument,
              capture / "capture.json");
}

TEST(CaptureErrors, MissingFilesAreNamed) {
  struct Missing {
    const char* removed;
    ErrorId id;
    const char* named;
  };
  for (const Missing& m : {Missing{"cameras/images.txt", ErrorId::FileMissing, "cameras/images.txt"},
                           Missing{"walk/cam01", ErrorId::CameraMissingVideo, "walk/cam01"},
                           Missing{"walk/mask01", ErrorId::FileMissing, "background/cam01.png"},
                           Missing{"walk/cam01/000002.png", ErrorId::VideoTooShort, "walk/cam01/000002.png"}}) {
    SCOPED_TRACE(m.removed);
    SmallCapture capture;
    capture.remove(m.removed);
    expectError(capture.open(), m.id, capture / m.named);
  }
}

TEST(CaptureErrors, UnreadableVideo) {
  SmallCapture capture;
  capture.write("walk/cam00.mp4", std::string("not a video"));
  expectError(capture.open(), ErrorId::FileUnreadable, capture / "walk/cam00.mp4");
}

TEST(CaptureErrors, TruncatedVideo) {
  SmallCapture capture;
  std::filesystem::copy_file(kSample + "/walk/cam00.mp4", capture / "walk/cam00.mp4");
  std::filesystem::resize_file(capture / "walk/cam00.mp4", 20000);
  auto opened = capture.open();
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message.find("walk/cam00.mp4"), std::string::npos) << opened.error().message;
}

// The container states its frame count, so no decoding is needed to find out.
TEST(CaptureErrors, VideoTooShort) {
  SmallCapture capture;
  capture.write("capture.json", std::string(R"({"fps": 25, "sequences": [{"name": "walk", "frames": 29}]})"));
  capture.write("cameras/cameras.txt", std::string("1 PINHOLE 720 960 1697 1697 360 480\n"));
  capture.write("cameras/images.txt", std::string("1 1 0 0 0 0 0 3 1 cam00\n"));
  for (int frame = 0; frame < 29; ++frame) capture.write("walk/mesh/" + numbered(frame, ".obj"), quadObj(0));
  std::filesystem::copy_file(kSample + "/walk/cam00.mp4", capture / "walk/cam00.mp4");
  std::filesystem::copy_file(kSample + "/walk/mask00.mkv", capture / "walk/mask00.mkv");
  expectError(capture.open(), ErrorId::VideoTooShort, capture / "walk/cam00.mp4");
}

// A container without a frame count: the reader finds the end.
TEST(CaptureErrors, VideoEndsEarlyWithoutHint) {
  struct TwoPictures final : VideoSource {
    int left = 2;
    Result<std::optional<Image>> next() override {
      if (left-- > 0) return std::optional<Image>(SmallCapture::grey(5));
      return std::optional<Image>();
    }
  };
  SmallCapture files;
  files.write("walk/cam01.mkv", std::string("x"));
  const OpenVideo open = [](const std::string&, int) -> Result<std::unique_ptr<VideoSource>> {
    return std::unique_ptr<VideoSource>(std::make_unique<TwoPictures>());
  };
  auto capture = mattes::openCapture(files.path(), open);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], open);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader.value()->next().ok());
  EXPECT_TRUE(reader.value()->next().ok());
  expectError(reader.value()->next(), ErrorId::VideoTooShort, files / "walk/cam01.mkv");
}

TEST(CaptureErrors, PictureSizeDiffersFromCalibration) {
  SmallCapture capture;
  capture.write("walk/cam01/000000.png", Image(18, 12, 3));
  expectError(capture.open(), ErrorId::FrameSize, capture / "walk/cam01/");
}

TEST(CaptureErrors, MatteSizeDiffersFromCalibration) {
  SmallCapture capture;
  capture.write("walk/mask00/000000.png", Image(16, 13, 1));
  expectError(capture.open(), ErrorId::FrameSize, capture / "walk/mask00/");
}

TEST(CaptureErrors, PictureSizeChangesLater) {
  SmallCapture files;
  files.write("walk/cam01/000001.png", Image(18, 12, 3));
  auto capture = files.open();
  ASSERT_TRUE(capture.ok());
  auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile, 1);
  ASSERT_TRUE(reader.ok());
  expectError(reader.value()->next(), ErrorId::FrameSize, files / "walk/cam01/");
}

TEST(CaptureErrors, UnknownCameraModel) {
  SmallCapture capture;
  capture.write("cameras/cameras.txt", std::string("1 RAD_TAN_THIN_PRISM_FISHEYE 16 12 20 20 8 6 0 0 0 0\n"));
  expectError(capture.open(), ErrorId::CameraModel, capture / "cameras/cameras.txt");
}

TEST(CaptureErrors, NonFiniteOrSingularPose) {
  SmallCapture capture;
  for (const std::string pose : {"nan 0 0 0 0 0 3", "1 0 0 0 0 inf 3", "0 0 0 0 0 0 3", "1 0 0 x 0 0 3", "1 0 0"}) {
    capture.write("cameras/images.txt", "1 " + pose + " 1 cam00\n\n");
    expectError(capture.open(), ErrorId::CameraPose, capture / "cameras/images.txt:1");
  }
}

TEST(CaptureErrors, BadIntrinsics) {
  SmallCapture capture;
  for (const std::string model : {"PINHOLE 16 12 0 20 8 6", "PINHOLE 16 12 nan 20 8 6", "PINHOLE 16 12 20",
                                  "PINHOLE 0 12 20 20 8 6", "PINHOLE 99999999999 12 20 20 8 6"}) {
    capture.write("cameras/cameras.txt", "\n1 " + model + "\n");
    expectError(capture.open(), ErrorId::CameraPose, capture / "cameras/cameras.txt:2");
  }
}

TEST(CaptureErrors, MeshTopologyChangesInLaterFrame) {
  SmallCapture capture;
  for (const std::string face : {"f 1/1 2/2 4/4\nf 2/2 3/3 4/4\n", "f 1/1 2/2 3/3\n"}) {
    std::string text = quadObj(0.2);
    capture.write("walk/mesh/000002.obj", text.substr(0, text.find("f ")) + face);
    expectError(capture.open(), ErrorId::MeshTopology, capture / "walk/mesh/000002.obj");
  }
  capture.write("walk/mesh/000002.obj", "v 9 9 9\n" + quadObj(0.2));
  expectError(capture.open(), ErrorId::MeshTopology, capture / "walk/mesh/000002.obj");
}

TEST(CaptureErrors, MissingMeshFrame) {
  SmallCapture capture;
  capture.remove("walk/mesh/000001.obj");
  expectError(capture.open(), ErrorId::FileMissing, capture / "walk/mesh/000001.obj");
}

TEST(CaptureErrors, MeshWithNanInLaterFrame) {
  SmallCapture capture;
  capture.write("walk/mesh/000001.obj", "v nan 0 0\n" + quadObj(0).substr(quadObj(0).find('\n') + 1));
  expectError(capture.open(), ErrorId::MeshNotFinite, capture / "walk/mesh/000001.obj:1");
}

TEST(CaptureErrors, PackedPositionsOfAnotherSize) {
  SmallCapture capture;
  capture.write("capture.json",
                SmallCapture::json(R"(, "mesh": {"topology": "walk/mesh/000000.obj", "positions": "p.i16",
                                             "units_per_metre": 100})"));
  capture.write("p.i16", std::string(3 * 4 * 6 - 2, '\0'));
  expectError(capture.open(), ErrorId::MeshTopology, capture / "p.i16");
  capture.remove("p.i16");
  expectError(capture.open(), ErrorId::FileMissing, capture / "p.i16");
}

}  // namespace
}  // namespace fourdvt::capture
