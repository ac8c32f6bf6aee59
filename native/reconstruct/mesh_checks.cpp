// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/mesh_checks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kStrips = 64;

Triangle corners(const TriangleMesh& mesh, uint32_t face) {
  const glm::uvec3& f = mesh.faces[face];
  return {glm::dvec3(mesh.positions[f.x]), glm::dvec3(mesh.positions[f.y]), glm::dvec3(mesh.positions[f.z])};
}

// Counts edges without exactly two faces of opposite direction.
void checkEdges(const TriangleMesh& mesh, MeshReport& report) {
  // Edges by their lower vertex; the higher one, and the direction in the lowest bit.
  std::vector<uint32_t> ends(mesh.positions.size() + 1, 0);
  std::vector<uint64_t> edges(3 * mesh.faces.size());
  const auto forEach = [&](const auto& take) {
    for (const glm::uvec3& f : mesh.faces)
      for (int k = 0; k < 3; ++k) {
        const uint64_t a = f[k], b = f[(k + 1) % 3];
        take(std::min(a, b), std::max(a, b) << 1 | (a < b));
      }
  };
  forEach([&](uint64_t lower, uint64_t) { ++ends[lower + 1]; });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  forEach([&](uint64_t lower, uint64_t edge) { edges[ends[lower]++] = edge; });
  int distinct = 0;
  for (size_t v = 0, begin = 0; v < mesh.positions.size(); ++v) {
    std::sort(edges.begin() + long(begin), edges.begin() + long(ends[v]));
    for (size_t end = begin; begin < ends[v]; begin = end, ++distinct) {
      int forward = 0, backward = 0;
      for (; end < ends[v] && edges[end] >> 1 == edges[begin] >> 1; ++end) ++(edges[end] & 1 ? forward : backward);
      if (forward != 1 || backward != 1) report.open_edges += size_t(forward + backward);
    }
  }
  std::vector<bool> used(mesh.positions.size(), false);
  for (const glm::uvec3& f : mesh.faces) used[f.x] = used[f.y] = used[f.z] = true;
  report.euler = int(std::count(used.begin(), used.end(), true)) - distinct + int(mesh.faces.size());
}

// Computes the component of each face; returns the number of components.
int componentsOf(const TriangleMesh& mesh, std::vector<int>& component) {
  std::vector<uint32_t> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const glm::uvec3& f : mesh.faces) root[find(f.x)] = root[find(f.z)] = find(f.y);
  std::vector<int> number(mesh.positions.size(), -1);
  int count = 0;
  for (const glm::uvec3& f : mesh.faces) {
    int& n = number[find(f.x)];
    if (n < 0) n = count++;
    component.push_back(n);
  }
  return count;
}

// Solid angle of the face seen from p, over 4π, > 0 from behind. Source: Adriaan van Oosterom, Jan Strackee: The Solid
// Angle of a Plane Triangle. IEEE Transactions on Biomedical Engineering 30(2), 1983.
double winding(const Triangle& t, const glm::dvec3& p) {
  const glm::dvec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double above = glm::dot(a, glm::cross(b, c));
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return std::atan2(above, below) / (2 * std::numbers::pi);
}

void checkComponents(const TriangleMesh& mesh, MeshReport& report) {
  std::vector<int> component;
  report.components = componentsOf(mesh, component);
  std::vector<double> volumes(report.components, 0);
  std::vector<glm::dvec3> points(report.components);  // one point of each component
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Triangle t = corners(mesh, f);
    const glm::dvec3 origin(mesh.positions[mesh.faces[0].x]);
    volumes[component[f]] += glm::dot(t[0] - origin, glm::cross(t[1] - origin, t[2] - origin)) / 6;
    points[component[f]] = t[0];
  }
  report.volume_m3 = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  for (int c = 0; c < report.components; ++c) {
    double round = 0;  // winding number of the other components around that point
    for (uint32_t f = 0; f < mesh.faces.size(); ++f)
      if (component[f] != c) round += winding(corners(mesh, f), points[c]);
    const bool surrounded = round > 0.5;
    if (surrounded ? volumes[c] > 0 : volumes[c] < 0) ++report.inverted_components;
  }
}

