// SPDX-License-Identifier: Apache-2.0
// Closed meshes of implicit surfaces: a person of capsules, a ball, a ring.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::testing {

struct Capsule {
  glm::dvec3 from, to;
  double radius_m;
};

inline double distanceTo(const Capsule& c, const glm::dvec3& p) {
  const glm::dvec3 axis = c.to - c.from;
  const double t = std::clamp(glm::dot(p - c.from, axis) / std::max(1e-12, glm::dot(axis, axis)), 0.0, 1.0);
  return glm::length(p - c.from - t * axis) - c.radius_m;
}

// Signed distance to a person, 1.75 m high, blended where limbs meet; negative inside.
inline double distanceToPerson(const glm::dvec3& p) {
  static const std::vector<Capsule> kParts = {
      {{-0.04, 0.98, 0}, {0.04, 0.98, 0}, 0.15},        {{0, 1.0, 0}, {0, 1.32, 0}, 0.145},
      {{-0.1, 1.36, 0}, {0.1, 1.36, 0}, 0.1},           {{0, 1.4, 0}, {0, 1.55, 0.01}, 0.055},
      {{0, 1.6, 0.02}, {0, 1.66, 0.02}, 0.095},         {{0.17, 1.38, 0}, {0.38, 1.12, 0}, 0.05},
      {{0.38, 1.12, 0}, {0.55, 0.92, 0.06}, 0.04},      {{0.55, 0.92, 0.06}, {0.6, 0.84, 0.08}, 0.045},
      {{-0.17, 1.38, 0}, {-0.38, 1.12, 0}, 0.05},       {{-0.38, 1.12, 0}, {-0.55, 0.92, 0.06}, 0.04},
      {{-0.55, 0.92, 0.06}, {-0.6, 0.84, 0.08}, 0.045}, {{0.09, 0.92, 0}, {0.15, 0.5, 0.02}, 0.075},
      {{0.15, 0.5, 0.02}, {0.18, 0.1, -0.02}, 0.052},   {{0.18, 0.05, -0.03}, {0.2, 0.05, 0.12}, 0.048},
      {{-0.09, 0.92, 0}, {-0.15, 0.5, 0.02}, 0.075},    {{-0.15, 0.5, 0.02}, {-0.18, 0.1, -0.02}, 0.052},
      {{-0.18, 0.05, -0.03}, {-0.2, 0.05, 0.12}, 0.048}};
  const double blend = 60;
  double sum = 0;
  for (const Capsule& part : kParts) sum += std::exp(-blend * distanceTo(part, p));
  return -std::log(sum) / blend;
}

inline double distanceToBall(const glm::dvec3& p) { return glm::length(p) - 0.5; }

inline double distanceToRing(const glm::dvec3& p) {
  return glm::length(glm::dvec2(std::hypot(p.x, p.z) - 0.5, p.y)) - 0.18;
}

// Surface nets: a vertex in each cell that the surface crosses, moved to the surface and evened out along it. Source:
// Sarah F. F. Gibson: Constrained Elastic Surface Nets. MICCAI, 1998.
template <class Distance>
class SurfaceNets {
 public:
  SurfaceNets(const Distance& distance, const glm::dvec3& low, const glm::dvec3& high, double cell_m)
      : distance_(distance), low_(low), cell_m_(cell_m), size_(glm::ceil((high - low) / cell_m)) {
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) values_.push_back(distance_(pointAt({x, y, z})));
  }

  TriangleMesh mesh() {
    TriangleMesh out;
    for (int z = 1; z + 1 < size_.z; ++z)
      for (int y = 1; y + 1 < size_.y; ++y)
        for (int x = 1; x + 1 < size_.x; ++x)
          for (int axis = 0; axis < 3; ++axis) addQuad({x, y, z}, axis, out);
    for (int i = 0; i < 12; ++i) evenOut(out);
    out.positions.assign(points_.begin(), points_.end());
    return out;
  }

 private:
  glm::dvec3 pointAt(const glm::ivec3& at) const { return low_ + cell_m_ * glm::dvec3(at); }
  size_t index(const glm::ivec3& at) const { return size_t((at.z * size_.y + at.y) * size_.x + at.x); }

  uint32_t vertexOf(const glm::ivec3& cell) {
    const auto [it, fresh] = vertices_.try_emplace(index(cell), uint32_t(points_.size()));
    if (fresh) points_.push_back(pointAt(cell) + 0.5 * cell_m_);
    return it->second;
  }

  // The four cells round the edge from `at` along `axis`, where its ends lie on different sides.
  void addQuad(const glm::ivec3& at, int axis, TriangleMesh& out) {
    glm::ivec3 along(0), right(0), up(0);
    along[axis] = right[(axis + 1) % 3] = up[(axis + 2) % 3] = 1;
    const bool inside = values_[index(at)] < 0;
    if (inside == (values_[index(at + along)] < 0)) return;
    uint32_t v[4] = {vertexOf(at - right - up), vertexOf(at - up), vertexOf(at), vertexOf(at - right)};
    if (!inside) std::swap(v[1], v[3]);
    out.faces.emplace_back(v[0], v[1], v[2]);
    out.faces.emplace_back(v[0], v[2], v[3]);
  }

  glm::dvec3 gradientAt(const glm::dvec3& p) const {
    glm::dvec3 g;
    for (int k = 0; k < 3; ++k) {
      glm::dvec3 step(0);
      step[k] = 1e-4;
      g[k] = (distance_(p + step) - distance_(p - step)) / 2e-4;
    }
    return g;
  }

  void evenOut(const TriangleMesh& mesh) {
    std::vector<glm::dvec3> sums(points_.size(), glm::dvec3(0));
    std::vector<double> counts(points_.size(), 0);
    for (const glm::uvec3& f : mesh.faces)
      for (int k = 0; k < 3; ++k) sums[f[k]] += points_[f[(k + 1) % 3]], ++counts[f[k]];
    for (size_t v = 0; v < points_.size(); ++v) {
      points_[v] += 0.5 * (sums[v] / counts[v] - points_[v]);
      for (int i = 0; i < 2; ++i) {
        const glm::dvec3 g = gradientAt(points_[v]);
        points_[v] -= distance_(points_[v]) * g / std::max(0.1, glm::dot(g, g));
      }
    }
  }

  const Distance& distance_;
  const glm::dvec3 low_;
  const double cell_m_;
  const glm::ivec3 size_;
  std::vector<double> values_;
  std::map<size_t, uint32_t> vertices_;  // by cell
  std::vector<glm::dvec3> points_;
};

inline TriangleMesh personMesh(double cell_m = 0.0265) {
  return SurfaceNets(distanceToPerson, {-0.75, -0.1, -0.3}, {0.75, 1.9, 0.35}, cell_m).mesh();
}
inline TriangleMesh ballMesh(double cell_m) {
  return SurfaceNets(distanceToBall, glm::dvec3(-0.7), glm::dvec3(0.7), cell_m).mesh();
}
inline TriangleMesh ringMesh(double cell_m) {
  return SurfaceNets(distanceToRing, {-0.9, -0.4, -0.9}, {0.9, 0.4, 0.9}, cell_m).mesh();
}

}  // namespace fourdvt::testing
