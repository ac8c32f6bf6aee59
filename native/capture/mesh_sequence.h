// SPDX-License-Identifier: Apache-2.0
// The mesh files of a sequence: their names, and the check that all have one topology. Does NOT keep frames.
#pragma once

#include <string>

#include "capture/capture.h"

namespace fourdvt::capture {

// The remedy where meshes are needed and there are none.
inline constexpr const char* kRunReconstruct = "run `fourdvt reconstruct CAPTURE -o CAPTURE2` first, and use CAPTURE2";

// Error InvalidArgument if the sequence has no such frame.
Status checkFrame(const CaptureSequence& sequence, uint32_t frame);

// Path of one frame, from a pattern with exactly one %d or %0Nd; empty if `pattern` is no such pattern.
std::string framePath(const std::string& pattern, uint32_t frame);

// Path of a frame's mesh file; the sequence has one file a frame.
std::string meshPath(const CaptureSequence& sequence, uint32_t frame);

// Reads the whole OBJ at `path`. Errors: FileMissing and those of parseObj, which has `split_as`, too.
Result<UvMesh> readObj(const std::string& path, const MeshTopology* split_as = nullptr);

bool sameTopology(const MeshTopology& a, const MeshTopology& b);

// Checks that every mesh frame exists and has the capture's topology. Reads all files, but parses only those whose
// topology lines differ from the first one's. Errors: FileMissing, MeshTopology and those of parseObj.
Status checkMeshSequence(const Capture& capture, const CaptureSequence& sequence);

}  // namespace fourdvt::capture
