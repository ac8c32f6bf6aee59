// SPDX-License-Identifier: Apache-2.0
// Mesh files of a sequence: names, topology check. Does NOT keep frames.
#pragma once

#include <string>

#include "capture/capture.h"

namespace fourdvt::capture {

// Path of one frame from a pattern with exactly one %d or %0Nd; empty if the pattern is not one.
std::string framePath(const std::string& pattern, uint32_t frame);

// Reads the OBJ at `path` whole. Errors: FileMissing and those of parseObj.
Result<ObjMesh> readObj(const std::string& path);

bool sameTopology(const MeshTopology& a, const MeshTopology& b);

// Every mesh frame exists and has the capture's topology; reads, but parses only files that differ from the first.
Status checkMeshSequence(const Capture& capture, const CaptureSequence& sequence);

}  // namespace fourdvt::capture
