// SPDX-License-Identifier: Apache-2.0
#include "capture/input_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

struct InputFiles : testing::Test {
  fs::path folder = fs::path(testing::TempDir()) / ("input_files_test_" + std::to_string(getpid()));
  Capture capture;
  void SetUp() override {
    fs::remove_all(folder);
    capture.folder = folder.string();
    capture.background_folder = (folder / "background").string();
    capture.cameras_folder = (folder / "cameras").string();
    write("capture.json");
    capture.cameras.emplace_back().pinhole.name = "cam00";
    write("cameras/cameras.txt");
    write("background/cam00/000000.png");
    CaptureSequence& turn = capture.sequences.emplace_back();
    turn.name = "turn";
    turn.frame_count = 3;
    turn.folder = (folder / "turn").string();
    turn.mesh_pattern = (folder / "turn/mesh/%06d.obj").string();
    turn.sound = CaptureSound{write("turn.wav"), 0};
    for (const char* name : {"turn/mesh/000000.obj", "turn/mesh/000001.obj", "turn/mesh/000002.obj"}) write(name);
  }
  void TearDown() override { fs::remove_all(folder); }
  std::string write(const std::string& name) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << name;
    return (folder / name).string();
  }
  void touch(const std::string& name) const {
    fs::last_write_time(folder / name, fs::last_write_time(folder / name) + std::chrono::seconds(5));
  }
};

TEST_F(InputFiles, PlatesInFoldersOfTheirCamerasCount) {
  const uint64_t before = commonInputDigest(capture);
  EXPECT_EQ(commonInputDigest(capture), before);
  touch("background/cam00/000000.png");
  const uint64_t other_plate = commonInputDigest(capture);
  EXPECT_NE(other_plate, before);
  write("background/cam00/000001.png");
  const uint64_t two_plates = commonInputDigest(capture);
  EXPECT_NE(two_plates, other_plate);
  capture.background_folder = capture.cameras_folder = capture.folder;
  const uint64_t at_the_root = commonInputDigest(capture);
  write("turn/mesh/000003.obj");
  EXPECT_EQ(commonInputDigest(capture), at_the_root) << "what pieces write is no input";
}

TEST_F(InputFiles, MeshesCountWholeAndByFrames) {
  const CaptureSequence& turn = capture.sequences[0];
  const uint64_t all = meshDigest(turn), first = inputDigest(capture, turn, 0, 2),
                 last = inputDigest(capture, turn, 2, 3);
  touch("turn/mesh/000002.obj");
  EXPECT_NE(meshDigest(turn), all);
  EXPECT_EQ(inputDigest(capture, turn, 0, 2), first);
  EXPECT_NE(inputDigest(capture, turn, 2, 3), last);
}

TEST_F(InputFiles, SoundsCountByThemselves) {
  const uint64_t sounds = soundDigest(capture), common = commonInputDigest(capture);
  touch("turn.wav");
  EXPECT_NE(soundDigest(capture), sounds);
  EXPECT_EQ(commonInputDigest(capture), common);
  CaptureClass& steps = capture.classes.emplace_back();
  steps.footstep = CaptureSound{write("step.wav"), 0};
  EXPECT_NE(soundDigest(capture), sounds);
}

}  // namespace
}  // namespace fourdvt::capture
