// SPDX-License-Identifier: Apache-2.0
#include "capture_fixture.h"
#include "mattes/plate_key.h"

namespace fourdvt::mattes {

using namespace capture;

namespace {

void paint(Image& image, int x0, int y0, int x1, int y1, std::initializer_list<uint8_t> colour) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) std::copy(colour.begin(), colour.end(), image.at(x, y));
  }
}

Image greenPlate() {
  Image plate(48, 48, 3);
  paint(plate, 0, 0, 48, 48, {40, 160, 60});
  return plate;
}

TEST(CaptureMatte, KeysColoursAgainstThePlate) {
  const Image plate = greenPlate();
  for (auto colour : {std::initializer_list<uint8_t>{200, 170, 150}, {20, 20, 20}, {250, 250, 250}, {40, 60, 160}}) {
    Image picture = plate;
    paint(picture, 10, 12, 30, 40, colour);
    const Image alpha = chromaKey(picture, plate);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        const bool corner = (x == 10 || x == 29) && (y == 12 || y == 39);
        const bool inside = x >= 10 && x < 30 && y >= 12 && y < 40;
        if (corner) continue;  // rounded by the clean-up
        ASSERT_EQ(*alpha.at(x, y), inside ? 255 : 0) << x << "," << y;
      }
    }
  }
}

TEST(CaptureMatte, ShadeAndNoiseOfTheBackdropStayBackground) {
  const Image plate = greenPlate();
  Image picture = plate;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    picture.pixels[i] = static_cast<uint8_t>(picture.pixels[i] + static_cast<int>(i * 7919 % 9) - 4);
  }
  paint(picture, 5, 5, 20, 20, {36, 146, 55});  // 9 % darker
  const Image alpha = chromaKey(picture, plate);
  for (uint8_t a : alpha.pixels) ASSERT_EQ(a, 0);
}

TEST(CaptureMatte, RampIsSoftAndSpecksGo) {
  const Image plate = greenPlate();
  Image picture = plate;
  paint(picture, 10, 10, 40, 40, {180, 60, 160});
  paint(picture, 20, 20, 21, 21, {40, 160, 60});  // pinhole
  paint(picture, 3, 3, 4, 4, {180, 60, 160});     // speck
  paint(picture, 38, 10, 40, 40, {55, 149, 71});  // a mixed rim
  const Image alpha = chromaKey(picture, plate);
  EXPECT_EQ(*alpha.at(20, 20), 255);
  EXPECT_EQ(*alpha.at(3, 3), 0);
  EXPECT_GT(*alpha.at(38, 25), 0);
  EXPECT_LT(*alpha.at(38, 25), 255);
}

// Compares with the sample's own mattes.
TEST(CaptureMatte, AgreesWithTheSamplesMattes) {
  for (const char* name : {"00", "03", "06"}) {
    auto video = platform::openVideoFile(kSample + "/walk/cam" + name + ".mp4", 3);
    auto mattes = platform::openVideoFile(kSample + "/walk/mask" + name + ".mkv", 1);
    auto plate = platform::readImage(kSample + "/background/cam" + name + ".png");
    ASSERT_TRUE(video.ok() && mattes.ok() && plate.ok());
    const Image picture = *video.value()->next().value(), truth = *mattes.value()->next().value();
    const Image alpha = chromaKey(picture, plate.value());
    size_t both = 0, either = 0;
    for (size_t i = 0; i < alpha.pixels.size(); ++i) {
      const bool a = alpha.pixels[i] >= 128, b = truth.pixels[i] >= 128;
      both += a && b;
      either += a || b;
    }
    const double iou = static_cast<double>(both) / static_cast<double>(either);
    std::printf("chroma key, camera %s: IoU %.4f\n", name, iou);
    EXPECT_GT(iou, 0.97) << name;
  }
}

}  // namespace
}  // namespace fourdvt::mattes
