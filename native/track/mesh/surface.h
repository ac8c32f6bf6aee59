// SPDX-License-Identifier: Apache-2.0
// Half-edge view of a closed triangle mesh, as the steps of the atlas share it. Half-edge 3 * face + k runs from the
// face's corner k to its next corner.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::track {

struct Surface {
  std::vector<glm::dvec3> points;  // [vertex] metres
  std::vector<glm::uvec3> faces;
  std::vector<uint32_t> twins;      // [half-edge] the opposite half-edge
  std::vector<glm::dvec3> normals;  // [face] unit; (0,1,0) for a face without area
  std::vector<glm::dvec3> centres;  // [face] metres
  std::vector<double> areas;        // [face] square metres
  std::vector<double> seam_costs;   // [half-edge] weight of a metre of seam; equal for twins
  std::vector<double> resolution;   // [face] relative texels per metre

  uint32_t faceCount() const { return uint32_t(faces.size()); }
  uint32_t from(uint32_t half_edge) const { return faces[half_edge / 3][int(half_edge % 3)]; }
  uint32_t to(uint32_t half_edge) const { return from(next(half_edge)); }
  uint32_t faceAcross(uint32_t half_edge) const { return twins[half_edge] / 3; }
  double length(uint32_t half_edge) const { return glm::length(points[to(half_edge)] - points[from(half_edge)]); }
  static uint32_t next(uint32_t half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
  static uint32_t previous(uint32_t half_edge) { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }
};

// Fails with MeshTopology where an edge has not exactly two faces of the same orientation or a vertex has several fans
// of faces, with MeshIndex or MeshNotFinite for bad input. Empty `resolution` and `hidden` are even.
Result<Surface> surfaceOf(const TriangleMesh& mesh, std::span<const float> resolution, std::span<const float> hidden);

}  // namespace fourdvt::track
