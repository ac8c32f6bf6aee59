// SPDX-License-Identifier: Apache-2.0
#include "refine/surface_fit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/robust.h"

namespace fourdvt::refine {
namespace {

constexpr int kReweightings = 6;
using SparseMatrix = Eigen::SparseMatrix<double>;

}  // namespace

OffsetClaim claimOf(const OutlinePoint& s) {
  return {s.from, s.to, s.to_share, s.residual_pixels / s.pixels_per_metre};
}

std::vector<float> fitOffsets(std::span<const OffsetClaim> claims, std::span<const InnerEdge> edges,
                              std::span<const float> current, std::span<const Clearance> clearances,
                              const SurfaceFitOptions& options) {
  const Eigen::Index count = Eigen::Index(current.size());
  Eigen::VectorXd offset(count);
  for (Eigen::Index v = 0; v < count; ++v) offset[v] = current[size_t(v)];
  if (claims.empty()) return {current.begin(), current.end()};
  // Total offset constraint per point: the remaining offset of its edge plus the present one.
  std::vector<double> wanted(claims.size());
  for (size_t i = 0; i < claims.size(); ++i) {
    const OffsetClaim& c = claims[i];
    wanted[i] = c.offset_m + (1 - c.to_share) * offset[c.from] + c.to_share * offset[c.to];
  }
  Eigen::SimplicialLDLT<SparseMatrix> solver;
  std::vector<double> misfit(claims.size());
  for (int round = 0; round < kReweightings; ++round) {
    for (size_t i = 0; i < claims.size(); ++i) {
      const OffsetClaim& c = claims[i];
      misfit[i] = wanted[i] - (1 - c.to_share) * offset[c.from] - c.to_share * offset[c.to];
    }
    const double scale = std::max(1e-5, robustScale(misfit));
    const double usual = options.keep_at_median ? quantile(wanted, 0.5) : 0;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    const auto add = [&](uint32_t a, uint32_t b, double value) { entries.emplace_back(int(a), int(b), value); };
    for (Eigen::Index v = 0; v < count; ++v)
      entries.emplace_back(int(v), int(v), options.keep), right[v] += options.keep * usual;
    for (const InnerEdge& e : edges) {
      add(e.from, e.from, options.stiffness);
      add(e.to, e.to, options.stiffness);
      add(e.from, e.to, -options.stiffness);
      add(e.to, e.from, -options.stiffness);
    }
    for (size_t i = 0; i < claims.size(); ++i) {
      const OffsetClaim& c = claims[i];
      const double w = tukeyWeight(misfit[i] / scale);
      const double a = 1 - c.to_share, b = c.to_share;
      add(c.from, c.from, w * a * a);
      add(c.to, c.to, w * b * b);
      add(c.from, c.to, w * a * b);
      add(c.to, c.from, w * a * b);
      right[c.from] += w * a * wanted[i];
      right[c.to] += w * b * wanted[i];
    }
    SparseMatrix matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (round == 0) solver.analyzePattern(matrix);
    solver.factorize(matrix);
    offset = solver.solve(right);
  }
  std::vector<float> out(current.size());
  for (size_t v = 0; v < out.size(); ++v)
    out[v] = float(std::clamp(offset[Eigen::Index(v)], -options.bound_m, options.bound_m));
  keepClear(clearances, out);
  return out;
}

namespace {

constexpr float kShare = 0.8f;        // share of the thickness that offsets may take up
constexpr float kMinOpposite = 0.5f;  // minimum cosine between one side's normal and the other's, reversed
constexpr float kCovered_m = 0.05f;   // search range for surfaces that cover a sample
constexpr int kPushRounds = 200;
constexpr float kSettled_m = 2e-6f;                // termination: maximum step of all vertices
constexpr float kCell_m = 0.02f, kMaxCells = 200;  // side; maximum number along the mesh's longest side
constexpr glm::vec3 kPlaces[] = {
    {4 / 6.f, 1 / 6.f, 1 / 6.f}, {1 / 6.f, 4 / 6.f, 1 / 6.f}, {1 / 6.f, 1 / 6.f, 4 / 6.f}, {1 / 3.f, 1 / 3.f, 1 / 3.f}};

uint64_t keyOf(const glm::ivec3& cell) {
  const auto part = [](int v) { return uint64_t(uint32_t(v + (1 << 20)) & 0x1fffff); };
  return part(cell.x) << 42 | part(cell.y) << 21 | part(cell.z);
}

// Uniform grid of the faces' bounding boxes.
class Faces {
 public:
  Faces(std::span<const glm::uvec3> face_vertices, std::span<const glm::vec3> positions)
      : face_vertices_(face_vertices), positions_(positions) {
    if (positions.empty()) return;
    const BoundingBox box = boundsOf(positions);
    low_ = box.min;
    const glm::vec3 size = box.max - low_;
    cell_m_ = std::max(kCell_m, std::max(size.x, std::max(size.y, size.z)) / kMaxCells);
    for (uint32_t f = 0; f < face_vertices.size(); ++f) {
      const glm::vec3 a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
      eachCell(glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)),
               [&](uint64_t key) { cells_[key].push_back(f); });
    }
  }

