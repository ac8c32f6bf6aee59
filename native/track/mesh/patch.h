// SPDX-License-Identifier: Apache-2.0
// A chart: faces joined across glued half-edges, with a texture vertex for each fan of joined faces round a vertex, and
// its flattening.
#pragma once

#include "track/mesh/charts.h"

namespace fourdvt::track {

struct Patch {
  FaceSet faces;                          // faces of the surface
  std::vector<glm::uvec3> corners;        // [face of the patch] texture vertices, indices < vertices.size()
  std::vector<uint32_t> vertices;         // [texture vertex] vertex of the surface
  std::vector<uint32_t> border;           // half-edges of the surface, in the order of the one loop of a disk
  std::vector<uint32_t> border_vertices;  // [place in border] texture vertex at the half-edge's start
  std::vector<glm::dvec2> flat;           // [texture vertex] metres; x right, y UP, seen from outside
  bool disk = false;                      // connected, one loop, no handles
};

// Joins `faces` across the half-edges with `glued`; `flat` stays empty.
Patch patchOf(const Surface& surface, FaceSet faces, const std::vector<uint8_t>& glued);

// Next half-edge of a border, counter-clockwise seen from outside; `half_edge` is one that is not glued.
uint32_t nextOnBorder(const Surface& surface, const std::vector<uint8_t>& glued, uint32_t half_edge);

// L2 and L∞ stretch of a chart scaled to the area of its surface; 1: isometric.
struct Stretch {
  double l2 = 1, max = 1;
  bool folded = false;  // a face is mirrored or has no area in the plane
};
Stretch stretchOf(const Surface& surface, const Patch& patch);

// Flattens a disk without mirrored faces: sets `flat` to a start on a circle.
void startOnCircle(const Surface& surface, Patch& patch);

// Improves `flat` towards an isometry, `rounds` times.
void flattenRigidly(const Surface& surface, Patch& patch, int rounds);

// Returns true where the border meets itself, or comes closer than `gap_m` to a place that is farther than that on the
// surface.
bool borderMeetsItself(const Surface& surface, const Patch& patch, double gap_m);

}  // namespace fourdvt::track
