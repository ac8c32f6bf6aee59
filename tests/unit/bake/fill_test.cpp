// SPDX-License-Identifier: Apache-2.0
// Gutters across a seam, push-pull and hole filling on small textures.
#include "bake/texels/fill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

constexpr int kSize = 64;

// A strip of two squares that share the edge of vertices 1 and 4, cut into two charts:
//   chart A: u 0.125..0.375, chart B: u 0.625..0.875 (mirrored top to bottom if `flipped`), both v 0.25..0.75.
MeshTopology twoCharts(bool flipped) {
  MeshTopology t;
  t.vertex_count = 6;  // 0 1 2 above, 3 4 5 below
  const float top = 0.25f, bottom = 0.75f;
  t.uvs = {{0.125f, top}, {0.375f, top}, {0.375f, bottom}, {0.125f, bottom}};
  for (glm::vec2 uv :
       {glm::vec2(0.625f, top), glm::vec2(0.875f, top), glm::vec2(0.875f, bottom), glm::vec2(0.625f, bottom)})
    t.uvs.push_back(flipped ? glm::vec2(uv.x, 1 - uv.y) : uv);
  t.face_vertices = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  t.face_uvs = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  return t;
}

const GutterTexel* at(const GutterMap& map, int x, int y) {
  for (const GutterTexel& g : map.texels)
    if (g.texel == uint32_t(y * kSize + x)) return &g;
  return nullptr;
}

TEST(GutterMap, StepsAcrossTheSeamIntoTheNeighbour) {
  const GutterMap map = makeGutterMap(twoCharts(false), kSize, 6);
  // Chart A ends at texel 24, chart B starts at texel 40: k texels beyond A correspond to k texels into B.
  for (int k = 0; k < 6; ++k) {
    const GutterTexel* right_of_a = at(map, 24 + k, 30);
    ASSERT_NE(right_of_a, nullptr) << k;
    EXPECT_NEAR(right_of_a->source_x, 40.5f + k, 1e-3);
    EXPECT_NEAR(right_of_a->source_y, 30.5f, 1e-3);
    const GutterTexel* left_of_b = at(map, 39 - k, 30);
    ASSERT_NE(left_of_b, nullptr) << k;
    EXPECT_NEAR(left_of_b->source_x, 23.5f - k, 1e-3);
  }
  EXPECT_EQ(at(map, 31, 30), nullptr) << "beyond the gutter's width";
  EXPECT_EQ(at(map, 7, 30), nullptr) << "a mesh border has nothing behind it";
}

TEST(GutterMap, FollowsAMirroredPartner) {
  const GutterMap map = makeGutterMap(twoCharts(true), kSize, 4);
  const GutterTexel* g = at(map, 25, 20);
  ASSERT_NE(g, nullptr);
  EXPECT_NEAR(g->source_x, 41.5f, 1e-3);
  EXPECT_NEAR(g->source_y, kSize - 20.5f, 1e-3);
}

// A strip of three rectangles, one chart each: A 16, B 3 (between texels 36 and 39), C 12 texels wide.
TEST(GutterMap, WalksOnOverANarrowChartIntoTheNext) {
  MeshTopology t;
  t.vertex_count = 8;  // 0 1 2 3 above, 4 5 6 7 below
  const float left[3] = {8, 36, 48}, width[3] = {16, 3, 12};
  for (uint32_t k = 0; k < 3; ++k) {
    const float u0 = left[k] / kSize, u1 = (left[k] + width[k]) / kSize;
    for (glm::vec2 uv : {glm::vec2(u0, 0.25f), glm::vec2(u1, 0.25f), glm::vec2(u1, 0.75f), glm::vec2(u0, 0.75f)})
      t.uvs.push_back(uv);
    t.face_vertices.push_back({k, k + 1, k + 5});
    t.face_vertices.push_back({k, k + 5, k + 4});
    t.face_uvs.push_back({4 * k, 4 * k + 1, 4 * k + 2});
    t.face_uvs.push_back({4 * k, 4 * k + 2, 4 * k + 3});
  }
  const GutterMap map = makeGutterMap(t, kSize, 5);
  for (int k = 0; k < 5; ++k) {
    const GutterTexel* g = at(map, 24 + k, 30);
    ASSERT_NE(g, nullptr) << k;
    EXPECT_NEAR(g->source_x, k < 3 ? 36.5f + k : 48.5f + (k - 3), 1e-3) << k;
    EXPECT_NEAR(g->source_y, 30.5f, 1e-3);
  }
}