  struct Hit {
    uint32_t face = 0;
    glm::vec3 shares{0};  // barycentric weights
    float distance_m = 0;
    bool from_behind = false;
  };
  // Nearest face but `own` along the unit vector `ray`, closer than `reach`.
  std::optional<Hit> along(const glm::vec3& from, const glm::vec3& ray, uint32_t own, float reach) const {
    std::optional<Hit> nearest;
    const auto before = [&] { return nearest ? nearest->distance_m : reach; };
    for (float start = 0; start < before(); start += cell_m_) {
      const glm::vec3 a = from + start * ray, b = from + std::min(start + cell_m_, reach) * ray;
      eachCell(glm::min(a, b), glm::max(a, b), [&](uint64_t key) {
        const auto it = cells_.find(key);
        if (it == cells_.end()) return;
        for (const uint32_t f : it->second) {
          if (f == own) continue;
          const std::optional<Hit> hit = meet(from, ray, f);
          if (hit && hit->distance_m < before()) nearest = hit;
        }
      });
    }
    return nearest;
  }

 private:
  template <class Use>
  void eachCell(const glm::vec3& low_point, const glm::vec3& high_point, Use use) const {
    const glm::ivec3 low = cellOf(low_point), high = cellOf(high_point);
    for (int x = low.x; x <= high.x; ++x)
      for (int y = low.y; y <= high.y; ++y)
        for (int z = low.z; z <= high.z; ++z) use(keyOf({x, y, z}));
  }
  glm::ivec3 cellOf(const glm::vec3& point) const { return glm::floor((point - low_) / cell_m_); }
  glm::vec3 corner(uint32_t face, int k) const { return positions_[face_vertices_[face][k]]; }

  // Intersects a ray with a triangle. Source: Tomas Möller, Ben Trumbore: Fast, Minimum Storage Ray/Triangle
  // Intersection. Journal of Graphics Tools 2(1), 1997.
  std::optional<Hit> meet(const glm::vec3& from, const glm::vec3& ray, uint32_t face) const {
    const glm::vec3 a = corner(face, 0), ab = corner(face, 1) - a, ac = corner(face, 2) - a;
    const glm::vec3 p = glm::cross(ray, ac);
    const float size = glm::dot(ab, p);  // negative: hit from behind
    if (size == 0) return std::nullopt;
    const glm::vec3 to = from - a, q = glm::cross(to, ab);
    const float u = glm::dot(to, p) / size, v = glm::dot(ray, q) / size, distance = glm::dot(ac, q) / size;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && distance > 0)) return std::nullopt;
    return Hit{face, {1 - u - v, u, v}, distance, size < 0};
  }

  const std::span<const glm::uvec3> face_vertices_;
  const std::span<const glm::vec3> positions_;
  glm::vec3 low_{0};
  float cell_m_ = kCell_m;
  std::unordered_map<uint64_t, std::vector<uint32_t>> cells_;
};

}  // namespace

