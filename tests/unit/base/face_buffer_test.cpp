// SPDX-License-Identifier: Apache-2.0
#include "base/face_buffer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

// A tilted fan of slivers, partly outside of the picture: every sample is compared with the barycentric weights of each
// face.
TEST(Rasterise, FindsTheFacesOfAllSamples) {
  const PinholeCamera camera = orbit(20);
  Positions positions{{0.1f, 0.05f, 0}};
  std::vector<glm::uvec3> faces;
  for (uint32_t k = 0; k < 60; ++k) {
    const float angle = 0.1f * float(k) + 0.01f * float(k % 7), radius = k % 5 ? 0.4f : 3.0f;
    positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.1f * std::sin(3 * angle));
    if (k > 0) faces.emplace_back(0, k, k + 1);
  }
  const FaceBuffer buffer = rasterise(camera, faces, positions, 2);
  const std::vector<uint8_t> covered = coveredSamples(camera, faces, positions, 2);
  for (int y = 0; y < buffer.height; ++y)
    for (int x = 0; x < buffer.width; ++x) {
      float nearest = std::numeric_limits<float>::infinity();
      for (const glm::uvec3& face : faces) {
        ProjectedFace t;
        double w[3];
        if (!projectFace(camera, face, positions, 2, t) || !t.barycentric({x + 0.5, y + 0.5}, w)) continue;
        const auto& d = t.inverse_depth;
        nearest = std::min(nearest, float(1 / (w[0] * d[0] + w[1] * d[1] + w[2] * d[2])));
      }
      const size_t at = size_t(y) * buffer.width + x;
      EXPECT_EQ(buffer.depth_m[at], nearest) << x << " " << y;
      EXPECT_EQ(covered[at], std::isfinite(nearest)) << x << " " << y;
    }
}

}  // namespace
}  // namespace fourdvt
