// SPDX-License-Identifier: Apache-2.0
// Checks that a mesh bounds a solid: indices, closedness, orientation and crossings.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <string>

#include "base/mesh.h"

namespace fourdvt::reconstruct {
struct MeshReport {
  size_t bad_indices = 0;  // faces with an invalid vertex index; all other counts are then unset
  size_t open_edges = 0;   // directed edges without exactly one opposite edge
  size_t inverted_components =
      0;                        // winding disagrees with the enclosing component; outermost ones must have volume > 0
  size_t crossing_pairs = 0;    // face pairs that cross or overlap deeper than the tolerance
  size_t degenerate_faces = 0;  // height below the tolerance: harmless, but without normal
  int components = 0;           // connected by shared vertices
  int euler = 0;                // used vertices - edges + faces; 2 per ball, 0 for a torus
  double volume_m3 = 0;         // signed

  bool closed() const { return bad_indices == 0 && open_edges == 0; }
  bool outward() const { return inverted_components == 0; }
  bool solid() const { return closed() && outward() && crossing_pairs == 0; }
};

// `tolerance_m`: permitted error by rounding of positions to float. Adjacent faces are tested too; shared vertices are
// no crossing. Time grows with faces² times the mean share of the two longest axes covered by a face.
MeshReport checkMesh(const TriangleMesh& mesh, double tolerance_m = 1e-6);

// True if checkMesh() finds a solid; ends at the first flaw.
bool isSolid(const TriangleMesh& mesh, double tolerance_m = 1e-6);

// One line for messages of tests and benches.
std::string describe(const MeshReport& report);

using Triangle = std::array<glm::dvec3, 3>;

// Minimum translation that separates two crossing triangles, coplanar overlap included; 0: disjoint or touching, or the
// two sides of a sheet thinner than the tolerance. May return 0 early for a translation of at most `tolerance`.
double crossingDepth(const Triangle& a, const Triangle& b, double tolerance);

}  // namespace fourdvt::reconstruct
