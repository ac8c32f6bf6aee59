// SPDX-License-Identifier: Apache-2.0
// The key against a natural background, on pictures with known mattes: a textured wall, an object with its own texture,
// a hard shadow, sensor noise.
#include "mattes/background_key.h"

#include <cmath>
#include <functional>

#include "capture_fixture.h"
#include "mattes/key_evidence.h"

namespace fourdvt::mattes {

using namespace capture;

namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr double kNoise = 0.02 * 255;

double random01(uint32_t x, uint32_t y, uint32_t z) {
  uint32_t h = x * 0x8da6b343u ^ y * 0xd8163841u ^ z * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return double((h ^ (h >> 15)) & 0xffffff) / 0x1000000;
}

double normal(uint32_t x, uint32_t y, uint32_t z) {
  double sum = 0;
  for (uint32_t k = 0; k < 12; ++k) sum += random01(x, y, 13 * z + k);
  return sum - 6;
}

uint8_t level(double v) { return static_cast<uint8_t>(std::lround(std::min(255.0, std::max(0.0, v)))); }

// Encoded sRGB level after multiplying linear light by `ratio`.
double scaled(double encoded, double ratio) {
  const double v = encoded / 255, linear = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  const double out = linear * ratio;
  return 255 * (out <= 0.0031308 ? 12.92 * out : 1.055 * std::pow(out, 1 / 2.4) - 0.055);
}

// Boards in different browns and greys, with grain.
void wall(int x, int y, double (&rgb)[3]) {
  const uint32_t board = uint32_t(x / 17), row = uint32_t((y + 31 * (board % 5)) / 53);
  const double grain = 14 * std::sin(0.9 * x + 7 * random01(board, row, 3)) + 9 * std::sin(0.21 * y + x);
  for (uint32_t c = 0; c < 3; ++c) {
    rgb[c] = 150 - 24.0 * c + 50 * (random01(board, row, 1) - 0.5) + 24 * (random01(board, row, 4 + c) - 0.5) + grain;
    if (x % 17 == 0) rgb[c] = 50;
  }
}

// A blue and red checked cloth.
void cloth(int x, int y, double (&rgb)[3]) {
  const bool check = (x / 7 + y / 9) % 2 == 0;
  rgb[0] = check ? 60 : 150;
  rgb[1] = check ? 90 : 60;
  rgb[2] = (check ? 150 : 70) + 10 * std::sin(0.7 * x);
}

struct Scene {
  std::function<double(double x, double y)> object = [](double, double) { return 0.0; };  // coverage, 0…1
  std::function<bool(int x, int y)> shadow = [](int, int) { return false; };
  double light = 0.35;  // factor of linear light in the shadow
  double noise = kNoise;
  double brightness = 1;  // of the wall, linear
  double texture = 1;     // contrast of the wall

  Image picture(uint32_t take) const {
    Image out(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        double behind[3], front[3];
        wall(x, y, behind);
        for (int c = 0; c < 3; ++c) behind[c] = 150 - 24.0 * c + texture * (behind[c] - 150 + 24.0 * c);
        cloth(x, y, front);
        const double share = object(x + 0.5, y + 0.5);
        for (uint32_t c = 0; c < 3; ++c) {
          const double lit = scaled(behind[c], brightness * (shadow(x, y) ? light : 1));
          out.at(x, y)[c] =
              level(lit + share * (front[c] - lit) + noise * normal(uint32_t(x), uint32_t(y), 3 * take + c));
        }
      }
    return out;
  }
  BackgroundModel model(uint32_t plates) const {
    Scene empty;
    empty.noise = noise;
    empty.brightness = brightness;
    empty.texture = texture;
    std::vector<Image> pictures;
    for (uint32_t k = 0; k < plates; ++k) pictures.push_back(empty.picture(100 + k));
    return makeBackgroundModel(pictures);
  }
  // Intersection over union of a matte and the object.
  double iou(const Image& alpha) const {
    size_t both = 0, either = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool a = *alpha.at(x, y) >= 128, b = object(x + 0.5, y + 0.5) >= 0.5;
        both += a && b;
        either += a || b;
      }
    return double(both) / double(either);
  }
};

// Coverage of a disc, with a ramp of one pixel at its outline.
std::function<double(double, double)> disc(double cx, double cy, double radius) {
  return [=](double x, double y) { return std::min(1.0, std::max(0.0, radius + 0.5 - std::hypot(x - cx, y - cy))); };
}

bool inShadow(int x, int y) { return y > 100 && y < 140 && x > 20 && x < 150; }

