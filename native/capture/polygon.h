// SPDX-License-Identifier: Apache-2.0
// Triangles of polygons in space, between the polygons' own corners.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace fourdvt::capture {

// The most corners of a polygon that is no fan of its first corner: clipping takes the square of their number.
inline constexpr size_t kMostConcaveCorners = 4096;

// Appends `corners`.size() - 2 triangles of the numbers 0…corners.size()-1, which turn as the polygon does. A polygon
// whose triangles to its first corner all face one way (every convex one does) becomes that fan. Another one is clipped
// in the plane of its mean normal; corners at one place are one, as where a cut leads to a hole. A polygon that crosses
// itself has no inside, and one without area no plane: they become fans, too. False, and nothing appended, for a
// polygon of more than kMostConcaveCorners that would have to be clipped.
bool splitPolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles);

// The message for such a polygon.
std::string tooManyCorners(size_t corners);

// The same for faces of a mesh whose corners are known only after it was read whole: they are fans until then.
class LatePolygons {
 public:
  // `corners` of a face, of which triangles first_face… are the fan.
  void add(size_t first_face, std::span<const uint32_t> corners);
  // Puts other triangles in place of fans that are wrong; faces with an index out of range stay. Returns 0, or the
  // number of corners of a polygon that splitPolygon refuses.
  size_t split(std::span<const glm::vec3> positions, std::vector<glm::uvec3>& faces) const;

 private:
  struct Polygon {
    size_t first_face = 0, first_corner = 0, count = 0;
  };
  std::vector<Polygon> polygons_;
  std::vector<uint32_t> corners_;
};

}  // namespace fourdvt::capture
