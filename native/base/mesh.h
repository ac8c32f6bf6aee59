// SPDX-License-Identifier: Apache-2.0
// Triangle topology with UVs per corner, the same in all frames of a character. Positions are kept apart, per frame.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt {
struct MeshTopology {
  uint32_t vertex_count = 0;
  std::vector<glm::vec2> uvs;             // texture coordinates, origin TOP left (glTF); texel = uv * size
  std::vector<glm::uvec3> face_vertices;  // indices < vertex_count, counter-clockwise seen from outside
  std::vector<glm::uvec3> face_uvs;       // indices < uvs.size(), one per face

  uint32_t faceCount() const { return static_cast<uint32_t>(face_vertices.size()); }
};

using Positions = std::vector<glm::vec3>;  // vertex_count points in world, metres

// A surface of one frame, of any topology: indices < positions.size(), counter-clockwise seen from outside.
struct TriangleMesh {
  Positions positions;  // world, metres
  std::vector<glm::uvec3> faces;
};

struct BoundingBox {
  glm::vec3 min{0}, max{0};
};

// Area-weighted unit vertex normals, vertex_count of them; a vertex without area gets (0,1,0).
void computeVertexNormals(const std::vector<glm::uvec3>& face_vertices, const glm::vec3* positions, size_t vertex_count,
                          std::vector<glm::vec3>& normals);

// Two tangents per vertex of the base mesh, and how a displacement along them moves texture coordinates. Bake and
// player compute the same frames, so that a displacement of two numbers per vertex needs no pose.

struct SurfaceFrames {
  // [vertex] two orthonormal vectors of the base pose, perpendicular to its normal; right-handed with it.
  std::vector<glm::mat2x3> tangents;
  // [3 * face + corner] texture coordinates per metre along the vertex's tangents. Averaged over the chart's faces
  // round the vertex, so that the texture stays continuous inside a chart. Zero where a face has no area.
  std::vector<glm::mat2> uv_from_tangents;
};

// `base`: vertex_count positions of the base mesh. A texture vertex must belong to one vertex, as in decoded base
// meshes.
SurfaceFrames computeSurfaceFrames(const MeshTopology& topology, std::span<const glm::vec3> base);

}  // namespace fourdvt