size_t kept(const Image& alpha, const std::function<bool(int, int)>& where) {
  size_t count = 0;
  for (int y = 0; y < alpha.height; ++y)
    for (int x = 0; x < alpha.width; ++x) count += where(x, y) && *alpha.at(x, y) >= 128;
  return count;
}

TEST(CaptureBackgroundKey, TellsTheObjectFromItsHardShadow) {
  Scene scene;
  scene.object = disc(110, 75, 42);
  scene.shadow = inShadow;
  const auto bare = [&](int x, int y) { return inShadow(x, y) && scene.object(x, y) == 0; };
  for (const uint32_t plates : {1u, 5u}) {
    const Image alpha = backgroundKey(scene.picture(0), scene.model(plates));
    std::printf("object before its shadow, %u plates: IoU %.4f\n", plates, scene.iou(alpha));
    EXPECT_GE(scene.iou(alpha), 0.97) << plates;
    EXPECT_LT(kept(alpha, bare), 20u) << plates;
  }
}

// An area as dark as the shadow, but without the boards' grain: an object.
TEST(CaptureBackgroundKey, AShadowKeepsTheTextureAndAnObjectDoesNot) {
  Scene scene;
  scene.shadow = inShadow;
  const Image shadow = scene.picture(0);
  Image object = shadow;
  for (int y = 101; y < 140; ++y)
    for (int x = 21; x < 150; ++x) {
      double other[3];
      wall(x + 64, y + 23, other);
      for (uint32_t c = 0; c < 3; ++c)
        object.at(x, y)[c] = level(scaled(other[c], 0.35) + kNoise * normal(uint32_t(x), uint32_t(y), c));
    }
  const BackgroundModel model = scene.model(3);
  EXPECT_LT(kept(backgroundKey(shadow, model), inShadow), 40u);
  EXPECT_GT(kept(backgroundKey(object, model), inShadow), 0.6 * 38 * 129);
}

// A cloth of the boards' hue, as dark as the shadow beside it, but with another texture, or none.
TEST(CaptureBackgroundKey, ADarkClothOfTheWallsHueIsNoShadow) {
  Scene scene;
  scene.shadow = [](int x, int y) { return y > 120 && x > 20; };
  scene.texture = 0.5;
  const auto cloth = [](int x, int y) { return x > 60 && x < 140 && y > 20 && y < 100; };
  for (const double contrast : {0.0, 0.3}) {
    Image picture = scene.picture(0);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (uint32_t c = 0; c < 3 && cloth(x, y); ++c) {
          const double light = 0.35 + contrast * (random01(uint32_t(x / 3), uint32_t(y / 3), 9) - 0.5);
          picture.at(x, y)[c] = level(scaled(150 - 24.0 * c, light) + kNoise * normal(uint32_t(x), uint32_t(y), c));
        }
    const BackgroundModel model = scene.model(5);
    const cv::Mat cost = KeyEvidence(picture, model, {}).cost();
    int mistaken = 0;
    for (int y = 26; y < 95; ++y)
      for (int x = 66; x < 135; ++x) mistaken += cost.at<float>(y, x) > 0;
    // Many of its pixels alone could be shadowed boards; the neighbours and the cut decide.
    EXPECT_LT(mistaken, (contrast > 0 ? 0.05 : 0.45) * 69 * 69) << contrast;
    const Image alpha = backgroundKey(picture, model);
    EXPECT_GT(kept(alpha, cloth), 0.95 * 79 * 79) << contrast;
    EXPECT_LT(kept(alpha, scene.shadow), 40u) << contrast;
  }
}

// A shadow has the same ratio on all colours: that of linear light, to the power of the sRGB curve.
TEST(CaptureBackgroundKey, AShadowHasOneRatio) {
  for (const double brightness : {1.0, 0.15}) {
    Scene scene;
    scene.brightness = brightness;
    scene.noise = 1;
    scene.shadow = inShadow;
    const Image picture = scene.picture(0);
    const BackgroundModel model = scene.model(5);
    EXPECT_LT(kept(backgroundKey(picture, model), [](int, int) { return true; }), 40u) << brightness;
    const cv::Mat ratio = KeyEvidence(picture, model, {}).ratio();
    double sum = 0;
    for (int y = 101; y < 140; ++y)
      for (int x = 21; x < 150; ++x) sum += ratio.at<float>(y, x) / (39.0 * 129);
    EXPECT_NEAR(sum, std::pow(0.35, 1 / 2.4), 0.01) << brightness;
  }
}

TEST(CaptureBackgroundKey, NothingInFrontIsAnEmptyMatte) {
  Scene scene;
  const BackgroundModel model = scene.model(1);
  EXPECT_EQ(kept(backgroundKey(scene.picture(0), model), [](int, int) { return true; }), 0u);
  scene.shadow = inShadow;
  scene.light = 1.3;  // a highlight
  EXPECT_EQ(kept(backgroundKey(scene.picture(0), model), [](int, int) { return true; }), 0u);
}

