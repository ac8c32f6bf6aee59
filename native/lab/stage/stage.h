// SPDX-License-Identifier: Apache-2.0
// Converts a capture into the stage of a live system: RIG.json, cameras, plates, and per camera a video to play in a
// loop. Videos and plates are undistorted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/video.h"
#include "capture/capture.h"

namespace fourdvt::stage {

struct StageOptions {
  std::string folder;                // output folder
  int width = 320, height = 240;     // even
  std::string sequence;              // empty: the capture's first
  std::vector<std::string> cameras;  // empty: all
  bool counter = false;              // paint the picture's number on the performer; requires mattes or plates
  int pictures = 0;                  // video length, repeating the sequence; 0: the sequence once, or 1000 if counted
};

// counter.json, if counted:
//   {"cell_px": 4, "columns": 4, "rows": 4, "pictures": 1000, "frames": 19, "cameras": {"cam00": [[x, y], …]}}
// has per camera and frame of the sequence the corner of the cells in pixels, or null where they have no room; picture
// i shows frame i modulo "frames". Errors: InvalidArgument (an option, named), those of the capture's readers,
// WriteFailed.
Status writeStage(const capture::Capture& capture, const StageOptions& options, const OpenVideo& open_video,
                  const std::function<void(const std::string& camera, uint32_t picture)>& progress = {});

}  // namespace fourdvt::stage
