// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/polyhedral_hull.h"

#include "reconstruct/hull_edges.h"
#include "reconstruct/hull_planes.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kMaxAttempts = 4;
constexpr double kCoarser = 3;  // growth of the flatness threshold per attempt

}  // namespace

Result<PolyhedralHull> polyhedralHull(std::span<const SilhouetteCone> cones, const BoundingBox& bounds) {
  Error last{ErrorId::Internal, "polyhedral hull: planes meet in one point, or an outline's rings cross"};
  PlaneRounding rounding;
  for (int attempt = 1; attempt <= kMaxAttempts; ++attempt) {
    FOURDVT_ASSIGN(const HullPlanes planes, hullPlanes(cones, bounds, rounding));
    ++rounding.seed;
    rounding.min_turn_px *= kCoarser;
    auto edges = hullEdges(planes, cones);
    if (!edges) continue;
    auto mesh = hullFaces(planes, *edges);
    if (!mesh) {
      last = mesh.error();
      continue;
    }
    PolyhedralHull hull{mesh.take(), false, attempt};
    for (const HalfEdge& edge : *edges) hull.touches_bounds |= edge.plane < kBoundPlanes;
    return hull;
  }
  return last;
}

}  // namespace fourdvt::reconstruct
