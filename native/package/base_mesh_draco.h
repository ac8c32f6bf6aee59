// SPDX-License-Identifier: Apache-2.0
// Conversion of Draco meshes to BaseMesh. Internal to package/.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "draco/mesh/mesh.h"
#include "package/base_mesh.h"

namespace fourdvt::package {

// Decodes an edgebreaker mesh; null on any error.
std::unique_ptr<draco::Mesh> decodeDracoMesh(std::span<const uint8_t> bytes, uint32_t max_faces = kMaxFaces);
// Checks that every point has a value of the attribute.
bool mappingInRange(const draco::PointAttribute& attribute, uint32_t point_count);
// Checks attributes, mappings and finiteness. Errors: MeshDataInvalid.
Result<BaseMesh> baseMeshFromDraco(const draco::Mesh& mesh);

// Checks the fixed header of Draco data before the library parses it, so that corrupt counts cannot make it allocate.
// True for an edgebreaker mesh of at most `max_faces` whose counts are plausible for the byte length.
bool looksLikeMesh(std::span<const uint8_t> bytes, uint32_t max_faces);

}  // namespace fourdvt::package
