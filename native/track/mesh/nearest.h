// SPDX-License-Identifier: Apache-2.0
// Nearest points on a triangle mesh, by a tree of boxes.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::track {

// Answers queries for the nearest point of a mesh, exact up to rounding. Copies the mesh. Queries may run in parallel.
class NearestSurface {
 public:
  // Requires valid indices and finite positions. Without faces every query returns nullopt.
  explicit NearestSurface(const TriangleMesh& mesh);

  struct Hit {
    glm::vec3 point{0};        // on the surface
    uint32_t face = 0;         // the first among equally near ones
    glm::vec3 barycentric{0};  // weights of the face's corners, sum 1
    float distance_m = 0;      // from the query's point
  };

  // Returns the nearest point at most `within_m` away, which may be infinity.
  std::optional<Hit> nearest(const glm::vec3& point, float within_m) const;

  // Accepts only faces whose unit normal n has dot(n, normal) >= min_cosine. Faces without area have the normal 0.
  std::optional<Hit> nearestFacing(const glm::vec3& point, const glm::vec3& normal, float min_cosine,
                                   float within_m) const;

  const glm::vec3& faceNormal(uint32_t face) const { return normals_[face]; }  // unit, or 0 without area

 private:
  struct Node {
    glm::vec3 low, high;
    uint32_t begin = 0, end = 0;  // range in `triangles_`
    uint32_t children = 0;        // the first of two adjacent nodes; 0: a leaf
  };
  struct Triangle {
    std::array<glm::vec3, 3> corners;
    uint32_t face;
  };

  void build(uint32_t node);
  template <class Accept>
  std::optional<Hit> search(const glm::vec3& point, float within_m, const Accept& accept) const;

  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;  // in the order of the leaves
  std::vector<glm::vec3> normals_;   // [face]
};

}  // namespace fourdvt::track
