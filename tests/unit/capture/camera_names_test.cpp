// SPDX-License-Identifier: Apache-2.0
// Cameras by the pictures that a COLMAP model lists: names with blanks, folders of rigs, several instants, rigs.bin and
// frames.bin. These two are written by hand after the layout in COLMAP's documentation ("Output Format"), since no
// version that writes them (3.12 and later) was available.
#include <glm/gtc/quaternion.hpp>

#include "base/bytes.h"
#include "capture/colmap_model.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

struct Listed {
  const char* path;
  double x;  // the camera's position, which identifies it
};

Result<std::vector<ListedCamera>> camerasOf(const std::vector<Listed>& listed) {
  std::vector<ListedPicture> pictures;
  for (const Listed& one : listed) {
    ListedPicture picture{{}, one.path, "images.txt:" + std::to_string(pictures.size() + 1) + ": "};
    picture.camera.pinhole = {"", 64, 48, 50, 50, 32, 24};
    picture.camera.pinhole.cam_from_world[3] = glm::dvec4(one.x, 0, 3, 1);
    pictures.push_back(picture);
  }
  return camerasOfPictures(pictures);
}

void expectNames(const std::vector<Listed>& listed, const std::string& names, const std::string& pictures) {
  auto cameras = camerasOf(listed);
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  std::string got, shown;
  for (const ListedCamera& camera : cameras.value()) {
    got += (got.empty() ? "" : ", ") + camera.camera.pinhole.name;
    shown += (shown.empty() ? "" : ", ") + camera.pictures;
  }
  EXPECT_EQ(got, names);
  EXPECT_EQ(shown, pictures);
}

TEST(PictureNames, PartsOfThePathThatDifferNameTheCamera) {
  expectNames({{"cam00.png", 0}, {"cam01.jpg", 1}}, "cam00, cam01", "cam00.png, cam01.jpg");
  expectNames({{"images/cam00.png", 0}, {"./images/cam01.png", 1}}, "cam00, cam01",
              "images/cam00.png, images/cam01.png");
  expectNames({{"images\\cam00.png", 0}, {"images\\cam01.png", 1}}, "cam00, cam01",
              "images/cam00.png, images/cam01.png");
  expectNames({{"cam00/000000.png", 0}, {"cam01/000007.png", 1}}, "cam00, cam01", "cam00, cam01");
  expectNames({{"rig1/cam00/image0001.jpg", 0}, {"rig1/cam01/image0001.jpg", 1}}, "cam00, cam01",
              "rig1/cam00, rig1/cam01");
  expectNames({{"rig1/cam00/1.jpg", 0}, {"rig2/cam00/1.jpg", 1}}, "rig1, rig2", "rig1/cam00, rig2/cam00");
  expectNames({{"rig1/a/1.jpg", 0}, {"rig1/b/1.jpg", 1}, {"rig2/a/1.jpg", 2}}, "rig1_a, rig1_b, rig2_a",
              "rig1/a, rig1/b, rig2/a");
  expectNames({{"top/cam1.jpg", 0}, {"top/cam2.jpg", 1}, {"low/cam1.jpg", 2}, {"low/cam2.jpg", 3}},
              "top_cam1, top_cam2, low_cam1, low_cam2", "top/cam1.jpg, top/cam2.jpg, low/cam1.jpg, low/cam2.jpg");
  expectNames({{"b/000000.png", 0}, {"a.jpg", 1}, {"c", 2}}, "b, a, c", "b, a.jpg, c");
  expectNames({{"one/000000.png", 0}}, "one", "one");
}

TEST(PictureNames, SeveralInstantsOfAStandingCameraAreOne) {
  expectNames({{"cam00/1.jpg", 0}, {"cam01/1.jpg", 1}, {"cam00/2.jpg", 0}, {"cam01/2.jpg", 1}}, "cam00, cam01",
              "cam00, cam01");
  expectNames({{"r/cam00/1.jpg", 0}, {"r/cam00/2.jpg", 1e-4}, {"r/cam01/1.jpg", 1}}, "cam00, cam01",
              "r/cam00, r/cam01");
  expectNames({{"cam00_0001.jpg", 0}, {"cam00_0002.jpg", 0}, {"cam01_0001.jpg", 1}}, "cam00, cam01",
              "cam00_0001.jpg, cam01_0001.jpg");
}

TEST(PictureNames, WhatCannotBeToldApartIsRefused) {
  expectError(camerasOf({{"cam00/1.jpg", 0}, {"cam01/1.jpg", 1}, {"cam00/2.jpg", 0.5}, {"cam01/2.jpg", 1}}),
              ErrorId::CameraPose, "images.txt:3: camera \"cam00\" has another pose or lens in 2.jpg than in 1.jpg");
  expectError(camerasOf({{"a.png", 0}, {"a.jpg", 1}}), ErrorId::CameraPose,
              "images.txt:2: camera \"a\" is listed twice");
  expectError(camerasOf({{"", 0}}), ErrorId::CameraPose, "no name");
  expectError(camerasOf({{"..", 0}}), ErrorId::CameraPose, "cannot name");
}

const std::string kCamera = "1 PINHOLE 64 48 50 50 32 24\n";

TEST(PictureNames, BlanksBelongToTheName) {
  auto cameras = parseColmapText(kCamera,
                                 "1 1 0 0 0 0 0 3 1 cam 00.png\n2 1 0 0 0 1 0 3 1 A cam00 (1).png  \n1 2 -1\n"
                                 "3 1 0 0 0 2 0 3 1 cam03 moved after lunch.png\n\n",
                                 "m");
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  ASSERT_EQ(cameras.value().size(), 3u);
  EXPECT_EQ(cameras.value()[0].pinhole.name, "cam 00");
  EXPECT_EQ(cameras.value()[1].pinhole.name, "A cam00 (1)");
  EXPECT_EQ(cameras.value()[2].pinhole.name, "cam03 moved after lunch");
}