void checkDegenerate(const TriangleMesh& mesh, double tolerance_m, MeshReport& report) {
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Triangle t = corners(mesh, f);
    const double longest = std::max({glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
    const double twice = glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    report.degenerate_faces += twice <= tolerance_m * longest || longest <= tolerance_m;
  }
}

// Unit vector, or zero for an edge without length.
glm::dvec3 direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

struct Facet {
  Triangle at;
  glm::dvec3 edges[3], normal, unit_normal;  // edges: unit vectors
  Facet() = default;
  explicit Facet(const Triangle& t) : at(t) {
    for (int i = 0; i < 3; ++i) edges[i] = direction(t[(i + 1) % 3] - t[i]);
    normal = glm::cross(edges[0], edges[1]);
    unit_normal = direction(normal);
  }
};
double depthOf(const Facet& a, const Facet& b, double tolerance);

// Sorts the faces' boxes into strips along the second longest axis, and those of a strip along the longest one, and
// compares overlapping ones. Counts the pairs that cross; may end after the first if `any` is true.
size_t crossingPairs(const TriangleMesh& mesh, double tolerance_m, bool any) {
  struct Box {
    glm::vec3 low, high;
    uint32_t face;
  };
  std::vector<Box> boxes(mesh.faces.size());
  std::vector<Facet> facets(boxes.size());
  inParallel(boxes.size(), [&](int f) {
    const glm::uvec3& face = mesh.faces[f];
    const glm::vec3 &a = mesh.positions[face.x], &b = mesh.positions[face.y], &c = mesh.positions[face.z];
    boxes[f] = {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), uint32_t(f)};
    facets[f] = Facet(corners(mesh, uint32_t(f)));
  });
  glm::vec3 low = boxes[0].low, high = boxes[0].high;
  for (const Box& box : boxes) low = glm::min(low, box.low), high = glm::max(high, box.high);
  const glm::vec3 size = high - low;
  int axes[] = {0, 1, 2};
  std::sort(axes, axes + 3, [&](int a, int b) { return size[a] > size[b]; });
  const int along = axes[0], across = axes[1];
  const auto stripOf = [&](float place) {
    return size[across] > 0 ? std::clamp(int((place - low[across]) / size[across] * kStrips), 0, kStrips - 1) : 0;
  };
  std::vector<std::vector<Box>> strips(kStrips);
  for (const Box& box : boxes)
    for (int s = stripOf(box.low[across]); s <= stripOf(box.high[across]); ++s) strips[s].push_back(box);
  std::atomic<size_t> pairs = 0;
  inParallel(strips.size(), [&](int s) {
    std::vector<Box>& strip = strips[s];
    std::sort(strip.begin(), strip.end(), [&](const Box& a, const Box& b) { return a.low[along] < b.low[along]; });
    for (size_t i = 0; i < strip.size() && !(any && pairs > 0); ++i) {
      const Box& a = strip[i];
      for (size_t k = i + 1; k < strip.size() && strip[k].low[along] <= a.high[along]; ++k) {
        const Box& b = strip[k];
        if (glm::any(glm::greaterThan(a.low, b.high)) || glm::any(glm::greaterThan(b.low, a.high))) continue;
        if (stripOf(std::max(a.low[across], b.low[across])) != s) continue;  // each pair in one strip
        if (depthOf(facets[a.face], facets[b.face], tolerance_m) > 0) ++pairs;
      }
    }
  });
  return pairs;
}

size_t badIndices(const TriangleMesh& mesh) {
  return size_t(std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const glm::uvec3& f) {
    return glm::any(glm::greaterThanEqual(f, glm::uvec3(uint32_t(mesh.positions.size()))));
  }));
}

}  // namespace

