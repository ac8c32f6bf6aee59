// SPDX-License-Identifier: Apache-2.0
// Faces for the edges of a polyhedral visual hull: loops in every plane, and triangles between their vertices.
#pragma once

#include <span>

#include "base/result.h"
#include "reconstruct/hull_edges.h"

namespace fourdvt::reconstruct {

// A closed mesh, or Internal where the half edges do not make one: each vertex must end three edges, two of every face
// that it lies on. `edges`: sorted by plane on return.
Result<TriangleMesh> hullFaces(const HullPlanes& planes, std::vector<HalfEdge>& edges);

}  // namespace fourdvt::reconstruct
