// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: topology with UVs per corner, shared by all frames of a character; positions, stored apart, per
// frame; normals, tangents and sizes.
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

// Surface of one frame, of any topology: indices < positions.size(), counter-clockwise seen from outside.
struct TriangleMesh {
  Positions positions;  // world, metres
  std::vector<glm::uvec3> faces;
};

struct BoundingBox {
  glm::vec3 min{0}, max{0};
  void grow(std::span<const glm::vec3> points);
  glm::dvec3 middle() const { return 0.5 * (glm::dvec3(min) + glm::dvec3(max)); }
};
// Bounding box of the points; zero without any.
BoundingBox boundsOf(std::span<const glm::vec3> points);

// Area-weighted unit vertex normals, vertex_count of them; (0,1,0) for a vertex without area.
void computeVertexNormals(const std::vector<glm::uvec3>& face_vertices, const glm::vec3* positions, size_t vertex_count,
                          std::vector<glm::vec3>& normals);

// Tangent frame per vertex of the base mesh, and the texture displacement per metre along each tangent. Bake and player
// compute identical frames, so that a tangential displacement is stored as two numbers per vertex, without a pose.
struct SurfaceFrames {
  // [vertex] two orthonormal tangents of the base pose, perpendicular to its normal; right-handed with it.
  std::vector<glm::mat2x3> tangents;
  // [3 * face + corner] texture coordinates per metre along the vertex's tangents, averaged over the chart's faces
  // round the vertex for continuity inside a chart. Zero for faces without area.
  std::vector<glm::mat2> uv_from_tangents;
};

// `base`: vertex_count positions of the base mesh. Requires each texture vertex to belong to one vertex, as in decoded
// base meshes.
SurfaceFrames computeSurfaceFrames(const MeshTopology& topology, std::span<const glm::vec3> base);

// Drops the vertices without a face and renumbers the others in the order of their first use.
void dropUnusedVertices(TriangleMesh& mesh);

// Longest side of the points' bounding box, metres. Requires at least one point.
double longestSide(const Positions& positions);

// Factor from lengths of a life-size scene to lengths of this one, a power of two, so that scaling is exact and changes
// rarely. 1 if the median of the frames' longest sides is 1.42 to 2.82 m, or if no side is above 0.
double lengthScale(std::vector<double> longest_sides_m);

}  // namespace fourdvt
