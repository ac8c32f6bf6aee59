// SPDX-License-Identifier: Apache-2.0
#include "live/camera/outline_message.h"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "stage_fixture.h"

namespace fourdvt::live {
namespace {

using package::Rect;

Image discCoverage(int width, int height, const glm::dvec2& centre, double radius_px) {
  Image out(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      *out.at(x, y) = uint8_t(std::lround(255 * testing::discShare(x, y, centre, radius_px)));
  return out;
}

int64_t turn(const Point16& a, const Point16& b, const Point16& c) {
  return (int64_t(b.x) - a.x) * (int64_t(c.y) - a.y) - (int64_t(b.y) - a.y) * (int64_t(c.x) - a.x);
}

// True if two edges intersect or touch.
bool meet(const Point16& a, const Point16& b, const Point16& c, const Point16& d) {
  const auto sign = [](int64_t v) { return (v > 0) - (v < 0); };
  const int abc = sign(turn(a, b, c)), abd = sign(turn(a, b, d)), cda = sign(turn(c, d, a)), cdb = sign(turn(c, d, b));
  if (abc == 0 && abd == 0) {
    const auto between = [](int p, int q, int r) { return std::min(p, q) <= r && r <= std::max(p, q); };
    return (between(a.x, b.x, c.x) && between(a.y, b.y, c.y)) || (between(a.x, b.x, d.x) && between(a.y, b.y, d.y)) ||
           (between(c.x, d.x, a.x) && between(c.y, d.y, a.y));
  }
  return abc * abd <= 0 && cda * cdb <= 0;
}

// Expects that every ring has at least three distinct points, lies in the picture, and touches neither itself nor
// others.
void expectValid(const std::vector<Ring16>& rings, const Image& coverage) {
  EXPECT_LE(rings.size(), kMaxRings);
  std::vector<std::pair<Point16, Point16>> edges;
  std::vector<std::pair<size_t, size_t>> places;  // ring, number
  for (size_t r = 0; r < rings.size(); ++r) {
    ASSERT_GE(rings[r].size(), 3u);
    for (size_t i = 0; i < rings[r].size(); ++i) {
      const Point16 &p = rings[r][i], &q = rings[r][(i + 1) % rings[r].size()];
      EXPECT_FALSE(p == q);
      EXPECT_LE(p.x, coverage.width * kPointsPerPixel);
      EXPECT_LE(p.y, coverage.height * kPointsPerPixel);
      edges.emplace_back(p, q);
      places.emplace_back(r, i);
    }
  }
  EXPECT_LE(edges.size(), kMaxRingPoints);
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t j = i + 1; j < edges.size(); ++j) {
      const bool same = places[i].first == places[j].first;
      const size_t count = rings[places[i].first].size(), apart = places[j].second - places[i].second;
      if (same && (apart == 1 || apart + 1 == count)) continue;  // neighbours share a point
      ASSERT_FALSE(meet(edges[i].first, edges[i].second, edges[j].first, edges[j].second)) << i << " " << j;
    }
}

Image randomCoverage(int width, int height, uint32_t seed, int grain) {
  std::mt19937 random(seed);
  Image out(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      *out.at(x, y) = x % grain || y % grain ? *out.at(x - x % grain, y - y % grain) : uint8_t(random());
  return out;
}

TEST(Rings, AreAnEmptyStagesBorder) {
  const auto rings = ringsOf(Image(40, 30, 1), 1);
  ASSERT_EQ(rings.size(), 1u);
  expectValid(rings, Image(40, 30, 1));
  EXPECT_EQ(rings[0].size(), 4u);
  for (const Point16& p : rings[0]) {
    EXPECT_TRUE(p.x == 0 || p.x == 40 * 16) << p.x;
    EXPECT_TRUE(p.y == 0 || p.y == 30 * 16) << p.y;
  }
}

TEST(Rings, AreNoneWhereNoBackgroundIsSeen) { EXPECT_TRUE(ringsOf(Image(40, 30, 1, 255), 1).empty()); }

TEST(Rings, FollowADisc) {
  const glm::dvec2 centre(100.3, 80.6);
  const Image coverage = discCoverage(200, 160, centre, 50);
  for (const double tolerance_px : {0.0, 0.5, 2.0, 8.0}) {
    const auto rings = ringsOf(coverage, tolerance_px);
    ASSERT_EQ(rings.size(), 2u);
    expectValid(rings, coverage);
    const Ring16& round = rings[0][0].x == 0 || rings[0][1].x == 0 ? rings[1] : rings[0];
    double twice_area = 0;
    for (size_t i = 0; i < round.size(); ++i) {
      const glm::dvec2 p(round[i].x / 16.0, round[i].y / 16.0),
          next(round[(i + 1) % round.size()].x / 16.0, round[(i + 1) % round.size()].y / 16.0);
      EXPECT_NEAR(glm::length(p - centre), 50, 0.15);
      twice_area += p.x * next.y - p.y * next.x;
    }
    EXPECT_LT(twice_area, 0);  // background lies outside
    EXPECT_NEAR(-twice_area / 2, std::numbers::pi * 2500, 330 * (tolerance_px + 0.1));
  }
}

TEST(Rings, NeverCrossOnTheirSteps) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    const Image coverage = randomCoverage(60, 44, seed, seed % 2 ? 1 : 3);
    for (const double tolerance_px : {0.0, 1.0, 4.0}) expectValid(ringsOf(coverage, tolerance_px), coverage);
  }
}

TEST(Rings, StayWithinTheMessagesLimits) {
  const auto fits = [](const Image& coverage) {
    CameraPicture message;
    message.rings = ringsOf(coverage, 0);
    EXPECT_GT(message.rings.size(), 10u);
    EXPECT_TRUE(readFromCamera(writeFromCamera(message)).ok());
  };
  fits(randomCoverage(400, 300, 5, 4));  // too many rings
  Image comb(1200, 800, 1);              // too many points, in few rings
  for (int y = 20; y < 780; ++y)
    for (int x = 20; x < 1180; ++x)
      if ((y / 30) % 2) *comb.at(x, y) = (x / 3 + y / 5) % 3 ? 255 : uint8_t(100 + (x * 7 + y * 13) % 60);
  fits(comb);
}

TEST(Region, LeavesNothingOfThePerformerOutside) {
  Image coverage(50, 40, 1, 200);
  keepRegion({10, 5, 20, 30}, coverage);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x)
      EXPECT_EQ(*coverage.at(x, y), x >= 10 && x < 30 && y >= 5 && y < 35 ? 200 : 0) << x << " " << y;
  Image whole(50, 40, 1, 200), beyond(50, 40, 1, 200);
  keepRegion({}, whole);
  EXPECT_EQ(whole.pixels, Image(50, 40, 1, 200).pixels);
  keepRegion({60, 5, 20, 30}, beyond);
  EXPECT_EQ(beyond.pixels, Image(50, 40, 1).pixels);
}

