// SPDX-License-Identifier: Apache-2.0
// Mesh files of a sequence: their names, and the check that all have one topology. Frames are not kept in memory.
#pragma once

#include <string>

#include "capture/capture.h"
#include "capture/mesh_file.h"
#include "capture/mesh_order.h"

namespace fourdvt::capture {

// Remedy for missing meshes where they are required.
inline constexpr const char* kRunReconstruct = "run `fourdvt reconstruct CAPTURE -o CAPTURE2` first, and use CAPTURE2";

// Error InvalidArgument if the sequence has no such frame.
Status checkFrame(const CaptureSequence& sequence, uint32_t frame);

// Path of one frame, from a pattern with exactly one %d or %0Nd; empty for other patterns.
std::string framePath(const std::string& pattern, uint32_t frame);

// Path of a frame's mesh file; the sequence is not packed.
std::string meshPath(const CaptureSequence& sequence, uint32_t frame);

// Instant of a frame in its mesh file. A single file of several frames begins with picture 0, not with frame 0.
MeshInstant meshInstant(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

// Reads the whole OBJ at `path`. `split_as` and errors: as in parseObj, and FileMissing.
Result<UvMesh> readObj(const std::string& path, const MeshTopology* split_as = nullptr);

// Reads a frame's mesh with its UVs, in the file's units; polygons are split as in the capture's topology. Errors:
// those of readObj and readUvGltf; Unsupported (files of another kind).
Result<UvMesh> readUvMesh(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

bool sameTopology(const MeshTopology& a, const MeshTopology& b);

// Checks that every mesh frame exists and has the capture's topology, with vertices in the order of `reference`, which
// is made from the first frame if empty. Reads all files, but parses faces only where the topology lines differ from
// the first file's. Errors: FileMissing, MeshTopology and those of readUvMesh.
Status checkMeshSequence(const Capture& capture, const CaptureSequence& sequence,
                         std::optional<EdgeLengths>& reference);

}  // namespace fourdvt::capture
