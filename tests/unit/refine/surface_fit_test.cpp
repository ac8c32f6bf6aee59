// SPDX-License-Identifier: Apache-2.0
#include "refine/surface_fit.h"

#include <gtest/gtest.h>

#include "sphere_fixture.h"

namespace fourdvt::refine {
namespace {

constexpr int kCameras = 8;

// Two rounds from zero against mattes that `spoil` may change.
template <class Spoil>
std::vector<float> fit(double radius, const Spoil& spoil) {
  const BallMesh given = ballMesh(radius);
  std::vector<float> offsets(given.positions.size());
  for (int round = 0; round < 2; ++round) {
    BallMesh mesh = given;
    for (size_t v = 0; v < offsets.size(); ++v) mesh.positions[v] += offsets[v] * given.normals[v];
    std::vector<OffsetClaim> claims;
    for (int c = 0; c < kCameras; ++c) {
      MatteCrop matte = ballMatte();
      spoil(c, matte);
      for (const OutlinePoint& s :
           outlinePoints(ballCamera(c, kCameras), mesh.faces, mesh.edges, mesh.positions, mesh.normals, matte, {}))
        claims.push_back(claimOf(s));
    }
    offsets = fitOffsets(claims, mesh.edges, offsets, {}, {});
  }
  return offsets;
}

void expectAll(const std::vector<float>& offsets, double metres, double tolerance) {
  for (const float offset : offsets) EXPECT_NEAR(offset, metres, tolerance);
}

TEST(SurfaceFit, BallThatIsTooLargeShrinksByAsMuch) {
  expectAll(fit(kBallRadius_m + 0.004, [](int, MatteCrop&) {}), -0.004, 0.0006);
}

TEST(SurfaceFit, BallThatIsTooSmallGrows) {
  expectAll(fit(kBallRadius_m - 0.003, [](int, MatteCrop&) {}), 0.003, 0.0007);
}

TEST(SurfaceFit, TornMattesDoNotDragTheSurface) {
  const auto tear = [](int camera, MatteCrop& matte) {
    std::mt19937 random(static_cast<unsigned>(camera) + 1);
    for (int hole = 0; hole < 12; ++hole) {  // on the edge: about 5 % of its length
      const double angle = random() * 6.2831853 / 4294967296.0, radius = 189;
      const int x = int(kBallPicture / 2 + radius * std::cos(angle)),
                y = int(kBallPicture / 2 + radius * std::sin(angle));
      for (int j = -5; j <= 5; ++j)
        for (int i = -5; i <= 5; ++i) *matte.alpha.at(x + i, y + j) = hole % 2 ? 0 : 255;
    }
  };
  expectAll(fit(kBallRadius_m + 0.004, tear), -0.004, 0.0012);
}

TEST(SurfaceFit, NoVertexMovesBeyondTheBound) {
  for (const float offset : fit(kBallRadius_m + 0.02, [](int, MatteCrop&) {})) {
    EXPECT_GE(offset, -0.01f);
    EXPECT_LT(offset, -0.008f);
  }
}

TEST(SurfaceFit, VerticesWithoutClaimsTakeTheUsualOffset) {
  const BallMesh mesh = ballMesh(1, 3);
  std::vector<OffsetClaim> claims;
  for (uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.positions[v].y > 0.3f) claims.push_back({v, v, 0, -0.002f});
  expectAll(fitOffsets(claims, mesh.edges, std::vector<float>(mesh.positions.size()), {}, {}), -0.002, 1e-4);
}

TEST(SurfaceFit, NoClaimsChangeNothing) {
  const BallMesh mesh = ballMesh(1, 1);
  const std::vector<float> current(mesh.positions.size(), 0.003f);
  EXPECT_EQ(fitOffsets({}, mesh.edges, current, {}, {}), current);
}

}  // namespace
}  // namespace fourdvt::refine
