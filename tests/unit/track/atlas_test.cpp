// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/atlas.h"

#include <gtest/gtest.h>

#include <ctime>
#include <functional>
#include <numeric>

#include "person_fixture.h"

namespace fourdvt::testing {
namespace {

using track::AtlasOptions;
using track::AtlasQuality;
using track::atlasQuality;
using track::unwrapped;

const TriangleMesh& person() {
  static const TriangleMesh kMesh = personMesh();
  return kMesh;
}

MeshTopology unwrap(const TriangleMesh& mesh, std::span<const float> resolution = {},
                    std::span<const float> hidden = {}, const AtlasOptions& options = {}) {
  Result<MeshTopology> made = unwrapped(mesh, resolution, hidden, options);
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message);
  return made.ok() ? made.take() : MeshTopology{};
}

const MeshTopology& unwrappedPerson() {
  static const MeshTopology kTopology = unwrap(person());
  return kTopology;
}

// Number of each texture vertex's chart: the connected texture vertices.
std::vector<uint32_t> chartsOf(const MeshTopology& t) {
  std::vector<uint32_t> parents(t.uvs.size());
  std::iota(parents.begin(), parents.end(), 0u);
  const std::function<uint32_t(uint32_t)> root = [&](uint32_t v) {
    while (parents[v] != v) v = parents[v] = parents[parents[v]];
    return v;
  };
  for (const glm::uvec3& uvs : t.face_uvs)
    for (int k = 1; k < 3; ++k) parents[root(uvs[k])] = root(uvs[0]);
  std::vector<uint32_t> charts(t.uvs.size());
  for (uint32_t v = 0; v < charts.size(); ++v) charts[v] = root(v);
  return charts;
}

constexpr uint32_t kNoChart = ~uint32_t(0);

// Chart over each texel's centre.
std::vector<uint32_t> rasterised(const MeshTopology& t, int texels) {
  const std::vector<uint32_t> charts = chartsOf(t);
  std::vector<uint32_t> out(size_t(texels) * size_t(texels), kNoChart);
  for (const glm::uvec3& uvs : t.face_uvs) {
    glm::dvec2 p[3];
    for (int k = 0; k < 3; ++k) p[k] = glm::dvec2(t.uvs[uvs[k]]) * double(texels);
    const auto turn = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    const glm::ivec2 low = glm::floor(glm::min(p[0], glm::min(p[1], p[2])));
    const glm::ivec2 high = glm::floor(glm::max(p[0], glm::max(p[1], p[2])));
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const glm::dvec2 c(x + 0.5, y + 0.5);
        if (turn(p[0], p[1], c) <= 0 && turn(p[1], p[2], c) <= 0 && turn(p[2], p[0], c) <= 0)
          out[size_t(y) * size_t(texels) + size_t(x)] = charts[uvs[0]];
      }
  }
  return out;
}

// Least distance, below `reach`, between texel centres of different charts, or of a chart and the border.
double leastGap(const std::vector<uint32_t>& raster, int texels, int reach) {
  const auto at = [&](int x, int y) { return raster[size_t(y) * size_t(texels) + size_t(x)]; };
  double least = reach;
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) {
      const uint32_t own = at(x, y);
      if (own == kNoChart) continue;
      const double border = std::min(std::min(x, y), texels - 1 - std::max(x, y)) + 0.5;
      least = std::min(least, 2 * border);
      const bool inner = x > 0 && y > 0 && x + 1 < texels && y + 1 < texels && at(x - 1, y) == own &&
                         at(x + 1, y) == own && at(x, y - 1) == own && at(x, y + 1) == own;
      if (inner) continue;
      for (int v = std::max(0, y - reach); v <= std::min(texels - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(texels - 1, x + reach); ++u)
          if (at(u, v) != kNoChart && at(u, v) != own) least = std::min(least, std::hypot(u - x, v - y));
    }
  return least;
}

void expectSound(const TriangleMesh& mesh, const MeshTopology& t, int texels = 1024) {
  ASSERT_EQ(t.face_uvs.size(), mesh.faces.size());
  EXPECT_EQ(t.face_vertices, mesh.faces);
  EXPECT_EQ(t.vertex_count, mesh.positions.size());
  for (const glm::vec2& uv : t.uvs) {
    EXPECT_GT(std::min(uv.x, uv.y), 0);
    EXPECT_LT(std::max(uv.x, uv.y), 1);
  }
  std::vector<uint32_t> owners(t.uvs.size(), ~uint32_t(0));
  for (size_t f = 0; f < t.face_uvs.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      uint32_t& owner = owners[t.face_uvs[f][k]];
      if (owner == ~uint32_t(0)) owner = t.face_vertices[f][k];
      EXPECT_EQ(owner, t.face_vertices[f][k]);
    }
  EXPECT_EQ(std::count(owners.begin(), owners.end(), ~uint32_t(0)), 0) << "texture vertices without a face";
  const AtlasQuality quality = atlasQuality(t, mesh.positions, texels);
  EXPECT_EQ(quality.flipped_faces, 0u);
  EXPECT_EQ(quality.overlapping_texels, 0u);
  EXPECT_LT(quality.stretch_max, 2);
}

