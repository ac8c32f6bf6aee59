// SPDX-License-Identifier: Apache-2.0
// Points on a closed triangle surface and walks along it: how the studio lets appearance slide over a mesh.
// Distances are those of the pose that the surface was made with. Does NOT remesh.
#pragma once

#include <array>

#include "base/mesh.h"

namespace fourdvt::studio {

struct SurfacePoint {
  uint32_t face = 0;
  glm::dvec3 share{1, 0, 0};  // barycentric, of the face's corners; sum 1
};

class Surface {
 public:
  // Copies both. Every edge has at most two faces.
  Surface(std::vector<glm::uvec3> faces, Positions positions);

  const std::vector<glm::uvec3>& faces() const { return faces_; }
  const Positions& positions() const { return positions_; }
  const std::vector<glm::vec3>& normals() const { return normals_; }  // unit, per vertex
  glm::dvec3 faceNormal(uint32_t face) const;                         // unit
  SurfacePoint atVertex(uint32_t vertex) const;
  // The closest point to `p` on the faces round the nearest vertex.
  SurfacePoint nearest(const glm::dvec3& p) const;
  // The end of the geodesic that leaves `from` in the direction of `step`, turned into the surface, and is as long as
  // `step`. A walk that meets an open edge ends there.
  SurfacePoint walk(const SurfacePoint& from, const glm::dvec3& step) const;
  // Where the point lies when the vertices are at `pose`.
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