std::vector<Clearance> clearancesOf(std::span<const glm::uvec3> face_vertices, std::span<const glm::vec3> positions,
                                    std::span<const glm::vec3> normals, float bound_m) {
  std::vector<Clearance> out;
  const Faces faces(face_vertices, positions);
  const auto mixed = [&](const glm::uvec3& v, const glm::vec3& shares, std::span<const glm::vec3> of) {
    return shares.x * of[v.x] + shares.y * of[v.y] + shares.z * of[v.z];
  };
  for (uint32_t f = 0; f < face_vertices.size(); ++f) {
    for (uint32_t i = 0; i < std::size(kPlaces); ++i) {
      const glm::vec3& place = kPlaces[i];
      const glm::vec3 sum = mixed(face_vertices[f], place, normals), point = mixed(face_vertices[f], place, positions);
      const float length = glm::length(sum);
      if (!(length > 0)) continue;
      const glm::vec3 inward = sum / -length;
      const auto behind = faces.along(point, inward, f, 2 * bound_m / kShare);
      if (!behind || !behind->from_behind) continue;
      const glm::uvec3 other = face_vertices[behind->face];
      const float opposite = glm::dot(inward, mixed(other, behind->shares, normals));
      if (opposite < kMinOpposite) continue;
      // Inside another part of the mesh, the surface behind is not the other side of this part.
      const auto before = faces.along(point, -inward, f, kCovered_m);
      if (before && before->from_behind) continue;
      Clearance c{.place = f * uint32_t(std::size(kPlaces)) + i, .max_m = kShare * behind->distance_m};
      for (int k = 0; k < 3; ++k) {
        c.vertices[k] = face_vertices[f][k];
        c.shares[k] = -place[k];
        c.vertices[3 + k] = other[k];
        c.shares[3 + k] = -opposite * behind->shares[k];
      }
      for (int k = 3; k < 6; ++k)  // a vertex shared by both faces gets the sum of both shares
        for (int j = 0; j < 3; ++j)
          if (c.vertices[k] == c.vertices[j]) c.shares[j] += std::exchange(c.shares[k], 0.f);
      out.push_back(c);
    }
  }
  return out;
}

std::vector<Clearance> usualClearances(std::vector<Clearance> of_all_frames, size_t frames) {
  std::sort(of_all_frames.begin(), of_all_frames.end(), [](const Clearance& a, const Clearance& b) {
    return std::tie(a.place, a.max_m) < std::tie(b.place, b.max_m);
  });
  std::vector<Clearance> out;
  for (size_t first = 0, last = 0; first < of_all_frames.size(); first = last) {
    while (last < of_all_frames.size() && of_all_frames[last].place == of_all_frames[first].place) ++last;
    if (last - first > frames / 2) out.push_back(of_all_frames[first + frames / 2]);
  }
  return out;
}

void keepClear(std::span<const Clearance> clearances, std::span<float> offsets_m) {
  std::vector<float> pushed(clearances.size(), 0);  // accumulated, never below 0
  for (int round = 0; round < kPushRounds; ++round) {
    float furthest_m = 0;
    for (size_t i = 0; i < clearances.size(); ++i) {
      const Clearance& c = clearances[i];
      float closing_m = -c.max_m, give = 0;
      for (int k = 0; k < 6; ++k) {
        closing_m += c.shares[k] * offsets_m[c.vertices[k]];
        give += c.shares[k] * c.shares[k];
      }
      if (!(give > 0)) continue;
      const float push = std::max(closing_m / give, -pushed[i]);
      pushed[i] += push;
      for (int k = 0; k < 6; ++k) {
        const float step_m = push * c.shares[k];
        offsets_m[c.vertices[k]] -= step_m;
        furthest_m = std::max(furthest_m, std::abs(step_m));
      }
    }
    if (furthest_m < kSettled_m) return;
  }
}

}  // namespace fourdvt::refine
