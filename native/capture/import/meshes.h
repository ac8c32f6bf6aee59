// SPDX-License-Identifier: Apache-2.0
// Finds meshes beside the pictures of an import; they stay unturned and unscaled.
#pragma once

#include "capture/import/takes.h"

namespace fourdvt::capture {

enum class ImportedMeshes { None, ConstantTopology, PerFrame };

// Sets the meshes of the takes, one file per frame, from the folder `mesh` of each: .obj, .ply, .glb or .gltf, by the
// numbers in their names. Topology is constant if all are OBJ files whose faces and UVs are equal in the first and the
// last frame of all takes. Errors: FileMissing (a frame has none), InvalidArgument (several series of files).
Result<ImportedMeshes> findMeshes(std::vector<Take>& takes, std::vector<std::string>& done,
                                  std::vector<std::string>& warnings);

}  // namespace fourdvt::capture
