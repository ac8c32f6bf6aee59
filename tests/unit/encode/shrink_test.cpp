// SPDX-License-Identifier: Apache-2.0
// Smaller layers: constants and means are preserved, a step moves by area, neighbours in a tiled picture do not bleed
// in.
#include <gtest/gtest.h>

#include <random>

#include "encode/tile.h"

using namespace fourdvt;
using namespace fourdvt::encode;

namespace {

Image constant(int width, int height, uint8_t r, uint8_t g, uint8_t b, int channels = 3) {
  Image out(width, height, channels, 255);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      uint8_t* p = out.at(x, y);
      p[0] = r, p[1] = g, p[2] = b;
    }
  return out;
}

double meanOf(const Image& image, int channel) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) sum += image.at(x, y)[channel];
  return sum / (double(image.width) * image.height);
}

}  // namespace

TEST(Shrink, ConstantsStayConstant) {
  for (const auto& [from, to] : {std::pair{1024, 384}, {128, 64}, {512, 512}, {160, 96}, {96, 64}}) {
    for (int channels : {3, 4}) {
      const Image small = shrunk(constant(from, from / 2, 255, 7, 128, channels), to, to / 2);
      ASSERT_EQ(small.width, to);
      ASSERT_EQ(small.height, to / 2);
      ASSERT_EQ(small.channels, 3);
      EXPECT_EQ(small.pixels, constant(to, to / 2, 255, 7, 128).pixels) << from << " to " << to;
    }
  }
}

TEST(Shrink, KeepsTheMean) {
  std::mt19937 random(7);
  Image noise(160, 160, 3);
  for (uint8_t& level : noise.pixels) level = uint8_t(random());
  const Image small = shrunk(noise, 96, 64);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(meanOf(small, c), meanOf(noise, c), 0.05) << "rounding";
}

// 8 texels to 3: texel 1 covers 2 2/3 to 5 1/3.
TEST(Shrink, AStepCountsByItsArea) {
  Image step(8, 8, 3);
  for (int y = 0; y < 8; ++y)
    for (int x = 4; x < 8; ++x)
      for (int c = 0; c < 3; ++c) step.at(x, y)[c] = 240;
  const Image small = shrunk(step, 3, 3);
  for (int y = 0; y < 3; ++y) {
    EXPECT_EQ(small.at(0, y)[0], 0);
    EXPECT_EQ(small.at(1, y)[1], 120);
    EXPECT_EQ(small.at(2, y)[2], 240);
  }
}

TEST(Shrink, TheSameSizeIsTheSamePicture) {
  Image picture(6, 4, 3);
  for (size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] = uint8_t(i * 37);
  EXPECT_EQ(shrunk(picture, 6, 4).pixels, picture.pixels);
}

// Black and white squares side by side: luma and chroma of each stay pure up to its edge.
TEST(Shrink, SquaresOfATiledPictureDoNotMix) {
  const TileLayout layout = makeTileLayout(3, 96);
  const Image black = constant(256, 256, 0, 0, 0), white = constant(128, 128, 255, 255, 255),
              red = constant(128, 128, 255, 0, 0);
  I420Picture picture(layout.width, layout.height), alone(layout.width, layout.height);
  tileShrunk(layout.layers, {&black, &white, &red}, layout.barcode, 5, picture);
  const std::vector<Image> exact = {constant(96, 96, 0, 0, 0), constant(48, 48, 255, 255, 255),
                                    constant(48, 48, 255, 0, 0)};
  tileFrame(layout, exact, 5, alone);
  EXPECT_EQ(picture.y, alone.y);
  EXPECT_EQ(picture.u, alone.u);
  EXPECT_EQ(picture.v, alone.v);
}