TEST(PictureNames, PointsStayInNames) {
  CaptureCamera camera;
  camera.pinhole = {"cam.one", 64, 48, 50, 50, 32, 24};
  const ColmapText text = colmapText({camera}, 1);
  auto again = parseColmapText(text.cameras, text.images, "m");
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(again.value()[0].pinhole.name, "cam.one");
}

// Rig of two cameras, the second turned by 90° about y and 1 to the right of the first; the rig stands 3 back.
const double kHalf = std::sqrt(0.5);

TEST(ColmapRigs, PosesAreTheRigsInTextAndBytes) {
  const std::string rigs =
      "# RIG_ID, NUM_SENSORS, ...\n4 2 CAMERA 1 CAMERA 2 1 0.70710678118654757 0 0.70710678118654757 0 1 0 0\n";
  const std::string frames = "9 4 1 0 0 0 0 0 3 3 CAMERA 1 11 CAMERA 2 12 IMU 5 99\n";
  ByteWriter r, f;
  const auto doubles = [](ByteWriter& out, std::initializer_list<double> values) {
    for (const double value : values) out.f64(value);
  };
  r.u64(1), r.u32(4), r.u32(2), r.u32(0), r.u32(1), r.u32(0), r.u32(2), r.u8(1);
  doubles(r, {kHalf, 0, kHalf, 0, 1, 0, 0});
  f.u64(1), f.u32(9), f.u32(4);
  doubles(f, {1, 0, 0, 0, 0, 0, 3});
  f.u32(3);
  for (const auto& [kind, sensor, image] : {std::array<uint32_t, 3>{0, 1, 11}, {0, 2, 12}, {1, 5, 99}})
    f.u32(kind), f.u32(sensor), f.u64(image);
  const auto bytes = [](ByteWriter& out) {
    const auto data = out.take();
    return std::string(data.begin(), data.end());
  };
  const std::string rigs_bin = bytes(r), frames_bin = bytes(f);
  for (const auto& read : {parseRigsText(rigs, frames, "m"), parseRigsBinary(rigs_bin, frames_bin, "m")}) {
    ASSERT_TRUE(read.ok()) << read.error().message;
    ASSERT_EQ(read.value().size(), 2u);
    EXPECT_EQ(read.value().at(11), (std::array<double, 7>{1, 0, 0, 0, 0, 0, 3}));
    // (0, 0, 3) of the rig turned by 90° about y is (3, 0, 0).
    const std::array<double, 7> expected{kHalf, 0, kHalf, 0, 4, 0, 0};
    for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(read.value().at(12)[i], expected[i], 1e-12) << i;
  }
  for (size_t kept = 0; kept < frames_bin.size(); kept += 3) {
    expectError(parseRigsBinary(rigs_bin, frames_bin.substr(0, kept), "m"), ErrorId::CameraPose, "m/frames.bin");
    if (kept < rigs_bin.size())
      expectError(parseRigsBinary(rigs_bin.substr(0, kept), frames_bin, "m"), ErrorId::CameraPose, "m/");
  }
  expectError(parseRigsText("4 2 CAMERA 1 CAMERA 2 1 0,7 0 1 0 1 0 0\n", frames, "m"), ErrorId::CameraPose,
              "m/rigs.txt:1: \"0,7\" has a decimal comma");
  expectError(parseRigsText(rigs, "9 5 1 0 0 0 0 0 3 1 CAMERA 1 11\n", "m"), ErrorId::CameraPose, "m/frames.txt:1");
  expectError(parseRigsText(rigs, "9 4 1 0 0 0 0 0 3 2 CAMERA 1 11\n", "m"), ErrorId::CameraPose, "m/frames.txt:1");
}

TEST(ColmapRigs, GoBeforeThePosesOfImages) {
  const TempFolder files;
  files.write("cameras.txt", kCamera + "2 PINHOLE 64 48 60 60 32 24\n");
  files.write("images.txt",
              std::string("11 1 0 0 0 9 9 9 1 rig/cam00/1.png\n\n12 1 0 0 0 9 9 9 2 rig/cam01/1.png\n\n"));
  files.write("rigs.txt", std::string("4 2 CAMERA 1 CAMERA 2 1 1 0 0 0 1 0 0\n"));
  files.write("frames.txt", std::string("9 4 1 0 0 0 0 0 3 2 CAMERA 1 11 CAMERA 2 12\n"));
  auto cameras = readColmapCameras(files.path());
  ASSERT_TRUE(cameras.ok()) << cameras.error().message;
  ASSERT_EQ(cameras.value().size(), 2u);
  EXPECT_EQ(cameras.value()[0].pinhole.cam_from_world[3], glm::dvec4(0, 0, 3, 1));
  EXPECT_EQ(cameras.value()[1].pinhole.cam_from_world[3], glm::dvec4(1, 0, 3, 1));
  EXPECT_EQ(cameras.value()[1].pinhole.fx, 60);
  EXPECT_EQ(cameras.value()[1].pinhole.name, "cam01");
  files.remove("rigs.txt");
  expectError(readColmapCameras(files.path()), ErrorId::FileMissing, "rigs.txt");
}

}  // namespace
}  // namespace fourdvt::capture
