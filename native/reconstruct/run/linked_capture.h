// SPDX-License-Identifier: Apache-2.0
// A capture folder that shows another one's pictures beside meshes of its own: videos, mattes, plates and calibrations
// are links, capture.json is rewritten. Does NOT write meshes.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::reconstruct {

inline constexpr const char* kMeshFolder = "mesh";  // of a sequence's folder

// Links whatever the capture folder `from` holds into `to`, which exists: everything but capture.json, meshes,
// sequences that are not asked for, and the report of an earlier reconstruction. Links are relative, so that both
// folders can be moved together; where links cannot be made, files are copied. What is there already stays; `to` may be
// renamed within its parent folder later. Then writes capture.json with these sequences, "topology": "per-frame" and
// their meshes at <sequence>/mesh/%06d.ply; motion classes, which need one topology, are left out. Errors: WriteFailed,
// CaptureJson, FileMissing.
Status linkCapture(const std::string& from, const std::string& to, const std::vector<std::string>& sequences);

}  // namespace fourdvt::reconstruct
