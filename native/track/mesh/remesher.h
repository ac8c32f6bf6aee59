// SPDX-License-Identifier: Apache-2.0
// Passes of remeshing; remesh.h has the whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "track/mesh/half_edges.h"
#include "track/mesh/nearest.h"

namespace fourdvt::track {

// A surface in work: vertices lie on the input surface before and after each pass, no pass turns a face over.
class Remesher {
 public:
  // `surface` and `size` are borrowed; `mesh` and `positions` are the surface's own, with its fans apart.
  Remesher(const TriangleMesh& surface, std::span<const float> size, HalfEdges mesh, Positions positions);

  // Passes. Edge lengths are relative: over `length_m` times the mean size of the edge's ends.
  void splitLong(float length_m);
  void collapseShort(float length_m);
  void flipEdges(bool for_valence);  // towards valence 6; false: towards larger angles
  void relax();                      // one tangential step of each vertex

  // Splits the longest or collapses the shortest edges until there are `faces`, or until no change is permitted.
  void trim(size_t faces, float length_m);

  size_t faceCount() const { return mesh_.faceCount(); }
  double relativeArea() const;  // sum over the faces of the area over the squared size, m²
  TriangleMesh result() const;

 private:
  struct Place {
    glm::vec3 position;
    float size;
  };
  struct Candidate {
    float length;  // relative
    uint32_t half_edge;
  };

  std::optional<Place> placed(const glm::vec3& point, const glm::vec3& normal, float within_m) const;
  glm::vec3 twiceArea(uint32_t h) const;   // normal of h's face, as long as twice the area
  glm::vec3 ringNormal(uint32_t v) const;  // unit, or 0
  float relativeLength(uint32_t h) const;  // metres per size
  std::vector<Candidate> edges(float min_length, float max_length) const;
  bool keepsFaces(uint32_t v, uint32_t but, const glm::vec3& position, const glm::vec3& normal, float min_share) const;
  bool staysShort(uint32_t v, const Place& place, float max_length) const;
  bool split(uint32_t h);
  bool collapse(uint32_t h, float max_length);
  bool flipGains(uint32_t h, bool for_valence) const;
  size_t changeEdges(const std::vector<Candidate>& candidates, size_t max_changes, bool split, float max_length);

  HalfEdges mesh_;
  Positions positions_;
  std::vector<float> sizes_;  // [vertex]
  const TriangleMesh& surface_;
  std::span<const float> surface_sizes_;
  NearestSurface nearest_;
};

}  // namespace fourdvt::track
