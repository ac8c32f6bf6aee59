// SPDX-License-Identifier: Apache-2.0
// Finds the mesh files of a sequence by the numbers in their names. Does NOT read meshes.
#pragma once

#include <string>

#include "capture/capture.h"

namespace fourdvt::capture {

// True if a file of the folder is a mesh: .obj, .ply, .glb or .gltf.
bool holdsMeshes(const std::string& folder);

// Sets the sequence's mesh_pattern and first_mesh from the files of `folder` that end in .obj, .ply, .glb or .gltf:
// numbered files, whatever stands before and after the number, or the only file, of a sequence of one frame or of
// glTF. Errors: FileMissing (no such folder, no meshes in it), InvalidArgument (several candidates, one still mesh for
// several frames), Unsupported (meshes of another kind alone).
Status findMeshFiles(const std::string& folder, CaptureSequence& sequence);

// Sets first_mesh for the mesh_pattern that the sequence has: 0 if the numbers are the frames', else the first number
// that there is.
void findFirstMesh(CaptureSequence& sequence);

// Error FileMissing that names the first frame without a file and says how many have none.
Status checkMeshFiles(const CaptureSequence& sequence);

}  // namespace fourdvt::capture
