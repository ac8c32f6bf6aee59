// SPDX-License-Identifier: Apache-2.0
// Planes that bound a polyhedral visual hull: the six faces of the bounds, and per edge of an outline a wedge between
// two viewing lines. Normals point out of the hull. Coordinates are scaled: the bounds' centre is the origin, their
// longest half side is 1. Plane predicates are exact, since vertices are represented by their planes.
//
// Source: Steven Fortune, Christopher J. Van Wyk: Static Analysis Yields Efficient Exact Integer Arithmetic for
// Computational Geometry. ACM Transactions on Graphics 15(3), 1996.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "reconstruct/polyhedral_hull.h"

namespace fourdvt::reconstruct {
// Plane n · x + d = 0 with integer coefficients of at most 2^29, so that the determinant of four planes fits into 128
// bits.
struct Plane {
  std::array<double, 4> coefficients{};  // integers; n and d

  // Rounds the plane normal · x + offset = 0 with unit normal, which moves it by about 2^-27 within [-1, 1]³.
  static Plane rounded(const glm::dvec3& normal, double offset);
};

// Intersection line of two planes, directed along the cross product of their normals.
struct PlaneLine {
  PlaneLine(const Plane& first, const Plane& second);
  const Plane *first, *second;          // borrowed
  double m01, m02, m03, m12, m13, m23;  // minors of the two rows
};

// Intersection point of three planes.
class PlanePoint {
 public:
  PlanePoint() = default;
  PlanePoint(const PlaneLine& line, const Plane& third);  // borrows the planes
  // 1: the third plane's value grows along the line; -1: it falls; 0: no unique intersection.
  int heading() const { return heading_; }
  // Exact sign of n · x + d of another plane at the point; 0: the plane passes through it, or the point is not unique.
  int side(const Plane& other) const;
  glm::dvec3 position() const;

 private:
  std::array<const Plane*, 3> planes_{};
  std::array<double, 4> homogeneous_{};
  int heading_ = 0;
};

constexpr uint32_t kBoundPlanes = 6;
constexpr int kBounds = -1;  // index in place of a camera

struct HullPlane {
  Plane plane;
  glm::dvec3 normal{0};  // unit, equal in world and scaled coordinates
  int camera = kBounds;
  // Wedges only: planes of the previous and next edge in the ring. A point of this plane on the given sides of them
  // lies between the wedge's two viewing lines and in front of the camera.
  uint32_t previous = 0, next = 0;
  int previous_side = 0, next_side = 0;
  glm::dvec2 from{0}, to{0};   // edge, pixels; background has cross(to - from, x - from) > 0
  glm::dvec3 from_ray{0};      // unit direction of the viewing line through `from`
  bool reaches_bounds = true;  // false: the wedge lies outside the bounds
};

struct HullPlanes {
  std::vector<HullPlane> planes;    // bounds first, then wedges by camera
  std::vector<uint32_t> first;      // [camera] first plane; the total at the end
  std::vector<glm::dvec3> centres;  // [camera] scaled
  glm::dvec3 centre_in_world{0};    // metres
  double metres_per_unit = 1;

  glm::dvec3 inWorld(const glm::dvec3& scaled) const { return centre_in_world + metres_per_unit * scaled; }
  std::span<const HullPlane> ofCamera(int camera) const {
    return std::span(planes).subspan(first[camera], first[camera + 1] - first[camera]);
  }
};

// Perturbation of planes into general position, in which no four of them meet in a point. Nearly flat corners of an
// outline are removed, since rounding would move the line of their planes far.
struct PlaneRounding {
  uint32_t seed = 1;          // random seed of the perturbation
  double jiggle = 0x1p-21;    // maximum change of a coefficient; scaled
  double min_turn_px = 0.01;  // minimum distance of a corner from the line between its neighbours
};

// Planes of the bounds and of all cameras' outlines. Errors: InvalidArgument (no cones or bounds, a camera within the
// bounds or closer to them than a thousandth of their size, two cameras at one position, non-finite numbers).
Result<HullPlanes> hullPlanes(std::span<const SilhouetteCone> cones, const BoundingBox& bounds,
                              const PlaneRounding& rounding = {});

// Visits every pair of wedges of two cameras that may meet within the bounds, once, as (plane of `first`, plane of
// `second`). The half planes through the baseline sort both cameras' viewing lines by angle; only wedges with
// overlapping angles can meet. Stops when `visit` returns false.
void visitEpipolarPairs(const HullPlanes& planes, int first, int second,
                        const std::function<bool(uint32_t, uint32_t)>& visit);

}  // namespace fourdvt::reconstruct
