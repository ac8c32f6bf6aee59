// SPDX-License-Identifier: Apache-2.0
// Surfaces as the package codes them, and how fine they are.
#pragma once

#include "base/mesh.h"
#include "package/surface_chunk.h"

namespace fourdvt::bake {

struct PositionGrid {
  glm::dvec3 origin_m{0};
  double step_m = 0.001;
};

// The surface with about `most_faces` faces, if it has more: edges collapse where that changes it least (quadric error
// metric, of meshoptimizer). Its topology stays, and vertices stay where they are; those at the same place become one
// first. 0: as it is.
TriangleMesh simplified(TriangleMesh surface, size_t most_faces);

// Vertices at exactly the same place become one, unless the topology is to stay as it is.
package::QuantisedSurface quantisedSurface(const PositionGrid& grid, const Positions& positions,
                                           const std::vector<glm::uvec3>& faces, bool welds);

}  // namespace fourdvt::bake
