// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/mesh_checks.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace fourdvt::reconstruct {
namespace {

// Appends a box, or with `inverted` the walls of a cavity.
void addBox(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high, bool inverted = false) {
  const uint32_t first = uint32_t(mesh.positions.size());
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
  const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads)
    for (const glm::uvec3& f : {glm::uvec3(q[0], q[1], q[2]), glm::uvec3(q[0], q[2], q[3])})
      mesh.faces.push_back(first + (inverted ? glm::uvec3(f.x, f.z, f.y) : f));
}

TriangleMesh box(const glm::vec3& low = glm::vec3(0), const glm::vec3& high = glm::vec3(1)) {
  TriangleMesh mesh;
  addBox(mesh, low, high);
  return mesh;
}

// A frame of four bars: a torus.
TriangleMesh frame() {
  TriangleMesh mesh;
  const float r[2] = {1, 2};
  for (int y = 0; y < 2; ++y)
    for (float radius : r)
      for (const glm::vec2& c : {glm::vec2(1, 1), {-1, 1}, {-1, -1}, {1, -1}})
        mesh.positions.emplace_back(c.x * radius, float(y), -c.y * radius);
  const auto at = [](uint32_t y, uint32_t outer, uint32_t corner) { return y * 8 + outer * 4 + corner % 4; };
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    mesh.faces.emplace_back(a, b, c);
    mesh.faces.emplace_back(a, c, d);
  };
  for (uint32_t k = 0; k < 4; ++k) {
    quad(at(1, 0, k), at(1, 1, k), at(1, 1, k + 1), at(1, 0, k + 1));
    quad(at(0, 1, k), at(0, 0, k), at(0, 0, k + 1), at(0, 1, k + 1));
    quad(at(1, 1, k), at(0, 1, k), at(0, 1, k + 1), at(1, 1, k + 1));
    quad(at(0, 0, k), at(1, 0, k), at(1, 0, k + 1), at(0, 0, k + 1));
  }
  return mesh;
}

TEST(MeshChecks, IsSolidAgreesWithTheReport) {
  TriangleMesh bad = box(), open = box(), crossing = box(), outside_in;
  bad.faces[0].x = 100;
  open.faces.pop_back();
  addBox(crossing, glm::vec3(0.5f), glm::vec3(1.5f));
  addBox(outside_in, glm::vec3(0), glm::vec3(1), true);
  TriangleMesh many;  // more boxes than strips, along the diagonal
  for (int k = 0; k < 100; ++k) addBox(many, glm::vec3(2.0f * float(k)), glm::vec3(2.0f * float(k) + 1));
  for (const TriangleMesh& mesh : {TriangleMesh(), box(), frame(), bad, open, crossing, outside_in, many})
    EXPECT_EQ(isSolid(mesh), checkMesh(mesh).solid()) << describe(checkMesh(mesh));
  addBox(many, glm::vec3(10.5f), glm::vec3(11.5f));
  EXPECT_FALSE(isSolid(many));
  EXPECT_EQ(checkMesh(many).crossing_pairs, checkMesh(crossing).crossing_pairs);
}

TEST(MeshChecks, BoxAndTorusAreSolid) {
  const MeshReport cube = checkMesh(box());
  EXPECT_TRUE(cube.solid()) << describe(cube);
  EXPECT_EQ(cube.components, 1);
  EXPECT_EQ(cube.euler, 2);
  EXPECT_NEAR(cube.volume_m3, 1, 1e-9);
  EXPECT_EQ(cube.degenerate_faces, 0u);
  const MeshReport torus = checkMesh(frame());
  EXPECT_TRUE(torus.solid()) << describe(torus);
  EXPECT_EQ(torus.euler, 0);
  EXPECT_NEAR(torus.volume_m3, 16 - 4, 1e-9);
  EXPECT_TRUE(checkMesh({}).solid());
}

TEST(MeshChecks, HoleFlipAndDoubleFaceAreNotClosed) {
  TriangleMesh mesh = box();
  mesh.faces.pop_back();
  EXPECT_EQ(checkMesh(mesh).open_edges, 3u);
  mesh = box();
  std::swap(mesh.faces[3].x, mesh.faces[3].y);
  EXPECT_EQ(checkMesh(mesh).open_edges, 6u);
  mesh = box();
  mesh.faces.push_back(mesh.faces[0]);
  EXPECT_FALSE(checkMesh(mesh).closed());
  EXPECT_GT(checkMesh(mesh).crossing_pairs, 0u);
}

