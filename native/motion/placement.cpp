// SPDX-License-Identifier: Apache-2.0
#include "motion/placement.h"

#include <cmath>

namespace fourdvt::motion {
namespace {

// Turns a ground vector (x, z) by a heading.
glm::vec2 turned(const glm::vec2& v, float heading_rad) {
  const float c = std::cos(heading_rad), s = std::sin(heading_rad);
  return {c * v.x + s * v.y, c * v.y - s * v.x};
}

}  // namespace

glm::mat4 worldFromCharacter(const Placement& placement) {
  const float c = std::cos(placement.heading_rad), s = std::sin(placement.heading_rad);
  return {{c, 0, -s, 0}, {0, 1, 0, 0}, {s, 0, c, 0}, {placement.ground_m.x, 0, placement.ground_m.y, 1}};
}

Placement moved(const Placement& placement, const glm::vec3& step) {
  return {placement.ground_m + turned({step.x, step.y}, placement.heading_rad),
          wrapAngle(placement.heading_rad + step.z)};
}

glm::vec3 stepBetween(const glm::vec3& from, const glm::vec3& to) {
  return {turned(glm::vec2(to) - glm::vec2(from), -from.z), to.z - from.z};
}

float wrapAngle(float radians) {
  constexpr float kTurn_rad = 6.28318531f;
  return radians - kTurn_rad * std::nearbyint(radians / kTurn_rad);
}

}  // namespace fourdvt::motion
