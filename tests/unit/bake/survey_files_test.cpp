// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>

#include "bake/stages/survey.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

TEST(SurveyFiles, StatisticsRoundTripAndRefuseOtherLengths) {
  LabelStatistics in;
  in.frames = 7;
  in.seam_percent = {1, 2, 3};
  in.flip_percent = {4};
  in.camera_flip_percent = {0.5, 0.25};
  in.seen_seam_percent = {7, 8};
  in.seen_flip_percent = {9};
  in.mean_penalty = {0.125, 1};
  in.energy = 12345.5;
  in.seconds = 2;
  std::vector<uint8_t> bytes = store::bytesOf(in);
  LabelStatistics out;
  ASSERT_TRUE(store::readBytes(bytes, out));
  EXPECT_EQ(out.frames, 7u);
  EXPECT_EQ(out.seam_percent, in.seam_percent);
  EXPECT_EQ(out.flip_percent, in.flip_percent);
  EXPECT_EQ(out.camera_seam_percent, in.camera_seam_percent);
  EXPECT_EQ(out.camera_flip_percent, in.camera_flip_percent);
  EXPECT_EQ(out.seen_seam_percent, in.seen_seam_percent);
  EXPECT_EQ(out.seen_flip_percent, in.seen_flip_percent);
  EXPECT_EQ(out.mean_penalty, in.mean_penalty);
  EXPECT_EQ(out.energy, in.energy);
  EXPECT_EQ(out.seconds, in.seconds);
  for (size_t n = 0; n < bytes.size(); ++n) {
    LabelStatistics part;
    EXPECT_FALSE(store::readBytes(std::span(bytes).first(n), part)) << n;
  }
  bytes.push_back(0);
  EXPECT_FALSE(store::readBytes(bytes, out));
}

TEST(SurveyFiles, WindowsAreFoundByTheirFramesUntilTheyAreRemoved) {
  const std::string folder = testing::TempDir() + "/fourdvt_kept_windows";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::string walk = folder + "/labels_walk_12.bin";
  const LabelKeeper keeper = windowKeeper(walk), other = windowKeeper(folder + "/labels_walk_123.bin");
  const std::vector<uint8_t> bytes{3, 1, 4, 255};
  ASSERT_TRUE(keeper.keep(0, 8, bytes).ok());
  ASSERT_TRUE(other.keep(0, 8, {7}).ok());
  EXPECT_EQ(keeper.find(0, 8), bytes);
  EXPECT_TRUE(keeper.find(0, 9).empty());
  EXPECT_TRUE(keeper.find(8, 16).empty());
  EXPECT_EQ(windowKeeper(walk).find(0, 8), bytes) << "by another run";

  const std::string file = walk + ".window-0-7";
  auto damaged = platform::readFile(file).take();
  damaged[1] ^= 1;
  ASSERT_TRUE(platform::writeFileAtomic(file, damaged).ok());
  EXPECT_TRUE(keeper.find(0, 8).empty());

  removeWindows(walk);
  EXPECT_FALSE(fs::exists(file));
  EXPECT_EQ(other.find(0, 8), std::vector<uint8_t>{7});
  fs::remove_all(folder);
  EXPECT_EQ(keeper.keep(0, 8, bytes).error().id, ErrorId::WriteFailed) << "without its folder";
}

TEST(SurveyFiles, PathsDifferByKey) {
  EXPECT_NE(store::keyedPath("f", "a", "1"), store::keyedPath("f", "a", "2"));
  EXPECT_EQ(store::keyedPath("f", "a", "1").rfind("f/a_", 0), 0u);
  const std::string long_name(300, 'x');
  EXPECT_NE(store::keyedPath("f", long_name, "1"), store::keyedPath("f", long_name, "2"));
}

}  // namespace
}  // namespace fourdvt::bake
