// SPDX-License-Identifier: Apache-2.0
// Replaces the triangles of a surface by even ones.
#pragma once

#include <cstdint>
#include <span>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::track {

struct RemeshOptions {
  uint32_t faces = 8000;  // >= 4
  int rounds = 8;         // rounds of splits, collapses, flips and relaxation, >= 1
};

// Remeshes a closed, oriented, manifold surface with about `faces` triangles (within 2 %) of edge lengths in proportion
// to `size`: [vertex] of the input, > 0, relative; empty: uniform. Keeps closedness, orientation, the genus and the
// components; parts that touch in a vertex come apart there. Vertices of the result lie on the input surface. Works in
// one thread; equal inputs have equal results. Errors: MeshIndex, MeshNotFinite; MeshTopology for an open surface,
// another number of sizes, or parts that need more faces; InvalidArgument for sizes and options out of range.
Result<TriangleMesh> remeshed(const TriangleMesh& surface, std::span<const float> size, const RemeshOptions& options);

}  // namespace fourdvt::track
