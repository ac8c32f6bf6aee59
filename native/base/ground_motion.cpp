// SPDX-License-Identifier: Apache-2.0
// A point of the ground is the complex number z + i x, so that a turn is a product.
#include "base/ground_motion.h"

#include <cmath>
#include <complex>

namespace fourdvt {
namespace {

using Ground = std::complex<double>;

Ground groundOf(const glm::dvec3& p) { return {p.z, p.x}; }
Ground shiftOf(const GroundMotion& motion) { return {motion.shift_m.y, motion.shift_m.x}; }

// Mean direction of a turn at a constant rate, as a share of its length: ∫ exp(i t turn) dt over 0…1.
Ground arcOf(double turn_rad) {
  const Ground turning(0, turn_rad);
  return std::abs(turn_rad) < 1e-9 ? Ground(1) : (std::exp(turning) - 1.0) / turning;
}

}  // namespace

glm::dvec3 GroundMotion::operator()(const glm::dvec3& p) const {
  const Ground at = std::polar(1.0, turn_rad) * groundOf(p) + shiftOf(*this);
  return {at.imag(), p.y, at.real()};
}

GroundMotion shareOf(const GroundMotion& motion, double share) {
  const double turn = share * motion.turn_rad;
  const Ground shift = share * arcOf(turn) / arcOf(motion.turn_rad) * shiftOf(motion);
  return {turn, {shift.imag(), shift.real()}};
}

glm::dvec3 velocityAt(const GroundMotion& motion, const glm::dvec3& place) {
  const Ground velocity = Ground(0, motion.turn_rad) * groundOf(place) + shiftOf(motion) / arcOf(motion.turn_rad);
  return {velocity.imag(), 0, velocity.real()};
}

}  // namespace fourdvt
