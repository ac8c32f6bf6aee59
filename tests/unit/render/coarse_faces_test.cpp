// SPDX-License-Identifier: Apache-2.0
// Faces of a coarser mesh, computed by hand, and their number for a person.
#include <gtest/gtest.h>

#include <set>

#include "../../render/mannequin.h"
#include "render/shared_corners.h"

namespace fourdvt::render {
namespace {

using List = std::vector<uint32_t>;

// Two strips of two faces each, 0.1 apart in x; vertices 1 and 2 of each lie in one cell of side 1.
std::vector<glm::vec3> strips() {
  std::vector<glm::vec3> out;
  for (const float x : {0.1f, 0.2f})
    for (const glm::vec2& p : {glm::vec2(0.5f, 0.5f), {1.2f, 0.5f}, {1.8f, 0.3f}, {1.5f, 1.5f}})
      out.emplace_back(x, p.y, p.x);
  return out;
}
const std::vector<glm::uvec3> kStrips = {{0, 1, 3}, {1, 2, 3}, {4, 5, 7}, {5, 6, 7}};

TEST(CoarseFaces, mergesVerticesOfACellToTheLowestOne) {
  // Faces 1 and 3 vanish; vertex 1 becomes 2 and 5 becomes 6, the faces' last corners are 4 and 10.
  EXPECT_EQ(coarseCorners(kStrips, strips(), 1, -9), (List{0, 4, 5, 6, 10, 11}));
}

TEST(CoarseFaces, keepsSurfacesApartThatOnlyTouch) {
  // Both strips lie in the same cell: no face remains, none joins them.
  EXPECT_EQ(coarseCorners(kStrips, strips(), 4, -9), List{});
  std::vector<glm::vec3> positions = strips();
  positions[3].y = positions[7].y = 5;
  EXPECT_EQ(coarseCorners(kStrips, positions, 4, -9), List{});  // 0, 1, 2 share a cell, and 4, 5, 6
}

TEST(CoarseFaces, keepsWhatIsLow) {
  EXPECT_EQ(coarseCorners(kStrips, strips(), 1, 0.4f), (List{0, 3, 5, 3, 4, 5, 6, 9, 11, 9, 10, 11}));
}

TEST(CoarseFaces, aPersonKeepsItsLimbsAndAThirdOfItsFaces) {
  const testing::Mannequin mannequin(8000);
  const auto& faces = mannequin.scene.mesh.topology.face_vertices;
  const List coarse = coarseCorners(faces, mannequin.scene.mesh.positions, 0.06f, 0.2f);
  EXPECT_LT(coarse.size(), faces.size());  // of three times as many corners
  std::set<int> limbs;
  for (size_t i = 0; i < coarse.size(); i += 3) {
    int limb[3];
    for (int k = 0; k < 3; ++k)
      limb[k] = mannequin.limb_of_[faces[coarse[i + size_t(k)] / 3][int(coarse[i + size_t(k)] % 3)]];
    ASSERT_TRUE(limb[0] == limb[1] && limb[1] == limb[2]);
    limbs.insert(limb[0]);
  }
  EXPECT_EQ(limbs.size(), 6u);
}

}  // namespace
}  // namespace fourdvt::render
