// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/genus_zero.h"

#include <gtest/gtest.h>

#include <numbers>

#include "implicit_mesh.h"
#include "reconstruct/mesh_checks.h"
#include "track/mesh/nearest.h"

namespace fourdvt::testing {
namespace {

using reconstruct::checkMesh;
using reconstruct::MeshReport;
using track::genusZeroSurface;

constexpr double kVoxel_m = 0.01;

TriangleMesh meshAround(const Implicit& inside) { return meshOf(inside, glm::vec3(-0.6f), glm::vec3(0.6f), 0.02f); }

void expectBall(const TriangleMesh& mesh) {
  const MeshReport report = checkMesh(mesh);
  EXPECT_TRUE(report.closed() && report.outward()) << describe(report);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 2);
}

TEST(GenusZero, KeepsABall) {
  const auto found = genusZeroSurface(meshAround(ball({}, 0.4f)), kVoxel_m);
  ASSERT_TRUE(found.ok()) << found.error().message;
  expectBall(found.value().mesh);
  EXPECT_EQ(found.value().cut_m3, 0);
  EXPECT_EQ(found.value().other_m3, 0);
  EXPECT_NEAR(checkMesh(found.value().mesh).volume_m3, 4.0 / 3 * std::numbers::pi * 0.064, 0.01 * 0.27);
  for (const glm::vec3& p : found.value().mesh.positions) ASSERT_NEAR(glm::length(p), 0.4f, 0.3 * kVoxel_m);
}

TEST(GenusZero, CutsARingOnce) {
  const auto found = genusZeroSurface(meshAround(torus(0.35f, 0.1f)), kVoxel_m);
  ASSERT_TRUE(found.ok()) << found.error().message;
  expectBall(found.value().mesh);
  // One slice of the ring is missing, some voxels wide.
  const double slice = std::numbers::pi * 0.01 * kVoxel_m;
  EXPECT_GT(found.value().cut_m3, 0.8 * slice);
  EXPECT_LT(found.value().cut_m3, 5 * slice);
}

// Two limbs that touch along a line part where they touch.
TEST(GenusZero, PartsLimbsWhereTheyTouch) {
  const auto figure = joint(ball({0, 0.4f, 0}, 0.12f), joint(capsule({0, 0.4f, 0}, {-0.1f, -0.4f, 0}, 0.06f),
                                                             capsule({0, 0.4f, 0}, {0.1f, -0.4f, 0}, 0.06f)));
  const auto crossed = joint(figure, capsule({-0.05f, -0.2f, 0}, {0.05f, -0.2f, 0}, 0.015f));
  const auto found = genusZeroSurface(meshAround(crossed), kVoxel_m);
  ASSERT_TRUE(found.ok()) << found.error().message;
  expectBall(found.value().mesh);
  EXPECT_GT(found.value().cut_m3, 0);
  // The cut lies in the bridge: the limbs are whole.
  const track::NearestSurface nearest(found.value().mesh);
  const auto limb = nearest.nearest({-0.09f, -0.4f, 0}, 1);
  ASSERT_TRUE(limb);
  EXPECT_GT(limb->distance_m, 0.04f);
}

TEST(GenusZero, ClosesHolesOfSomeTriangles) {
  TriangleMesh mesh = meshAround(ball({}, 0.4f));
  for (size_t f = 0; f < mesh.faces.size(); f += 97) mesh.faces.erase(mesh.faces.begin() + std::ptrdiff_t(f));
  const auto found = genusZeroSurface(mesh, kVoxel_m);
  ASSERT_TRUE(found.ok()) << found.error().message;
  expectBall(found.value().mesh);
  EXPECT_NEAR(checkMesh(found.value().mesh).volume_m3, 4.0 / 3 * std::numbers::pi * 0.064, 0.02 * 0.27);
}

TEST(GenusZero, KeepsTheLargestOfSeveralParts) {
  const auto found =
      genusZeroSurface(meshAround(joint(ball({-0.2f, 0, 0}, 0.3f), ball({0.35f, 0, 0}, 0.15f))), kVoxel_m);
  ASSERT_TRUE(found.ok()) << found.error().message;
  expectBall(found.value().mesh);
  EXPECT_NEAR(found.value().other_m3, 4.0 / 3 * std::numbers::pi * 0.003375, 0.0008);
}

TEST(GenusZero, RefusesASheet) {
  const TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const auto found = genusZeroSurface(sheet, kVoxel_m);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().id, ErrorId::MeshTopology);
}

}  // namespace
}  // namespace fourdvt::testing
