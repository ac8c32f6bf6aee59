// SPDX-License-Identifier: Apache-2.0
// Triangles for a flat polygon with holes, between its own vertices.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace fourdvt {
// A vertex of a polygon in its plane. Vertices differ in `id`; in a single loop, one that the loop touches twice has
// one id.
struct FlatVertex {
  glm::dvec2 place{0};
  uint32_t id = 0;
};
using FlatLoop = std::vector<FlatVertex>;

// Appends triangles of ids. `loops` turn left round the polygon's inside: outer ones counter-clockwise, holes
// clockwise; several outer ones are several polygons. Every loop edge is used once in its direction, every other edge
// once in each, even where rounded places make the polygon cross itself; so faces that share loop edges stay closed.
void triangulate(std::vector<FlatLoop> loops, std::vector<glm::uvec3>& triangles);

// Geometry of a plane.

// Twice the signed area of the triangle (0, a, b).
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace fourdvt
