// SPDX-License-Identifier: Apache-2.0
#include "live/server/tiles.h"

#include <gtest/gtest.h>

#include <random>

#include "encode/camera_layout.h"
#include "live/server/tile_painter.h"
#include "live_fixture.h"

namespace fourdvt::live {
namespace {

using package::CameraTile, package::Rect;

bool overlap(const Rect& a, const Rect& b) { return common(a, b).width > 0; }

struct TileStage {
  std::vector<PinholeCamera> cameras = reconstruct::sixCameras();
  std::vector<Rect> crops = std::vector<Rect>(6, Rect{0, 0, 320, 240});
  PackedSize size = packedSize(cameras, 0.5).take();
  LiveTiles tiles{cameras, size};
};

std::vector<Rect> randomBoxes(std::mt19937& random) {
  std::vector<Rect> out;
  const auto some = [&](int least, int most) { return std::uniform_int_distribution<int>(least, most)(random); };
  for (int c = 0; c < 6; ++c) {
    if (some(0, 9) == 0) {
      out.emplace_back();
      continue;
    }
    Rect r{some(0, 300), some(0, 220), 0, 0};
    r.width = some(1, 320 - r.x), r.height = some(1, 240 - r.y);
    out.push_back(r);
  }
  return out;
}

TEST(PackedSize, HasTheShareAndTheSidesThatReadersTake) {
  for (const double share : {0.05, 0.25, 0.5, 1.0})
    for (const int scale : {1, 2, 3}) {
      const auto cameras = reconstruct::sixCameras(320 * scale, 240 * scale);
      const auto size = packedSize(cameras, share);
      ASSERT_TRUE(size.ok());
      const PackedSize& s = size.value();
      EXPECT_EQ(s.width % 16, 0);
      EXPECT_EQ(s.height % 16, 0);
      EXPECT_GE(double(s.tiles.width) * s.tiles.height, share * 6 * 320 * 240 * scale * scale);
      EXPECT_EQ(s.barcode.rect.width, 32 * s.barcode.cell_size);
      EXPECT_LE(s.barcode.rect.x + s.barcode.rect.width, s.width);
      EXPECT_LE(s.barcode.rect.y + s.barcode.rect.height, s.height);
      EXPECT_FALSE(overlap(s.barcode.rect, s.tiles));
    }
  EXPECT_FALSE(packedSize(reconstruct::sixCameras(4000, 4000), 1).ok());
}

TEST(LiveTiles, NeverOverlapAndStayInside) {
  TileStage stage;
  std::mt19937 random(11);
  for (int run = 0; run < 300; ++run) {
    const std::vector<Rect> boxes = randomBoxes(random);
    stage.tiles.plan(boxes, stage.crops);
    const auto& tiles = stage.tiles.tiles();
    ASSERT_EQ(tiles.size(), 6u);
    for (size_t a = 0; a < 6; ++a) {
      ASSERT_EQ(tiles[a].empty(), boxes[a].width == 0);
      if (tiles[a].empty()) continue;
      const Rect cells = encode::cellsOf(tiles[a].tile);
      EXPECT_EQ(cells.x % 16, 0);
      EXPECT_EQ(cells.y % 16, 0);
      EXPECT_LE(cells.x + cells.width, stage.size.tiles.width);
      EXPECT_LE(cells.y + cells.height, stage.size.tiles.height);
      const Rect& s = tiles[a].source;
      EXPECT_TRUE(s.x >= 0 && s.y >= 0 && s.x + s.width <= 320 && s.y + s.height <= 240);
      EXPECT_EQ(common(s, boxes[a]).width, boxes[a].width);
      EXPECT_EQ(common(s, boxes[a]).height, boxes[a].height);
      for (size_t b = 0; b < a; ++b)
        EXPECT_FALSE(!tiles[b].empty() && overlap(cells, encode::cellsOf(tiles[b].tile))) << run;
    }
    EXPECT_FALSE(stage.tiles.wantsLayout(boxes, stage.crops));
  }
}

TEST(LiveTiles, SmallRegionsAreDrawnAsLargeAsTheyAre) {
  TileStage stage;
  stage.tiles.plan(std::vector<Rect>(6, Rect{100, 50, 80, 140}), stage.crops);
  EXPECT_EQ(stage.tiles.scale(), 1);
  for (const CameraTile& t : stage.tiles.tiles()) {
    EXPECT_EQ(t.tile.width, t.source.width);
    EXPECT_EQ(t.tile.height, t.source.height);
  }
  stage.tiles.plan(std::vector<Rect>(6, Rect{0, 0, 320, 240}), stage.crops);
  EXPECT_LT(stage.tiles.scale(), 0.75);
  EXPECT_GT(stage.tiles.scale(), 0.5);
}

TEST(LiveTiles, WantsALayoutWhenThePerformerLeaves) {
  TileStage stage;
  std::vector<Rect> boxes(6, Rect{100, 50, 80, 140});
  EXPECT_TRUE(stage.tiles.wantsLayout(boxes, stage.crops)) << "there is none";
  stage.tiles.plan(boxes, stage.crops);
  const auto planned = stage.tiles.tiles();
  boxes[3].x += 10;
  EXPECT_FALSE(stage.tiles.wantsLayout(boxes, stage.crops));
  EXPECT_EQ(stage.tiles.tiles()[3].source.x, planned[3].source.x) << "stays from key to key";
  boxes[3].x += 20;
  EXPECT_TRUE(stage.tiles.wantsLayout(boxes, stage.crops));
  stage.crops[3] = planned[3].source;
  EXPECT_FALSE(stage.tiles.wantsLayout(boxes, stage.crops)) << "the crop shows no more";
}

TEST(LiveTiles, KeepsToTheCropThatCame) {
  TileStage stage;
  stage.crops[2] = {96, 40, 60, 100};
  stage.crops[4] = {};
  stage.tiles.plan(std::vector<Rect>(6, Rect{100, 50, 80, 140}), stage.crops);
  const Rect& source = stage.tiles.tiles()[2].source;
  EXPECT_EQ(common(source, stage.crops[2]).width, source.width);
  EXPECT_TRUE(stage.tiles.tiles()[4].empty());
}

TEST(ProjectedBox, HoldsAllPointsInFrontOfTheCamera) {
  const PinholeCamera camera = reconstruct::sixCameras()[0];
  const Rect box = projectedBox(camera, {{0, 0, 0}, {0.1f, 0.1f, 0}});
  for (const glm::vec3 p : {glm::vec3(0), glm::vec3(0.1f, 0.1f, 0)}) {
    const glm::dvec3 at = camera.project(glm::dvec3(p));
    EXPECT_TRUE(at.x >= box.x && at.x <= box.x + box.width && at.y >= box.y && at.y <= box.y + box.height);
  }
  const glm::vec3 behind(camera.centreInWorld() - camera.forwardInWorld());
  EXPECT_EQ(projectedBox(camera, {behind}).width, 0);
  EXPECT_EQ(projectedBox(camera, {}).width, 0);
}

TEST(CameraRegions, FollowThePerformerWithRoomToSpare) {
  const auto cameras = reconstruct::sixCameras();
  CameraRegions regions(cameras);
  for (size_t c = 0; c < 6; ++c) EXPECT_EQ(regions.region(c).width, 0) << "all, at first";
  int changes = 0;
  for (int f = 0; f < 100; ++f) {
    const Rect box{60 + f, 70, 60, 100};
    const auto changed = regions.update(std::vector<Rect>(6, box), f * 40'000);
    changes += changed[0];
    const Rect least = padded(box, 0.15, 0, {0, 0, 320, 240});
    EXPECT_EQ(common(regions.region(0), least).width, least.width) << f;
    EXPECT_EQ(common(regions.region(0), least).height, least.height) << f;
  }
  EXPECT_LT(changes, 20);
  EXPECT_LT(regions.region(0).width * regions.region(0).height, 320 * 240);
  EXPECT_FALSE(regions.update({}, 4'100'000)[0]) << "nobody for a moment";
  EXPECT_TRUE(regions.update({}, 5'100'000)[0]);
  EXPECT_EQ(regions.region(0).width, 0);
  EXPECT_FALSE(regions.update({}, 6'100'000)[0]);
}

}  // namespace
}  // namespace fourdvt::live
