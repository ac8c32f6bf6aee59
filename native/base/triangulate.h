// SPDX-License-Identifier: Apache-2.0
// Triangulation of a planar polygon with holes, without new vertices.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt {
// Polygon vertex in its plane. Ids are unique, except that a loop that touches itself repeats the id of the contact
// point.
struct FlatVertex {
  glm::dvec2 place{0};
  uint32_t id = 0;
};
using FlatLoop = std::vector<FlatVertex>;

// Appends triangles of ids. `loops` keep the polygon's inside on their left: outer ones counter-clockwise, holes
// clockwise; several outer loops are several polygons. The triangles use each loop edge once in its direction and each
// other edge once in each direction, even if rounding makes the polygon self-intersect; faces that share loop edges
// therefore stay closed.
void triangulate(std::vector<FlatLoop> loops, std::vector<glm::uvec3>& triangles);

// Twice the signed area of the triangle (0, a, b).
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace fourdvt
