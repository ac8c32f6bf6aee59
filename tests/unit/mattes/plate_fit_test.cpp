// SPDX-License-Identifier: Apache-2.0
// Plates fitted to pictures of another exposure, white balance or camera position, with the truth known.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "mattes/background_key.h"
#include "mattes/background_model.h"

using namespace fourdvt;
using namespace fourdvt::mattes;

namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr double kToe_levels = 0.055 * 255;

uint32_t hash(uint32_t x, uint32_t y, uint32_t z) {
  uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ z * 0xc2b2ae3du;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  return h ^ h >> 13;
}
double noise(uint32_t x, uint32_t y, uint32_t z) {  // variance 1
  return (hash(x, y, z) % 10000 / 10000.0 - 0.5) * std::sqrt(12.0);
}

// Level of a smooth, textured wall at any position in the picture.
double wall(double x, double y, int c) {
  return 120 + 50 * std::sin(x / 11 + c) * std::cos(y / 7) + 30 * std::sin((x + 2 * y) / 23) + 10 * c;
}

struct Change {
  double gain[3] = {1, 1, 1}, offset = 0;
  double dx = 0, dy = 0, turn = 0;  // picture → plate: pixels, radians
  double object = 0;                // share of the picture's width covered by an object
};

Image filmed(const Change& change, uint32_t take) {
  Image out(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        const double u = x * std::cos(change.turn) - y * std::sin(change.turn) + change.dx;
        const double v = x * std::sin(change.turn) + y * std::cos(change.turn) + change.dy;
        double level = (wall(u, v, c) + kToe_levels) * change.gain[c] + change.offset - kToe_levels;
        if (x > 60 && x < 60 + change.object * kWidth) level = hash(uint32_t(x / 4), uint32_t(y / 4), 9) % 200 + 20.0;
        level += noise(uint32_t(x), uint32_t(y), take * 3 + uint32_t(c));
        out.at(x, y)[c] = uint8_t(std::lround(std::clamp(level, 0.0, 255.0)));
      }
  return out;
}

BackgroundModel plates() {
  const std::vector<Image> all{filmed({}, 1), filmed({}, 2), filmed({}, 3), filmed({}, 4)};
  return makeBackgroundModel(all);
}

double meanError(const PlateFit& fit, const Image& picture, const Change& change) {
  double sum = 0;
  int count = 0;
  for (int y = 12; y < kHeight - 12; ++y)
    for (int x = 12; x < kWidth - 12; ++x) {
      if (x > 56 && x < 64 + change.object * kWidth) continue;
      for (int c = 0; c < 3; ++c, ++count)
        sum += std::abs(double(fit.background.mean[3 * (size_t(y) * kWidth + size_t(x)) + size_t(c)]) -
                        picture.at(x, y)[c]);
    }
  return sum / count;
}

TEST(CapturePlateFit, PlatesThatFitStayAsTheyAre) {
  const BackgroundModel model = plates();
  for (const double object : {0.0, 0.3}) {
    Change change;
    change.object = object;
    const PlateFit fit = fitPlate(model, filmed(change, 20));
    EXPECT_EQ(fit.background.mean, model.mean);
    EXPECT_EQ(fit.background.extra, model.extra);
    EXPECT_EQ(fit.shift_pixels, 0);
    EXPECT_EQ(fit.gain, (std::array<float, 3>{1, 1, 1}));
  }
}

TEST(CapturePlateFit, ExposureAndWhiteBalance) {
  Change change;
  change.gain[0] = 0.93, change.gain[1] = 1.04, change.gain[2] = 0.97;
  change.object = 0.3;
  const Image picture = filmed(change, 20);
  const PlateFit fit = fitPlate(plates(), picture);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(fit.gain[c], change.gain[c], 0.006) << c;
  EXPECT_LT(meanError(fit, picture, change), 1.2) << "noise alone has .9";
}

TEST(CapturePlateFit, ACameraThatWasMoved) {
  Change change;
  change.dx = 1.3, change.dy = -0.8, change.turn = 0.004, change.object = 0.25;
  const Image picture = filmed(change, 20);
  const PlateFit fit = fitPlate(plates(), picture);
  EXPECT_GT(fit.shift_pixels, 0.9f);
  EXPECT_LT(fit.shift_pixels, 2.5f);
  EXPECT_LT(meanError(fit, picture, change), 1.3);
}

TEST(CapturePlateFit, MovedAndExposedAnew) {
  Change change;
  change.dx = -0.9, change.dy = 1.1, change.offset = 4, change.object = 0.25;
  for (double& g : change.gain) g = 0.9;
  const Image picture = filmed(change, 20);
  const PlateFit fit = fitPlate(plates(), picture);
  EXPECT_LT(meanError(fit, picture, change), 1.3);
  EXPECT_LT(fit.residual_levels, 3.0f);
}

// Another room: no fit may make it look alike.
TEST(CapturePlateFit, AnotherRoomDoesNotFit) {
  Image other = filmed({}, 30);
  for (uint8_t& v : other.pixels) v = uint8_t(255 - v);
  const PlateFit fit = fitPlate(plates(), other);
  EXPECT_GT(fit.residual_levels, 15.0f);
}

// A constant wall without structure: no shift, no division by zero.
TEST(CapturePlateFit, APlainWallHasAGainAndNoShift) {
  const std::vector<Image> plain{Image(kWidth, kHeight, 3, 100)};
  const PlateFit fit = fitPlate(makeBackgroundModel(plain), Image(kWidth, kHeight, 3, 110));
  EXPECT_EQ(fit.shift_pixels, 0);
  EXPECT_NEAR(fit.background.mean[0], 110, 0.5);
  const std::vector<Image> black{Image(kWidth, kHeight, 3, 0)};
  EXPECT_EQ(fitPlate(makeBackgroundModel(black), Image(kWidth, kHeight, 3, 255)).gain[0], 1);
}

}  // namespace
