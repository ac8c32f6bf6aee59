// SPDX-License-Identifier: Apache-2.0
// Meshes that lie beside the pictures of an import. Does NOT turn, scale or judge them.
#pragma once

#include "capture/import/takes.h"

namespace fourdvt::capture {

enum class ImportedMeshes { None, ConstantTopology, PerFrame };

// Sets the meshes of the takes, one file a frame, from the folder `mesh` of each: .obj, .ply, .glb or .gltf, found by
// the numbers in their names. Constant topology: OBJ files whose faces and UVs are the same in the first and the last
// frame of all takes. Errors: FileMissing (a frame has none), InvalidArgument (several series of files).
Result<ImportedMeshes> findMeshes(std::vector<Take>& takes, std::vector<std::string>& done,
                                  std::vector<std::string>& warnings);

}  // namespace fourdvt::capture
