// SPDX-License-Identifier: Apache-2.0
// The base mesh in the start file's coding: exact round trips, small sizes for Draco's meshes, limits and damage.
#include "package/mesh_code.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

using namespace fourdvt;
using namespace fourdvt::package;

namespace {

template <class Vec>
bool sameBits(const std::vector<Vec>& a, const std::vector<Vec>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec)) == 0;
}

void expectSame(const BaseMesh& got, const BaseMesh& want) {
  EXPECT_EQ(got.topology.vertex_count, want.topology.vertex_count);
  EXPECT_EQ(got.topology.face_vertices, want.topology.face_vertices);
  EXPECT_EQ(got.topology.face_uvs, want.topology.face_uvs);
  EXPECT_TRUE(sameBits(got.positions, want.positions));
  EXPECT_TRUE(sameBits(got.topology.uvs, want.topology.uvs));
}

// Encoded bytes, after checking the round trip.
std::vector<uint8_t> roundTrip(const BaseMesh& mesh) {
  auto bytes = encodeMeshCode(mesh);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message;
  if (!bytes.ok()) return {};
  auto back = decodeMeshCode(bytes.value(), mesh.topology.vertex_count, mesh.topology.faceCount());
  EXPECT_TRUE(back.ok());
  if (back.ok()) expectSame(back.value(), mesh);
  return bytes.take();
}

BaseMesh meshOf(const std::vector<glm::uvec3>& faces, const std::vector<glm::uvec3>& face_uvs, uint32_t vertices,
                uint32_t uvs) {
  BaseMesh out{{vertices, {}, faces, face_uvs}, {}};
  std::mt19937 random(7);
  const auto next = [&] { return float(random() % 1000) / 999; };
  for (uint32_t v = 0; v < vertices; ++v) out.positions.emplace_back(next(), 2 * next(), next());
  for (uint32_t u = 0; u < uvs; ++u) out.topology.uvs.emplace_back(next(), next());
  return out;
}
BaseMesh meshOf(const std::vector<glm::uvec3>& faces, uint32_t vertices) {
  return meshOf(faces, faces, vertices, vertices);
}

// Grid closed round: a tube or a torus, with one or two UV seams along it.
struct Grid {
  uint32_t around, along;
  bool closed_along;
};
void addGrid(const Grid& grid, float x, BaseMesh& out) {
  MeshTopology& t = out.topology;
  const uint32_t rows = grid.along + !grid.closed_along, first = t.vertex_count;
  const uint32_t first_uv = uint32_t(t.uvs.size());
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < grid.around; ++i) {
      const float u = 6.2831853f * i / grid.around, w = 6.2831853f * j / grid.along;
      const float r = 0.2f + 0.03f * std::sin(2 * u + 3 * w);
      out.positions.emplace_back(x + (0.6f + r * std::cos(u)) * std::cos(w), r * std::sin(u),
                                 (0.6f + r * std::cos(u)) * std::sin(w));
    }
  }
  for (uint32_t j = 0; j <= grid.along; ++j)
    for (uint32_t i = 0; i <= grid.around; ++i)
      t.uvs.emplace_back(0.05f + 0.4f * i / grid.around, 0.05f + 0.9f * j / grid.along);
  const auto add = [&](std::array<glm::uvec2, 3> at) {
    glm::uvec3 v, u;
    for (int k = 0; k < 3; ++k) {
      v[k] = first + at[k].y % rows * grid.around + at[k].x % grid.around;
      u[k] = first_uv + at[k].y * (grid.around + 1) + at[k].x;
    }
    t.face_vertices.push_back(v), t.face_uvs.push_back(u);
  };
  for (uint32_t j = 0; j < grid.along; ++j) {
    for (uint32_t i = 0; i < grid.around; ++i) {
      add({{{i, j}, {i + 1, j}, {i, j + 1}}});
      add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  }
  t.vertex_count = uint32_t(out.positions.size());
}
BaseMesh gridMesh(const std::vector<Grid>& grids) {
  BaseMesh out;
  for (size_t g = 0; g < grids.size(); ++g) addGrid(grids[g], 2.0f * g, out);
  return out;
}

