// SPDX-License-Identifier: Apache-2.0
#include "silhouette/contour.h"

#include <gtest/gtest.h>

#include <numbers>

#include "silhouette_fixture.h"

namespace fourdvt::silhouette {
namespace {

// A disc with exact coverage, 255 inside.
Image disc(double x, double y, double radius, int width = 100, int height = 80) {
  Image image(width, height, 1);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      int hits = 0;
      for (int k = 0; k < 256; ++k)
        hits += std::hypot(i + (k % 16 + 0.5) / 16 - x, j + (k / 16 + 0.5) / 16 - y) < radius;
      *image.at(i, j) = uint8_t(hits * 255 / 256);
    }
  return image;
}

Image invert(Image image) {
  for (uint8_t& p : image.pixels) p = uint8_t(255 - p);
  return image;
}

Image noise(uint32_t seed, int width = 40, int height = 30) {
  std::mt19937 random(seed);
  Image image(width, height, 1);
  for (uint8_t& p : image.pixels) p = uint8_t(random() % 256);
  return image;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

double distance(const glm::dvec2& p, const Ring& ring) {
  double nearest = 1e9;
  for (size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i], along = ring[(i + 1) % ring.size()] - a;
    const double share = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
    nearest = std::min(nearest, glm::distance(p, a + share * along));
  }
  return nearest;
}

// Number of pairs of edges that cross or touch, except neighbours.
int crossings(const Outline& outline) {
  struct Edge {
    glm::dvec2 a, b;
    size_t ring, index, count;
  };
  std::vector<Edge> edges;
  for (size_t r = 0; r < outline.rings.size(); ++r)
    for (size_t i = 0, n = outline.rings[r].size(); i < n; ++i)
      edges.push_back({outline.rings[r][i], outline.rings[r][(i + 1) % n], r, i, n});
  const auto left = [](const Edge& e) { return std::min(e.a.x, e.b.x); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& e, const Edge& f) { return left(e) < left(f); });
  int count = 0;
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t k = i + 1; k < edges.size() && left(edges[k]) <= std::max(edges[i].a.x, edges[i].b.x); ++k) {
      const Edge &e = edges[i], &f = edges[k];
      if (e.ring == f.ring && ((e.index + 1) % e.count == f.index || (f.index + 1) % f.count == e.index)) continue;
      const double a = cross(e.b - e.a, f.a - e.a), b = cross(e.b - e.a, f.b - e.a), c = cross(f.b - f.a, e.a - f.a),
                   d = cross(f.b - f.a, e.b - f.a);
      const bool near = glm::all(glm::lessThanEqual(glm::min(e.a, e.b), glm::max(f.a, f.b))) &&
                        glm::all(glm::lessThanEqual(glm::min(f.a, f.b), glm::max(e.a, e.b)));
      count += near && a * b <= 0 && c * d <= 0;
    }
  return count;
}

size_t points(const Outline& outline) {
  size_t count = 0;
  for (const Ring& ring : outline.rings) count += ring.size();
  return count;
}

// Ring other than the picture's border.
const Ring& inner(const Outline& outline) {
  return *std::min_element(outline.rings.begin(), outline.rings.end(), [](const Ring& a, const Ring& b) {
    return std::abs(signedArea_px2(a)) < std::abs(signedArea_px2(b));
  });
}

TEST(Contour, LiesOnTheDiscsEdgeBetweenPixels) {
  const Outline outline = outlineOf(disc(47.3, 38.6, 25), {0});
  ASSERT_EQ(outline.rings.size(), 2u);
  for (const glm::dvec2& p : inner(outline)) EXPECT_NEAR(glm::distance(p, {47.3, 38.6}), 25, 0.12);
  EXPECT_NEAR(signedArea_px2(inner(outline)), -std::numbers::pi * 25 * 25, 2);
}

TEST(Contour, BackgroundLiesOnTheRight) {
  const Outline outline = outlineOf(disc(50, 40, 20));
  ASSERT_EQ(outline.rings.size(), 2u);
  EXPECT_LT(signedArea_px2(inner(outline)), 0);  // round the performer: background outside
  EXPECT_DOUBLE_EQ(signedArea_px2(outline.rings[0]), 100 * 80);
  const Outline hole = outlineOf(invert(disc(50, 40, 20)));
  ASSERT_EQ(hole.rings.size(), 1u);  // the performer fills the rest up to the border
  EXPECT_NEAR(signedArea_px2(hole.rings[0]), std::numbers::pi * 400, 60);
}

