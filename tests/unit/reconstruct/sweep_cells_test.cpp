// SPDX-License-Identifier: Apache-2.0
// Cells of a plane sweep are closed only where every point of them is before a camera's background.
#include "reconstruct/stereo/sweep_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace fourdvt::reconstruct {
namespace {

constexpr int kMatteSide = 64, kBlocks = 6, kFirstPlane = 100;
constexpr double kStep_m = 0.01, kFocal = 60;

// Alpha 255 in the columns from `first` on, `beside` before them.
Image matte(int first, uint8_t beside) {
  Image out(kMatteSide, kMatteSide, 4, 255);
  for (int y = 0; y < kMatteSide; ++y)
    for (int x = 0; x < first; ++x) out.at(x, y)[3] = beside;
  return out;
}

TEST(SweepCells, CountsOnlyBackgroundInsideThePicture) {
  const MatteCounts counts(matte(32, 88), 89);
  EXPECT_TRUE(counts.onlyBackground({4, 4}, {29, 60}));
  EXPECT_FALSE(counts.onlyBackground({4, 4}, {31, 60})) << "the next pixel's centre is at 32.5";
  EXPECT_FALSE(counts.onlyBackground({1, 4}, {20, 60})) << "may leave the picture";
  EXPECT_FALSE(MatteCounts(matte(32, 89), 89).onlyBackground({4, 4}, {20, 60}));
}

// A camera beside the reference, which sees a point at depth z moved by kFocal · 0.3 m / z pixels.
TEST(SweepCells, ClosedCellsLieBeforeTheBackground) {
  const Image picture = matte(32, 0);
  const MatteCounts counts(picture, 89);
  SweptCamera camera{glm::dmat4(1.0), &counts};
  camera.pixel_from_reference = glm::dmat4(0.0);
  for (int k = 0; k < 3; ++k) camera.pixel_from_reference[k][k] = 1;
  camera.pixel_from_reference[3][0] = kFocal * 0.3;
  const PictureRegion region{.x = 2, .y = 20, .width = 30, .height = 10};
  std::vector<int> first_plane(size_t(region.width) * region.height, kFirstPlane);
  for (int y = 0; y < region.height; ++y) first_plane[size_t(y) * region.width + 29] = -1;
  const std::vector<uint8_t> open = openCells(std::span(&camera, 1), region, first_plane, kBlocks, kStep_m);
  const int across = 8, down = 3;
  ASSERT_EQ(open.size(), size_t(across * down * kBlocks));
  int closed = 0;
  for (int b = 0; b < kBlocks; ++b)
    for (int y = 0; y < region.height; ++y)
      for (int x = 0; x < region.width - 1; ++x) {
        if (open[size_t((b * down + y / kSweepCell) * across + x / kSweepCell)]) continue;
        ++closed;
        for (int k = 0; k < 4; ++k)
          EXPECT_LT(region.x + x + 0.5 + kFocal * 0.3 / ((kFirstPlane + 4 * b + k) * kStep_m), 31.5);
      }
  EXPECT_GT(closed, 0);
  EXPECT_TRUE(std::any_of(open.begin(), open.end(), [](uint8_t cell) { return cell == 255; }));
}

TEST(SweepCells, AreClosedWithoutAFront) {
  const Image picture = matte(0, 0);
  const MatteCounts counts(picture, 89);
  const SweptCamera camera{glm::dmat4(1.0), &counts};
  const std::vector<int> none(16, -1), some(16, kFirstPlane);
  const PictureRegion region{.x = 8, .y = 8, .width = 4, .height = 4};
  EXPECT_EQ(openCells(std::span(&camera, 1), region, none, 1, kStep_m), std::vector<uint8_t>{0});
  EXPECT_EQ(openCells(std::span(&camera, 1), region, some, 1, kStep_m), std::vector<uint8_t>{255});
}

}  // namespace
}  // namespace fourdvt::reconstruct
