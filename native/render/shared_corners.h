// SPDX-License-Identifier: Apache-2.0
// Index lists that let faces share shaded vertices, and coarse faces for shadows. The list's entry for a corner (three
// per face) is the first corner with equal shading; shaders pull data by gl_VertexID, so draws with and without the
// list give the same picture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt::render {

// Returns for each corner the previous corner with the same texture coordinates, or its own index. uvs: indices of the
// faces' corners, below uv_count.
std::vector<uint32_t> cornersBefore(std::span<const glm::uvec3> uvs, size_t uv_count);

// Shares corners of equal vertex, texture coordinates and face labels. before: cornersBefore; labels: [member][face],
// packed.
void shareCorners(std::span<const uint32_t> before, std::span<const glm::uvec3> vertices,
                  std::span<const uint32_t> labels, std::vector<uint32_t>& shared);

// Merges vertices that share a grid cell and are connected by edges within it, each group to its vertex of minimum
// height; vertices below `fine_below_m` are kept. Vertex clustering after RB93 (Jarek Rossignac, Paul Borrel:
// Multi-resolution 3D Approximations for Rendering Complex Scenes. Modeling in Computer Graphics, 1993), restricted to
// connected surface. Returns an index list, three corners per remaining face, for content without detail.
std::vector<uint32_t> coarseCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float cell_m, float fine_below_m);

// Returns the shadow-casting faces of a character's base mesh; empty if the mesh is so coarse that all faces should
// cast.
std::vector<uint32_t> shadowCorners(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                                    float ground_y_m, float length_scale);

}  // namespace fourdvt::render