TEST(CaptureBackgroundKey, HolesStayAndSpecksGo) {
  Scene scene;
  const auto body = disc(100, 80, 45), hole = disc(100, 80, 9), speck = disc(20, 20, 1), pinhole = disc(80, 60, 1);
  scene.object = [&](double x, double y) { return std::max(speck(x, y), body(x, y) - hole(x, y) - pinhole(x, y)); };
  const Image alpha = backgroundKey(scene.picture(0), scene.model(1));
  const auto near = [](int cx, int cy, int r) {
    return [=](int x, int y) { return std::hypot(x + 0.5 - cx, y + 0.5 - cy) < r; };
  };
  EXPECT_LT(kept(alpha, near(100, 80, 7)), 5u);  // of 154
  EXPECT_EQ(kept(alpha, near(20, 20, 4)), 0u);
  EXPECT_EQ(kept(alpha, near(80, 60, 4)), kept(Image(kWidth, kHeight, 1, 255), near(80, 60, 4)));
}

// Without noise the ramp equals the mixture: the outline is known to a fraction of a pixel.
TEST(CaptureBackgroundKey, OutlineIsTheShareOfTheObject) {
  Scene scene;
  scene.noise = 0.3;
  scene.object = disc(100.3, 80.6, 40.25);
  const Image alpha = backgroundKey(scene.picture(0), scene.model(1));
  double difference = 0, area = 0, truth = 0;
  int soft = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double share = scene.object(x + 0.5, y + 0.5), got = *alpha.at(x, y) / 255.0;
      area += got;
      truth += share;
      if (share <= 0 || share >= 1) continue;
      difference += std::abs(got - share);
      ++soft;
    }
  EXPECT_LT(difference / soft, 0.12);  // a hard outline: 0.25
  EXPECT_NEAR(area, truth, 0.005 * truth);
}

// A curtain that moves between the plates is background in all its places.
TEST(CaptureBackgroundKey, SeveralPlatesSayWhatFlickers) {
  Scene scene;
  const auto moving = [&](uint32_t take) {
    Image out = scene.picture(take);
    for (int y = 20; y < 60; ++y)
      for (int x = 20; x < 70; ++x)
        for (int c = 0; c < 3; ++c) out.at(x, y)[c] = level(out.at(x, y)[c] + 30 * std::sin(0.4 * x + 2.1 * take));
    return out;
  };
  std::vector<Image> plates;
  for (uint32_t k = 0; k < 8; ++k) plates.push_back(moving(k + 1));
  const auto all = [](int, int) { return true; };
  EXPECT_LT(kept(backgroundKey(moving(0), makeBackgroundModel(plates)), all), 30u);
  plates.resize(1);
  EXPECT_GT(kept(backgroundKey(moving(0), makeBackgroundModel(plates)), all), 150u);
}

TEST(CaptureBackgroundKey, PlatesOfABackdropAreTold) {
  Image green(kWidth, kHeight, 3), blue = green, grey(kWidth, kHeight, 3, 128);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double light = 1.1 - 0.5 * y / kHeight;
      const bool stand = x < 40;  // a part of the picture only
      for (uint32_t c = 0; c < 3; ++c) {
        const double n = kNoise * normal(uint32_t(x), uint32_t(y), c);
        green.at(x, y)[c] = level(stand ? 90 + n : light * std::array{46, 168, 82}[c] + n);
        blue.at(x, y)[c] = level(light * std::array{30, 60, 170}[c] + n);
      }
    }
  EXPECT_TRUE(isChromaPlate(green));
  EXPECT_TRUE(isChromaPlate(blue));
  EXPECT_FALSE(isChromaPlate(grey));
  EXPECT_FALSE(isChromaPlate(Scene().picture(0)));
  // A green floor and bluish walls are a room, although saturated about equally everywhere.
  Image room(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (uint32_t c = 0; c < 3; ++c)
        room.at(x, y)[c] =
            (y > kHeight / 2 ? std::array<uint8_t, 3>{60, 145, 95} : std::array<uint8_t, 3>{60, 138, 110})[c];
  EXPECT_FALSE(isChromaPlate(room));
  for (int camera = 0; camera < 8; ++camera) {
    const auto plate = platform::readImage(kSample + "/background/cam0" + std::to_string(camera) + ".png");
    ASSERT_TRUE(plate);
    EXPECT_TRUE(isChromaPlate(plate.value())) << camera;
  }
}

}  // namespace
}  // namespace fourdvt::mattes
