// SPDX-License-Identifier: Apache-2.0
// Unsigned distance from one surface to another.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::measure {

// Distance queries from points to a surface; keeps a copy of it. Requires at least one face.
class DistanceToSurface {
 public:
  explicit DistanceToSurface(const TriangleMesh& surface);
  ~DistanceToSurface();
  DistanceToSurface(DistanceToSurface&&) noexcept;
  // Metres; clamped to `limit_m`.
  double at(const glm::dvec3& point, double limit_m = 1) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

// Points spread evenly over the surface, about one per `spacing_m` squared; deterministic.
std::vector<glm::dvec3> pointsOn(const TriangleMesh& surface, double spacing_m);

struct DistanceFigures {
  double mean_m = 0, median_m = 0, p95_m = 0;
};
DistanceFigures distanceFigures(std::vector<double> distances_m);

// Distances from points on `from` to `to`.
DistanceFigures surfaceDistance(const TriangleMesh& from, const TriangleMesh& to, double spacing_m = 0.004);

}  // namespace fourdvt::measure
