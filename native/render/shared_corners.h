// SPDX-License-Identifier: Apache-2.0
// Index lists by which faces share what the vertex shader makes of their corners. Shaders that pull their data by
// gl_VertexID draw the same with such a list as without one: its entry of a corner (three per face) is the first corner
// that is shaded alike.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt::render {

// The last corner before each one that has the same texture coordinates; its own number where there is none. uvs: of
// the faces' corners, less than uv_count.
std::vector<uint32_t> cornersBefore(std::span<const glm::uvec3> uvs, size_t uv_count);

// Corners are shaded alike if they have the same vertex and texture coordinates, and their faces the same labels.
// before: cornersBefore; labels: [member][face], packed.
void shareCorners(std::span<const uint32_t> before, std::span<const glm::uvec3> vertices,
                  std::span<const uint32_t> labels, std::vector<uint32_t>& shared);

// Fewer faces over the same vertices, for what shows no detail, such as a soft shadow.

// Merges vertices that lie in the same cell of a grid and are joined by edges there (RB93, but never across
// surfaces that only touch), each group to its lowest vertex; what is lower than `fine_below_m` stays as
// it is. Returns an index list (shared_corners.h), three corners per face that is left.
std::vector<uint32_t> coarseCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float cell_m, float fine_below_m);

// The faces that cast the shadow of a character of this base mesh; none where it is so coarse that all of them should.
std::vector<uint32_t> shadowCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float ground_y_m, float length_scale);

}  // namespace fourdvt::render
