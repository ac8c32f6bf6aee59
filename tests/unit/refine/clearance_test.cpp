// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "refine/surface_fit.h"
#include "sphere_fixture.h"

namespace fourdvt::refine {
namespace {

constexpr float kThick_m = 0.004f, kWide_m = 0.02f;
constexpr int kCells = 6;  // along a side of the plate

struct Plate {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::uvec3> faces;
};

// Two square sheets back to back, at z = 0 and at -thick, not joined at the rim.
Plate plate(float thick_m, const glm::vec3& shift = glm::vec3(0)) {
  Plate out;
  for (const float side : {1.f, -1.f}) {
    const uint32_t first = uint32_t(out.positions.size());
    for (int j = 0; j <= kCells; ++j)
      for (int i = 0; i <= kCells; ++i) {
        out.positions.push_back(shift + glm::vec3(i * kWide_m, j * kWide_m, side > 0 ? 0 : -thick_m));
        out.normals.push_back({0, 0, side});
      }
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i) {
        const uint32_t a = first + j * (kCells + 1) + i, b = a + 1, c = a + kCells + 1, d = c + 1;
        out.faces.push_back(side > 0 ? glm::uvec3(a, b, d) : glm::uvec3(a, d, b));
        out.faces.push_back(side > 0 ? glm::uvec3(a, d, c) : glm::uvec3(a, c, d));
      }
  }
  return out;
}

std::vector<Clearance> clearances(const Plate& p) { return clearancesOf(p.faces, p.positions, p.normals, 0.015f); }

TEST(Clearance, OfAPlateIsAShareOfItsThickness) {
  const Plate thin = plate(kThick_m);
  const auto found = clearances(thin);
  EXPECT_EQ(found.size(), 4 * thin.faces.size());
  for (const Clearance& c : found) {
    EXPECT_NEAR(c.max_m, 0.8f * kThick_m, 1e-6);
    float own = 0, other = 0;
    for (int k = 0; k < 3; ++k) own += c.shares[k], other += c.shares[3 + k];
    EXPECT_NEAR(own, -1, 1e-5);
    EXPECT_NEAR(other, -1, 1e-5);
  }
}

TEST(Clearance, ThickPartsHaveNone) {
  EXPECT_TRUE(clearances(plate(0.1f)).empty());
  const BallMesh ball = ballMesh(1, 3);
  EXPECT_TRUE(clearancesOf(ball.faces, ball.positions, ball.normals, 0.015f).empty());
}

// A plate inside a cube: the cube lies behind it there.
TEST(Clearance, PlacesInsideAnotherPartHaveNone) {
  Plate both = plate(0.1f);  // thick, from z = 0 down
  const Plate inside = plate(kThick_m, {0, 0, -0.02f});
  const uint32_t first = uint32_t(both.positions.size()), faces = uint32_t(both.faces.size());
  both.positions.insert(both.positions.end(), inside.positions.begin(), inside.positions.end());
  both.normals.insert(both.normals.end(), inside.normals.begin(), inside.normals.end());
  for (const glm::uvec3& f : inside.faces) both.faces.push_back(f + first);
  for (const Clearance& c : clearances(both)) EXPECT_FALSE(c.place / 4 >= faces && c.place / 4 < faces + faces / 2);
}

TEST(Clearance, CountsWhereMostFramesHaveIt) {
  const Clearance often{.place = 3, .max_m = 0.002f}, wider{.place = 3, .max_m = 0.004f},
      seldom{.place = 7, .max_m = 0.001f};
  const auto usual = usualClearances({wider, seldom, often, wider}, 4);
  ASSERT_EQ(usual.size(), 1u);
  EXPECT_EQ(usual[0].place, 3u);
  EXPECT_FLOAT_EQ(usual[0].max_m, 0.004f);
  EXPECT_TRUE(usualClearances({often, wider}, 4).empty());
}

TEST(Clearance, TwoSidesGiveWayAlike) {
  const Plate thin = plate(kThick_m);
  const auto found = clearances(thin);
  std::vector<float> offsets(thin.positions.size(), -0.003f);
  keepClear(found, offsets);
  for (const Clearance& c : found) {
    float closing = 0;
    for (int k = 0; k < 6; ++k) closing += c.shares[k] * offsets[c.vertices[k]];
    EXPECT_LE(closing, c.max_m + 1.1e-5f);
  }
  for (const float offset : offsets) EXPECT_NEAR(offset, -0.0016f, 2e-4);
  std::vector<float> outwards(thin.positions.size(), 0.003f);
  keepClear(found, outwards);
  for (const float offset : outwards) EXPECT_EQ(offset, 0.003f);
}

// A hem whose outer side the outlines move inwards by more than its thickness, the inner one along with it.
TEST(Clearance, HoldsWhateverTheOutlinesClaim) {
  const Plate thin = plate(kThick_m);
  std::vector<OffsetClaim> claims;
  for (uint32_t v = 0; v < thin.positions.size() / 2; ++v)
    for (int times = 0; times < 20; ++times) claims.push_back({v, v, 0, -0.005f});
  const auto thickness = [&](std::span<const Clearance> found) {
    const auto offsets =
        fitOffsets(claims, innerEdges(thin.faces), std::vector<float>(thin.positions.size()), found, {});
    const size_t middle = thin.positions.size() / 4, across = middle + thin.positions.size() / 2;
    return kThick_m + offsets[middle] + offsets[across];
  };
  EXPECT_LT(thickness({}), -0.004);
  EXPECT_NEAR(thickness(clearances(thin)), 0.2 * kThick_m, 1e-4);
}

}  // namespace
}  // namespace fourdvt::refine
