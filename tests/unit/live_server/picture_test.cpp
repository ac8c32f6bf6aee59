// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "live/server/live_encoder.h"
#include "live/server/tile_painter.h"
#include "live_fixture.h"
#include "package/barcode.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::live {
namespace {

using package::CameraTile, package::Rect;

struct Yuv {
  double y, u, v;
};

// Converts to BT.709, limited range.
Yuv yuvOf(const uint8_t* rgb) {
  const double r = rgb[0] / 255.0, g = rgb[1] / 255.0, b = rgb[2] / 255.0;
  const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return {16 + 219 * y, 128 + 224 * (b - y) / 1.8556, 128 + 224 * (r - y) / 1.5748};
}

void expectColour(const I420View& view, int x, int y, const uint8_t* rgb, double tolerance, const char* where) {
  const Yuv wanted = yuvOf(rgb);
  EXPECT_NEAR(view.y[y * view.stride_y + x], wanted.y, tolerance) << where << " " << x << ", " << y;
  EXPECT_NEAR(view.u[y / 2 * view.stride_u + x / 2], wanted.u, tolerance) << where << " " << x << ", " << y;
  EXPECT_NEAR(view.v[y / 2 * view.stride_v + x / 2], wanted.v, tolerance) << where << " " << x << ", " << y;
}

Image flat(int width, int height, const uint8_t* rgb) {
  Image out(width, height, 3);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = rgb[i % 3];
  return out;
}

Ring16 ringRound(const Rect& r) {
  const auto at = [](int x, int y) { return Point16{uint16_t(16 * x), uint16_t(16 * y)}; };
  return {at(r.x, r.y), at(r.x, r.y + r.height), at(r.x + r.width, r.y + r.height), at(r.x + r.width, r.y)};
}

Ring16 holeAt(const Rect& r) {
  Ring16 out = ringRound(r);
  std::reverse(out.begin(), out.end());
  return out;
}

struct Painted {
  PackedSize size = packedSize(reconstruct::sixCameras(), 0.5).take();
  TilePainter painter{size};
  std::unique_ptr<JpegDecoder> decoder = JpegDecoder::create().take();

