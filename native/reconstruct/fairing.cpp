// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/fairing.h"

#include <algorithm>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr float kStep = 0.5f;
constexpr float kBeyond_px = 0.25f;  // how far a vertex may come to lie outside of a silhouette
constexpr int kHalvings = 5;

// Vertex pairs of all edges, each twice.
std::vector<std::pair<uint32_t, uint32_t>> edgesOf(const TriangleMesh& mesh) {
  std::vector<std::pair<uint32_t, uint32_t>> out;
  out.reserve(mesh.faces.size() * 3);
  for (const glm::uvec3& f : mesh.faces)
    for (int k = 0; k < 3; ++k) out.emplace_back(f[k], f[(k + 1) % 3]);
  return out;
}

// Each vertex moves by `share` of the way to the mean of its neighbours.
void relax(Positions& positions, const std::vector<std::pair<uint32_t, uint32_t>>& edges, float share) {
  std::vector<glm::vec3> sum(positions.size(), glm::vec3(0));
  std::vector<float> count(positions.size(), 0);
  for (const auto& [a, b] : edges) {  // a closed surface has every edge once in each direction
    sum[a] += positions[b];
    count[a] += 1;
  }
  for (size_t v = 0; v < positions.size(); ++v)
    if (count[v] > 0) positions[v] += share * (sum[v] / count[v] - positions[v]);
}

// How far a point lies inside the silhouette that it is nearest to leaving, pixels; negative outside.
float clearance(std::span<const CarvingView> views, const glm::vec3& point) {
  float least = silhouette::SilhouetteDistance::kOutside;
  for (const CarvingView& view : views) {
    const glm::dvec3 p = view.silhouette->camera.project(glm::dvec3(point));
    if (p.z > 0) least = std::min(least, view.distance.at(p.x, p.y));
  }
  return least;
}

}  // namespace

int fairSurface(TriangleMesh& mesh, std::span<const CarvingView> views, int rounds,
                const std::function<bool(const TriangleMesh&)>& still_good) {
  const auto edges = edgesOf(mesh);
  for (int round = 0; round < rounds; ++round) {
    const Positions before = mesh.positions;
    relax(mesh.positions, edges, kStep);
    inParallel(before.size(), [&](int v) {
      const float least = std::min(-kBeyond_px, clearance(views, before[v]));
      glm::vec3& p = mesh.positions[v];
      for (int half = 0; half < kHalvings && clearance(views, p) < least; ++half) p = 0.5f * (p + before[v]);
      if (clearance(views, p) < least) p = before[v];
    });
    if (still_good(mesh)) continue;
    mesh.positions = before;
    return round;
  }
  return rounds;
}

}  // namespace fourdvt::reconstruct
