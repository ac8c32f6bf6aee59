// SPDX-License-Identifier: Apache-2.0
#include "base/mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/robust.h"

namespace fourdvt {

void computeVertexNormals(const std::vector<glm::uvec3>& face_vertices, const glm::vec3* positions, size_t vertex_count,
                          std::vector<glm::vec3>& normals) {
  normals.assign(vertex_count, glm::vec3(0));
  for (const glm::uvec3& f : face_vertices) {
    const glm::vec3 area_normal = glm::cross(positions[f.y] - positions[f.x], positions[f.z] - positions[f.x]);
    normals[f.x] += area_normal;
    normals[f.y] += area_normal;
    normals[f.z] += area_normal;
  }
  for (glm::vec3& n : normals) {
    const float length = glm::length(n);
    n = length > 1e-20f ? n / length : glm::vec3(0, 1, 0);
  }
}

namespace {

glm::mat2x3 tangentsOf(const glm::vec3& normal) {
  const glm::vec3 helper = std::abs(normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 first = glm::normalize(glm::cross(helper, normal));
  return {first, glm::cross(normal, first)};
}

// Least squares over the faces round a texture vertex: Σ du dpᵀ · (Σ dp dpᵀ)⁻¹ in the tangent plane.
struct Sums {
  glm::mat2 du_dp{0}, dp_dp{0};
  void add(const glm::vec2& du, const glm::vec2& dp) {
    du_dp += glm::outerProduct(du, dp);
    dp_dp += glm::outerProduct(dp, dp);
  }
  glm::mat2 solve() const {
    const float scale = dp_dp[0][0] + dp_dp[1][1];
    const float determinant = glm::determinant(dp_dp);
    if (!(determinant > 1e-6f * scale * scale)) return glm::mat2(0);
    return du_dp * glm::inverse(dp_dp);
  }
};

}  // namespace

SurfaceFrames computeSurfaceFrames(const MeshTopology& topology, std::span<const glm::vec3> base) {
  SurfaceFrames frames;
  std::vector<glm::vec3> normals;
  computeVertexNormals(topology.face_vertices, base.data(), base.size(), normals);
  for (const glm::vec3& normal : normals) frames.tangents.push_back(tangentsOf(normal));
  std::vector<Sums> sums(topology.uvs.size());
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t vertex = topology.face_vertices[face][corner];
      for (int other = 1; other < 3; ++other) {
        const int to = (corner + other) % 3;
        const glm::vec3 edge = base[topology.face_vertices[face][to]] - base[vertex];
        const glm::vec2 du = topology.uvs[topology.face_uvs[face][to]] - topology.uvs[topology.face_uvs[face][corner]];
        sums[topology.face_uvs[face][corner]].add(du, edge * frames.tangents[vertex]);
      }
    }
  frames.uv_from_tangents.reserve(3 * size_t(topology.faceCount()));
  for (const glm::uvec3& face : topology.face_uvs)
    for (int corner = 0; corner < 3; ++corner) frames.uv_from_tangents.push_back(sums[face[corner]].solve());
  return frames;
}

void BoundingBox::grow(std::span<const glm::vec3> points) {
  for (const glm::vec3& p : points) min = glm::min(min, p), max = glm::max(max, p);
}

BoundingBox boundsOf(std::span<const glm::vec3> points) {
  BoundingBox box;
  if (!points.empty()) box = {points[0], points[0]};
  box.grow(points);
  return box;
}

void dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<uint32_t> renumbered(mesh.positions.size(), UINT32_MAX);
  Positions used;
  for (glm::uvec3& face : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      uint32_t& number = renumbered[face[k]];
      if (number == UINT32_MAX) {
        number = static_cast<uint32_t>(used.size());
        used.push_back(mesh.positions[face[k]]);
      }
      face[k] = number;
    }
  mesh.positions = std::move(used);
}

double longestSide(const Positions& positions) {
  const auto [low, high] = boundsOf(positions);
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

double lengthScale(std::vector<double> longest_sides_m) {
  constexpr double kPerson_m = 2;  // mid-range size of a person's surface, arms raised to crouching
  const double usual_m = median(std::move(longest_sides_m));
  return usual_m > 0 ? std::exp2(std::round(std::log2(usual_m / kPerson_m))) : 1;
}

}  // namespace fourdvt
