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

// The last corner before each one that has the same vertex and, if `uvs` are given, the same texture coordinates; its
// own number where there is none.
std::vector<uint32_t> cornersBefore(std::span<const glm::uvec3> vertices, std::span<const glm::uvec3> uvs,
                                    size_t vertex_count);

// For draws in which all such corners are shaded alike.
std::vector<uint32_t> firstCorners(std::vector<uint32_t> before);

// For draws in which they are if their faces have the same labels, too. labels: [member][face], packed.
void shareCorners(std::span<const uint32_t> before, std::span<const uint32_t> labels, std::vector<uint32_t>& shared);

}  // namespace fourdvt::render
