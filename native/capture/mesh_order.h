// SPDX-License-Identifier: Apache-2.0
// Finds frames of a mesh whose faces stay while its vertices change places, by their edges.
#pragma once

#include <vector>

#include "base/mesh.h"

namespace fourdvt::capture {

class EdgeLengths {
 public:
  // Lengths of the faces' edges at one instant.
  EdgeLengths(const std::vector<glm::uvec3>& faces, const Positions& positions);
  // Share of edges that are over five times as long at another instant, for the mesh's size, and span a twentieth of
  // it: about 0 for a surface that moves, about 1 for one whose vertices are shuffled.
  double grown(const Positions& positions) const;

 private:
  struct Edge {
    uint32_t a, b;
    float length;  // of the mesh's size
  };
  std::vector<Edge> edges_;
};

inline constexpr double kMostGrown = 0.05;  // more is no motion of a surface

}  // namespace fourdvt::capture
