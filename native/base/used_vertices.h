// SPDX-License-Identifier: Apache-2.0
// Native only: what simplification leaves unused.
#pragma once

#include "base/mesh.h"

namespace fourdvt {

// Drops the vertices that no face has; the others are numbered in the order of their first use.
void dropUnusedVertices(TriangleMesh& mesh);

}  // namespace fourdvt
