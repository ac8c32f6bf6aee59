// SPDX-License-Identifier: Apache-2.0
// Cameras with time offsets, and clips that start later: indices of the picture, mesh and matte read for a frame.
#include "capture_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

// [camera] grey level of each frame: 10 × the picture's number, plus the camera's.
std::vector<std::vector<int>> greysOf(const Capture& capture) {
  std::vector<std::vector<int>> out(capture.cameras.size());
  auto reader = mattes::FrameReader::open(capture, capture.sequences[0], platform::openVideoFile);
  EXPECT_TRUE(reader.ok()) << reader.error().message;
  for (uint32_t f = 0; reader.ok() && f < capture.sequences[0].frame_count; ++f) {
    const auto frame = reader.value()->next();
    EXPECT_TRUE(frame.ok()) << frame.error().message;
    for (size_t c = 0; frame.ok() && c < out.size(); ++c) out[c].push_back(frame.value().pictures[c].at(0, 0)[0]);
  }
  return out;
}

std::string straight(const std::string& extra) {
  return R"({"fps": 25, "sequences": [{"name": "walk", )" + extra + "}]}";
}

using Greys = std::vector<std::vector<int>>;

TEST(CaptureOffsets, LoopGoesRound) {
  SmallCapture files;
  files.write("capture.json", SmallCapture::json(R"(, "offset_frames": {"cam01": -1.3})"));
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(greysOf(capture.value()), (Greys{{0, 10, 20}, {21, 1, 11}}));
  EXPECT_DOUBLE_EQ(capture.value().sequences[0].offsetOf("cam01"), -1.3);
  EXPECT_DOUBLE_EQ(capture.value().sequences[0].offsetOf("cam00"), 0);
}

TEST(CaptureOffsets, ClipStartsLaterAndMeshesFollow) {
  SmallCapture files;
  files.write("capture.json", straight(R"("frames": 2, "first_frame": 1, "offset_frames": {"cam01": -0.6})"));
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(greysOf(capture.value()), (Greys{{10, 20}, {1, 11}}));
  EXPECT_NEAR(readMeshFrame(capture.value(), capture.value().sequences[0], 0).value()[0].z, 0.1, 1e-6);
  EXPECT_NEAR(readMeshFrame(capture.value(), capture.value().sequences[0], 1).value()[0].z, 0.2, 1e-6);
}

TEST(CaptureOffsets, SequenceGoesBeforeTheWhole) {
  SmallCapture files;
  files.write("capture.json", R"({"fps": 25, "offset_frames": {"cam00": 1, "cam01": 1},
    "sequences": [{"name": "walk", "frames": 2, "offset_frames": {"cam01": 0.2}}]})");
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(greysOf(capture.value()), (Greys{{10, 20}, {1, 11}}));
}

TEST(CaptureOffsets, WhatCannotBeReadIsSaidWithTheRemedy) {
  SmallCapture files;
  const auto error = [&](const std::string& sequence) {
    files.write("capture.json", straight(sequence));
    const auto opened = files.open();
    EXPECT_FALSE(opened.ok()) << sequence;
    return opened.ok() ? std::string() : opened.error().message;
  };
  const auto has = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  };
  std::string message = error(R"("frames": 3, "offset_frames": {"cam01": 3})");
  has(message, "capture.json");
  has(message, "camera \"cam01\", is longer than the clip of 3 frames");
  message = error(R"("frames": 3, "offset_frames": {"cam00": -0.7, "cam01": -2})");
  has(message, "\"cam01\"");
  has(message, "\"first_frame\" to 2 at least");
  message = error(R"("frames": 3, "offset_frames": {"cam01": 1})");
  has(message, "cam01");
  has(message, "missing");
  has(error(R"("frames": 3, "offset_frames": {"cam07": 1})"), "names the camera \"cam07\"");
  has(error(R"("frames": 3, "offset_frames": {"cam01": "late"})"), "numbers by camera");
  has(error(R"("frames": 3, "offset_frames": [1, 2])"), "numbers by camera");
  has(error(R"("frames": 3, "offset_frames": {"cam01": 1e300})"), "numbers by camera");
  has(error(R"("frames": 3, "first_frame": -1)"), "\"first_frame\"");
  has(error(R"("frames": 3, "first_frame": 1)"), "mesh/000003.obj");
}

TEST(CaptureOffsets, MeshesPerFrameAreNumberedFromTheFirstFrame) {
  BareCapture files;
  files.write("walk/mesh/000001.obj", quadObj(0.1));
  files.write("walk/mesh/000002.obj", quadObj(0.2));
  files.write("capture.json", R"({"fps": 25, "topology": "per-frame",
    "sequences": [{"name": "walk", "frames": 2, "first_frame": 1}]})");
  const auto capture = files.openAs(MeshNeed::AnySurface);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_NEAR(readSurfaceFrame(capture.value(), capture.value().sequences[0], 0).value().positions[0].z, 0.1, 1e-6);
}

}  // namespace
}  // namespace fourdvt::capture
