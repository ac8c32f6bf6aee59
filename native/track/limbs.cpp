// SPDX-License-Identifier: Apache-2.0
#include "track/limbs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "base/parallel.h"
#include "track/graph.h"
#include "track/mesh/nearest.h"

namespace fourdvt::track {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr double kAlone_m = 0.6;  // cost of a limb without counterpart
constexpr double kThickness = 5;  // weight of a difference of radii

// Distances along edges.
class EdgePaths {
 public:
  explicit EdgePaths(const TriangleMesh& surface) : start_(surface.positions.size() + 1, 0) {
    const std::vector<glm::uvec2> edges = edgesOf(surface.faces);
    for (const glm::uvec2& e : edges) ++start_[e.x + 1], ++start_[e.y + 1];
    for (size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
    to_.resize(2 * edges.size());
    std::vector<uint32_t> next(start_.begin(), start_.end() - 1);
    for (const glm::uvec2& e : edges) {
      const float length = glm::distance(surface.positions[e.x], surface.positions[e.y]);
      to_[next[e.x]++] = {e.y, length};
      to_[next[e.y]++] = {e.x, length};
    }
  }

  // Lowers distances to those from `source`, where they are smaller.
  void spread(uint32_t source, std::vector<double>& distances) const {
    using Entry = std::pair<double, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    distances[source] = 0;
    open.push({0, source});
    while (!open.empty()) {
      const auto [distance, v] = open.top();
      open.pop();
      if (distance > distances[v]) continue;
      for (uint32_t i = start_[v]; i < start_[v + 1]; ++i) {
        const double there = distance + to_[i].length_m;
        if (there >= distances[to_[i].vertex]) continue;
        distances[to_[i].vertex] = there;
        open.push({there, to_[i].vertex});
      }
    }
  }

 private:
  struct Edge {
    uint32_t vertex;
    float length_m;
  };
  std::vector<uint32_t> start_;  // [vertex] first edge
  std::vector<Edge> to_;
};

std::vector<double> areasOf(const TriangleMesh& surface) {
  std::vector<double> out(surface.positions.size(), 0);
  for (const glm::uvec3& f : surface.faces) {
    const glm::dvec3 a = surface.positions[f.x], b = surface.positions[f.y], c = surface.positions[f.z];
    const double area = glm::length(glm::cross(b - a, c - a)) / 6;
    for (int k = 0; k < 3; ++k) out[f[k]] += area;
  }
  return out;
}

// Rings round a tip until they widen to the trunk.
std::vector<Limb::Ring> ringsOf(const TriangleMesh& surface, std::span<const double> areas,
                                std::span<const double> from_tip, const LimbOptions& options) {
  double farthest = 0;
  for (const double d : from_tip)
    if (d < kUnreached) farthest = std::max(farthest, d);
  std::vector<Limb::Ring> rings(size_t(farthest / options.step_m) + 1);
  for (uint32_t v = 0; v < from_tip.size(); ++v)
    if (from_tip[v] < kUnreached) rings[size_t(from_tip[v] / options.step_m)].vertices.push_back(v);
  size_t end = 0;
  for (; end < rings.size() && !rings[end].vertices.empty(); ++end) {
    Limb::Ring& ring = rings[end];
    double area = 0, square = 0;
    for (const uint32_t v : ring.vertices) {
      ring.middle += areas[v] * glm::dvec3(surface.positions[v]);
      area += areas[v];
    }
    if (!(area > 0)) break;
    ring.middle /= area;
    for (const uint32_t v : ring.vertices) {
      const glm::dvec3 arm = glm::dvec3(surface.positions[v]) - ring.middle;
      square += areas[v] * glm::dot(arm, arm);
    }
    ring.radius_m = std::sqrt(square / area);
    if (ring.radius_m > options.max_radius_m) break;
  }
  rings.resize(end);
  return rings;
}

// Mean distance and difference in thickness near the trunk, which holds a limb in its place: tips swing past each
// other.
double costOf(const Limb& a, const Limb& b) {
  const size_t rings = std::min(a.rings.size(), b.rings.size()), count = std::max<size_t>(2, rings / 4);
  const size_t first = rings - std::min(rings, count);
  double apart = 0, thicker = 0;
  for (size_t k = first; k < rings; ++k) {
    apart += glm::distance(a.rings[k].middle, b.rings[k].middle);
    thicker += std::abs(a.rings[k].radius_m - b.rings[k].radius_m);
  }
  return (apart + kThickness * thicker) / double(rings - first);
}

// Best assignment of the limbs from `first` on; few enough to try all.
double assign(std::span<const Limb> from, std::span<const Limb> to, size_t first, std::vector<bool>& used,
              std::vector<LimbPair>& best) {
  best.clear();
  if (first == from.size()) return 0;
  double least = kAlone_m + assign(from, to, first + 1, used, best);
  for (size_t i = 0; i < to.size(); ++i) {
    if (used[i]) continue;
    const double cost = costOf(from[first], to[i]);
    if (cost >= kAlone_m) continue;
    used[i] = true;
    std::vector<LimbPair> others;
    const double whole = cost + assign(from, to, first + 1, used, others);
    used[i] = false;
    if (whole >= least) continue;
    least = whole;
    best = std::move(others);
    best.push_back({first, i});
  }
  return least;
}

}  // namespace

std::vector<Limb> limbsOf(const TriangleMesh& surface, const LimbOptions& options) {
  std::vector<Limb> out;
  if (surface.faces.empty()) return out;
  const EdgePaths paths(surface);
  const std::vector<double> areas = areasOf(surface);
  glm::dvec3 middle(0);
  double area = 0;
  for (size_t v = 0; v < areas.size(); ++v) middle += areas[v] * glm::dvec3(surface.positions[v]), area += areas[v];
  middle /= area;
  uint32_t trunk = 0;
  for (uint32_t v = 0; v < areas.size(); ++v)
    if (areas[v] > 0 && glm::distance(middle, glm::dvec3(surface.positions[v])) <
                            glm::distance(middle, glm::dvec3(surface.positions[trunk])))
      trunk = v;
  std::vector<double> distances(areas.size(), kUnreached);
  paths.spread(trunk, distances);
  for (int i = 0; i < options.count; ++i) {
    Limb limb;
    double farthest = 0;
    for (uint32_t v = 0; v < distances.size(); ++v)
      if (distances[v] < kUnreached && distances[v] > farthest) farthest = distances[v], limb.tip = v;
    if (farthest < options.min_length_m) break;
    std::vector<double> from_tip(areas.size(), kUnreached);
    paths.spread(limb.tip, from_tip);
    for (size_t v = 0; v < distances.size(); ++v) distances[v] = std::min(distances[v], from_tip[v]);
    limb.rings = ringsOf(surface, areas, from_tip, options);
    if (double(limb.rings.size()) * options.step_m >= options.min_length_m) out.push_back(std::move(limb));
  }
  return out;
}

std::vector<Limb> limbsOn(const Positions& positions, const TriangleMesh& surface, std::span<const Limb> limbs) {
  const NearestSurface nearest(surface);
  std::vector<uint32_t> places(positions.size());  // [vertex] nearest vertex of the surface
  inParallel(positions.size(), [&](size_t v) {
    const auto hit = nearest.nearest(positions[v], std::numeric_limits<float>::infinity());
    int corner = 0;
    for (int k = 1; k < 3; ++k)
      if (hit->barycentric[k] > hit->barycentric[corner]) corner = k;
    places[v] = surface.faces[hit->face][corner];
  });
  constexpr uint32_t kNoRing = 0xffffffff;
  std::vector<Limb> out;
  for (const Limb& limb : limbs) {
    std::vector<uint32_t> ring_of(surface.positions.size(), kNoRing);
    for (uint32_t k = 0; k < limb.rings.size(); ++k)
      for (const uint32_t v : limb.rings[k].vertices) ring_of[v] = k;
    Limb& coarse = out.emplace_back();
    coarse.rings.resize(limb.rings.size());
    for (uint32_t v = 0; v < positions.size(); ++v)
      if (const uint32_t k = ring_of[places[v]]; k != kNoRing) coarse.rings[k].vertices.push_back(v);
  }
  follow(positions, out);
  return out;
}

void follow(const Positions& positions, std::vector<Limb>& limbs) {
  for (Limb& limb : limbs)
    for (Limb::Ring& ring : limb.rings) {
      if (ring.vertices.empty()) continue;
      const auto count = double(ring.vertices.size());
      ring.middle = glm::dvec3(0);
      for (const uint32_t v : ring.vertices) ring.middle += glm::dvec3(positions[v]) / count;
      double square = 0;
      for (const uint32_t v : ring.vertices) {
        const glm::dvec3 arm = glm::dvec3(positions[v]) - ring.middle;
        square += glm::dot(arm, arm) / count;
      }
      ring.radius_m = std::sqrt(square);
    }
}

std::vector<LimbPair> pairedLimbs(std::span<const Limb> from, std::span<const Limb> to) {
  std::vector<bool> used(to.size(), false);
  std::vector<LimbPair> out;
  assign(from, to, 0, used, out);
  return out;
}

}  // namespace fourdvt::track