// Texels per metre, as the mean over faces whose centre `contains`, weighted by area.
template <class Contains>
double resolutionWhere(const TriangleMesh& mesh, const MeshTopology& t, const Contains& contains) {
  double flat = 0, surface = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const glm::vec3 a = mesh.positions[mesh.faces[f].x], b = mesh.positions[mesh.faces[f].y],
                    c = mesh.positions[mesh.faces[f].z];
    if (!contains((a + b + c) / 3.f)) continue;
    const glm::vec2 p = t.uvs[t.face_uvs[f].x], q = t.uvs[t.face_uvs[f].y], r = t.uvs[t.face_uvs[f].z];
    surface += glm::length(glm::cross(b - a, c - a));
    flat += std::abs((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
  }
  return std::sqrt(flat / surface);
}

bool onHead(const glm::vec3& p) { return p.y > 1.6f; }
bool onLegs(const glm::vec3& p) { return p.y < 0.7f; }

std::vector<float> headAt(float resolution) {
  std::vector<float> out;
  for (const glm::vec3& p : person().positions) out.push_back(p.y > 1.5f ? resolution : 1);
  return out;
}

double headToLegs(float resolution) {
  const MeshTopology t = unwrap(person(), headAt(resolution));
  return resolutionWhere(person(), t, onHead) / resolutionWhere(person(), t, onLegs);
}

// Share of the seams that lie at z < 0.
double seamsBehind(const MeshTopology& t) {
  std::map<std::pair<uint32_t, uint32_t>, glm::uvec2> sides;
  double behind = 0, all = 0;
  for (size_t f = 0; f < t.face_uvs.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = t.face_vertices[f][k], b = t.face_vertices[f][(k + 1) % 3];
      const glm::uvec2 uvs(t.face_uvs[f][k], t.face_uvs[f][(k + 1) % 3]);
      const auto [it, fresh] = sides.try_emplace(std::minmax(a, b), uvs);
      if (fresh || it->second == glm::uvec2(uvs.y, uvs.x)) continue;
      const glm::vec3 p = person().positions[a], q = person().positions[b];
      all += glm::length(q - p);
      if (p.z + q.z < 0) behind += glm::length(q - p);
    }
  return behind / all;
}

ErrorId errorOf(const TriangleMesh& mesh, std::span<const float> resolution = {}, std::span<const float> hidden = {},
                const AtlasOptions& options = {}) {
  const Result<MeshTopology> made = unwrapped(mesh, resolution, hidden, options);
  if (made.ok()) return ErrorId::None;
  EXPECT_EQ(made.error().message.find('\n'), std::string::npos);
  return made.error().id;
}

TriangleMesh tetrahedron(const glm::vec3& tip) {
  return {{tip, tip + glm::vec3(1, 0, 0), tip + glm::vec3(0, 1, 0), tip + glm::vec3(0, 0, 1)},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(Atlas, PersonLiesFlatAndFillsTheTexture) {
  expectSound(person(), unwrappedPerson());
  const AtlasQuality quality = atlasQuality(unwrappedPerson(), person().positions, 1024);
  EXPECT_GE(quality.charts, 12u);
  EXPECT_LE(quality.charts, 60u);
  EXPECT_LT(quality.stretch_l2, 1.02);
  EXPECT_GT(quality.packed_share, 0.58);
}

TEST(Atlas, ChartsKeepTheGutter) {
  EXPECT_GE(leastGap(rasterised(unwrappedPerson(), 1024), 1024, 12), 10);
  const MeshTopology small = unwrap(person(), {}, {}, {.texels = 300, .gutter_texels = 6});
  expectSound(person(), small, 300);
  EXPECT_GE(leastGap(rasterised(small, 300), 300, 8), 6);
}

TEST(Atlas, BallAndRingLieFlat) {
  for (const TriangleMesh& mesh : {ballMesh(0.06), ringMesh(0.06)}) expectSound(mesh, unwrap(mesh));
}

TEST(Atlas, TetrahedronLiesFlat) {
  const TriangleMesh mesh = tetrahedron(glm::vec3(0));
  expectSound(mesh, unwrap(mesh));
}

TEST(Atlas, PartsOfAMeshLieBesideEachOther) {
  TriangleMesh two = ballMesh(0.08);
  const TriangleMesh other = ballMesh(0.08);
  const uint32_t first = uint32_t(two.positions.size());
  for (const glm::vec3& p : other.positions) two.positions.push_back(p + glm::vec3(2, 0, 0));
  for (const glm::uvec3& f : other.faces) two.faces.push_back(f + first);
  expectSound(two, unwrap(two));
}

TEST(Atlas, SameInputGivesTheSameAtlas) {
  const MeshTopology again = unwrap(person());
  EXPECT_EQ(again.uvs, unwrappedPerson().uvs);
  EXPECT_EQ(again.face_uvs, unwrappedPerson().face_uvs);
}

TEST(Atlas, ResolutionScalesWhereItIsWanted) {
  EXPECT_NEAR(headToLegs(1), 1, 0.02);
  EXPECT_NEAR(headToLegs(2), 2, 0.1);
  EXPECT_NEAR(headToLegs(10), 3, 0.1) << "limited to 3";
}

TEST(Atlas, SeamsPreferHiddenPlaces) {
  std::vector<float> hidden;
  for (const glm::vec3& p : person().positions) hidden.push_back(p.z < 0 ? 1.f : 0.f);
  const MeshTopology t = unwrap(person(), {}, hidden);
  expectSound(person(), t);
  EXPECT_GT(seamsBehind(t), seamsBehind(unwrappedPerson()) + 0.08);
}

TEST(Atlas, PersonIsUnwrappedInSeconds) {
  const std::clock_t start = std::clock();
  unwrap(person());
  EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 5);
}

TEST(Atlas, OpenMeshIsRefused) {
  TriangleMesh mesh = tetrahedron(glm::vec3(0));
  mesh.faces.pop_back();
  EXPECT_EQ(errorOf(mesh), ErrorId::MeshTopology);
  EXPECT_EQ(errorOf({}), ErrorId::MeshTopology);
}

TEST(Atlas, MeshThatIsNoManifoldIsRefused) {
  TriangleMesh mesh = tetrahedron(glm::vec3(0));
  mesh.faces.push_back(mesh.faces[0]);
  EXPECT_EQ(errorOf(mesh), ErrorId::MeshTopology) << "a face twice";
  mesh = tetrahedron(glm::vec3(0));
  std::swap(mesh.faces[0].x, mesh.faces[0].y);
  EXPECT_EQ(errorOf(mesh), ErrorId::MeshTopology) << "a face turned over";
  mesh = tetrahedron(glm::vec3(0));
  const TriangleMesh other = tetrahedron(glm::vec3(-1, 0, 0));
  for (const uint32_t v : {0, 2, 3}) mesh.positions.push_back(other.positions[v]);
  const uint32_t index[4] = {4, 0, 5, 6};  // its vertex 1 is the first one's tip
  for (const glm::uvec3& f : other.faces) mesh.faces.emplace_back(index[f.x], index[f.y], index[f.z]);
  EXPECT_EQ(errorOf(mesh), ErrorId::MeshTopology) << "two parts that touch at a vertex";
}

TEST(Atlas, BadNumbersAreRefused) {
  const TriangleMesh mesh = tetrahedron(glm::vec3(0));
  const std::vector<float> three(3, 1), zero(4, 0), two(4, 2);
  EXPECT_EQ(errorOf(mesh, three), ErrorId::InvalidArgument);
  EXPECT_EQ(errorOf(mesh, {}, three), ErrorId::InvalidArgument);
  EXPECT_EQ(errorOf(mesh, zero), ErrorId::InvalidArgument);
  EXPECT_EQ(errorOf(mesh, {}, two), ErrorId::InvalidArgument);
  EXPECT_EQ(errorOf(mesh, {}, {}, {.texels = 8}), ErrorId::InvalidArgument);
  TriangleMesh broken = mesh;
  broken.positions[1].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(errorOf(broken), ErrorId::MeshNotFinite);
  broken = mesh;
  broken.faces[0].x = 9;
  EXPECT_EQ(errorOf(broken), ErrorId::MeshIndex);
}

TEST(AtlasQuality, FindsMirroredAndCoveredFaces) {
  const TriangleMesh mesh = tetrahedron(glm::vec3(0));
  MeshTopology t = unwrap(mesh);
  for (glm::vec2& uv : t.uvs) uv.x = 1 - uv.x;
  EXPECT_EQ(atlasQuality(t, mesh.positions, 256).flipped_faces, 4u);
  t.face_uvs[1] = t.face_uvs[0];
  EXPECT_GT(atlasQuality(t, mesh.positions, 256).overlapping_texels, 500u);
}

TEST(AtlasQuality, MeasuresStretch) {
  // A right triangle and its twin on the back, mapped to twice the length along x in the texture.
  const MeshTopology t{3,
                       {{0.1f, 0.4f}, {0.3f, 0.4f}, {0.1f, 0.3f}, {0.7f, 0.4f}, {0.5f, 0.4f}, {0.7f, 0.3f}},
                       {{0, 1, 2}, {1, 0, 2}},
                       {{0, 1, 2}, {4, 3, 5}}};
  const AtlasQuality quality = atlasQuality(t, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 256);
  EXPECT_EQ(quality.charts, 2u);
  EXPECT_NEAR(quality.stretch_l2, std::sqrt((0.5 * 0.5 + 1) / 2 * 2), 1e-4);
  EXPECT_NEAR(quality.stretch_max, std::sqrt(2.0), 1e-4);
  EXPECT_NEAR(quality.packed_share, 0.02, 1e-6);
  EXPECT_NEAR(quality.seam_m, 2 + std::sqrt(2.0), 1e-5);
}

}  // namespace
}  // namespace fourdvt::testing
