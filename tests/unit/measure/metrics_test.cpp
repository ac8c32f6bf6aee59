// SPDX-License-Identifier: Apache-2.0
#include "measure/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fourdvt::measure {
namespace {

Image noise(int width, int height, uint32_t seed, int low = 0, int high = 255) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> value(low, high);
  Image image(width, height, 3);
  for (uint8_t& p : image.pixels) p = static_cast<uint8_t>(value(random));
  return image;
}

Mask everywhere(const Image& image) { return Mask(static_cast<size_t>(image.width) * image.height, 1); }

// SSIM at one pixel straight from its definition (WBSS04 Eq. 13, weights summing to 1), two-pass variances.
double referenceSsimAt(const Image& a, const Image& b, int cx, int cy) {
  double weights[11][11], total = 0;
  for (int j = 0; j < 11; ++j)
    for (int i = 0; i < 11; ++i) total += weights[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / 4.5);
  auto y = [](const Image& m, int px, int py) {
    const uint8_t* p = m.at(px, py);
    return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
  };
  double mx = 0, my = 0, vx = 0, vy = 0, cov = 0;
  for (int j = 0; j < 11; ++j)
    for (int i = 0; i < 11; ++i) {
      mx += weights[j][i] / total * y(a, cx + i - 5, cy + j - 5);
      my += weights[j][i] / total * y(b, cx + i - 5, cy + j - 5);
    }
  for (int j = 0; j < 11; ++j)
    for (int i = 0; i < 11; ++i) {
      const double dx = y(a, cx + i - 5, cy + j - 5) - mx, dy = y(b, cx + i - 5, cy + j - 5) - my;
      vx += weights[j][i] / total * dx * dx;
      vy += weights[j][i] / total * dy * dy;
      cov += weights[j][i] / total * dx * dy;
    }
  const double c1 = 6.5025, c2 = 58.5225;
  return (2 * mx * my + c1) * (2 * cov + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
}

TEST(Psnr, ConstantOffsetHasClosedForm) {
  const Image a(20, 10, 3, 100), b(20, 10, 3, 105);
  EXPECT_NEAR(psnr(a, b, everywhere(a)), 20 * std::log10(255.0 / 5), 1e-12);
}

TEST(Psnr, CountsOnlyTheRegion) {
  Image a(8, 8, 3, 50), b(8, 8, 3, 50);
  b.at(1, 1)[0] = 60;   // inside
  b.at(6, 6)[0] = 255;  // outside
  Mask inside(64, 0);
  inside[1 * 8 + 1] = inside[1 * 8 + 2] = 1;
  EXPECT_NEAR(psnr(a, b, inside), 10 * std::log10(255.0 * 255.0 / (100.0 / 6)), 1e-12);
}

TEST(Psnr, EqualIsInfiniteAndEmptyIsNotANumber) {
  const Image a = noise(9, 9, 1);
  EXPECT_TRUE(std::isinf(psnr(a, a, everywhere(a))));
  EXPECT_TRUE(std::isnan(psnr(a, a, Mask(81, 0))));
}

TEST(Ssim, OfIdenticalPicturesIsOne) {
  const Image a = noise(40, 30, 2);
  EXPECT_NEAR(ssim(a, a, everywhere(a)), 1.0, 1e-9);
}

TEST(Ssim, OfConstantPicturesIsTheLuminanceTerm) {
  const Image a(24, 24, 3, 90), b(24, 24, 3, 120);
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(ssim(a, b, everywhere(a)), (2 * 90.0 * 120 + c1) / (90.0 * 90 + 120.0 * 120 + c1), 1e-9);
}

TEST(Ssim, AgreesWithTheDefinitionAtEveryPixel) {
  const Image a = noise(37, 29, 3), other = noise(37, 29, 4);
  Image b = a;
  for (size_t i = 0; i < b.pixels.size(); ++i)
    b.pixels[i] = static_cast<uint8_t>((3 * a.pixels[i] + other.pixels[i]) / 4);
  const std::vector<double> map = ssimMap(a, b);
  double sum = 0;
  int count = 0;
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 37; ++x) {
      const bool valid = x >= 5 && y >= 5 && x < 32 && y < 24;
      ASSERT_EQ(std::isnan(map[y * 37 + x]), !valid);
      if (!valid) continue;
      const double expected = referenceSsimAt(a, b, x, y);
      ASSERT_NEAR(map[y * 37 + x], expected, 1e-9);
      sum += expected;
      ++count;
    }
  EXPECT_NEAR(ssim(a, b, everywhere(a)), sum / count, 1e-9);
}

TEST(Ssim, OutsideTheRegionDoesNotCount) {
  const Image a = noise(60, 20, 5);
  Image b = a;
  for (int y = 0; y < 20; ++y)
    for (int x = 40; x < 60; ++x) b.at(x, y)[1] = static_cast<uint8_t>(255 - b.at(x, y)[1]);
  Mask left(60 * 20, 0);
  for (int y = 0; y < 20; ++y) std::fill_n(left.begin() + y * 60, 34, 1);
  EXPECT_NEAR(ssim(a, b, left), 1.0, 1e-9);
  EXPECT_LT(ssim(a, b, everywhere(a)), 0.95);
}

TEST(Composite, MultipliesByAlphaAndUnitesSilhouettes) {
  Image a(2, 1, 4), b(2, 1, 4);
  a.at(0, 0)[0] = 200;
  a.at(0, 0)[3] = 128;
  b.at(1, 0)[3] = 127;
  EXPECT_EQ(compositedOnBlack(a).at(0, 0)[0], 100);
  EXPECT_EQ(unionOfSilhouettes(a, b), (Mask{1, 0}));
  EXPECT_EQ(commonSilhouette(a, b), (Mask{0, 0}));
}

}  // namespace
}  // namespace fourdvt::measure
