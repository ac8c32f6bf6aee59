// SPDX-License-Identifier: Apache-2.0
// Tangents and texture coordinates per metre, on an analytic plane and cylinder.
#include <gtest/gtest.h>

#include <cmath>

#include "base/mesh.h"

namespace fourdvt {
namespace {

constexpr int kColumns = 24, kRows = 6;

// Grid of columns × rows quads; each vertex has one texture vertex.
template <class PointAt, class UvAt>
void makeGrid(const PointAt& point, const UvAt& uv, MeshTopology& topology, Positions& positions) {
  for (int row = 0; row <= kRows; ++row)
    for (int column = 0; column <= kColumns; ++column) {
      positions.push_back(point(column, row));
      topology.uvs.push_back(uv(column, row));
    }
  const auto at = [](int column, int row) { return uint32_t(row * (kColumns + 1) + column); };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      topology.face_vertices.push_back({at(column, row), at(column + 1, row), at(column, row + 1)});
      topology.face_vertices.push_back({at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)});
    }
  topology.face_uvs = topology.face_vertices;
  topology.vertex_count = uint32_t(positions.size());
}

glm::vec2 alongTangents(const SurfaceFrames& frames, uint32_t vertex, const glm::vec3& move) {
  return move * frames.tangents[vertex];
}

void expectFrames(const SurfaceFrames& frames, const MeshTopology& topology, const Positions& positions) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(topology.face_vertices, positions.data(), positions.size(), normals);
  ASSERT_EQ(frames.tangents.size(), positions.size());
  for (size_t v = 0; v < normals.size(); ++v) {
    const glm::mat2x3& t = frames.tangents[v];
    EXPECT_NEAR(glm::length(t[0]), 1, 1e-5);
    EXPECT_NEAR(glm::length(t[1]), 1, 1e-5);
    EXPECT_NEAR(glm::dot(t[0], t[1]), 0, 1e-5);
    EXPECT_NEAR(glm::dot(t[0], normals[v]), 0, 1e-5);
    EXPECT_NEAR(glm::dot(glm::cross(t[0], t[1]), normals[v]), 1, 1e-5);
  }
}

TEST(SurfaceFrame, aSlantedPlaneWithATurnedTexture) {
  const glm::vec3 across = glm::normalize(glm::vec3(1, 0.3f, -0.2f));
  const glm::vec3 up = glm::normalize(glm::cross(glm::vec3(0.1f, 0.2f, 1), across));
  const glm::mat2 uv_from_plane(0.4f, 0.1f, -0.3f, 0.7f);
  MeshTopology topology;
  Positions positions;
  const auto plane = [](int c, int r) { return glm::vec2(0.02f * c + 0.003f * r, 0.03f * r); };
  makeGrid([&](int c, int r) { return plane(c, r).x * across + plane(c, r).y * up; },
           [&](int c, int r) { return glm::vec2(0.5f) + uv_from_plane * plane(c, r); }, topology, positions);
  const SurfaceFrames frames = computeSurfaceFrames(topology, positions);
  expectFrames(frames, topology, positions);
  ASSERT_EQ(frames.uv_from_tangents.size(), 3u * topology.faceCount());
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner)
      for (const glm::vec2& move : {glm::vec2(0.01f, 0), {0, 0.01f}, {-0.02f, 0.013f}}) {
        const uint32_t vertex = topology.face_vertices[face][corner];
        const glm::vec2 du =
            frames.uv_from_tangents[3 * face + corner] * alongTangents(frames, vertex, move.x * across + move.y * up);
        const glm::vec2 expected = uv_from_plane * move;
        EXPECT_NEAR(du.x, expected.x, 1e-5);
        EXPECT_NEAR(du.y, expected.y, 1e-5);
      }
}

TEST(SurfaceFrame, aCylinderUnrolled) {
  constexpr float kRadius = 0.3f, kTurn = 0.15f;
  MeshTopology topology;
  Positions positions;
  makeGrid(
      [&](int c, int r) { return glm::vec3(kRadius * std::sin(kTurn * c), 0.05f * r, kRadius * std::cos(kTurn * c)); },
      [&](int c, int r) { return glm::vec2(0.1f + kRadius * kTurn * c, 0.9f - 0.05f * r); }, topology, positions);
  const SurfaceFrames frames = computeSurfaceFrames(topology, positions);
  expectFrames(frames, topology, positions);
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t vertex = topology.face_vertices[face][corner];
      const int column = int(vertex) % (kColumns + 1);
      if (column == 0 || column == kColumns) continue;  // neighbours on one side only: the normal leans
      const float turn = kTurn * column;
      const glm::mat2& k = frames.uv_from_tangents[3 * face + corner];
      const glm::vec2 round = k * alongTangents(frames, vertex, {0.01f * std::cos(turn), 0, -0.01f * std::sin(turn)});
      const glm::vec2 up = k * alongTangents(frames, vertex, {0, 0.01f, 0});
      EXPECT_NEAR(round.x, 0.01f, 2e-4);
      EXPECT_NEAR(round.y, 0, 2e-4);
      EXPECT_NEAR(up.x, 0, 2e-4);
      EXPECT_NEAR(up.y, -0.01f, 2e-4);
    }
}

TEST(SurfaceFrame, aFaceWithoutAreaMovesNothing) {
  MeshTopology topology;
  topology.vertex_count = 3;
  topology.uvs = {{0, 0}, {1, 0}, {0, 1}};
  topology.face_vertices = topology.face_uvs = {{0, 1, 2}};
  for (const glm::mat2& k : computeSurfaceFrames(topology, Positions(3, glm::vec3(1))).uv_from_tangents)
    EXPECT_EQ(k, glm::mat2(0));
}

}  // namespace
}  // namespace fourdvt