struct ThroughDraco {
  std::vector<uint8_t> draco, code;
};
ThroughDraco throughDraco(const BaseMesh& mesh, int position_bits = 14, int uv_bits = 13) {
  auto encoded = encodeBaseMesh(mesh.topology, mesh.positions, position_bits, uv_bits);
  EXPECT_TRUE(encoded.ok()) << encoded.error().message;
  return {encoded.value().bytes, roundTrip(decodeBaseMesh(encoded.value().bytes).take())};
}

void expectInRange(const BaseMesh& mesh) {
  const MeshTopology& t = mesh.topology;
  ASSERT_EQ(mesh.positions.size(), t.vertex_count);
  ASSERT_EQ(t.face_uvs.size(), t.faceCount());
  for (uint32_t f = 0; f < t.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(t.face_vertices[f][k] < t.vertex_count && t.face_uvs[f][k] < t.uvs.size());
  }
  for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

void expectRefused(std::span<const uint8_t> bytes, const char* what, uint32_t max_vertices = 1 << 20,
                   uint32_t max_faces = 1 << 20) {
  auto mesh = decodeMeshCode(bytes, max_vertices, max_faces);
  ASSERT_FALSE(mesh.ok()) << what;
  EXPECT_EQ(mesh.error().id, ErrorId::MeshDataInvalid) << what;
}

void put32(std::vector<uint8_t>& bytes, size_t at, uint32_t value) { std::memcpy(&bytes[at], &value, 4); }

constexpr size_t kHeaderBytes = 40;

}  // namespace

TEST(MeshCode, GivesBackDracosMeshesInAsManyBytes) {
  for (const Grid& grid : {Grid{40, 60, true}, Grid{40, 60, false}}) {
    const ThroughDraco both = throughDraco(gridMesh({grid}));
    EXPECT_LT(both.code.size(), 1.05 * both.draco.size());
  }
}

TEST(MeshCode, GivesBackSeveralComponentsOfDraco) {
  const ThroughDraco both = throughDraco(gridMesh({{20, 30, true}, {12, 30, false}, {16, 16, true}, {5, 7, false}}));
  EXPECT_LT(both.code.size(), both.draco.size());
}

// Draco's order is derived, not stored: a vertex costs little more than its coordinates.
TEST(MeshCode, FindsDracosGridAndOrderAgain) {
  for (int bits : {8, 11, 14, 16}) {
    const BaseMesh mesh = gridMesh({{40, 60, true}});
    const ThroughDraco both = throughDraco(mesh, bits, 12);
    EXPECT_LT(both.code.size() * 8.0 / mesh.topology.vertex_count, 3 * bits * 0.75 + 12) << bits;
  }
}

TEST(MeshCode, GivesBackSmallMeshes) {
  roundTrip(meshOf({{0, 1, 2}}, 3));
  roundTrip(meshOf({{2, 0, 1}}, 3));
  roundTrip(meshOf({{0, 1, 2}, {3, 4, 5}}, 6));                        // two components
  roundTrip(meshOf({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}}, 6));  // four faces at an edge
  roundTrip(meshOf({{0, 1, 2}, {0, 3, 4}}, 5));                        // two faces joined at a vertex
  roundTrip(meshOf({{0, 1, 2}, {0, 2, 1}, {0, 1, 2}}, 3));             // one face three times
  roundTrip(meshOf({{0, 1, 2}, {1, 3, 2}}, {{0, 1, 2}, {5, 4, 3}}, 4, 6));
  roundTrip(meshOf({{0, 1, 2}, {1, 3, 2}}, {{0, 0, 0}, {0, 0, 0}}, 4, 1));  // one UV of all vertices
  roundTrip(meshOf({{0, 0, 1}, {1, 1, 1}, {1, 0, 0}, {0, 1, 2}}, 3));       // faces without area
}