TEST(MeshChecks, IndexOutOfRange) {
  TriangleMesh mesh = box();
  mesh.faces[5].y = 8;
  EXPECT_EQ(checkMesh(mesh).bad_indices, 1u);
  EXPECT_FALSE(checkMesh(mesh).solid());
}

TEST(MeshChecks, InsideOutIsNotOutward) {
  TriangleMesh mesh;
  addBox(mesh, glm::vec3(0), glm::vec3(1), true);
  EXPECT_TRUE(checkMesh(mesh).closed());
  EXPECT_EQ(checkMesh(mesh).inverted_components, 1u);
  EXPECT_LT(checkMesh(mesh).volume_m3, 0);
}

TEST(MeshChecks, CavityMustBeInverted) {
  TriangleMesh cavity = box(), nested = box();
  addBox(cavity, glm::vec3(0.3f), glm::vec3(0.6f), true);
  addBox(nested, glm::vec3(0.3f), glm::vec3(0.6f));
  EXPECT_TRUE(checkMesh(cavity).solid()) << describe(checkMesh(cavity));
  EXPECT_EQ(checkMesh(nested).inverted_components, 1u);
}

TEST(MeshChecks, ComponentsApartFromEachOther) {
  TriangleMesh mesh = box();
  addBox(mesh, glm::vec3(2), glm::vec3(3));
  EXPECT_TRUE(checkMesh(mesh).solid());
  EXPECT_EQ(checkMesh(mesh).components, 2);
  EXPECT_EQ(checkMesh(mesh).euler, 4);
}

TEST(MeshChecks, CrossingBoxes) {
  TriangleMesh mesh = box();
  addBox(mesh, glm::vec3(0.5f, 0.4f, 0.3f), glm::vec3(1.5f, 1.4f, 1.3f));
  EXPECT_GT(checkMesh(mesh).crossing_pairs, 0u);
  // Penetration below the tolerance counts as rounding.
  TriangleMesh touching = box();
  addBox(touching, glm::vec3(0.9999997f, 0.2f, 0.2f), glm::vec3(2, 0.8f, 0.8f));
  EXPECT_EQ(checkMesh(touching, 1e-6).crossing_pairs, 0u);
  EXPECT_GT(checkMesh(touching, 1e-8).crossing_pairs, 0u);
}

TEST(MeshChecks, OverlapWithinOnePlane) {
  // Side by side with overlapping coplanar faces of the same orientation.
  TriangleMesh mesh = box();
  addBox(mesh, glm::vec3(0.5f, 0.5f, 0), glm::vec3(1.5f, 1.5f, 1));
  EXPECT_GT(checkMesh(mesh).crossing_pairs, 0u);
}

TEST(MeshChecks, NeighboursThatCrossBeyondWhatTheyShare) {
  // A corner pushed through the opposite side: the faces at the corner share vertices with those they cross.
  TriangleMesh mesh = box();
  mesh.positions[7] = {0.4f, 0.5f, -0.5f};
  const MeshReport report = checkMesh(mesh);
  EXPECT_TRUE(report.closed());
  EXPECT_GT(report.crossing_pairs, 0u);
  // Two faces that share one vertex, the second piercing the first.
  const TriangleMesh pair{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.1f, 1}, {0.1f, 0.5f, -1}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(checkMesh(pair).crossing_pairs, 1u);
  TriangleMesh turned = pair;
  std::swap(turned.faces[1].y, turned.faces[1].z);
  EXPECT_EQ(checkMesh(turned).crossing_pairs, 1u);
  const TriangleMesh apart{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.1f, 1}, {-0.1f, -0.5f, -1}},
                           {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(checkMesh(apart).crossing_pairs, 0u);
}

TEST(MeshChecks, TwoSidesOfASheetDoNotCross) {
  // A tetrahedron flattened by rounding.
  const TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2f, 0.2f, 0}},
                           {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_TRUE(checkMesh(sheet).solid()) << describe(checkMesh(sheet));
}

TEST(MeshChecks, DegenerateFacesAreCounted) {
  TriangleMesh mesh = box();
  mesh.positions[0] = mesh.positions[1];
  EXPECT_EQ(checkMesh(mesh).degenerate_faces, 2u);
}

}  // namespace
}  // namespace fourdvt::reconstruct
