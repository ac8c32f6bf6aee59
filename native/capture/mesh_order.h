// SPDX-License-Identifier: Apache-2.0
// Detects, by edge lengths, frames of a mesh whose vertices are permuted while its faces stay.
#pragma once

#include <vector>

#include "base/mesh.h"

namespace fourdvt::capture {

class EdgeLengths {
 public:
  // Measures the faces' edges at one instant.
  EdgeLengths(const std::vector<glm::uvec3>& faces, const Positions& positions);
  // Share of edges that, relative to the mesh's size, are over five times as long at another instant and span a
  // twentieth of it: about 0 for a moving surface, about 1 for shuffled vertices.
  double grown(const Positions& positions) const;

 private:
  struct Edge {
    uint32_t a, b;
    float length;  // relative to the mesh's size
  };
  std::vector<Edge> edges_;
};

inline constexpr double kMaxGrown = 0.05;  // maximum share for a moving surface

}  // namespace fourdvt::capture
