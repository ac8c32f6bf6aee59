// SPDX-License-Identifier: Apache-2.0
// Geometry of a plane.
#pragma once

#include <glm/glm.hpp>

namespace fourdvt {

// Twice the signed area of the triangle (0, a, b).
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace fourdvt
