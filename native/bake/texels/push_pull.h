// SPDX-License-Identifier: Apache-2.0
// Push-pull interpolation: a smooth field through scattered valid texels (ALGORITHMS 2.4).
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace fourdvt::bake {

// `field`: size × size texels, xyz = value × weight, w = weight (0 unknown, 1 known). On return every texel with
// w < 1 has been blended towards coarser levels; w is 1 everywhere unless nothing was known. size is even.
void pushPull(std::vector<glm::vec4>& field, int size);

}  // namespace fourdvt::bake
