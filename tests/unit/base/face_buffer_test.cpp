// SPDX-License-Identifier: Apache-2.0
#include "base/face_buffer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "square_fixture.h"

namespace fourdvt {
namespace {

using testing::kSquare, testing::kSquareFaces, testing::orbit;

TEST(Rasterise, SquareCoversItsAreaAtItsDepth) {
  const FaceBuffer buffer = rasterise(orbit(0), kSquareFaces, kSquare, 1);
  int covered = 0;
  for (float depth : buffer.depth_m) {
    if (!std::isfinite(depth)) continue;
    EXPECT_NEAR(depth, 2.0f, 1e-5f);
    ++covered;
  }
  EXPECT_EQ(covered, 32 * 32);
}

// Two squares, one 0.2 m in front of the other and half as wide: the small one hides the middle of the large one.
TEST(Rasterise, TheNearerFaceWins) {
  Positions positions = kSquare;
  for (const glm::vec3& p : kSquare) positions.push_back(glm::vec3(0.5f * p.x, 0.5f * p.y, 0.2f));
  std::vector<glm::uvec3> faces = kSquareFaces;
  for (const glm::uvec3& f : kSquareFaces) faces.push_back(f + 4u);
  const FaceBuffer buffer = rasterise(orbit(0), faces, positions, 1);
  const size_t centre = 32 * 64 + 32, edge = 32 * 64 + 18;
  EXPECT_GE(buffer.face[centre], 2u);
  EXPECT_NEAR(buffer.depth_m[centre], 1.8f, 1e-5f);
  EXPECT_LT(buffer.face[edge], 2u);
  EXPECT_EQ(buffer.face[0], FaceBuffer::kNoFace);
}

}  // namespace
}  // namespace fourdvt
