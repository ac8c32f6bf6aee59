// SPDX-License-Identifier: Apache-2.0
// Layout and colour conversion of the tiled picture.
#include "encode/tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "package/barcode.h"

namespace fourdvt::encode {
namespace {

bool overlap(const package::Rect& a, const package::Rect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

void expectInsideAndApart(bool equal_layers, int members) {
  for (int texture : {128, 256, 512, 1024, 1504}) {
    for (int layers = 1; layers <= 6; ++layers) {
      const TileLayout layout = makeTileLayout(layers, texture, equal_layers, members);
      EXPECT_EQ(layout.width % 16, 0);
      EXPECT_EQ(layout.height % 16, 0);
      std::vector<package::Rect> rects = layout.layers;
      ASSERT_EQ(int(rects.size()), layers * members);
      rects.push_back(layout.barcode.rect);
      for (size_t i = 0; i < rects.size(); ++i) {
        EXPECT_TRUE(rects[i].x >= 0 && rects[i].y >= 0 && rects[i].x + rects[i].width <= layout.width &&
                    rects[i].y + rects[i].height <= layout.height)
            << texture << " " << layers << " " << i;
        EXPECT_TRUE(rects[i].x % 2 == 0 && rects[i].y % 2 == 0);
        for (size_t j = 0; j < i; ++j) EXPECT_FALSE(overlap(rects[i], rects[j])) << i << " " << j;
      }
    }
  }
}

TEST(TileLayout, RectanglesLieInsideAndApart) {
  for (int members = 1; members <= package::kMaxMembers; ++members)
    for (bool equal_layers : {false, true}) expectInsideAndApart(equal_layers, members);
}

TEST(TileLayout, MembersAreStackedAsTheyAreAlone) {
  const TileLayout one = makeTileLayout(3, 1024), two = makeTileLayout(3, 1024, false, 2);
  EXPECT_EQ(two.width, 1536);
  EXPECT_EQ(two.height, 2064);
  for (int m = 0; m < 2; ++m)
    for (int l = 0; l < 3; ++l) {
      const package::Rect &alone = one.layers[l], &stacked = two.layers[3 * m + l];
      EXPECT_EQ(stacked.x, alone.x);
      EXPECT_EQ(stacked.y, alone.y + 1024 * m);
      EXPECT_EQ(stacked.width, alone.width);
    }
}

// Four members of 1024 in one column would be 4112 texels high.
TEST(TileLayout, MembersTakeASecondColumnRatherThanTooHighAPicture) {
  const TileLayout four = makeTileLayout(3, 1024, false, 4);
  EXPECT_EQ(four.width, 3072);
  EXPECT_EQ(four.height, 2064);
  EXPECT_EQ(checkTileLayout(3, 1024, false, 4), "");
  const std::string wrong = checkTileLayout(3, 2048, false, 2);
  EXPECT_NE(wrong.find("2 members of layers 3 with texture 2048"), std::string::npos) << wrong;
  EXPECT_NE(wrong.find("smaller texture"), std::string::npos) << wrong;
}

TEST(TileLayout, EqualLayersAreEqualAndOfTheFewestTexels) {
  for (int layers = 1; layers <= 6; ++layers)
    for (const package::Rect& rect : makeTileLayout(layers, 512, true).layers) {
      EXPECT_EQ(rect.width, 512);
      EXPECT_EQ(rect.height, 512);
    }
  const TileLayout three = makeTileLayout(3, 1024, true), five = makeTileLayout(5, 1024, true);
  EXPECT_EQ(three.width * three.height, 1024 * (3 * 1024 + 16)) << "one column, the barcode below";
  EXPECT_EQ(five.width * five.height, 6 * 1024 * 1024) << "the barcode has the sixth cell";
}

// The largest picture that readers accept holds three equal layers of 2048² with the barcode in the fourth cell.
TEST(TileLayout, EqualLayersOf2048FitExactly) {
  const TileLayout layout = makeTileLayout(3, 2048, true);
  EXPECT_EQ(layout.width, 4096);
  EXPECT_EQ(layout.height, 4096);
  EXPECT_EQ(checkTileLayout(3, 2048, true), "");
  EXPECT_EQ(checkTileLayout(3, 2048, false), "");
  EXPECT_NE(checkTileLayout(4, 2048, true).find("4096 x 4112, more than 4096"), std::string::npos);
  EXPECT_NE(checkTileLayout(4, 2048, true).find("smaller texture"), std::string::npos);
}

TEST(TileLayout, DefaultIs1536By1040) {
  const TileLayout layout = makeTileLayout(3, 1024);
  EXPECT_EQ(layout.width, 1536);
  EXPECT_EQ(layout.height, 1040);
}

struct Yuv {
  double y, u, v;
};

Yuv bt709(double r, double g, double b) {
  const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return {16 + 219 * y / 255, 128 + 224 * (b - y) / 1.8556 / 255, 128 + 224 * (r - y) / 1.5748 / 255};
}

TEST(DrawLayer, MatchesBt709InDoublePrecision) {
  std::mt19937 random(7);
  Image layer(64, 64, 4, 255);
  for (uint8_t& value : layer.pixels) value = static_cast<uint8_t>(random());
  for (int c = 0; c < 3; ++c) layer.at(0, 0)[c] = 255, layer.at(1, 0)[c] = 0;
  I420Picture picture(128, 96);
  drawLayer(layer, {32, 16, 64, 64}, picture);
  for (int y = 0; y < 64; y += 2) {
    for (int x = 0; x < 64; x += 2) {
      double sum[3] = {0, 0, 0};
      for (int k = 0; k < 4; ++k) {
        const uint8_t* p = layer.at(x + k % 2, y + k / 2);
        const double luma = picture.y[(16 + y + k / 2) * 128 + 32 + x + k % 2];
        ASSERT_NEAR(luma, bt709(p[0], p[1], p[2]).y, 0.501);
        for (int c = 0; c < 3; ++c) sum[c] += p[c] / 4.0;
      }
      const Yuv expected = bt709(sum[0], sum[1], sum[2]);
      const size_t at = (8 + y / 2) * 64 + 16 + x / 2;
      ASSERT_NEAR(picture.u[at], expected.u, 0.501);
      ASSERT_NEAR(picture.v[at], expected.v, 0.501);
    }
  }
  EXPECT_EQ(picture.y[0], 126) << "outside the rectangle nothing changes";
}

TEST(DrawLayer, RoundTripsGrey) {
  Image layer(32, 32, 4, 255);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c) layer.at(x, y)[c] = static_cast<uint8_t>(8 * y);
  I420Picture picture(64, 64);
  drawLayer(layer, {16, 16, 32, 32}, picture);
  const Image back = rgbFromTile(picture.view(), {16, 16, 32, 32});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(back.at(x, y)[c], 8 * y, 1);
}

TEST(TileFrame, CarriesTheFrameIndex) {
  const TileLayout layout = makeTileLayout(2, 512);
  I420Picture picture(layout.width, layout.height);
  for (uint32_t frame : {0u, 1u, 27u, 4095u, 5000u}) {
    tileFrame(layout, {Image(512, 512, 4, 255), Image(256, 256, 4, 0)}, frame, picture);
    EXPECT_EQ(package::readBarcode(layout.barcode, picture.view()), frame % 4096);
  }
}

}  // namespace
}  // namespace fourdvt::encode