TEST(GutterMap, WalkThatLeavesTheMeshHasNoContent) {
  // Chart B is 16 texels wide, so that a gutter of 20 would pass the end of the mesh.
  const GutterMap map = makeGutterMap(twoCharts(false), 2 * kSize, 40);
  for (const GutterTexel& g : map.texels) {
    EXPECT_GE(g.source_x, 16);
    EXPECT_LE(g.source_x, 112);
  }
  bool beyond = false;
  for (const GutterTexel& g : map.texels) beyond |= g.texel == uint32_t(60 * 2 * kSize + 48 + 33);
  EXPECT_FALSE(beyond) << "33 texels beyond chart A, and B is 32 wide";
}

// Content of chart A and chart B as one continuous ramp over the strip.
uint8_t ramp(float strip_x) { return static_cast<uint8_t>(40 + 4 * strip_x); }

Image rampLayer(const GutterMap& map) {
  Image layer(kSize, kSize, 4);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (!map.inside[y * kSize + x]) continue;
      const uint8_t value = ramp(x < 32 ? float(x - 8) : float(x - 40 + 16));
      std::fill_n(layer.at(x, y), 3, value);
      layer.at(x, y)[3] = 255;
    }
  }
  return layer;
}

TEST(Fill, GuttersContinueTheContent) {
  const GutterMap map = makeGutterMap(twoCharts(false), kSize, 6);
  std::vector<Image> layers{rampLayer(map)};
  fillLayers({&map}, layers);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(layers[0].at(24 + k, 30)[0], ramp(16.0f + k));
    EXPECT_EQ(layers[0].at(39 - k, 30)[0], ramp(15.0f - k));
  }
  for (size_t i = 3; i < layers[0].pixels.size(); i += 4) ASSERT_EQ(layers[0].pixels[i], 255);
}

TEST(Fill, HolesOfFurtherLayersTakeTheFirstShiftedByTheirDifference) {
  const GutterMap map = makeGutterMap(twoCharts(false), kSize, 6);
  std::vector<Image> layers{rampLayer(map), rampLayer(map)};
  for (size_t i = 0; i < layers[1].pixels.size(); i += 4)
    for (int c = 0; c < 3; ++c) layers[1].pixels[i + c] += layers[1].pixels[i + 3] ? 20 : 0;
  for (int y = 24; y < 36; ++y)
    for (int x = 12; x < 20; ++x) std::fill_n(layers[1].at(x, y), 4, uint8_t(0));
  fillLayers({&map, &map}, layers);
  for (int y = 24; y < 36; ++y)
    for (int x = 12; x < 20; ++x) ASSERT_NEAR(layers[1].at(x, y)[0], ramp(float(x - 8)) + 20, 1);
}

TEST(Fill, HolesOfTheFirstLayerTakeAFurtherOneShiftedByTheirDifference) {
  const GutterMap map = makeGutterMap(twoCharts(false), kSize, 6),
                  small = makeGutterMap(twoCharts(false), kSize / 2, 3);
  std::vector<Image> layers{rampLayer(map), Image(kSize / 2, kSize / 2, 4)};
  // Layer 2 has a mark that is absent from layer 1, and is 25 levels darker.
  for (int y = 0; y < kSize / 2; ++y)
    for (int x = 0; x < kSize / 2; ++x) {
      if (!small.inside[y * kSize / 2 + x]) continue;
      const bool mark = x >= 7 && x < 9 && y >= 14 && y < 16;
      std::fill_n(layers[1].at(x, y), 3, mark ? uint8_t(200) : uint8_t(layers[0].at(2 * x, 2 * y)[0] + 2 - 25));
      layers[1].at(x, y)[3] = 255;
    }
  for (int y = 24; y < 36; ++y)
    for (int x = 12; x < 20; ++x) std::fill_n(layers[0].at(x, y), 4, uint8_t(0));
  fillLayers({&map, &small}, layers);
  EXPECT_NEAR(layers[0].at(15, 29)[0], 225, 2);
  EXPECT_NEAR(layers[0].at(16, 30)[0], 225, 2);
  for (int y = 24; y < 36; ++y)
    for (int x : {12, 19}) ASSERT_NEAR(layers[0].at(x, y)[0], ramp(float(x - 8)), 3) << x << " " << y;
}

