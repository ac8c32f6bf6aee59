// SPDX-License-Identifier: Apache-2.0
// Points on a closed triangle surface and geodesic walks along it, for appearance that slides over a mesh. Distances
// are those of the constructor's pose.
#pragma once

#include <array>

#include "base/mesh.h"

namespace fourdvt::studio {

struct SurfacePoint {
  uint32_t face = 0;
  glm::dvec3 share{1, 0, 0};  // barycentric, per face corner; sum 1
};

class Surface {
 public:
  // Copies both. An edge has at most two faces.
  Surface(std::vector<glm::uvec3> faces, Positions positions);

  const std::vector<glm::uvec3>& faces() const { return faces_; }
  const Positions& positions() const { return positions_; }
  const std::vector<glm::vec3>& normals() const { return normals_; }  // unit, per vertex
  glm::dvec3 faceNormal(uint32_t face) const;                         // unit
  SurfacePoint atVertex(uint32_t vertex) const;
  // Closest point to `p` on the faces round the nearest vertex.
  SurfacePoint nearest(const glm::dvec3& p) const;
  // End of the geodesic from `from` in the direction of `step`, projected to the surface, with the length of `step`.
  // Stops at an open edge.
  SurfacePoint walk(const SurfacePoint& from, const glm::dvec3& step) const;
  // Position of the point for vertices at `pose`.
  glm::dvec3 place(const SurfacePoint& point, const Positions& pose) const;

 private:
  glm::dvec3 corner(uint32_t face, int k) const { return positions_[faces_[face][k]]; }
  glm::dvec3 shareRate(uint32_t face, const glm::dvec3& direction) const;
  bool cross(SurfacePoint& at, int opposite, glm::dvec3& direction) const;

  std::vector<glm::uvec3> faces_;
  Positions positions_;
  std::vector<glm::vec3> normals_;
  std::vector<std::array<int, 3>> neighbours_;  // across the edge opposite to corner k; -1: open
  std::vector<std::vector<uint32_t>> vertex_faces_;
};

}  // namespace fourdvt::studio
