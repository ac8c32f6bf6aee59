// SPDX-License-Identifier: Apache-2.0
// Triangulation of polygons in space, without new vertices.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace fourdvt::capture {

// Maximum corners of a polygon that needs clipping, which takes quadratic time.
inline constexpr size_t kMaxConcaveCorners = 4096;

// Appends `corners`.size() - 2 triangles with indices 0…corners.size()-1, oriented as the polygon. A polygon whose fan
// from its first corner is consistently oriented (every convex one) becomes that fan. Others are clipped in the plane
// of their mean normal; coincident corners are merged, as where a cut leads to a hole. Self-intersecting polygons and
// polygons without area become fans, too. Returns false, and appends nothing, for a polygon of more than
// kMaxConcaveCorners that needs clipping.
bool splitPolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles);

// Message for a polygon that splitPolygon refuses.
std::string tooManyCorners(size_t corners);

// Triangulation of faces whose corners' positions are known only after the whole mesh was read; until then they are
// fans.
class LatePolygons {
 public:
  // Adds a face with `corners`, whose fan starts at triangle first_face.
  void add(size_t first_face, std::span<const uint32_t> corners);
  // Replaces fans that are wrong; faces with an index out of range stay. Returns 0, or the number of corners of a
  // polygon that splitPolygon refuses.
  size_t split(std::span<const glm::vec3> positions, std::vector<glm::uvec3>& faces) const;

 private:
  struct Polygon {
    size_t first_face = 0, first_corner = 0, count = 0;
  };
  std::vector<Polygon> polygons_;
  std::vector<uint32_t> corners_;
};

}  // namespace fourdvt::capture
