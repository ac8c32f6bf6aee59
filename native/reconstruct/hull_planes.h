// SPDX-License-Identifier: Apache-2.0
// The planes that bound a polyhedral visual hull: six of the bounds, and one wedge between two viewing lines for every
// edge of an outline. Normals point out of the hull. Coordinates are scaled: the bounds' centre is the origin, the
// longest half of the bounds is 1.
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
// On which side of a plane three other planes meet, answered exactly. A vertex of a hull is known by its planes only,
// so that whoever asks about it gets the same answer (FV96). Does NOT break ties: planes that meet in no single point,
// or four in one, give 0.

// n · x + d, with integers of at most 2^29 as coefficients: the determinant of four planes fits into 128 bits.
struct Plane {
  std::array<double, 4> coefficients{};  // integers; n and d

  // The plane through points with normal · x + offset = 0, rounded. The normal is a unit vector. x within [-1, 1]³ is
  // where the answers are to be good; its rounding then moves the plane by about 2^-27.
  static Plane rounded(const glm::dvec3& normal, double offset);
};

// The line in which two planes meet, directed along the cross product of their normals.
struct PlaneLine {
  PlaneLine(const Plane& first, const Plane& second);
  const Plane *first, *second;          // borrowed
  double m01, m02, m03, m12, m13, m23;  // minors of the two rows
};

// The point in which three planes meet.
class PlanePoint {
 public:
  PlanePoint() = default;
  PlanePoint(const PlaneLine& line, const Plane& third);  // borrows the planes
  // 1: the third plane's value grows along the line; -1: it falls; 0: they do not meet in a point.
  int heading() const { return heading_; }
  // The sign of n · x + d of another plane here; 0: it passes through the point.
  int side(const Plane& other) const;
  glm::dvec3 position() const;

 private:
  std::array<const Plane*, 3> planes_{};
  std::array<double, 4> homogeneous_{};
  int heading_ = 0;
};

constexpr uint32_t kBoundPlanes = 6;
constexpr int kBounds = -1;  // in place of a camera

struct HullPlane {
  Plane plane;
  glm::dvec3 normal{0};  // unit, world and scaled alike
  int camera = kBounds;
  // A wedge alone: the planes of the edges before and after in its ring. Where a point of this plane lies on these
  // sides of them, it lies between the wedge's two viewing lines and in front of the camera.
  uint32_t previous = 0, next = 0;
  int previous_side = 0, next_side = 0;
  glm::dvec2 from{0}, to{0};   // pixels: the edge; background has cross(to - from, x - from) > 0
  glm::dvec3 from_ray{0};      // unit direction of the viewing line through `from`
  bool reaches_bounds = true;  // false: no point of it lies within the bounds
};

struct HullPlanes {
  std::vector<HullPlane> planes;    // the bounds', then the wedges camera after camera
  std::vector<uint32_t> first;      // per camera its first plane; the end at last
  std::vector<glm::dvec3> centres;  // per camera, scaled
  glm::dvec3 centre_in_world{0};    // metres
  double metres_per_unit = 1;

  glm::dvec3 inWorld(const glm::dvec3& scaled) const { return centre_in_world + metres_per_unit * scaled; }
  std::span<const HullPlane> ofCamera(int camera) const {
    return std::span(planes).subspan(first[camera], first[camera + 1] - first[camera]);
  }
};

// How planes are brought into general position, in which no four of them meet in a point. Corners of an outline that
// are too flat are left out: the line in which their planes meet would move far when these are rounded.
struct PlaneRounding {
  uint32_t seed = 1;            // of the chance by which coefficients are moved
  double jiggle = 0x1p-21;      // the most that they are moved; scaled
  double least_turn_px = 0.01;  // between a corner and the line between its neighbours; flatter ones are left out
};

// The planes of all cameras' outlines and of the bounds. Errors: InvalidArgument (no cones or bounds, a camera within
// the bounds or a thousandth of their size from them, two cameras at one place, numbers that are not finite).
Result<HullPlanes> hullPlanes(std::span<const SilhouetteCone> cones, const BoundingBox& bounds,
                              const PlaneRounding& rounding = {});

// Which wedges of two cameras can meet. The half planes from the line through both centres sort the viewing lines of
// both cameras by angle; two wedges meet only where their angles overlap.

// Calls `visit` with the planes of every pair that may meet within the bounds: first one of camera `first`, then one of
// camera `second`. Each pair once. Stops when `visit` returns false.
void visitEpipolarPairs(const HullPlanes& planes, int first, int second,
                        const std::function<bool(uint32_t, uint32_t)>& visit);

}  // namespace fourdvt::reconstruct
