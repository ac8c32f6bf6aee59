// SPDX-License-Identifier: Apache-2.0
// Surfaces as they are coded in the package: number of faces, positions on a grid, vertex colours.
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

// Simplifies the surface to about `max_faces` faces, if it has more, by edge collapses in order of their quadric
// error (meshoptimizer). Topology is preserved, and vertices stay where they are; those at the same place are merged
// first. 0: unchanged.
TriangleMesh simplified(TriangleMesh surface, size_t max_faces);

// Quantises positions to the grid. welds: merges vertices at exactly the same place; false preserves the topology.
package::QuantisedSurface quantisedSurface(const PositionGrid& grid, const Positions& positions,
                                           const std::vector<glm::uvec3>& faces, bool welds);

// Colours of a surface's vertices from calibrated pictures, for glTF viewers that show neither videos nor cameras;
// detail finer than the vertices' distance is averaged. Linear RGB of each vertex, 65535 = 1, as in glTF's COLOR_0.
// Each camera that sees the vertex (a depth test against the surface itself, with a tolerance of half a mean edge) is
// weighted by the fourth power of the cosine between normal and ray; its colour is the mean of the pixels of at least
// half alpha in a square round the vertex, two thirds of the mean edge wide and at most 25 pixels. Vertices that no
// camera sees take a mean of their neighbours, nearest first; all are mid-grey where none is seen. `pictures` has one
// of each camera, of the camera's size: RGBA, sRGB.
std::vector<glm::u16vec3> vertexColours(const TriangleMesh& surface, const std::vector<PinholeCamera>& cameras,
                                        std::span<const Image> pictures);

}  // namespace fourdvt::encode
