// SPDX-License-Identifier: Apache-2.0
// Finds the mesh files of a sequence by the numbers in their names, without reading them.
#pragma once

#include <string>

#include "capture/capture.h"

namespace fourdvt::capture {

// True if the folder contains a mesh: .obj, .ply, .glb or .gltf.
bool holdsMeshes(const std::string& folder);

// Sets the sequence's mesh_pattern and first_mesh from the files of `folder` that end in .obj, .ply, .glb or .gltf:
// numbered files with any prefix and suffix, or the only file, for a sequence of one frame or for glTF. Errors:
// FileMissing (no such folder, no meshes in it), InvalidArgument (several candidates, one static mesh for several
// frames), Unsupported (meshes of unsupported kinds only).
Status findMeshFiles(const std::string& folder, CaptureSequence& sequence);

// Sets first_mesh for the sequence's mesh_pattern: 0 if the numbers are the frames', else the first existing number.
void findFirstMesh(CaptureSequence& sequence);

// Error FileMissing with the first frame without a file and the count of missing files.
Status checkMeshFiles(const CaptureSequence& sequence);

}  // namespace fourdvt::capture
