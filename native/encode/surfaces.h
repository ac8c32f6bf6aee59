// SPDX-License-Identifier: Apache-2.0
// Surfaces as the package codes them: how many faces they have, their positions on a grid, colours of their vertices.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "package/surface_chunk.h"

namespace fourdvt::encode {

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

// Colours of a surface's vertices from calibrated pictures, for glTF viewers that draw neither videos nor cameras;
// detail finer than the vertices' distance is averaged. Linear RGB of each vertex, 65535 = 1, as glTF's COLOR_0 has it.
// A camera counts where it sees the vertex (a depth test against the surface itself, half a mean edge to spare), by the
// fourth power of the cosine between normal and ray; its colour is the mean of the pixels of at least half alpha in a
// square round it, two thirds of the mean edge wide and 25 pixels at most. Vertices that no camera sees take a mean of
// their neighbours, nearest first; all are mid-grey where none is seen. `pictures` has one of each camera, of the
// camera's size: RGBA, sRGB.
std::vector<glm::u16vec3> vertexColours(const TriangleMesh& surface, const std::vector<PinholeCamera>& cameras,
                                        std::span<const Image> pictures);

}  // namespace fourdvt::encode
