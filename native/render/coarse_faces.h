// SPDX-License-Identifier: Apache-2.0
// Fewer faces over the same vertices, for what shows no detail, such as a soft shadow.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt::render {

// Merges vertices that lie in the same cell of a grid and are joined by edges there (RB93, but never across
// surfaces that only touch), each group to its lowest vertex; what is lower than `fine_below_m` stays as
// it is. Returns an index list (shared_corners.h), three corners per face that is left.
std::vector<uint32_t> coarseCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float cell_m, float fine_below_m);

// The faces that cast the shadow of a character of this base mesh; none where it is so coarse that all of them should.
std::vector<uint32_t> shadowCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float ground_y_m, float length_scale);

}  // namespace fourdvt::render