TEST(Crop, HoldsThePerformerAndAMargin) {
  Image coverage(100, 80, 1, 20);
  for (int y = 30; y <= 41; ++y)
    for (int x = 45; x <= 52; ++x) *coverage.at(x, y) = 255;
  const Rect all = cropOf(coverage, {});
  EXPECT_LE(all.x, 45 - kCropMargin_px);
  EXPECT_LE(all.y, 30 - kCropMargin_px);
  EXPECT_GE(all.x + all.width, 52 + 1 + kCropMargin_px);
  EXPECT_GE(all.y + all.height, 41 + 1 + kCropMargin_px);
  EXPECT_LE(all.width * all.height, (8 + 2 * kCropMargin_px + 2) * (12 + 2 * kCropMargin_px + 2));
  const Rect within = cropOf(coverage, {44, 20, 60, 60});
  EXPECT_EQ(within.x, 44);
  EXPECT_EQ(within.y, 22);
  EXPECT_EQ(cropOf(Image(100, 80, 1, 127), {}).width, 0);
  const Rect odd = cropOf(Image(33, 21, 1, 255), {});
  EXPECT_EQ(odd.width, 33);
  EXPECT_EQ(odd.height, 21);
}

TEST(Jpeg, ShowsTheCrop) {
  Image rgb(64, 48, 3, 90);
  for (int y = 16; y < 32; ++y)
    for (int x = 20; x < 40; ++x) rgb.at(x, y)[0] = 220;
  const auto coarse = jpegOf(rgb, {10, 8, 40, 34}, 20), fine = jpegOf(rgb, {10, 8, 40, 34}, 95);
  EXPECT_LT(coarse.size(), fine.size());
  const cv::Mat read = cv::imdecode(fine, cv::IMREAD_COLOR);
  ASSERT_EQ(read.size(), cv::Size(40, 34));
  EXPECT_NEAR(read.at<cv::Vec3b>(16, 20)[2], 220, 6);  // red, in BGR
  EXPECT_NEAR(read.at<cv::Vec3b>(16, 20)[0], 90, 6);
  EXPECT_NEAR(read.at<cv::Vec3b>(2, 2)[2], 90, 6);
}

TEST(Jpeg, FitsTheMessage) {
  Image rgb(3000, 2000, 3);
  std::mt19937 random(1);
  for (uint8_t& value : rgb.pixels) value = uint8_t(random());
  const auto bytes = jpegOf(rgb, {0, 0, 3000, 2000}, 100);
  EXPECT_LT(bytes.size(), kMaxCameraMessageBytes - 4 * kMaxRingPoints - 2 * kMaxRings - 64);
  EXPECT_EQ(cv::imdecode(bytes, cv::IMREAD_COLOR).size(), cv::Size(3000, 2000));
}

}  // namespace
}  // namespace fourdvt::live
