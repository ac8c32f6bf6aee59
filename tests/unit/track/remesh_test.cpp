// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "implicit_mesh.h"
#include "reconstruct/mesh_checks.h"
#include "track/mesh/nearest.h"

namespace fourdvt::testing {
namespace {

using track::NearestSurface;
using track::remeshed;

constexpr float kAnywhere = std::numeric_limits<float>::infinity();

TriangleMesh ballMesh() { return meshOf(ball({}, 0.5f), glm::vec3(-0.6f), glm::vec3(0.6f), 0.08f); }

// A ball of 5 cm with a finger 10 cm long and 16 mm thick.
TriangleMesh fingerMesh() {
  const auto figure = joint(ball({}, 0.05f), capsule({}, {0.15f, 0, 0}, 0.008f));
  return meshOf(figure, {-0.06f, -0.06f, -0.06f}, {0.17f, 0.06f, 0.06f}, 0.004f);
}

float angle(const glm::vec3& at, const glm::vec3& a, const glm::vec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(glm::normalize(a - at), glm::normalize(b - at)), -1.0f, 1.0f)));
}

double shareOfThin(const TriangleMesh& mesh) {
  size_t thin = 0;
  for (const glm::uvec3& f : mesh.faces) {
    float least = 180;
    for (int k = 0; k < 3; ++k)
      least =
          std::min(least, angle(mesh.positions[f[k]], mesh.positions[f[(k + 1) % 3]], mesh.positions[f[(k + 2) % 3]]));
    thin += least < 10;
  }
  return double(thin) / double(mesh.faces.size());
}

double edgeLength(const TriangleMesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& f : mesh.faces)
    for (int k = 0; k < 3; ++k) sum += glm::distance(mesh.positions[f[k]], mesh.positions[f[(k + 1) % 3]]);
  return sum / (3.0 * double(mesh.faces.size()));
}

double maxDistance(const Positions& points, const TriangleMesh& surface) {
  const NearestSurface nearest(surface);
  double most = 0;
  for (const glm::vec3& p : points) most = std::max(most, double(nearest.nearest(p, kAnywhere)->distance_m));
  return most;
}

// Remeshes, and checks all that holds for every surface.
TriangleMesh checked(const TriangleMesh& surface, std::span<const float> size, uint32_t faces) {
  auto result = remeshed(surface, size, {.faces = faces});
  EXPECT_TRUE(result.ok()) << result.error().message;
  if (!result.ok()) return {};
  const reconstruct::MeshReport before = reconstruct::checkMesh(surface),
                                after = reconstruct::checkMesh(result.value());
  EXPECT_TRUE(after.closed() && after.outward()) << describe(after);
  EXPECT_EQ(after.degenerate_faces, 0u) << describe(after);
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.components, before.components);
  EXPECT_NEAR(double(result.value().faces.size()), faces, 0.02 * faces);
  EXPECT_LE(shareOfThin(result.value()), 0.01);
  EXPECT_LE(maxDistance(result.value().positions, surface), 1e-6);
  return result.take();
}

TEST(Remesh, BallBecomesEven) {
  const TriangleMesh input = ballMesh();
  for (const uint32_t faces : {600u, 6000u}) {
    const TriangleMesh mesh = checked(input, {}, faces);
    EXPECT_LE(maxDistance(input.positions, mesh), 0.2 * edgeLength(mesh));
    for (const glm::uvec3& f : mesh.faces)
      for (int k = 0; k < 3; ++k) {
        const double length = glm::distance(mesh.positions[f[k]], mesh.positions[f[(k + 1) % 3]]);
        EXPECT_GT(length, 0.5 * edgeLength(mesh));
        EXPECT_LT(length, 1.6 * edgeLength(mesh));
      }
  }
}

TEST(Remesh, TorusKeepsItsHole) {
  const TriangleMesh input = meshOf(torus(0.5f, 0.15f), {-0.7f, -0.7f, -0.2f}, {0.7f, 0.7f, 0.2f}, 0.04f);
  EXPECT_EQ(reconstruct::checkMesh(checked(input, {}, 1500)).euler, 0);
}

TEST(Remesh, FingerStaysWhole) {
  const TriangleMesh input = fingerMesh();
  const TriangleMesh mesh = checked(input, {}, 5000);
  EXPECT_NEAR(edgeLength(mesh), 0.004, 0.0006);
  EXPECT_LE(maxDistance(input.positions, mesh), 0.5 * edgeLength(mesh));
}

TEST(Remesh, NoisyFingerStaysWhole) {
  TriangleMesh input = fingerMesh();
  std::mt19937 random(1);
  for (glm::vec3& p : input.positions)
    for (int k = 0; k < 3; ++k) p[k] += 4e-4f * (float(random() % 2001) / 1000 - 1);
  checked(input, {}, 3000);
}

TEST(Remesh, ComponentsStayApart) {
  const auto figure = joint(ball({-0.06f, 0, 0}, 0.05f), ball({0.06f, 0, 0}, 0.05f));
  checked(meshOf(figure, {-0.12f, -0.06f, -0.06f}, {0.12f, 0.06f, 0.06f}, 0.007f), {}, 800);
}

