// SPDX-License-Identifier: Apache-2.0
// Whether two triangles of space cross.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace fourdvt::reconstruct {

using Triangle = std::array<glm::dvec3, 3>;

// By how much one of them would have to move so that they do not cross, overlap in one plane included; 0: they are
// apart or touch, or are the two sides of a sheet thinner than the tolerance. Stops looking, and returns 0, when it is
// at most `tolerance`.
double crossingDepth(const Triangle& a, const Triangle& b, double tolerance);

}  // namespace fourdvt::reconstruct
