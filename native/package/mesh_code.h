// SPDX-License-Identifier: Apache-2.0
// A base mesh in a coding of its own, which is decoded without Draco: for the start file. It keeps the order of
// vertices, UVs, faces and corners, and every bit of the values. Byte layout: FORMAT.md, "The mesh in the start file".
#pragma once

#include "package/base_mesh.h"

namespace fourdvt::package {

// Native only. Small where order and values are those that decodeBaseMesh gives; right for every mesh whose vertices
// and UVs are at most three per face. Errors: Internal.
Result<std::vector<uint8_t>> encodeMeshCode(const BaseMesh& decoded);
// Errors: MeshDataInvalid, also for more vertices or faces than given.
Result<BaseMesh> decodeMeshCode(std::span<const uint8_t> bytes, uint32_t max_vertices = 3 * kMaxFaces,
                                uint32_t max_faces = kMaxFaces);

}  // namespace fourdvt::package