TEST(Remesh, LengthsFollowTheSize) {
  const TriangleMesh input = ballMesh();
  const auto size_at = [](const glm::vec3& p) { return 2 + 2 * p.x; };  // 1 to 3
  std::vector<float> size;
  for (const glm::vec3& p : input.positions) size.push_back(size_at(p));
  const TriangleMesh mesh = checked(input, size, 3000);
  std::vector<double> relative;
  for (const glm::uvec3& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 &a = mesh.positions[f[k]], &b = mesh.positions[f[(k + 1) % 3]];
      relative.push_back(2 * glm::distance(a, b) / (size_at(a) + size_at(b)));
    }
  std::sort(relative.begin(), relative.end());
  EXPECT_LT(relative[relative.size() * 99 / 100], 1.7 * relative[relative.size() / 100]);
}

TEST(Remesh, EqualInputsHaveEqualResults) {
  const TriangleMesh input = ballMesh();
  const auto one = remeshed(input, {}, {.faces = 500}), two = remeshed(input, {}, {.faces = 500});
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one.value().positions, two.value().positions);
  EXPECT_EQ(one.value().faces, two.value().faces);
}

TEST(Remesh, BadInputsAreErrors) {
  const auto error = [](const TriangleMesh& mesh, std::span<const float> size) {
    const auto result = remeshed(mesh, size, {.faces = 500});
    EXPECT_FALSE(result.ok());
    if (result.ok()) return ErrorId::None;
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
    return result.error().id;
  };
  const TriangleMesh good = ballMesh();
  TriangleMesh open = good, index = good, turned = good, infinite = good;
  open.faces.pop_back();
  index.faces[3].y = uint32_t(index.positions.size());
  std::swap(turned.faces[5].x, turned.faces[5].y);
  infinite.positions[7].z = kAnywhere;
  EXPECT_EQ(error(open, {}), ErrorId::MeshTopology);
  EXPECT_EQ(error(turned, {}), ErrorId::MeshTopology);
  EXPECT_EQ(error(TriangleMesh{}, {}), ErrorId::MeshTopology);
  EXPECT_EQ(error(index, {}), ErrorId::MeshIndex);
  EXPECT_EQ(error(infinite, {}), ErrorId::MeshNotFinite);
  std::vector<float> size(good.positions.size() - 1, 1.0f);
  EXPECT_EQ(error(good, size), ErrorId::MeshTopology);
  size.push_back(0);
  EXPECT_EQ(error(good, size), ErrorId::InvalidArgument);
}

TEST(NearestSurface, AgreesWithTheSearchOfAllFaces) {
  const TriangleMesh mesh = fingerMesh();
  const NearestSurface all(mesh);
  std::vector<NearestSurface> single;
  for (uint32_t f = 0; f < mesh.faces.size(); f += 7) {
    const glm::uvec3& face = mesh.faces[f];
    single.emplace_back(
        TriangleMesh{{mesh.positions[face.x], mesh.positions[face.y], mesh.positions[face.z]}, {{0, 1, 2}}});
  }
  TriangleMesh some{mesh.positions, {}};
  for (uint32_t f = 0; f < mesh.faces.size(); f += 7) some.faces.push_back(mesh.faces[f]);
  const NearestSurface tree(some);
  const glm::vec3 up(0, 0, 1);
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    glm::vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = 0.2f * (float(random() % 2001) / 1000 - 1);
    float least = kAnywhere, least_up = kAnywhere;
    for (size_t f = 0; f < single.size(); ++f) {
      const float distance = single[f].nearest(p, kAnywhere)->distance_m;
      least = std::min(least, distance);
      if (tree.faceNormal(uint32_t(f)).z >= 0.5f) least_up = std::min(least_up, distance);
    }
    const auto hit = tree.nearest(p, kAnywhere), facing = tree.nearestFacing(p, up, 0.5f, kAnywhere);
    ASSERT_TRUE(hit && facing);
    EXPECT_EQ(hit->distance_m, least);
    EXPECT_EQ(facing->distance_m, least_up);
    EXPECT_GE(tree.faceNormal(facing->face).z, 0.5f);
    const glm::uvec3& face = some.faces[hit->face];
    glm::vec3 sum(0);
    for (int k = 0; k < 3; ++k) sum += hit->barycentric[k] * some.positions[face[k]];
    EXPECT_LT(glm::distance(sum, hit->point), 1e-6f);
    EXPECT_FALSE(tree.nearest(p, 0.99f * least));
    EXPECT_TRUE(all.nearest(p, 1.01f * least));
  }
}

TEST(NearestSurface, AnswersForFacesWithoutAreaAndForNone) {
  EXPECT_FALSE(NearestSurface(TriangleMesh{}).nearest({}, kAnywhere));
  const NearestSurface line(TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {{0, 1, 2}}});
  const auto hit = line.nearest({2, 1, 0}, kAnywhere);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->point, glm::vec3(2, 0, 0));
  EXPECT_FALSE(line.nearestFacing({2, 1, 0}, {0, 1, 0}, 0.1f, kAnywhere));
}

}  // namespace
}  // namespace fourdvt::testing
