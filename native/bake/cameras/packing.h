// SPDX-License-Identifier: Apache-2.0
// Places rectangles beside each other. The same input gives the same places on every machine.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt::bake {

struct Packing {
  int height = 0;
  std::vector<glm::ivec2> places;  // of the rectangles' top left corners, in the order of the sizes
};

// Packs into a strip of this width, by a skyline: each rectangle, the tallest first, goes where it lies highest up. No
// rectangle is wider than the strip; those without area lie at (0, 0) and take no space.
Packing packInto(std::span<const glm::ivec2> sizes, int width);

}  // namespace fourdvt::bake
