// SPDX-License-Identifier: Apache-2.0
// Fewer faces for a surface, by edge collapses (meshoptimizer). Does NOT change its topology, nor keep faces from
// crossing.
#pragma once

#include <cstddef>

#include "base/mesh.h"

namespace fourdvt::reconstruct {

// At most `most_faces`, where the topology allows it; no change if there are no more already. Vertices in use keep
// their places.
void simplify(TriangleMesh& mesh, size_t most_faces);

}  // namespace fourdvt::reconstruct