  void draw(const CameraTile& tile, const Image& rgb, const Rect& crop, const std::vector<Ring16>& rings) {
    auto planes = decoder->decode(jpegOf(rgb, 98), crop.width, crop.height);
    ASSERT_TRUE(planes.ok()) << planes.error().message;
    painter.draw(tile, planes.value(), crop, rings);
  }
};

TEST(TilePainter, KeepsColours) {
  const uint8_t colours[][3] = {{0, 0, 0},     {255, 255, 255}, {128, 128, 128}, {200, 120, 60}, {40, 90, 160},
                                {220, 30, 40}, {30, 200, 60},   {60, 60, 220},   {230, 220, 40}, {150, 60, 180}};
  for (const auto& rgb : colours)
    for (const int side : {64, 48}) {  // as large as the source, and smaller
      Painted painted;
      painted.draw({{32, 16, 64, 64}, {16, 32, side, side}}, flat(320, 240, rgb), {0, 0, 320, 240}, {});
      for (const int at : {0, side / 2, side - 1}) expectColour(painted.painter.view(), 16 + at, 32 + at, rgb, 2, "in");
    }
}

TEST(TilePainter, ContinuesThePerformerAndShowsNothingOfTheRoom) {
  Painted painted;
  const Rect performer{100, 80, 40, 60};
  Image picture = flat(320, 240, kRoomColour);
  for (int y = performer.y; y < performer.y + performer.height; ++y)
    for (int x = performer.x; x < performer.x + performer.width; ++x) std::copy_n(kBallColour, 3, picture.at(x, y));
  const std::vector<Ring16> rings = {ringRound({0, 0, 320, 240}), holeAt(performer)};
  const CameraTile tile{{84, 64, 72, 92}, {0, 0, 72, 92}};
  painted.draw(tile, picture, {0, 0, 320, 240}, rings);
  const I420View view = painted.painter.view();
  expectColour(view, 36, 46, kBallColour, 2, "in the performer");
  for (const glm::ivec2 at : {glm::ivec2(10, 46), {62, 46}, {36, 8}, {36, 84}, {15, 15}})
    expectColour(view, at.x, at.y, kBallColour, 12, "beside the performer");
  expectColour(view, 78, 46, kBallColour, 24, "in the cells beyond the tile");
  EXPECT_EQ(view.y[46 * view.stride_y + 82], 126) << "beyond the cells nothing is drawn";
}

TEST(TilePainter, FillsWhatTheCropDoesNotShow) {
  Painted painted;
  const CameraTile tile{{100, 80, 64, 64}, {64, 64, 64, 64}};
  painted.draw(tile, flat(32, 64, kBallColour), {100, 80, 32, 64}, {});
  expectColour(painted.painter.view(), 64 + 16, 64 + 32, kBallColour, 2, "shown");
  expectColour(painted.painter.view(), 64 + 40, 64 + 32, kBallColour, 12, "not shown");
}

TEST(TilePainter, ClearsForAnotherLayout) {
  Painted painted;
  painted.draw({{0, 0, 64, 64}, {0, 0, 64, 64}}, flat(320, 240, kBallColour), {0, 0, 320, 240}, {});
  painted.painter.clear();
  EXPECT_EQ(painted.painter.view().y[32 * painted.size.width + 32], 126);
}

TEST(JpegDecoder, RefusesWhatIsNoJpegOrOfAnotherSize) {
  auto decoder = JpegDecoder::create().take();
  const auto jpeg = jpegOf(flat(64, 48, kBallColour));
  EXPECT_FALSE(decoder->decode(jpeg, 48, 64).ok());
  EXPECT_FALSE(decoder->decode(std::vector<uint8_t>(100, 7), 64, 48).ok());
  EXPECT_FALSE(decoder->decode(std::span(jpeg).first(30), 64, 48).ok());
  EXPECT_TRUE(decoder->decode(jpeg, 64, 48).ok()) << "and goes on";
}

// Moving picture with a barcode.
struct Moving {
  PackedSize size = packedSize(reconstruct::sixCameras(), 0.5).take();
  std::vector<uint8_t> y = std::vector<uint8_t>(size_t(size.width) * size.height);
  std::vector<uint8_t> u = std::vector<uint8_t>(y.size() / 4, 90), v = std::vector<uint8_t>(y.size() / 4, 170);
  I420View at(uint32_t frame) {
    for (int row = 0; row < size.height; ++row)
      for (int x = 0; x < size.width; ++x)
        y[size_t(row) * size.width + x] = uint8_t(128 + 60 * std::sin(0.05 * x + 0.02 * row + 0.3 * frame));
    package::drawBarcode(size.barcode, frame, y.data(), size.width);
    return {size.width, size.height, y.data(), u.data(), v.data(), size.width, size.width / 2, size.width / 2};
  }
};

TEST(LiveEncoder, GivesEveryPictureAtOnceInOrderWithKeysOnDemand) {
  Moving moving;
  auto encoder = LiveEncoder::create({moving.size.width, moving.size.height, 25, 23}).take();
  const std::set<uint32_t> keys = {0, 7, 8, 30};
  std::vector<uint32_t> shown;
  std::vector<int64_t> times_us;
  auto decoder = platform::SampleDecoder::create(encoder->codec(), {}, [&](const I420View& picture, int64_t time_us) {
    times_us.push_back(time_us);
    shown.push_back(package::readBarcode(moving.size.barcode, picture).value_or(9999));
    double worst = 0, sum = 0;
    const I420View truth = moving.at(shown.back());
    for (int row = 0; row < moving.size.tiles.height; ++row)
      for (int x = 0; x < picture.width; ++x) {
        const double off =
            std::abs(int(picture.y[row * picture.stride_y + x]) - int(truth.y[row * truth.stride_y + x]));
        worst = std::max(worst, off), sum += off;
      }
    EXPECT_LT(sum / picture.width / moving.size.tiles.height, 2);
    EXPECT_NEAR(picture.u[1000], 90, 2);
    EXPECT_NEAR(picture.v[1000], 170, 2);
  });
  ASSERT_TRUE(decoder.ok());
  std::vector<uint32_t> wanted;
  for (uint32_t f = 0; f < 40; ++f) {
    if (f == 20) encoder->setCrf(30);
    const auto picture = encoder->encode(moving.at(f), keys.count(f) > 0);
    ASSERT_TRUE(picture.ok()) << picture.error().message;
    EXPECT_EQ(picture.value().key, keys.count(f) > 0) << f;
    ASSERT_TRUE(decoder.value()->decode(picture.value().sample, f * 40000, picture.value().key).ok());
    wanted.push_back(f);
  }
  ASSERT_TRUE(decoder.value()->flush().ok());
  EXPECT_EQ(shown, wanted);
  EXPECT_TRUE(std::is_sorted(times_us.begin(), times_us.end()));
}

// A viewer that joins at a key needs no earlier pictures.
TEST(LiveEncoder, AKeyDecodesWithoutWhatWasBefore) {
  Moving moving;
  auto encoder = LiveEncoder::create({moving.size.width, moving.size.height, 25, 23}).take();
  uint32_t shown = 9999;
  auto decoder = platform::SampleDecoder::create(encoder->codec(), {}, [&](const I420View& picture, int64_t) {
    shown = package::readBarcode(moving.size.barcode, picture).value_or(9999);
  });
  for (uint32_t f = 0; f < 5; ++f) ASSERT_TRUE(encoder->encode(moving.at(f), f == 0).ok());
  const auto key = encoder->encode(moving.at(5), true);
  ASSERT_TRUE(key.ok());
  ASSERT_TRUE(decoder.value()->decode(key.value().sample, 0, true).ok());
  ASSERT_TRUE(decoder.value()->flush().ok());
  EXPECT_EQ(shown, 5u);
}

TEST(LiveEncoder, ChangesTheCrfAtTheNextKey) {
  Moving moving;
  auto encoder = LiveEncoder::create({moving.size.width, moving.size.height, 25, 18}).take();
  const std::string codec = encoder->codec();
  EXPECT_EQ(codec.rfind("avc1.", 0), 0u);
  const size_t fine = encoder->encode(moving.at(0), true).value().sample.size();
  encoder->setCrf(40);
  const size_t coarse = encoder->encode(moving.at(1), true).value().sample.size();
  EXPECT_LT(coarse, fine);
  EXPECT_EQ(encoder->codec(), codec);
}

TEST(LiveEncoder, RefusesAPictureOfAnotherSize) {
  auto encoder = LiveEncoder::create({64, 64, 25, 23}).take();
  Moving moving;
  EXPECT_FALSE(encoder->encode(moving.at(0), true).ok());
}

}  // namespace
}  // namespace fourdvt::live
