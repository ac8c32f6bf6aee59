// SPDX-License-Identifier: Apache-2.0
// Rigid motions over the ground at a constant rate. The ground is the xz plane and y is up, as in captures.
#pragma once

#include <glm/glm.hpp>

namespace fourdvt {

// A turn about the y axis, then a shift.
struct GroundMotion {
  double turn_rad = 0;    // positive from +z towards +x
  glm::dvec2 shift_m{0};  // along x and z
  glm::dvec3 operator()(const glm::dvec3& p) const;
};
// The share of a motion that a constant rate reaches after that share of its time; negative ones lead back, -1 is the
// inverse. Requires a turn of less than a whole one.
GroundMotion shareOf(const GroundMotion& motion, double share);
// Velocity at a place, metres per duration of the motion.
glm::dvec3 velocityAt(const GroundMotion& motion, const glm::dvec3& place);

}  // namespace fourdvt
