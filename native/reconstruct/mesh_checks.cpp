// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/text.h"

namespace fourdvt::reconstruct {
namespace {

Triangle corners(const TriangleMesh& mesh, uint32_t face) {
  const glm::uvec3& f = mesh.faces[face];
  return {glm::dvec3(mesh.positions[f.x]), glm::dvec3(mesh.positions[f.y]), glm::dvec3(mesh.positions[f.z])};
}

// Counts edges without exactly two faces of opposite direction.
void checkEdges(const TriangleMesh& mesh, MeshReport& report) {
  struct Directed {
    uint64_t ends;  // the lower vertex in the upper half
    int direction;
    bool operator<(const Directed& other) const { return ends < other.ends; }
  };
  std::vector<Directed> edges;
  for (const glm::uvec3& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const uint64_t a = f[k], b = f[(k + 1) % 3];
      edges.push_back({std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(edges.begin(), edges.end());
  int distinct = 0;
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end, ++distinct) {
    int forward = 0, backward = 0;
    for (; end < edges.size() && edges[end].ends == edges[begin].ends; ++end)
      ++(edges[end].direction > 0 ? forward : backward);
    if (forward != 1 || backward != 1) report.open_edges += size_t(forward + backward);
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

// Sorts the faces' boxes along the longest axis and compares overlapping ones.
void checkCrossings(const TriangleMesh& mesh, double tolerance_m, MeshReport& report) {
  struct Box {
    glm::dvec3 low, high;
    uint32_t face;
  };
  std::vector<Box> boxes;
  glm::dvec3 low(mesh.positions[mesh.faces[0].x]), high = low;
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Triangle t = corners(mesh, f);
    boxes.push_back({glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2])), f});
    low = glm::min(low, boxes.back().low);
    high = glm::max(high, boxes.back().high);
  }
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { return a.low[axis] < b.low[axis]; });
  for (size_t i = 0; i < boxes.size(); ++i)
    for (size_t k = i + 1; k < boxes.size() && boxes[k].low[axis] <= boxes[i].high[axis]; ++k) {
      const Box &a = boxes[i], &b = boxes[k];
      if (glm::any(glm::greaterThan(a.low, b.high)) || glm::any(glm::greaterThan(b.low, a.high))) continue;
      report.crossing_pairs += crossingDepth(corners(mesh, a.face), corners(mesh, b.face), tolerance_m) > 0;
    }
}

}  // namespace

MeshReport checkMesh(const TriangleMesh& mesh, double tolerance_m) {
  MeshReport report;
  for (const glm::uvec3& f : mesh.faces)
    report.bad_indices += glm::any(glm::greaterThanEqual(f, glm::uvec3(uint32_t(mesh.positions.size()))));
  if (report.bad_indices > 0 || mesh.faces.empty()) return report;
  checkEdges(mesh, report);
  checkComponents(mesh, report);
  checkDegenerate(mesh, tolerance_m, report);
  checkCrossings(mesh, tolerance_m, report);
  return report;
}

std::string describe(const MeshReport& r) {
  return printed(
      "%zu bad indices, %zu open edges, %zu inverted of %d components, %zu crossing pairs, %zu degenerate "
      "faces, Euler characteristic %d, %.6g m3",
      r.bad_indices, r.open_edges, r.inverted_components, r.components, r.crossing_pairs, r.degenerate_faces, r.euler,
      r.volume_m3);
}

namespace {

// Unit vector, or zero for an edge without length.
glm::dvec3 direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

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

}  // namespace

double crossingDepth(const Triangle& a, const Triangle& b, double tolerance) {
  glm::dvec3 edges_a[3], edges_b[3];
  for (int i = 0; i < 3; ++i) {
    edges_a[i] = direction(a[(i + 1) % 3] - a[i]);
    edges_b[i] = direction(b[(i + 1) % 3] - b[i]);
  }
  const glm::dvec3 normal_a = glm::cross(edges_a[0], edges_a[1]), normal_b = glm::cross(edges_b[0], edges_b[1]);
  double depth = std::numeric_limits<double>::infinity();
  const auto apart = [&](const glm::dvec3& axis) {
    depth = std::min(depth, overlap(a, b, axis));
    return depth <= tolerance;
  };
  // Coplanar triangles have zero overlap along the normal; within the plane they may overlap.
  const auto spread = [&](const Triangle& of, const Triangle& from, const glm::dvec3& normal) {
    double most = 0;
    for (const glm::dvec3& p : of) most = std::max(most, std::abs(glm::dot(p - from[0], direction(normal))));
    return most;
  };
  const bool flat = glm::length(normal_a) > 0 && glm::length(normal_b) > 0 && spread(b, a, normal_a) <= tolerance &&
                    spread(a, b, normal_b) <= tolerance;
  if (flat && glm::dot(normal_a, normal_b) < 0) return 0;  // two sides of a sheet
  if (!flat && (apart(normal_a) || apart(normal_b))) return 0;
  for (int i = 0; i < 3; ++i) {
    if (apart(glm::cross(normal_a, edges_a[i])) || apart(glm::cross(normal_b, edges_b[i]))) return 0;
    for (int k = 0; k < 3 && !flat; ++k)
      if (apart(glm::cross(edges_a[i], edges_b[k]))) return 0;
  }
  return std::isfinite(depth) ? depth : 0;  // no overlap between points
}

}  // namespace fourdvt::reconstruct
