// SPDX-License-Identifier: Apache-2.0
// Geometry of the picture's plane. Internal to reconstruct/.
#pragma once

#include <glm/glm.hpp>

namespace fourdvt::reconstruct {

// Twice the signed area of the triangle (0, a, b).
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace fourdvt::reconstruct
