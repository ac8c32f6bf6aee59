// SPDX-License-Identifier: Apache-2.0
// Removal of unused vertices after simplification; native only.
#pragma once

#include "base/mesh.h"

namespace fourdvt {

// Drops the vertices without a face and renumbers the others in the order of their first use.
void dropUnusedVertices(TriangleMesh& mesh);

}  // namespace fourdvt
