// SPDX-License-Identifier: Apache-2.0
// Placement of a character on the ground, and its root motion. Ground: the xz plane. A heading turns about y, positive
// from +z towards +x; heading 0 faces +z.
#pragma once

#include <glm/glm.hpp>

namespace fourdvt::motion {

struct Placement {
  glm::vec2 ground_m{0};  // x, z in world coordinates
  float heading_rad = 0;
};

glm::mat4 worldFromCharacter(const Placement& placement);
// Applies `step`: metres along x and z and radians about y, in the character's frame before the step.
Placement moved(const Placement& placement, const glm::vec3& step);
// Step from one root value to another (rootOf in blend.h, relative to frame 0), in the character's own frame at `from`.
glm::vec3 stepBetween(const glm::vec3& from, const glm::vec3& to);
float wrapAngle(float radians);  // wraps to -π…π

}  // namespace fourdvt::motion
