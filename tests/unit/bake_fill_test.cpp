// SPDX-License-Identifier: Apache-2.0
// Gutters across a seam, push-pull and hole filling on small textures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bake/fill.h"
#include "bake/push_pull.h"

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
  // Chart A ends at texel 24, chart B starts at texel 40: k texels beyond A are k texels into B.
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