MeshReport checkMesh(const TriangleMesh& mesh, double tolerance_m) {
  MeshReport report;
  report.bad_indices = badIndices(mesh);
  if (report.bad_indices > 0 || mesh.faces.empty()) return report;
  checkEdges(mesh, report);
  checkComponents(mesh, report);
  checkDegenerate(mesh, tolerance_m, report);
  report.crossing_pairs = crossingPairs(mesh, tolerance_m, false);
  return report;
}

bool isSolid(const TriangleMesh& mesh, double tolerance_m) {
  if (badIndices(mesh) > 0) return false;
  if (mesh.faces.empty()) return true;
  MeshReport report;
  checkEdges(mesh, report);
  if (!report.closed() || crossingPairs(mesh, tolerance_m, true) > 0) return false;
  checkComponents(mesh, report);
  return report.outward();
}

std::string describe(const MeshReport& r) {
  return printed(
      "%zu bad indices, %zu open edges, %zu inverted of %d components, %zu crossing pairs, %zu degenerate "
      "faces, Euler characteristic %d, %.6g m3",
      r.bad_indices, r.open_edges, r.inverted_components, r.components, r.crossing_pairs, r.degenerate_faces, r.euler,
      r.volume_m3);
}

namespace {

// Overlap of the projections onto the axis; infinity for a zero axis. By the separating axis theorem, convex bodies are
// disjoint if their projections onto a face normal or a cross product of edges are; coplanar triangles if those onto
// edge normals within the plane are.
double overlap(const Triangle& a, const Triangle& b, const glm::dvec3& axis) {
  const double length = glm::length(axis);
  if (length < 1e-150) return std::numeric_limits<double>::infinity();
  const glm::dvec3 unit = axis / length;
  const glm::dvec3& origin = a[0];  // keeps numbers, and hence rounding errors, small
  const auto shadow = [&](const Triangle& t) {
    const double p = glm::dot(t[0] - origin, unit), q = glm::dot(t[1] - origin, unit),
                 r = glm::dot(t[2] - origin, unit);
    return glm::dvec2(std::min({p, q, r}), std::max({p, q, r}));
  };
  const glm::dvec2 of_a = shadow(a), of_b = shadow(b);
  return std::min(of_a.y - of_b.x, of_b.y - of_a.x);
}

// See crossingDepth.
double depthOf(const Facet& a, const Facet& b, double tolerance) {
  double depth = std::numeric_limits<double>::infinity();
  const auto apart = [&](const glm::dvec3& axis) {
    depth = std::min(depth, overlap(a.at, b.at, axis));
    return depth <= tolerance;
  };
  // Coplanar triangles have zero overlap along the normal; within the plane they may overlap.
  const auto spread = [&](const Facet& of, const Facet& from) {
    double most = 0;
    for (const glm::dvec3& p : of.at) most = std::max(most, std::abs(glm::dot(p - from.at[0], from.unit_normal)));
    return most;
  };
  const bool flat =
      glm::length(a.normal) > 0 && glm::length(b.normal) > 0 && spread(b, a) <= tolerance && spread(a, b) <= tolerance;
  if (flat && glm::dot(a.normal, b.normal) < 0) return 0;  // two sides of a sheet
  if (!flat && (apart(a.normal) || apart(b.normal))) return 0;
  for (int i = 0; i < 3; ++i) {
    if (apart(glm::cross(a.normal, a.edges[i])) || apart(glm::cross(b.normal, b.edges[i]))) return 0;
    for (int k = 0; k < 3 && !flat; ++k)
      if (apart(glm::cross(a.edges[i], b.edges[k]))) return 0;
  }
  return std::isfinite(depth) ? depth : 0;  // no overlap between points
}

}  // namespace

double crossingDepth(const Triangle& a, const Triangle& b, double tolerance) {
  return depthOf(Facet(a), Facet(b), tolerance);
}

}  // namespace fourdvt::reconstruct
