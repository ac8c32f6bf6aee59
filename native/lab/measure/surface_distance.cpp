// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace fourdvt::measure {
namespace {

// Squared distance of p to the triangle a, b, c (Ericson, Real-Time Collision Detection, 5.1.5).
double squaredDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  const auto to = [&](const glm::dvec3& q) { return glm::dot(p - q, p - q); };
  if (d1 <= 0 && d2 <= 0) return to(a);
  const glm::dvec3 bp = p - b;
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return to(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return d1 == d3 ? to(a) : to(a + ab * (d1 / (d1 - d3)));
  const glm::dvec3 cp = p - c;
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return d2 == d6 ? to(a) : to(a + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6);
    return sum == 0 ? to(b) : to(b + (c - b) * ((d4 - d3) / sum));
  }
  const double whole = va + vb + vc;
  return whole == 0 ? to(a) : to(a + ab * (vb / whole) + ac * (vc / whole));
}

constexpr double kCell_m = 0.02;
constexpr double kMaxCells = 1500;  // along the longest side

uint64_t keyOf(const glm::ivec3& cell) {
  const auto part = [](int v) { return uint64_t(uint32_t(v + (1 << 20)) & 0x1fffff); };
  return part(cell.x) << 42 | part(cell.y) << 21 | part(cell.z);
}

}  // namespace

struct DistanceToSurface::Grid {
  TriangleMesh surface;
  glm::dvec3 origin{0};
  double cell_m = kCell_m;
  std::unordered_map<uint64_t, std::vector<uint32_t>> faces_by_cell;

  explicit Grid(const TriangleMesh& s) : surface(s) {
    glm::vec3 low(s.positions[s.faces[0].x]), high = low;
    for (const glm::uvec3& f : s.faces)
      for (int k = 0; k < 3; ++k) low = glm::min(low, s.positions[f[k]]), high = glm::max(high, s.positions[f[k]]);
    const glm::vec3 size = high - low;
    origin = low;
    cell_m = std::max(kCell_m, double(std::max({size.x, size.y, size.z})) / kMaxCells);
  }
  // Clamps the cell of a far point to the range of a key.
  glm::ivec3 cellOf(const glm::dvec3& point) const {
    return glm::ivec3(glm::clamp(glm::floor((point - origin) / cell_m), -1e6, 1e6));
  }

  glm::dvec3 corner(uint32_t face, int k) const { return glm::dvec3(surface.positions[surface.faces[face][k]]); }
  // Lowers `best` by the faces of one cell.
  void look(const glm::ivec3& cell, const glm::dvec3& point, double& best) const {
    const auto it = faces_by_cell.find(keyOf(cell));
    if (it == faces_by_cell.end()) return;
    for (const uint32_t f : it->second)
      best = std::min(best, squaredDistance(point, corner(f, 0), corner(f, 1), corner(f, 2)));
  }
};

DistanceToSurface::DistanceToSurface(const TriangleMesh& surface) : grid_(std::make_unique<Grid>(surface)) {
  for (uint32_t f = 0; f < surface.faces.size(); ++f) {
    const glm::dvec3 a = grid_->corner(f, 0), b = grid_->corner(f, 1), c = grid_->corner(f, 2);
    const glm::ivec3 low = grid_->cellOf(glm::min(a, glm::min(b, c))),
                     high = grid_->cellOf(glm::max(a, glm::max(b, c)));
    for (int x = low.x; x <= high.x; ++x)
      for (int y = low.y; y <= high.y; ++y)
        for (int z = low.z; z <= high.z; ++z) grid_->faces_by_cell[keyOf({x, y, z})].push_back(f);
  }
}

DistanceToSurface::~DistanceToSurface() = default;
DistanceToSurface::DistanceToSurface(DistanceToSurface&&) noexcept = default;

double DistanceToSurface::at(const glm::dvec3& point, double limit_m) const {
  const glm::ivec3 middle = grid_->cellOf(point);
  double best = limit_m * limit_m;
  // Shells of cells: content of shell r is at least r - 1 cells away.
  for (int r = 0; (r - 1) * grid_->cell_m < std::sqrt(best); ++r) {
    for (int x = -r; x <= r; ++x)
      for (int y = -r; y <= r; ++y) {
        const bool side = std::abs(x) == r || std::abs(y) == r;
        for (int z = -r; z <= r; z += side || r == 0 ? 1 : 2 * r)
          grid_->look(middle + glm::ivec3(x, y, z), point, best);
      }
  }
  return std::sqrt(best);
}

std::vector<glm::dvec3> pointsOn(const TriangleMesh& surface, double spacing_m) {
  std::vector<glm::dvec3> out;
  double owed = 0;  // points carried over from small faces
  for (const glm::uvec3& face : surface.faces) {
    const glm::dvec3 a(surface.positions[face.x]), b(surface.positions[face.y]), c(surface.positions[face.z]);
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    owed += area / (spacing_m * spacing_m);
    const auto count = size_t(owed);
    owed -= double(count);
    // A low-discrepancy sequence over the triangle (R2), folded at the diagonal.
    for (size_t i = 0; i < count; ++i) {
      double u = std::fmod(0.5 + 0.7548776662466927 * double(i), 1),
             v = std::fmod(0.5 + 0.5698402909980532 * double(i), 1);
      if (count == 1) u = v = 1.0 / 3;
      if (u + v > 1) u = 1 - u, v = 1 - v;
      out.push_back(a + (b - a) * u + (c - a) * v);
    }
  }
  return out;
}

DistanceFigures distanceFigures(std::vector<double> distances_m) {
  DistanceFigures out;
  if (distances_m.empty()) return out;
  for (double d : distances_m) out.mean_m += d / double(distances_m.size());
  std::sort(distances_m.begin(), distances_m.end());
  out.median_m = distances_m[distances_m.size() / 2];
  out.p95_m = distances_m[distances_m.size() * 95 / 100];
  return out;
}

DistanceFigures surfaceDistance(const TriangleMesh& from, const TriangleMesh& to, double spacing_m) {
  if (to.faces.empty()) return {};
  const DistanceToSurface distance(to);
  std::vector<double> all;
  for (const glm::dvec3& point : pointsOn(from, spacing_m)) all.push_back(distance.at(point));
  return distanceFigures(std::move(all));
}

}  // namespace fourdvt::measure