TEST(MeshCode, GivesBackACubeWithSeams) {
  std::vector<glm::uvec3> faces, uvs;
  const uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (uint32_t s = 0; s < 6; ++s) {
    const uint32_t* v = sides[s];
    faces.emplace_back(v[0], v[1], v[2]), faces.emplace_back(v[0], v[2], v[3]);
    uvs.emplace_back(4 * s, 4 * s + 1, 4 * s + 2), uvs.emplace_back(4 * s, 4 * s + 2, 4 * s + 3);
  }
  const BaseMesh cube = meshOf(faces, uvs, 8, 24);
  roundTrip(cube);
  throughDraco(cube);
}

TEST(MeshCode, GivesBackVerticesWithoutFaces) {
  roundTrip(meshOf({{1, 4, 2}, {4, 1, 0}}, {{2, 0, 1}, {3, 5, 0}}, 6, 6));
  roundTrip(meshOf({{1, 5, 3}, {5, 1, 0}, {5, 1, 3}}, {{8, 2, 4}, {2, 7, 7}, {4, 2, 8}}, 9, 9));
}

TEST(MeshCode, GivesBackRandomMeshes) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    const uint32_t count = 1 + random() % 40, vertices = 3 + random() % (3 * count - 2),
                   uvs = 1 + random() % (3 * count);
    std::vector<glm::uvec3> faces, face_uvs;
    for (uint32_t f = 0; f < count; ++f) {
      const uint32_t v = random() % vertices, u = random() % uvs;
      const bool strip = round % 3 > 0;
      const auto next = [&](uint32_t from, uint32_t step, uint32_t n) { return (strip ? from + step : random()) % n; };
      faces.emplace_back(v, next(v, 1, vertices), next(v, 2, vertices));
      face_uvs.emplace_back(u, next(u, 1, uvs), next(u, 2, uvs));
    }
    roundTrip(meshOf(faces, face_uvs, vertices, uvs));
  }
}

// Shuffled faces with rotated corners.
TEST(MeshCode, GivesBackAnyOrderOfFaces) {
  BaseMesh mesh = gridMesh({{9, 8, true}, {6, 5, false}});
  std::mt19937 random(12);
  for (int round = 0; round < 20; ++round) {
    for (uint32_t f = mesh.topology.faceCount() - 1; f > 0; --f) {
      const uint32_t other = random() % (f + 1);
      std::swap(mesh.topology.face_vertices[f], mesh.topology.face_vertices[other]);
      std::swap(mesh.topology.face_uvs[f], mesh.topology.face_uvs[other]);
      glm::uvec3 &v = mesh.topology.face_vertices[f], &u = mesh.topology.face_uvs[f];
      v = {v.y, v.z, v.x}, u = {u.y, u.z, u.x};
    }
    roundTrip(mesh);
  }
}

TEST(MeshCode, GivesBackValuesThatNoGridHas) {
  BaseMesh mesh = gridMesh({{9, 8, true}});
  mesh.positions[5] = {-0.0f, 1e-40f, 3e38f};
  mesh.positions[6].y = -3e38f;
  roundTrip(mesh);
  for (glm::vec3& p : mesh.positions) p = {0, 0, 0};
  roundTrip(mesh);
  mesh.positions[3].z = -0.0f;
  for (glm::vec2& uv : mesh.topology.uvs) uv = {-1e30f, 1e30f};
  roundTrip(mesh);
}

TEST(MeshCode, AFanOfManyFacesTakesLinearTime) {
  std::vector<glm::uvec3> faces, uvs;
  const uint32_t count = 100000;
  for (uint32_t v = 1; v <= count; ++v)
    faces.emplace_back(0, v, v + 1), uvs.emplace_back(v, v + count, v + 2 * count - 1);
  roundTrip(meshOf(faces, uvs, count + 2, 3 * count));
}

