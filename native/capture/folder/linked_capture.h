// SPDX-License-Identifier: Apache-2.0
// A capture folder that shows another one's pictures beside meshes or mattes of its own: videos, mattes, plates and
// calibrations are links, capture.json is rewritten. Does NOT write meshes or mattes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

inline constexpr const char* kMeshFolder = "mesh";  // of a sequence's folder

struct LinkOptions {
  std::vector<std::string> sequences;  // which go along
  bool own_meshes = false;             // "topology": "per-frame" at <sequence>/mesh/%06d.ply instead of the capture's
  std::vector<std::string> leave_out;  // cameras: the new capture has a calibration of its own, without them
  bool own_calibration = false;        // the cameras as they are in `capture`, not as in its folder
  bool own_times = false;              // the same of frames, first_frame and offset_frames
};

// Links whatever the folder of `capture` holds into `to`, which exists: everything but capture.json, reports, sequences
// that do not go along, and with `own_meshes` meshes. Links are relative, so that both folders can be moved together;
// where links cannot be made, files are copied. What is there already stays, texts that would not change
// included; `to` may be renamed within its parent folder later. Then writes capture.json; with `own_meshes` motion
// classes, which need one topology, are left out. Errors: WriteFailed, CaptureJson, FileMissing.
Status linkCapture(const Capture& capture, const std::string& to, const LinkOptions& options);

// Takes cameras out of a capture that was opened. Errors: InvalidArgument (a name that no camera has; fewer than two
// would be left).
Status leaveOut(const std::vector<std::string>& names, Capture& capture);

}  // namespace fourdvt::capture
