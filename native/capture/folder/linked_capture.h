// SPDX-License-Identifier: Apache-2.0
// Makes a capture folder that links to the videos, mattes, plates and calibrations of another one, and has a
// capture.json of its own. New meshes or mattes, which replace the links, are written by the caller.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

inline constexpr const char* kMeshFolder = "mesh";  // name in a sequence's folder

struct LinkOptions {
  std::vector<std::string> sequences;  // sequences to include
  bool own_meshes = false;             // "topology": "per-frame" at <sequence>/mesh/%06d.ply instead of the capture's
  std::vector<std::string> leave_out;  // cameras to remove; the new capture has its own calibration without them
  bool own_calibration = false;        // cameras as in `capture`, rather than as in its folder
  bool own_times = false;              // frames, first_frame and offset_frames as in `capture`
};

// Links the contents of `capture`'s folder into `to`, which exists: everything but capture.json, reports, excluded
// sequences, and with `own_meshes` meshes. Links are relative, so that both folders can be moved together; where links
// are impossible, files are copied. Existing entries stay, including texts that would not change; `to` may be renamed
// within its parent folder later. Then writes capture.json; with `own_meshes` motion classes, which require one
// topology, are left out. Errors: WriteFailed, CaptureJson, FileMissing.
Status linkCapture(const Capture& capture, const std::string& to, const LinkOptions& options);

// Removes cameras from an opened capture. Errors: InvalidArgument (a name that no camera has; fewer than two cameras
// left).
Status leaveOut(const std::vector<std::string>& names, Capture& capture);

}  // namespace fourdvt::capture
