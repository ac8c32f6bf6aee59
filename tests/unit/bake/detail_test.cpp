// SPDX-License-Identifier: Apache-2.0
// Fine detail over the frames of a GOP: noise falls and contrast grows where the frames agree; detail of a frame's own
// stays where they do not.
#include "bake/texels/detail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fourdvt::bake {
namespace {

constexpr int kSide = 512, kFrames = 12;

// Diagonal stripes of a period of 4 texels, moved by `shift` texels, of this contrast, with noise.
Image stripes(int shift, int contrast, double noise, uint32_t seed) {
  std::mt19937 random(seed);
  Image out(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const double spread = noise * (double(random()) / 4294967296.0 - 0.5) * std::sqrt(12.0);
        out.at(x, y)[c] = uint8_t(128 + ((x + y + shift) % 4 < 2 ? contrast : -contrast) + std::lround(spread));
      }
  return out;
}

// Covariance of both pictures' first channels around 128, without the border.
double product(const Image& a, const Image& b) {
  double sum = 0;
  int count = 0;
  for (int y = 8; y < kSide - 8; ++y)
    for (int x = 8; x < kSide - 8; ++x, ++count) sum += (a.at(x, y)[0] - 128.0) * (b.at(x, y)[0] - 128.0);
  return sum / count;
}

TEST(DetailMean, LowersNoiseAndRaisesContrastWhereFramesAgree) {
  const Image clean = stripes(0, 20, 0, 0);
  DetailMean mean;
  std::vector<Image> frames;
  for (uint32_t f = 0; f < kFrames; ++f) mean.add(frames.emplace_back(stripes(0, 20, 6, f)));
  const Image out = mean.sharpened(frames[3]);
  const double gain = product(out, clean) / product(clean, clean);
  EXPECT_GT(gain, 1.3);
  EXPECT_LT(gain, 1.6);
  const double noise = product(out, out) - gain * gain * product(clean, clean);
  EXPECT_LT(std::sqrt(noise), 4) << "6 before; the low band keeps its noise";
}

TEST(DetailMean, KeepsAFramesOwnDetailWhereItDiffers) {
  DetailMean mean;
  for (uint32_t f = 0; f + 1 < kFrames; ++f) mean.add(stripes(0, 20, 0, f));
  const Image moved = stripes(2, 20, 0, 0);  // dark where the others are bright
  mean.add(moved);
  EXPECT_GT(product(mean.sharpened(moved), moved), 0.9 * product(moved, moved));
}

TEST(DetailMean, LeavesSmoothColoursAlone) {
  Image smooth(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) smooth.at(x, y)[0] = uint8_t(x / 4), smooth.at(x, y)[2] = 255;
  DetailMean mean;
  mean.add(smooth);
  mean.add(smooth);
  const Image out = mean.sharpened(smooth);
  for (size_t i = 0; i < out.pixels.size(); ++i) ASSERT_NEAR(out.pixels[i], smooth.pixels[i], 1) << i;
}

}  // namespace
}  // namespace fourdvt::bake