// Layers that differ by a smooth gain: the hole's border shows no step beyond the content's own.
TEST(Fill, HoleMeetsItsBorderWithoutAStep) {
  const GutterMap map = makeGutterMap(twoCharts(false), kSize, 6);
  std::vector<Image> layers{rampLayer(map), rampLayer(map)};
  for (size_t i = 0; i < layers[1].pixels.size(); i += 4)
    for (int c = 0; c < 3; ++c) layers[1].pixels[i + c] = static_cast<uint8_t>(layers[1].pixels[i + c] * 0.7);
  for (int y = 24; y < 36; ++y)
    for (int x = 12; x < 20; ++x) std::fill_n(layers[1].at(x, y), 4, uint8_t(0));
  fillLayers({&map, &map}, layers);
  for (int y = 24; y < 36; ++y) {
    ASSERT_NEAR(layers[1].at(12, y)[0] - layers[1].at(11, y)[0], 0.7 * 4, 2.5) << y;
    ASSERT_NEAR(layers[1].at(20, y)[0] - layers[1].at(19, y)[0], 0.7 * 4, 2.5) << y;
  }
}

// A third chart that is adjacent to chart B in UV only must not colour it.
TEST(Fill, WhatNoCameraShowsComesFromTheSurfaceNotFromTheChartBeside) {
  MeshTopology t = twoCharts(false);
  t.vertex_count = 9;  // a triangle on its own, between the charts
  for (glm::vec2 uv : {glm::vec2(0.55f, 0.3f), glm::vec2(0.62f, 0.3f), glm::vec2(0.62f, 0.7f)}) t.uvs.push_back(uv);
  t.face_vertices.push_back({6, 7, 8});
  t.face_uvs.push_back({8, 9, 10});
  const GutterMap map = makeGutterMap(t, kSize, 2);
  Image layer(kSize, kSize, 4);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < 40; ++x) {
      if (!map.inside[y * kSize + x]) continue;
      std::fill_n(layer.at(x, y), 3, x < 32 ? uint8_t(60) : uint8_t(240));  // chart A, the triangle; B is a hole
      layer.at(x, y)[3] = 255;
    }
  std::vector<Image> layers{layer};
  fillLayers({&map}, layers);
  for (int y = 17; y < 47; ++y)
    for (int x = 40; x < 56; ++x) ASSERT_NEAR(layers[0].at(x, y)[0], 60, 2) << x << " " << y;
}

TEST(PushPull, KeepsWhatIsKnownAndStaysWithinItsRange) {
  std::vector<glm::vec4> field(kSize * kSize, glm::vec4(0));
  field[10 * kSize + 10] = glm::vec4(10, 0, 0, 1);
  field[50 * kSize + 50] = glm::vec4(90, 0, 0, 1);
  pushPull(field, kSize);
  EXPECT_FLOAT_EQ(field[10 * kSize + 10].x, 10);
  for (const glm::vec4& v : field) {
    ASSERT_NEAR(v.w, 1, 1e-4);
    ASSERT_GE(v.x, 10 - 1e-3);
    ASSERT_LE(v.x, 90 + 1e-3);
  }
  EXPECT_LT(field[11 * kSize + 11].x, field[49 * kSize + 49].x);
}

}  // namespace
}  // namespace fourdvt::bake