TEST(MeshCode, RefusesToEncodeWhatCannotBeRead) {
  const BaseMesh good = meshOf({{0, 1, 2}, {1, 3, 2}}, 4);
  const auto refused = [&](auto&& damage) {
    BaseMesh bad = good;
    damage(bad);
    auto bytes = encodeMeshCode(bad);
    return !bytes.ok() && bytes.error().id == ErrorId::Internal;
  };
  EXPECT_FALSE(refused([](BaseMesh&) {}));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.topology.face_vertices[1].y = 4; }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.topology.face_uvs[1].z = 4; }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.topology.face_uvs.pop_back(); }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.topology.uvs.clear(); }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.positions.pop_back(); }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.positions[2].y = NAN; }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m.topology.uvs[2].y = INFINITY; }));
  EXPECT_TRUE(refused([](BaseMesh& m) { m = BaseMesh(); }));
}

TEST(MeshCode, RefusesMoreThanItMayHave) {
  const BaseMesh grid = gridMesh({{9, 8, true}});
  const BaseMesh mesh = encodeBaseMesh(grid.topology, grid.positions).take().decoded;
  std::vector<uint8_t> bytes = roundTrip(mesh);
  const uint32_t vertices = mesh.topology.vertex_count, faces = mesh.topology.faceCount();
  expectRefused(bytes, "vertices", vertices - 1, faces);
  expectRefused(bytes, "faces", vertices, faces - 1);
  const auto with = [&](size_t at, uint32_t value) {
    std::vector<uint8_t> out = bytes;
    put32(out, at, value);
    return out;
  };
  for (uint32_t count : {0u, 1u << 21, 0x55555556u, UINT32_MAX}) {
    for (size_t field : {0, 4, 8}) expectRefused(with(field, count), "another count", UINT32_MAX, UINT32_MAX);
  }
  expectRefused(with(0, 2), "two vertices");
  expectRefused(with(0, 3 * faces + 1), "more vertices than corners");
  expectRefused(with(4, 3 * faces + 1), "more UVs than corners");
  expectRefused(with(8, uint32_t(64 * bytes.size() + 1)), "more faces than the bytes can hold");
  expectRefused(with(24, 0x7f800000), "an infinite step");
  expectRefused(with(12, 0x7fc00000), "an origin that is no number");
}

TEST(MeshCode, RefusesEveryTruncationAndTrailingBytes) {
  for (const Grid& grid : {Grid{9, 8, true}, Grid{3, 1, false}}) {
    std::vector<uint8_t> bytes = roundTrip(gridMesh({grid}));
    for (size_t n = 0; n < bytes.size(); ++n) expectRefused(std::span(bytes).first(n), "cut off");
    bytes.push_back(0);
    expectRefused(bytes, "one byte more");
  }
}

TEST(MeshCode, DamageNeverGivesIndicesOutOfRange) {
  BaseMesh mesh = gridMesh({{7, 6, true}, {4, 3, false}});
  for (int round = 0; round < 2; ++round) {
    const std::vector<uint8_t> bytes = roundTrip(mesh);
    for (size_t at = 0; at < bytes.size(); ++at) {
      for (int bit = 0; bit < 8; ++bit) {
        std::vector<uint8_t> damaged = bytes;
        damaged[at] ^= 1u << bit;
        auto decoded = decodeMeshCode(damaged, 1000, 1000);
        if (decoded.ok()) expectInRange(decoded.value());
      }
    }
    mesh.topology.uvs[0].x = mesh.positions[0].x = 1e30f;  // then values are floats
    std::swap(mesh.topology.face_vertices[3], mesh.topology.face_vertices[40]);
  }
}

TEST(MeshCode, BytesWithoutAMeshGiveNothingOutOfRange) {
  std::mt19937 random(13);
  for (int round = 0; round < 3000; ++round) {
    std::vector<uint8_t> bytes(kHeaderBytes + random() % 200);
    for (size_t i = 12; i < bytes.size(); ++i) bytes[i] = uint8_t(random());
    const uint32_t faces = 1 + random() % 60;
    put32(bytes, 0, 3 + random() % (3 * faces - 2)), put32(bytes, 4, 1 + random() % (3 * faces)),
        put32(bytes, 8, faces);
    auto decoded = decodeMeshCode(bytes, 1000, 1000);
    if (decoded.ok()) expectInRange(decoded.value());
  }
}
