// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "reconstruct/surface_cleaning.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

// Adds an octahedron; `size` negative: a hollow.
void addOctahedron(TriangleMesh& mesh, const glm::vec3& at, float size) {
  const auto first = uint32_t(mesh.positions.size());
  const float s = std::abs(size);
  for (const glm::vec3& p : {glm::vec3(s, 0, 0), {-s, 0, 0}, {0, s, 0}, {0, -s, 0}, {0, 0, s}, {0, 0, -s}})
    mesh.positions.push_back(at + p);
  for (const glm::uvec3& f :
       {glm::uvec3(0, 2, 4), {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}})
    mesh.faces.push_back(glm::uvec3(first) + (size > 0 ? f : glm::uvec3(f.x, f.z, f.y)));
}

struct ComponentsTest : ::testing::Test {
  // Two cameras on one side: an object behind a large one is hidden from both.
  std::vector<silhouette::Silhouette> silhouettes{{lookingAt({0, 0, 0}, {-0.2, 0, 3}, 240, 240), Image(240, 240, 1)},
                                                  {lookingAt({0, 0, 0}, {0.2, 0, 3}, 240, 240), Image(240, 240, 1)}};
  std::vector<const silhouette::Silhouette*> seen{&silhouettes[0], &silhouettes[1]};
  TriangleMesh mesh;
  void SetUp() override { addOctahedron(mesh, {0, 0, 0}, 0.5f); }
};

TEST_F(ComponentsTest, PhantomsBehindSomethingLargerAreDropped) {
  addOctahedron(mesh, {0, 0, -1}, 0.1f);
  EXPECT_EQ(dropNeedless(mesh, seen, 0), 1u);
  EXPECT_EQ(mesh.faces.size(), 8u);
  EXPECT_EQ(mesh.positions.size(), 6u);
}

TEST_F(ComponentsTest, WhatOneCameraSeesAloneStays) {
  addOctahedron(mesh, {0.8f, 0, 0}, 0.1f);
  EXPECT_EQ(dropNeedless(mesh, seen, 0), 0u);
  EXPECT_EQ(mesh.faces.size(), 16u);
}

TEST_F(ComponentsTest, SpecksAreDroppedAndHollowsStay) {
  addOctahedron(mesh, {0.8f, 0, 0}, 0.02f);  // below a thousandth of the largest
  addOctahedron(mesh, {0, 0, 0}, -0.2f);
  EXPECT_EQ(dropNeedless(mesh, seen, 0), 1u);
  EXPECT_EQ(mesh.faces.size(), 16u);
  for (const glm::vec3& p : mesh.positions) EXPECT_LT(p.x, 0.7f);
}

TEST_F(ComponentsTest, TheLeastVolumeIsTheCallers) {
  addOctahedron(mesh, {0.8f, 0, 0}, 0.1f);
  EXPECT_EQ(dropNeedless(mesh, seen, 4.0 / 3 * 0.001 + 1e-6), 1u);
}

}  // namespace
}  // namespace fourdvt::reconstruct
