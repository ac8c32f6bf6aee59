// SPDX-License-Identifier: Apache-2.0
// Base-mesh coding decoded without Draco, for the start file. Keeps the order of vertices, UVs, faces and corners, and
// every bit of the values. Byte layout: FORMAT.md, "The mesh in the start file".
#pragma once

#include "package/base_mesh.h"

namespace fourdvt::package {

// Encodes natively only: compact for the order and values of decodeBaseMesh, correct for every mesh with at most three
// vertices and UVs per face. Errors: Internal.
Result<std::vector<uint8_t>> encodeMeshCode(const BaseMesh& decoded);
// Errors: MeshDataInvalid, also for more vertices or faces than given.
Result<BaseMesh> decodeMeshCode(std::span<const uint8_t> bytes, uint32_t max_vertices = 3 * kMaxFaces,
                                uint32_t max_faces = kMaxFaces);

}  // namespace fourdvt::package
