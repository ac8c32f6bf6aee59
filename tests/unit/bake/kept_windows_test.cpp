// SPDX-License-Identifier: Apache-2.0
#include "bake/run/kept_windows.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "platform/files.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

TEST(KeptWindows, AreFoundByTheirFramesUntilTheyAreRemoved) {
  const std::string folder = testing::TempDir() + "/fourdvt_kept_windows";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const KeptWindows walk(folder + "/labels_walk_12.bin"), run(folder + "/labels_walk_123.bin");
  const LabelKeeper keeper = walk.keeper(), other = run.keeper();
  const std::vector<uint8_t> bytes{3, 1, 4, 255};
  ASSERT_TRUE(keeper.keep(0, 8, bytes).ok());
  ASSERT_TRUE(other.keep(0, 8, {7}).ok());
  EXPECT_EQ(keeper.find(0, 8), bytes);
  EXPECT_TRUE(keeper.find(0, 9).empty());
  EXPECT_TRUE(keeper.find(8, 16).empty());
  EXPECT_EQ(KeptWindows(folder + "/labels_walk_12.bin").keeper().find(0, 8), bytes) << "by another run";

  const std::string file = folder + "/labels_walk_12.bin.window-0-7";
  auto damaged = platform::readFile(file).take();
  damaged[1] ^= 1;
  ASSERT_TRUE(platform::writeFileAtomic(file, damaged).ok());
  EXPECT_TRUE(keeper.find(0, 8).empty());

  walk.remove();
  EXPECT_FALSE(fs::exists(file));
  EXPECT_EQ(other.find(0, 8), std::vector<uint8_t>{7});
  fs::remove_all(folder);
  EXPECT_EQ(keeper.keep(0, 8, bytes).error().id, ErrorId::WriteFailed) << "without its folder";
}

}  // namespace
}  // namespace fourdvt::bake
