// SPDX-License-Identifier: Apache-2.0
// Whether a mesh bounds a solid. Knows nothing of how the mesh was made, and does NOT repair it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <string>

#include "base/mesh.h"

namespace fourdvt::reconstruct {
struct MeshReport {
  size_t bad_indices = 0;          // faces with a vertex that does not exist; the rest then stays unknown
  size_t open_edges = 0;           // directed edges that are not met by exactly one in the other direction
  size_t inverted_components = 0;  // whose winding disagrees with what they lie in: an outermost one has volume > 0
  size_t crossing_pairs = 0;       // of faces that cross or overlap deeper than the tolerance
  size_t degenerate_faces = 0;     // height below the tolerance; no harm, but no normal either
  int components = 0;              // of faces that share vertices
  int euler = 0;                   // vertices in use - edges + faces; 2 for every ball, 0 for a torus
  double volume_m3 = 0;            // signed

  bool closed() const { return bad_indices == 0 && open_edges == 0; }
  bool outward() const { return inverted_components == 0; }
  bool solid() const { return closed() && outward() && crossing_pairs == 0; }
};

// `tolerance_m`: what rounding positions to float may do. Neighbours are tested like all others: what they share does
// not count as crossing. Time grows with faces² times the mean share of the longest axis that a face covers.
MeshReport checkMesh(const TriangleMesh& mesh, double tolerance_m = 1e-6);

// One line for messages of tests and benches.
std::string describe(const MeshReport& report);

// Whether two triangles of space cross.

using Triangle = std::array<glm::dvec3, 3>;

// By how much one of them would have to move so that they do not cross, overlap in one plane included; 0: they are
// apart or touch, or are the two sides of a sheet thinner than the tolerance. Stops looking, and returns 0, when it is
// at most `tolerance`.
double crossingDepth(const Triangle& a, const Triangle& b, double tolerance);

}  // namespace fourdvt::reconstruct