TEST(Contour, PerformerOnTheBorderHasNoEdgeThere) {
  const Outline outline = outlineOf(disc(0, 40, 20), {0.5});
  ASSERT_EQ(outline.rings.size(), 1u);
  EXPECT_FALSE(reconstruct::evenOddInside(outline, {0.5, 40}));
  EXPECT_FALSE(reconstruct::evenOddInside(outline, {-3, 40}));
  EXPECT_TRUE(reconstruct::evenOddInside(outline, {0.5, 10}));
  EXPECT_FALSE(reconstruct::evenOddInside(outline, {-0.5, 10}));
  for (const glm::dvec2& p : outline.rings[0]) EXPECT_FALSE(p.x < 1 && std::abs(p.y - 40) < 18) << p.x << " " << p.y;
}

TEST(Contour, EmptyAndFullPictures) {
  EXPECT_TRUE(outlineOf(Image(20, 10, 1, 255)).rings.empty());
  EXPECT_TRUE(outlineOf(Image()).rings.empty());
  const Outline border = outlineOf(Image(20, 10, 1, 0), {1});
  ASSERT_EQ(border.rings.size(), 1u);
  EXPECT_EQ(border.rings[0].size(), 4u);
}

TEST(Contour, SpecksAreLeftOut) {
  Image image = disc(50, 40, 20);
  for (int k = 0; k < 4; ++k) *image.at(5 + k % 2, 5 + k / 2) = 255;  // performer, 4 px² less its corners
  for (int k = 0; k < 4; ++k) *image.at(50 + k % 2, 40 + k / 2) = 0;  // background
  EXPECT_EQ(outlineOf(image, {1, 4}).rings.size(), 2u);
  EXPECT_EQ(outlineOf(image, {1, 2}).rings.size(), 4u);
}

TEST(Contour, AgreesWithEveryPixelOfNoise) {
  for (uint32_t seed = 0; seed < 10; ++seed) {
    const Image image = noise(seed);
    const Outline outline = outlineOf(image, {0, 0});
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        ASSERT_EQ(reconstruct::evenOddInside(outline, {x + 0.5, y + 0.5}), *image.at(x, y) < 128) << x << " " << y;
  }
}

TEST(Contour, SaddleFollowsTheCellsMean) {
  Image image(4, 4, 1, 0);
  *image.at(1, 1) = *image.at(2, 2) = 255;
  EXPECT_EQ(outlineOf(image, {0, 0}).rings.size(), 3u);  // two islands and the border
  *image.at(2, 1) = *image.at(1, 2) = 120;               // still background, but the mean is performer
  EXPECT_EQ(outlineOf(image, {0, 0}).rings.size(), 2u);
}

TEST(Contour, RingsNeverCrossAtAnyTolerance) {
  for (uint32_t seed = 0; seed < 10; ++seed)
    for (double tolerance_px : {0.0, 0.25, 1.0, 4.0, 8.0})
      EXPECT_EQ(crossings(outlineOf(noise(seed), {tolerance_px, 0})), 0) << seed << " at " << tolerance_px;
}

TEST(Contour, ToleranceBoundsTheDistanceAndSavesPoints) {
  const Image image = disc(47.3, 38.6, 30);
  const Outline all = outlineOf(image, {0});
  size_t last = points(all) + 1;
  for (double tolerance_px : {0.1, 0.25, 1.0, 4.0, 8.0}) {
    const Outline outline = outlineOf(image, {tolerance_px});
    ASSERT_EQ(outline.rings.size(), 2u);
    for (const glm::dvec2& p : inner(all)) EXPECT_LE(distance(p, inner(outline)), tolerance_px + 1e-9);
    EXPECT_LT(points(outline), last);
    last = points(outline);
  }
}

TEST(Contour, NarrowGapBetweenTwoBodiesStaysOpen) {
  // Two blocks 2 px apart whose facing sides undulate by more than the gap: simplified independently, they would cross.
  Image image(90, 60, 1, 0);
  for (int y = 5; y < 55; ++y)
    for (int x = 5; x < 85; ++x) {
      const double middle = 45 + 6 * std::sin(y * 0.35);
      *image.at(x, y) = std::abs(x - middle) < 1.2 ? 0 : 255;
    }
  for (double tolerance_px : {1.0, 4.0, 8.0}) {
    const Outline outline = outlineOf(image, {tolerance_px});
    EXPECT_EQ(outline.rings.size(), 3u);
    EXPECT_EQ(crossings(outline), 0) << tolerance_px;
  }
}

}  // namespace
}  // namespace fourdvt::silhouette
