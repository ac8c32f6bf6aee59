// SPDX-License-Identifier: Apache-2.0
// Places charts in a square texture at the largest common scale that leaves the gutters free.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace fourdvt::track {

struct PackedChart {
  std::vector<glm::dvec2> points;  // in any unit common to all charts
  std::vector<uint32_t> border;    // points of the outline, in order
};

// Turns, scales and moves the points into a texture of `texels` a side, in texels: charts lie at least `gutter_texels`
// apart and half of that from the texture's border. Returns false where they do not fit at any useful scale.
bool pack(std::vector<PackedChart>& charts, int texels, int gutter_texels);

}  // namespace fourdvt::track
