// SPDX-License-Identifier: Apache-2.0
// Between Draco's mesh and ours. Internal to package/.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "draco/mesh/mesh.h"
#include "package/base_mesh.h"

namespace fourdvt::package {

// Null if the bytes are not an edgebreaker mesh that decodes.
std::unique_ptr<draco::Mesh> decodeDracoMesh(std::span<const uint8_t> bytes, uint32_t max_faces = kMaxFaces);
// Whether every point has a value of the attribute.
bool mappingInRange(const draco::PointAttribute& attribute, uint32_t point_count);
// Checks attributes, mappings and finiteness. Errors: MeshDataInvalid.
Result<BaseMesh> baseMeshFromDraco(const draco::Mesh& mesh);

// Checks the fixed front of Draco data before the library sees it, so that corrupt counts cannot make it allocate. True
// for an edgebreaker mesh of at most `max_faces` whose counts the bytes can plausibly hold.
bool looksLikeMesh(std::span<const uint8_t> bytes, uint32_t max_faces);

}  // namespace fourdvt::package
